"""Stops fixed in space, past which the base moves: contacts, forces, derivatives and steady states of both solvers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from beams import unit_cantilever
from random_joints import SPATIAL
from refining import AnySolver
from settled import orbit_of

import analytic
import fe_lapjoint
from lapjoint import Axis, Problem, Stop
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.campaigns.grid import Grid
from lapjoint.errors import InputError
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import of_motion
from lapjoint.orbits.parameters import AMPLITUDE, FREQUENCY, excitation_change
from lapjoint.orbits.period_map import Tangent
from lapjoint.problem import FloatArray, RandomBaseMotion, RecordBaseMotion, ViscousDamping
from validation.cases.sdnd102 import DURATION, as_published, beam
from validation.invariants import energy, gaps, power, stated_impulses
from validation.verdict import Verdict

SOLVERS: tuple[AnySolver, ...] = (analytic.Solver(), fe_lapjoint.Solver(elements=20))
DERIVED = 99  # seed
IN_SPACE = 8e-4  # m
SMALL = (analytic.Solver(n_modes=8), fe_lapjoint.Solver(elements=4))  # few coordinates, for differences


RIGID, SOFTER = 1e12, 0.01  # N m2, of a bar 1 m long beside a wall; and a bar a hundredth as stiff
OFF = 1e-6  # of the duration, the largest impulse and each peak: that bar bends, by 1e-7


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=4), fe_lapjoint.Solver(elements=2)])
def test_a_mass_meets_a_wall_fixed_in_space_as_its_closed_form_does(solver: AnySolver) -> None:
    mass, off = as_published(), []
    hits = mass.hits(DURATION)
    for EI in (SOFTER * RIGID, RIGID):
        contacts = solver.simulate(beam(mass, EI), DURATION, errors=False).contacts
        assert len(contacts) == len(hits) == 10
        largest = max(hit.impulse for hit in hits)
        starts = [abs(c.start - hit.start) / DURATION for c, hit in zip(contacts, hits, strict=True)]
        impulses = [abs(c.impulse - hit.impulse) / largest for c, hit in zip(contacts, hits, strict=True)]
        peaks = [abs(c.peak_force / hit.peak - 1) for c, hit in zip(contacts, hits, strict=True)]
        off.append((max(starts), max(impulses), max(peaks)))
    assert all(number <= OFF for number in off[1]), off
    for more, less in zip(*off, strict=True):  # bending makes an error that goes with 1 / EI
        assert more / less > 1 / (2 * SOFTER)


def orbit_start(solver: AnySolver, problem: Problem) -> tuple[PeriodMap, SectionPoint]:
    """A period map, and a section point after the transient of some periods."""
    map_ = solver.period_map(problem)
    return map_, map_.march(map_.initial(), 40).end


@pytest.mark.parametrize("index", [0, 3, 15])
@pytest.mark.parametrize("solver", SMALL)
def test_derivatives_of_the_period_map_are_differences_of_marches(solver: AnySolver, index: int) -> None:
    map_, point = orbit_start(solver, SPATIAL(DERIVED, index))
    assert isinstance(map_, Tangent)
    matrix = map_.linearised(point, 2).derivative().matrix
    size, rng = map_.size(point), np.random.default_rng(0)
    later = map_.march(map_.moved(point, size * 1e-3 * rng.standard_normal(matrix.shape[0])), 2).end
    e = map_.difference(later, map_.march(point, 2).end)  # a motion's own deviation: no mode of the mesh alone
    e /= map_.norm(e)
    off = []
    for step in (1e-5 * size, 1e-6 * size):
        ends = [map_.difference(map_.march(map_.moved(point, s * step * e), 2).end, point) for s in (1, -1)]
        off.append(map_.norm((ends[0] - ends[1]) / (2 * step) - matrix @ e) / map_.norm(matrix @ e))
    assert min(off) <= 1e-7  # of truncation at the larger step, or of rounding at the smaller


@pytest.mark.parametrize("path", [FREQUENCY, AMPLITUDE, "stops.*.gap"])
@pytest.mark.parametrize("solver", SMALL)
def test_equations_of_a_branch_have_the_derivatives_that_differences_give(solver: AnySolver, path: str) -> None:
    problem = unit_cantilever(
        Stop(x=1.0, side="top", gap=IN_SPACE, stiffness=60.0, fixed_to="space"),
        Stop(x=0.6, side="bottom", gap=IN_SPACE, stiffness=200.0, fixed_to="base"),
        Stop(x=0.6, side="top", gap=IN_SPACE, stiffness=200.0, fixed_to="space"),
    )
    value = {FREQUENCY: 7.0, AMPLITUDE: 1e-3}.get(path, IN_SPACE)
    grid = Grid(problem, (Axis(path, (value,)),))
    of = ParameterRange(solver, lambda at: grid.with_values((at,)), path, 0.5 * value, 2 * value)
    resolution = of.resolution(value)
    point = orbit_of(resolution.map(value), 2).point
    start = of_motion(resolution, value, point, 2)
    assert {0, 2} & set(start.sequence.stops)
    equations = BoundaryProblem(resolution, start.sequence, 2, 0.0, start.tied)
    found = equations.linearised(start.unknowns)
    norms = np.concatenate(
        [resolution.arcs(value).unit_norms(start.sequence.first), np.ones(len(start.sequence.stops))]
    )
    for i in range(start.unknowns.size):
        step = np.zeros(start.unknowns.size)
        step[i] = 1e-5 * (value if i + 1 == step.size else 1.0 if i >= norms.size - len(start.sequence.stops) else 1e-3)
        both = [equations.residual(start.unknowns + sign * step) for sign in (1, -1)]
        column = (both[0] - both[1]) / (2 * step[i])
        off = np.abs(found.jacobian[:, i] - column) * norms
        assert off.max() <= 1e-6 * (np.abs(column) * norms).max(), (i, off.max())


def test_derivatives_by_amplitude_and_frequency_are_those_of_the_waves() -> None:
    """The inertia goes with the square of the frequency, and the displacement of the base does not."""
    problem = unit_cantilever(Stop(x=1.0, side="top", gap=IN_SPACE, stiffness=60.0, fixed_to="space"))
    by_frequency, by_amplitude = (excitation_change(problem, path) for path in (FREQUENCY, AMPLITUDE))
    assert by_frequency is not None
    assert by_amplitude is not None
    assert by_frequency.sizes.tolist() == pytest.approx([2 / 7.0, 0.0])
    assert by_amplitude.sizes.tolist() == pytest.approx([1e3, 1e3])


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_problem_under_another_excitation_is_the_problem_made_anew(solver: AnySolver) -> None:
    problem = unit_cantilever(Stop(x=1.0, side="top", gap=IN_SPACE, stiffness=60.0, fixed_to="space"))
    _ = problem.moved_stops
    other = problem.with_base_numbers(amplitude=2e-3, angular_frequency=5.0)
    assert other.moved_stops == problem.replace(base_motion=other.base_motion).moved_stops
    map_ = solver.period_map(problem)
    retuned = map_.retuned(FREQUENCY, 5.0, lambda: problem.with_base_numbers(angular_frequency=5.0))
    assert retuned is not None
    anew = solver.period_map(problem.with_base_numbers(angular_frequency=5.0))
    retuned, anew = (own.march(own.initial(), 8).impulses for own in (retuned, anew))
    assert retuned == pytest.approx(anew, rel=1e-6)


@pytest.mark.parametrize("solver", SOLVERS)
def test_energy_is_kept_beside_a_wall_that_stands_still(solver: AnySolver) -> None:
    """The stop pushes a beam in motion, and the base, from which energy is counted, moves past the stop."""
    stops = (
        Stop(x=1.0, side="top", gap=IN_SPACE, stiffness=60.0, fixed_to="space"),
        Stop(x=0.6, side="bottom", gap=-IN_SPACE, stiffness=20.0, fixed_to="space"),
    )
    problem = unit_cantilever(*stops).replace(damping=ViscousDamping(coefficient=0.5))
    history = solver.simulate(problem, 3.0, errors=False)
    assert len(history.contacts) > 4
    t = np.unique(np.concatenate([np.linspace(0.0, 3.0, 4001), history.switch_times]))
    gained = np.concatenate([[0.0], np.cumsum(simpson_steps(lambda s: power(history, s), t))])
    balance = energy(history, t) - energy(history, t[:1]) - gained
    assert np.abs(balance).max() <= 2e-3 * np.abs(gained).max()  # of truncation at switches
    assert gaps(history, 1e-3).verdict is Verdict.AGREE
    assert stated_impulses(history, 1e-6).verdict is Verdict.AGREE


def simpson_steps(rate: Callable[[FloatArray], FloatArray], t: FloatArray) -> FloatArray:
    """The integral of a rate over each step of a grid of times, ``(m - 1,)``, just inside of it at its ends."""
    width = np.diff(t)
    inner = 1e-9 * width
    return width / 6 * (rate(t[:-1] + inner) + 4 * rate((t[:-1] + t[1:]) / 2) + rate(t[1:] - inner))


def test_records_that_drift_are_refused_with_stops_in_space() -> None:
    stop = Stop(x=1.0, side="top", gap=IN_SPACE, stiffness=60.0, fixed_to="space")
    joint = unit_cantilever(stop.model_copy(update={"fixed_to": "base"}), stop)
    values = [0.0, 1e-4, 0.0, -1e-4, 0.0]
    for quantity in ("acceleration", "velocity"):
        for remove in ("nothing", "offset"):
            base = RecordBaseMotion(quantity=quantity, rate=100.0, values=values, remove=remove)
            for change in (joint.replace, joint.with_excitation):
                with pytest.raises(
                    InputError, match=rf'stops\[1\].fixed_to = "space": base_motion.remove is "{remove}"'
                ):
                    change(base_motion=base)
        joint.replace(base_motion=RecordBaseMotion(quantity=quantity, rate=100.0, values=values, remove="drift"))
    joint.replace(base_motion=RecordBaseMotion(quantity="displacement", rate=100.0, values=values))
    joint.replace(base_motion=RandomBaseMotion(psd=[[1.0, 1e-6], [2.0, 1e-6]], seed=1))
    with pytest.raises(InputError, match=r"psd\[0\]\[0\] = 0.0: must be greater than 0"):  # y would have no variance
        RandomBaseMotion(psd=[[0.0, 1e-6], [2.0, 1e-6]], seed=1)
