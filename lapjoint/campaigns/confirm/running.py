"""Confirms the bifurcations of a file of branches by another solver, from the motions that the file holds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
from lapjoint.campaigns.running import run_job
from lapjoint.campaigns.workers import Workers
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.confirm.solve import Confirmed
    from lapjoint.campaigns.confirm.spec import ConfirmSpec  # noqa: F401 (the base class below names it)


@dataclass(frozen=True)
class ConfirmJob(Job["ConfirmSpec", "Confirmed"]):
    """The work on a confirmation; its cells are the bifurcations.

    Modules that import scipy are imported late, because `lapjoint.campaigns` is also imported for lighter work.
    """

    longest_batch: ClassVar[int] = 4
    """Largest number of bifurcations in a batch: each takes some seconds."""

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Confirmed, None]:
        """The result of the other solver for a bifurcation."""
        from lapjoint.campaigns.confirm.solve import solve_bifurcation

        return solve_bifurcation(self.spec, cell), None

    def point(self, fields: Mapping[str, Any]) -> Confirmed:
        """The result for a bifurcation, from its attributes."""
        from lapjoint.campaigns.confirm.solve import Confirmed

        return Confirmed(**fields)

    def dataset(self, points: Mapping[int, Confirmed]) -> xr.Dataset:
        """The dataset of all bifurcations."""
        from lapjoint.campaigns.confirm.table import confirm_dataset

        return confirm_dataset(self.spec, [points[cell] for cell in range(self.spec.size)])


def confirm(
    branches: str | Path | xr.Dataset,
    *,
    solver: str = "fe",
    options: Mapping[str, Any] | None = None,
    share: float = 1.0,
    seed: int = 0,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Look for the bifurcations of branches by another solver, too.

    Parameters
    ----------
    branches : str, Path or xarray.Dataset
        What `lapjoint.branch` gave, or its file.
    solver : str
        Entry-point name of the other solver; it must give its period map.
    options : mapping, optional
        Numerical options of that.
    share : float
        Share of the bifurcations that are looked for, drawn at random; 1 for all.
    seed : int
        Seed of the draw.
    workers : int or map-like callable
        As for `sweep`.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``.
    out : str or Path, optional
        File of the dataset, as NetCDF.  Until all is done, a journal beside it keeps the bifurcations that are done,
        and the same call resumes.
    force : bool
        Whether something else in `out` may be thrown away.
    progress : callable, optional
        Called with the number of bifurcations done and the number of all.

    Returns
    -------
    xarray.Dataset
        The value and the error of each by both solvers, and the verdict; docs/branches.md lists the variables.

    Raises
    ------
    InputError
        If a parameter is not valid, `branches` has nothing that can be confirmed, `out` holds something else, or
        another process works on it.
    OutputError
        If the disk is full.
    Interrupted
        After Ctrl-C.
    """
    from lapjoint.campaigns.branches.table import read_branches
    from lapjoint.campaigns.confirm.spec import confirm_spec

    found = read_branches(branches) if isinstance(branches, str | Path) else branches
    spec = confirm_spec(found, solver, dict(options or {}), share, seed)
    return run_job(ConfirmJob(spec), workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)
