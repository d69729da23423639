"""The version of the files that a sweep writes: the dataset and the journal beside it.

It is raised whenever a reader of the version before would misread a file, or lack what it looks for.
"""

from __future__ import annotations

from numbers import Integral

FORMAT_VERSION = 2
"""Version 1 had `order`, `multiplier`, `spread` and `span` where this one has `period_multiple`, `multiplier_real` and
`multiplier_imag`, `standard_error` and `duration`; its datasets did not say that they were of version 1."""


def refusal(found: object) -> str:
    """Why a file is not read that says it is of the version `found`; empty where it is read."""
    if found == FORMAT_VERSION:
        return ""
    whose = "a newer" if isinstance(found, Integral) and int(found) > FORMAT_VERSION else "an older"
    return f"is of format version {found}, which {whose} lapjoint wrote; this one reads version {FORMAT_VERSION} only"
