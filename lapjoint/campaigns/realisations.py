"""Statistics of motions under random excitation: a realisation a cell, and the intervals from all of them.

A realisation is the problem with other seeds of its random parts: its own plus the number of the realisation.  Every
realisation is summarised by itself, to sums that do not grow with its duration; the statistics are made of the sums in
the order of the realisations, whichever worker made which.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lapjoint.campaigns.format_version import FORMAT_VERSION
from lapjoint.campaigns.plan import check_integer, digest_of, problem_identity, versions
from lapjoint.campaigns.running import run
from lapjoint.campaigns.workers import Workers
from lapjoint.errors import InputError, SolverError
from lapjoint.problem import Problem
from lapjoint.problem.random_motion import LARGEST_SEED
from lapjoint.solver import Progress, Solver, make_solver
from lapjoint.summaries.measure import Measure, measure, sums_of
from lapjoint.summaries.quantities import selection
from lapjoint.summaries.sums import Sums
from lapjoint.summaries.table import remarks, table

if TYPE_CHECKING:
    import xarray as xr

MOST_SEEDS = 100_000
"""Largest number of realisations."""
REHEARSAL = 1e-3
"""Part of the duration that is marched to have everything compiled, before workers begin."""


@dataclass(frozen=True)
class Realised:
    """What came of one realisation."""

    sums: dict[str, Any] | None = None
    """Its sums, as `Sums.plain` gives them; None if the solver gave up."""
    message: str = ""
    """Why the solver gave up; empty where it did not."""


@dataclass(frozen=True)
class Realisations:
    """All that statistics depend on: a `lapjoint.campaigns.campaign.Campaign`.

    Parameters
    ----------
    problem : Problem
        The joint.
    duration : float
        Of each motion, s, with what is left out at its start.
    seeds : int
        Number of realisations; more than one needs random excitation.
    solver : str
        Entry-point name of the solver.
    options : mapping
        Numerical options of the solver.
    at : tuple of float, optional
        Places, m; by default those of the stops and of the ends that no support fixes.
    quantities : tuple of str, optional
        What is summarised there; by default all that the problem has.
    settle : float, optional
        The start that is left out, s; by default seven decay times of the slowest mode.
    rate : float, optional
        Samples a second, Hz; by default sixteen in a period of the slowest mode.

    Raises
    ------
    InputError
        If the seeds are no number that is allowed.
    """

    noun: ClassVar[str] = "run of statistics"
    cells_noun: ClassVar[str] = "realisations"
    longest_batch: ClassVar[int] = 1
    chained: ClassVar[bool] = False

    problem: Problem
    duration: float
    seeds: int = 1
    solver: str = "analytic"
    options: Mapping[str, Any] = field(default_factory=dict)
    at: tuple[float, ...] | None = None
    quantities: tuple[str, ...] | None = None
    settle: float | None = None
    rate: float | None = None

    def __post_init__(self) -> None:
        check_integer("seeds", self.seeds, 1, MOST_SEEDS)
        if self.seeds > 1 and not self.problem.random:
            raise InputError(
                f"seeds = {self.seeds}: nothing in this problem is random, so all realisations would be one; give it a "
                'base_motion or a load of kind = "random", or leave seeds out'
            )

    @property
    def size(self) -> int:
        """Number of realisations."""
        return self.seeds

    def chains(self) -> Iterator[tuple[int, ...]]:
        """None: no realisation starts where another ends."""
        return iter(())

    def check(self) -> Solver:
        """Check all, and make the solver. See `lapjoint.campaigns.campaign.Campaign.check`."""
        solver = make_solver(self.solver, **self.options)
        self.measure(solver)
        return solver

    def measure(self, solver: Solver) -> Measure:
        """How each motion is summarised.

        Parameters
        ----------
        solver : Solver
            Gives the modes that tell how fast motions settle.

        Returns
        -------
        Measure
            The same for all.

        Raises
        ------
        InputError
            If something is not allowed, or nothing is left of a motion.
        """
        what = selection(self.problem, at=self.at, quantities=self.quantities)
        return measure(what, solver, self.duration, seeds=self.seeds, settle=self.settle, rate=self.rate)

    def realisation(self, number: int) -> Problem:
        """The problem with the seeds of a realisation.

        Parameters
        ----------
        number : int
            From 0: the problem itself.

        Returns
        -------
        Problem
            The problem.
        """
        if not number:
            return self.problem
        return self.problem.with_seeds(lambda own: (own + number) % (LARGEST_SEED + 1))

    def answer(
        self, cell: int, solver: Solver, section: dict[str, Any] | None, progress: Progress | None = None
    ) -> tuple[Realised, None]:
        """The sums of a realisation. See `lapjoint.campaigns.campaign.Campaign.answer`."""
        try:
            return Realised(sums_of(self.measure(solver), solver, self.realisation(cell), progress).plain()), None
        except SolverError as error:
            return Realised(message=str(error)), None

    def rehearse(self, solver: Solver) -> None:
        """March a thousandth of the duration. See `lapjoint.campaigns.campaign.Rehearses`."""
        short = replace(self.measure(solver), duration=REHEARSAL * self.duration, settle=0.0, units=1)
        sums_of(short, solver, self.problem)

    def point(self, fields: Mapping[str, Any]) -> Realised:
        """What came of a realisation. See `lapjoint.campaigns.campaign.Campaign.point`."""
        return Realised(**fields)

    def dataset(self, points: Mapping[int, Realised]) -> xr.Dataset:
        """The statistics. See `lapjoint.campaigns.campaign.Campaign.dataset`."""
        answers = [points[cell] for cell in range(self.size)]
        parts = [Sums.from_plain(answer.sums) for answer in answers if answer.sums is not None]
        failed = [answer.message for answer in answers if answer.sums is None]
        if not parts:
            raise SolverError(f"no realisation came to its end: {failed[0]}")
        sums, what = Sums.joined(parts), self.measure(make_solver(self.solver, **self.options))
        attributes = {
            "Conventions": "CF-1.11",
            "format_version": FORMAT_VERSION,
            "result_of": self.noun,
            "title": f"Statistics of: {self.problem.title or 'a joint'}",
            "problem": self.identity["problem"],
            "solver": self.solver,
            "solver_name": make_solver(self.solver, **self.options).name,
            "options": json.dumps(dict(self.options)),
            "seeds": self.seeds,
            "failed": len(failed),
            "messages": "\n".join(failed),
            "remarks": "\n".join(remarks(what, sums, len(parts))),
            **{f"version_{name}": number for name, number in versions().items()},
            "fingerprint": self.fingerprint,
        }
        return table(what, sums).assign_attrs(attributes)

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes these statistics from any other, as values that JSON can hold."""
        given = {
            name: getattr(self, name) for name in ("duration", "seeds", "solver", "at", "quantities", "settle", "rate")
        }
        return {
            **problem_identity(self.problem),
            **{name: list(value) if isinstance(value, tuple) else value for name, value in given.items()},
            "options": dict(self.options),
            "versions": versions(),
        }

    @cached_property
    def fingerprint(self) -> str:
        """A digest of the identity, in hexadecimal digits."""
        return digest_of(self.identity, self.options)


