"""A dataset that a command finds, or that is finished already in the file it would write."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from lapjoint.cli.echo import echo
from lapjoint.cli.options import Work

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.job import Spec


def found_or_stored(
    plan: Spec,
    title: str,
    holds: str,
    find: Callable[..., xr.Dataset],
    work: Work,
    *,
    search: bool = False,
) -> xr.Dataset:
    """The dataset of a plan: read from its file if the file is finished, else found, with progress under a `title`.

    `holds` names the content of a finished file, for example "this sweep".  `find` takes `progress` and the fields of
    `work`.  With `search`, the amount of work is not known in advance, and progress shows no remaining time.
    """
    from lapjoint.campaigns import stored
    from lapjoint.cli.progress import shown_points, shown_search

    there = None if work.out is None else stored(plan, work.out, force=work.force)
    if there is not None:
        echo(f"{work.out}: holds {holds} already, finished")
        return there
    with (shown_search if search else shown_points)(title) as progress:
        found = find(progress=progress, **work._asdict())
    if work.out is not None:
        echo(f"Wrote {work.out}")
    return found
