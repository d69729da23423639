"""Runs a search for branches: starts first, then the branches of the motions that they lead to, and so on.

Several processes follow branches in rounds of a few, one process one after the other.  Motions that lie on a branch
that is known are left out, by the sequence of the motions and not of the work; so neither the number of workers nor an
interruption changes what is found, or in what sequence.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import as_completed
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.branch_journal import BranchJournal
from lapjoint.campaigns.branch_plan import MAX_POINTS, BranchPlan
from lapjoint.campaigns.running import stored
from lapjoint.campaigns.workers import check_workers
from lapjoint.errors import InputError
from lapjoint.netcdf_files import write_netcdf
from lapjoint.problem import Problem
from lapjoint.processes import interrupts_held, process_pool
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr

_ROUND = 4
"""Number of branches that several processes follow before those that came out the same are told apart."""
Part = tuple[str, Callable[..., dict[str, Any]], Any]
"""A part of the work: its name, the function that does it, and what it takes besides the plan and a progress."""


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
    workers: int = 1,
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
        Number of random starts besides the problem's own initial state at both ends of the range: they find branches
        that do not spring from those.
    seed : int
        Seed of the random starts.
    errors : bool
        Whether to estimate the errors of the bifurcations, by finer selves of the solver.
    max_points : int
        Largest number of points of a branch; one that needs more, or more tries than go with so many, ends as
        ``effort``.
    workers : int
        Number of processes, -1 for all processors.
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
    plan = BranchPlan(
        problem, path, first, last, solver, dict(options or {}), max_period_multiple, starts, seed, errors, max_points
    )
    found = None if out is None else stored(plan, out, force=force)
    if found is not None:
        return found
    return find_branches(plan, workers=workers, out=out, force=force, progress=progress)


def find_branches(
    plan: BranchPlan,
    *,
    workers: int = 1,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a plan, and replace what is in `out`.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    workers : int
        Number of processes, -1 for all processors.
    out : str or Path, optional
        File of the dataset.
    force : bool
        Whether the journal of something else may be thrown away.
    progress : callable, optional
        Called with the number of parts of the work done, a branch under way as the share that is followed, and the
        number known of.

    Returns
    -------
    xarray.Dataset
        The dataset.

    Raises
    ------
    InputError
        If the plan is not valid, the journal belongs to something else, or another process works on it.
    OutputError
        If the disk is full; the message says what is kept.
    SolverError
        If the workers are lost; the message says what is kept.
    Interrupted
        After Ctrl-C; the message says what is kept.
    """
    from lapjoint.campaigns.branch_dataset import branch_dataset

    count = check_workers(workers)
    if not isinstance(count, int):
        raise InputError(f"workers = {workers!r}: must be a number of processes")
    plan.check()
    if out is None:
        return branch_dataset(plan, _Search(plan, None, count, progress).run())
    journal = BranchJournal(plan, out, force=force)
    with journal.going():
        dataset = branch_dataset(plan, _Search(plan, journal, count, progress).run())
        write_netcdf(dataset, out)
        journal.remove()
    return dataset


class _Search:
    """A search under way."""

    def __init__(
        self, plan: BranchPlan, journal: BranchJournal | None, workers: int, progress: Progress | None
    ) -> None:
        self._plan, self._journal, self._workers, self._progress = plan, journal, workers, progress
        self._parts: dict[str, dict[str, Any]] = {} if journal is None else journal.parts
        self._known_of = plan.size

    def run(self) -> list[dict[str, Any]]:
        """All branches, as `solve_branch` gives them, in the sequence in which they were accepted."""
        from lapjoint.campaigns.branch_parts import solve_branch, solve_start

        starts: list[Part] = [(f"start {i}", solve_start, i) for i in range(self._plan.size)]
        waiting = [seed for found in self._done(starts) for seed in found["seeds"]]
        branches: list[dict[str, Any]] = []
        seen, together = 0, 1 if self._workers == 1 else _ROUND
        while waiting:
            now: list[tuple[int, dict[str, Any]]] = []
            while waiting and len(now) < together:
                seed = waiting.pop(0)
                if not self._is_known(seed, branches):
                    now.append((seen, seed))
                seen += 1
            parts: list[Part] = [(f"branch {number}", solve_branch, seed) for number, seed in now]
            self._known_of += len(now)
            for (_, seed), found in zip(now, self._done(parts), strict=True):
                if found["points"] and not self._is_known(seed, branches):
                    branches.append(found)
                    waiting += found["seeds"]
        return branches

    def _is_known(self, seed: Mapping[str, Any], branches: list[dict[str, Any]]) -> bool:
        from lapjoint.campaigns.branch_parts import is_known

        return any(is_known(self._plan, seed, one) for one in branches)

    def _done(self, parts: list[Part]) -> list[dict[str, Any]]:
        """The results of some parts, in their sequence; those that are missing are worked out."""
        missing = [part for part in parts if part[0] not in self._parts]
        self._say()
        for name, result in self._worked_out(missing):
            if self._journal is None:
                self._parts[name] = result
            else:
                self._journal.keep(name, result)
            self._say()
        return [self._parts[name] for name, _, _ in parts]

    def _worked_out(self, missing: list[Part]) -> Iterator[tuple[str, dict[str, Any]]]:
        """Results, in any sequence."""
        if self._workers == 1 or len(missing) < 2:
            for name, function, what in missing:
                yield name, function(self._plan, what, self._say)
            return
        # The first makes numba compile the march and store the machine code, which the processes then load.
        name, function, what = missing[0]
        yield name, function(self._plan, what, self._say)
        with process_pool(min(self._workers, len(missing) - 1)) as pool:
            with interrupts_held():
                futures = {
                    pool.submit(partial(function, self._plan), what): name for name, function, what in missing[1:]
                }
            for future in as_completed(futures):
                yield futures[future], future.result()

    def _say(self, share: float = 0.0) -> None:
        if self._progress is not None:
            self._progress(len(self._parts) + share, self._known_of)
