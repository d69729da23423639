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
    """The dataset of a plan, from its file if it is finished there; else found, with progress shown.

    Parameters
    ----------
    plan : Kept
        The work.
    title : str
        What progress is headed.
    holds : str
        What is said of a file that holds it already, as "this sweep".
    find : callable
        Finds it: takes the plan, `out`, `force`, `progress` and what `how` holds.
    out : str or None
        Its file.
    force : bool
        Whether something else in the file may be thrown away.
    search : bool
        Whether what is found leads to more work, so that the time that is left cannot be told.
    **how : object
        Further keywords of `find`, as ``workers``.

    Returns
    -------
    xarray.Dataset
        The dataset.
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
