"""The version of the files that campaigns write, a dataset and the journal beside it, and what every dataset says.

The version is raised whenever a reader of the version before would misread a file, or miss something in it.
"""

from __future__ import annotations

import json
from numbers import Integral
from typing import Any, Protocol

from lapjoint.campaigns.campaign import Kept

FORMAT_VERSION = 3
"""Version of the files that are written, and the only one that is read.  Version 2 had no checksums.  Version 1 had
other names for `period_multiple`, `multiplier_real` and `multiplier_imag`, `standard_error` and `duration` too; its
datasets did not say that they were of version 1."""


def refusal(found: object) -> str:
    """The reason for which a file of some format version is not read.

    Parameters
    ----------
    found : object
        Format version that the file gives, of whatever type.

    Returns
    -------
    str
        The reason, as the rest of a sentence about the file; empty if the file can be read.
    """
    if found == FORMAT_VERSION:
        return ""
    whose = "a newer" if isinstance(found, Integral) and int(found) > FORMAT_VERSION else "an older"
    return f"is of format version {found}, which {whose} lapjoint wrote; this one reads version {FORMAT_VERSION} only"


class Work(Kept, Protocol):
    """Work of which a dataset is the result."""

    @property
    def solver(self) -> str:
        """Entry-point name of the solver."""


def attributes_of(work: Work, title: str, **own: Any) -> dict[str, Any]:
    """The attributes of a dataset.

    Parameters
    ----------
    work : Work
        What it is the result of.
    title : str
        Its title.
    **own : object
        What only datasets of this kind say.

    Returns
    -------
    dict
        What every dataset says, and `own`.
    """
    identity = work.identity
    return {
        "Conventions": "CF-1.11",
        "format_version": FORMAT_VERSION,
        "title": title,
        "solver": work.solver,
        "options": json.dumps(identity["options"]),
        **own,
        **{f"version_{name}": number for name, number in identity["versions"].items()},
        "fingerprint": work.fingerprint,
    }
