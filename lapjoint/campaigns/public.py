"""The campaigns as functions: `sweep`, `basins`, `branch`, `confirm` and `statistics`.

Jobs whose modules load scipy and numba are imported when they are asked for, because `lapjoint.campaigns` is also
imported for lighter work.  The package `confirm` is imported here: its first import gives its name in
`lapjoint.campaigns` to the package, and a later one would take the name from the function.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

from lapjoint.campaigns.basins.spec import EFFORT as EFFORT_OF_A_START
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.branches.spec import EFFORT, MAX_POINTS, BranchSpec
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.campaigns.running import Running, run_job
from lapjoint.campaigns.statistics.job import StatisticsJob
from lapjoint.campaigns.statistics.spec import Realisations, lasting
from lapjoint.campaigns.sweep.job import SweepJob
from lapjoint.campaigns.sweep.spec import Plan, Start
from lapjoint.problem import Problem
from lapjoint.problem.plane import Plane
from lapjoint.sampling.design import Kind, Samples, samples_of
from lapjoint.solver import Solver, named

if TYPE_CHECKING:
    import xarray as xr

import_module("lapjoint.campaigns.confirm")


def sweep(
    problem: Problem,
    axes: Iterable[Axis] = (),
    *,
    samples: int | None = None,
    design: Kind = "sobol",
    sample_seed: int = 0,
    solver: str | Solver = "analytic",
    options: Mapping[str, Any] | None = None,
    start: Start = "rest",
    starts: int = 1,
    seed: int = 0,
    sensitivity: bool = False,
    errors: bool = False,
    summary: Sequence[str] = (),
    strobe: int = 0,
    at: float | str | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find the steady states at every point of a grid of problems.

    Parameters
    ----------
    problem : Problem
        The problem that has all that the axes do not change.
    axes : iterable of Axis
        The numbers that are changed; `start` = "up" and "down" follow the first of them.
    samples : int, optional
        Number of samples of the problem's uncertain numbers, one more dimension: 8 times a power of two.
    design : {"sobol", "saltelli"}
        Scrambled Sobol points; or, for total sensitivity indices, `samples` blocks of d + 2 points for d uncertain
        numbers.
    sample_seed : int
        Seed of the samples.
    solver : str or Solver
        The solver, or its name.
    options : mapping, optional
        Numerical options of a solver that is given by its name.
    start : {"rest", "up", "down", "random"}
        Start of each motion: the problem's own initial state; the motion before it along the first axis, ascending or
        descending; or a random initial state.
    starts : int
        Number of starts at each point; with "rest", the starts after the first are random.
    seed : int
        Seed of the random initial states.
    sensitivity : bool
        Whether to measure how much deviations grew on the way to each motion; it takes about as long again.
    errors : bool
        Whether to estimate the numerical errors of the impulses; it takes less than as long again.
    summary : sequence of str
        Further numbers of each motion, of `lapjoint.summaries.of_orbit.SUMMARIES`, as ``stress_peak``, ``force_rms`` or
        ``contact_time``: variables of the dataset.
    strobe : int
        Number of stroboscopic samples of each motion, one at the start of each excitation period: the variables
        ``strobe_displacement``, m, and ``strobe_velocity``, m/s, relative to the base.  0 for none.
    at : float or str, optional
        Place of the samples, m; by default that of the stop farthest from the root, or the tip if there are no stops.
    **running : Running
        Workers, file and progress, and the errors that are raised: see `Running`.

    Returns
    -------
    xarray.Dataset
        The dataset; `lapjoint.campaigns.sweep.table` says how contacts are stored.
    """
    grid = Grid(problem, tuple(axes), _drawn(problem, samples, design, sample_seed))
    plan = Plan(grid, *named(solver, options), start, starts, seed, sensitivity, errors, tuple(summary), strobe, at)
    return run_job(SweepJob(plan), **running)


def _drawn(problem: Problem, samples: int | None, design: Kind, seed: int) -> Samples | None:
    """The samples of the uncertain numbers of a problem; None if none were asked for."""
    return None if samples is None else samples_of(problem, samples, design, seed)


