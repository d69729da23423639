"""A dataset that a command finds, or that is finished already in the file it would write."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from lapjoint.cli.echo import echo

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.campaign import Kept


def found_or_stored(
    plan: Kept,
    title: str,
    holds: str,
    find: Callable[..., xr.Dataset],
    *,
    out: str | None,
    force: bool,
    search: bool = False,
    **how: Any,
) -> xr.Dataset:
    """The dataset of a plan: from the file `out` if it is finished there, else found by `find`, with progress under a
    `title`.

    `holds` says what a finished file has, as "this sweep". With `search` what is found leads to more work, and no time
    left is told. `find` takes the plan, `out`, `force`, `progress` and `how`.
    """
    from lapjoint.campaigns import stored
    from lapjoint.cli.progress import shown_points, shown_search

    there = None if out is None else stored(plan, out, force=force)
    if there is not None:
        echo(f"{out}: holds {holds} already, finished")
        return there
    with (shown_search if search else shown_points)(title) as progress:
        found = find(plan, out=out, force=force, progress=progress, **how)
    if out is not None:
        echo(f"Wrote {out}")
    return found