def statistics(
    problem: Problem,
    solver: str = "analytic",
    *,
    duration: float | None = None,
    seeds: int = 1,
    options: Mapping[str, Any] | None = None,
    at: Sequence[float] | None = None,
    quantities: Sequence[str] | None = None,
    settle: float | None = None,
    rate: float | None = None,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Peaks, root mean squares, contacts and their distributions of a long motion, or of several realisations of one.

    Parameters
    ----------
    problem : Problem
        The joint.
    solver : str
        Entry-point name of the solver.
    duration : float, optional
        Of each motion, s, with what is left out at its start; by default that of the shortest record.
    seeds : int
        Number of realisations; more than one needs random excitation.
    options : mapping, optional
        Numerical options of the solver.
    at : sequence of float, optional
        Places, m; by default those of the stops and of the ends that no support fixes.
    quantities : sequence of str, optional
        Of `lapjoint.answers.quantities.QUANTITIES`; by default displacement, velocity, absolute acceleration, moment
        and, where the beam has a section, stress.
    settle : float, optional
        The start that is left out, s; by default seven decay times of the slowest mode.
    rate : float, optional
        Samples a second, Hz; by default sixteen in a period of the slowest mode.
    workers : int or map-like callable
        As for `sweep`.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``.
    out : str or Path, optional
        File of the dataset, as NetCDF.  Until all is done, a journal beside it keeps the realisations that are done,
        and the same call resumes.
    force : bool
        Whether other statistics in `out` may be thrown away.
    progress : callable, optional
        Called with the number of realisations done and the number of all; in one process, where realisations come one
        after the other, also with parts of the one that is marched.

    Returns
    -------
    xarray.Dataset
        Values and their 95 % intervals; `lapjoint.summaries.table` lists the variables.  It depends neither on the
        workers nor on interruptions.

    Raises
    ------
    InputError
        If a parameter is not allowed, `out` holds something else, or another process works on it.
    OutputError
        If the disk is full.
    SolverError
        If no realisation came to its end.
    Interrupted
        After Ctrl-C.
    """
    plan = Realisations(
        problem,
        lasting(problem, duration),
        seeds,
        solver,
        dict(options or {}),
        None if at is None else tuple(float(x) for x in at),
        None if quantities is None else tuple(quantities),
        settle,
        rate,
    )
    return run(plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def lasting(problem: Problem, duration: float | None) -> float:
    """The duration that is asked for, or that of the shortest record.

    Parameters
    ----------
    problem : Problem
        The joint.
    duration : float or None
        What is asked for, s.

    Returns
    -------
    float
        s.

    Raises
    ------
    InputError
        If nothing is asked for, and there is no record.
    """
    if duration is not None:
        return float(duration)
    if not np.isfinite(problem.longest):
        raise InputError("duration: is missing; only a problem with a record has a duration of its own")
    return problem.longest