def basins(
    problem: Problem,
    *,
    plane: str | None = None,
    grid: tuple[int, int] = (40, 40),
    ranges: tuple[tuple[float, float], tuple[float, float]] | None = None,
    energy: float | None = None,
    starts: int = 1000,
    seed: int = 0,
    over: Axis | None = None,
    effort: int = EFFORT_OF_A_START,
    solver: str | Solver = "analytic",
    options: Mapping[str, Any] | None = None,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Find which motion each of many starts ends in.

    Starts are either the points of a grid in a plane, or random ones of bounded energy.  Each is bound to a certified
    motion, or said not to be; see `lapjoint.orbits.binding`.

    Parameters
    ----------
    problem : Problem
        The joint and its excitation; its initial state is what starts are counted from.
    plane : str, optional
        Two coordinates by which the initial state is moved, displacement z or velocity v at places, m:
        ``"z(2.5),v(2.5)"``.
    grid : tuple of int
        Number of values of each coordinate.
    ranges : tuple of tuple of float, optional
        First and last value of each coordinate, m or m/s; by default some times the size of base motion and gap.
    energy : float, optional
        Bound on the energy of random starts, J; they are drawn evenly from all of the solver's space below it.
    starts : int
        Number of random starts.
    seed : int
        Seed of the random starts.
    over : Axis, optional
        A number of the problem, and the values for which all this is done.
    effort : int
        Most periods of the excitation marched from a start; what has not settled after them is undecided.
    solver : str or Solver
        The solver, or its name.
    options : mapping, optional
        Numerical options of a solver that is given by its name.
    **running : Running
        Workers, file and progress, and the errors that are raised: see `Running`.

    Returns
    -------
    xarray.Dataset
        The dataset; ``docs/basins.md`` lists its variables.
    """
    from lapjoint.campaigns.basins.job import BasinJob

    coordinates = None if plane is None else Plane.from_text(plane)
    plan = BasinPlan(problem, *named(solver, options), coordinates, grid, ranges, energy, starts, seed, effort, over)
    return run_job(BasinJob(plan), **running)


def branch(
    problem: Problem,
    path: str,
    first: float,
    last: float,
    *,
    solver: str | Solver = "analytic",
    options: Mapping[str, Any] | None = None,
    max_period_multiple: int = 1,
    starts: int = 0,
    seed: int = 0,
    errors: bool = True,
    max_points: int = MAX_POINTS,
    effort: int = EFFORT,
    also_over: Axis | None = None,
    from_grazes: bool = False,
    **running: Unpack[Running],
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
    solver : str or Solver
        The solver, or its name; it must give its period map, with arcs.
    options : mapping, optional
        Numerical options of a solver that is given by its name.
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
    **running : Running
        Workers, file and progress, and the errors that are raised: see `Running`.

    Returns
    -------
    xarray.Dataset
        The dataset; docs/branches.md lists its variables.
    """
    from lapjoint.campaigns.branches.job import BranchJob

    spec = BranchSpec(
        problem,
        path,
        first,
        last,
        *named(solver, options),
        max_period_multiple,
        starts,
        seed,
        errors,
        max_points,
        effort,
        also_over,
        from_grazes,
    )
    return run_job(BranchJob(spec), **running)


def confirm(
    branches: str | Path | xr.Dataset,
    *,
    solver: str | Solver = "fe",
    options: Mapping[str, Any] | None = None,
    share: float = 1.0,
    seed: int = 0,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Look for the bifurcations of branches by another solver, too.

    Parameters
    ----------
    branches : str, Path or xarray.Dataset
        The dataset that `lapjoint.branch` gave, or its file; it must have bifurcations, with errors.
    solver : str or Solver
        The other solver, or its name; it must give its period map, with arcs.
    options : mapping, optional
        Numerical options of an other solver that is given by its name.
    share : float
        Share of the bifurcations that are looked for, drawn at random; 1 for all.
    seed : int
        Seed of the draw.
    **running : Running
        Workers, file and progress, and the errors that are raised: see `Running`.

    Returns
    -------
    xarray.Dataset
        The value and the error of each by both solvers, and the verdict; docs/branches.md lists the variables.
    """
    from lapjoint.campaigns.branches.table import read_branches
    from lapjoint.campaigns.confirm.job import ConfirmJob
    from lapjoint.campaigns.confirm.spec import confirm_spec

    found = read_branches(branches) if isinstance(branches, str | Path) else branches
    return run_job(ConfirmJob(confirm_spec(found, *named(solver, options), share, seed)), **running)


def statistics(
    problem: Problem,
    solver: str | Solver = "analytic",
    *,
    duration: float | None = None,
    seeds: int = 1,
    options: Mapping[str, Any] | None = None,
    at: Sequence[float] | None = None,
    quantities: Sequence[str] | None = None,
    settle: float | None = None,
    rate: float | None = None,
    samples: int | None = None,
    design: Kind = "sobol",
    sample_seed: int = 0,
    **running: Unpack[Running],
) -> xr.Dataset:
    """Peaks, root mean squares, contacts and their distributions of a long motion, or of several realisations of one.

    Parameters
    ----------
    problem : Problem
        The joint.
    solver : str or Solver
        The solver, or its name.
    duration : float, optional
        Duration of each motion, s, with the start that is left out; by default that of the shortest record.
    seeds : int
        Number of realisations; more than one needs random excitation.
    options : mapping, optional
        Numerical options of a solver that is given by its name.
    at : sequence of float, optional
        Places, m; by default those of the stops and of the ends that no support fixes.
    quantities : sequence of str, optional
        Of `lapjoint.answers.quantities.QUANTITIES`; by default displacement, velocity, absolute acceleration, moment
        and, where the beam has a section, stress.
    settle : float, optional
        The start that is left out, s; by default seven decay times of the slowest mode.
    rate : float, optional
        Samples of a motion in a second, Hz; by default sixteen in a period of the slowest mode.
    samples, design, sample_seed : int, str, int, optional
        Samples of the problem's uncertain numbers, as `sweep` draws them; each has `seeds` realisations of its own.
    **running : Running
        Workers, file and progress, and the errors that are raised: see `Running`.

    Returns
    -------
    xarray.Dataset
        Values and their 95 % intervals; `lapjoint.summaries.table` lists the variables, and
        `lapjoint.campaigns.statistics.sampled` what files with samples have.

    Raises
    ------
    SolverError
        If no realisation came to its end, or with samples no sample has all its realisations.
    """
    places = None if at is None else tuple(float(x) for x in at)
    what = None if quantities is None else tuple(quantities)
    drawn, lasts = _drawn(problem, samples, design, sample_seed), lasting(problem, duration)
    spec = Realisations(problem, lasts, seeds, *named(solver, options), places, what, settle, rate, drawn)
    return run_job(StatisticsJob(spec), **running)
