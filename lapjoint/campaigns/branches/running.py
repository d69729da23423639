"""Runs a search for branches from its question to its dataset; workers do the parts of the search simultaneously.

Several workers follow a few branches at each value of a second parameter.  One process takes one value after the other,
and one branch after the other.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.batch import Batch, Solved
from lapjoint.campaigns.branches.journal import BranchJournal
from lapjoint.campaigns.branches.spec import EFFORT, MAX_POINTS, BranchSpec
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.running import send, stored
from lapjoint.campaigns.workers import Workers, check_workers
from lapjoint.files.netcdf import write_netcdf
from lapjoint.machine.processes import StandingPool, standing_pool
from lapjoint.problem import Problem
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.branches.search import Diagram, Part, Search

_AHEAD, _AHEAD_OF_OTHERS = 2, 32
"""Numbers of branches under way at each value of a second parameter: for each process, and for workers whose number is
not known.  With two branches for a process, one waits in the queue, so that no process waits for work."""


def branch(
    problem: Problem,
    path: str,
    first: float,
    last: float,
    *,
    solver: str = "analytic",
    options: Mapping[str, Any] | None = None,
    max_period_multiple: int = 1,
    starts: int = 0,
    seed: int = 0,
    errors: bool = True,
    max_points: int = MAX_POINTS,
    effort: int = EFFORT,
    also_over: Axis | None = None,
    from_grazes: bool = False,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Follow the periodic motions of a problem, stable or not, while one of its numbers changes.

    Parameters
    ----------
    problem : Problem
        The problem that has all that the number does not change.
    path : str
        Path of the number, as `Axis` takes it: ``stops.*.gap``, or `FREQUENCY`, which sets the frequency of all
        periodic excitation.
    first, last : float
        The range of the number, in its SI unit.
    solver : str
        Entry-point name of the solver; it must give its period map.
    options : mapping, optional
        Numerical options of the solver.
    max_period_multiple : int
        Largest period multiple: branches that spring from flips are followed up to it.
    starts : int
        Number of random starts besides the problem's own initial state and the motion without contact at both ends of
        the range: they find branches that do not spring from those.
    seed : int
        Seed of the random starts.
    errors : bool
        Whether to estimate the errors of the bifurcations, by finer resolutions of the solver.
    max_points : int
        Largest number of points of a branch; one that needs more, or more tries than go with so many, ends as
        ``effort``.
    effort : int
        Number of points of all branches together, each counted by its period multiple, from which on no further branch
        is followed, at each value of `also_over`; the dataset tells how many motions are left out.
    also_over : Axis, optional
        A second parameter, and its values: all is done at each value, and bifurcations that go on from value to value
        lie on one locus.
    from_grazes : bool
        Whether motions are looked for beside each graze that have its contact every second period alone, or in one half
        of a motion that mirrored itself.
    workers : int or map-like callable
        Number of processes, -1 for all processors; or a function that maps a function over an iterable.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``.
    out : str or Path, optional
        File of the dataset, as NetCDF.  Until the search is finished, a journal beside it keeps the branches that are
        done, and the same call resumes.
    force : bool
        Whether something else in `out` may be thrown away.
    progress : callable, optional
        Called with the number of parts of the work done, a branch under way as the share that is followed, and the
        number known of.

    Returns
    -------
    xarray.Dataset
        The dataset; docs/branches.md lists its variables.

    Raises
    ------
    InputError
        If a parameter is not valid, `out` holds something else, or another process works on it.
    OutputError
        If the disk is full.
    Interrupted
        After Ctrl-C.
    """
    numerics, limits = dict(options or {}), (max_points, effort)
    how = max_period_multiple, starts, seed, errors, *limits, also_over, from_grazes
    spec = BranchSpec(problem, path, first, last, solver, numerics, *how)
    found = None if out is None else stored(spec, out, force=force)
    if found is not None:
        return found
    return find_branches(spec, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def find_branches(
    spec: BranchSpec,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a search, and replace what is in `out`; arguments and errors are those of `branch`."""
    from lapjoint.campaigns.branches.spec import range_of
    from lapjoint.campaigns.branches.table import branch_dataset

    workers = check_workers(workers)
    spec.check()
    range_of(spec.at(0))
    if out is None:
        return branch_dataset(spec, _Work(spec, None, workers, scheduler, progress).done())
    journal = BranchJournal(spec, out, force=force)
    with journal.going():
        dataset = branch_dataset(spec, _Work(spec, journal, workers, scheduler, progress).done())
        write_netcdf(dataset, out)
        journal.remove()
    return dataset


class _Work:
    """The work on a search."""

    def __init__(
        self,
        spec: BranchSpec,
        journal: BranchJournal | None,
        workers: Workers,
        scheduler: str | None,
        progress: Progress | None,
    ) -> None:
        self._spec, self._journal, self._progress = spec, journal, progress
        self._workers, self._scheduler = workers, scheduler
        self._parts: dict[str, dict[str, Any]] = {} if journal is None else journal.parts
        self._pool: StandingPool | None = None
        self._given = set[str]()
        self._least = (spec.size + 1) * spec.values  # one branch at least is to be expected at each value

    def done(self) -> list[Diagram]:
        """The result at each value of the second parameter."""
        from lapjoint.campaigns.branches.search import Search

        alone = self._workers == 1 and self._scheduler is None
        workers = self._workers if isinstance(self._workers, int) and self._scheduler is None else 1
        ahead = 1 if alone else _AHEAD * workers if workers > 1 else _AHEAD_OF_OTHERS
        searches = [Search(self._spec, i, ahead) for i in range(self._spec.values)]
        with standing_pool(workers) if workers > 1 else nullcontext() as self._pool:
            for together in [[search] for search in searches] if alone else [searches]:
                self._do(together)
        return [search.diagram for search in searches]

    def _do(self, searches: list[Search]) -> None:
        """Do some searches simultaneously: their starts, and then their branches."""
        from lapjoint.campaigns.branches.cells import Parts

        def next_parts() -> list[Part]:
            parts = [part for search in searches for part in search.go_on(self._parts)]
            self._given |= {part.name for part in parts}
            return parts

        while parts := next_parts():
            cells, branches = Parts(self._spec, {}, 0), any(part.start is not None for part in parts)
            todo = [Batch((cell,)) for cell in cells.more(parts)]
            self._say()

            def deliver(solved: Solved, cells: Parts = cells, branches: bool = branches) -> list[Batch]:
                for cell, found in solved.points.items():
                    self._keep(cells.done(cell).name, found.result)  # type: ignore[attr-defined]  # it is Found
                return [Batch((cell,)) for cell in cells.more(next_parts())] if branches else []

            send(cells, todo, self._pool or self._workers, self._scheduler, deliver, self._say)

    def _keep(self, name: str, result: dict[str, Any]) -> None:
        if self._journal is None:
            self._parts[name] = result
        else:
            self._journal.keep(name, result)
        self._say()

    def _say(self, share: float = 0.0, whole: float = 1.0) -> None:
        if self._progress is not None:
            known_of = max(self._least, len(self._given | self._parts.keys()))
            self._progress(len(self._parts) + share / whole, known_of)
