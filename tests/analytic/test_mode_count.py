"""The default number of modes keeps its promise, from soft stops to stiff ones."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from analytic.mode_count import most_closed
from lapjoint import FREE, BaseMotion, ContactState, ModalDamping, Problem, SineLoad, Stop, paper_joint
from lapjoint.answers import History
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray
from tests.helpers.beams import unit_cantilever
from tests.helpers.few_and_many import few_and_many
from tests.helpers.population import joint, stiff_joint

FIRST = 6  # contacts compared: fewer than it takes a chaotic motion to magnify an error much


def cantilever(stiffness: float) -> Problem:
    return unit_cantilever(Stop(x=1.0, side="top", gap=1e-3, stiffness=stiffness))


def impulses(history: History) -> FloatArray:
    """Sum over all contacts of each stop, N s."""
    total = np.zeros(len(history.problem.stops))
    for contact in history.contacts:
        total[contact.stop] += contact.impulse
    return total


def first_contacts(problem: Problem) -> History | None:
    """The motion from rest up to a moment between two of its first contacts, or None if it has too few."""
    assert problem.base_motion is not None
    two_periods = 4 * math.pi / problem.base_motion.angular_frequency
    contacts = analytic.Solver().simulate(problem, two_periods).contacts
    if len(contacts) < 3:
        return None
    last = min(FIRST, len(contacts) - 1)
    end = max((contacts[last - 1].end + contacts[last].start) / 2, contacts[0].end)
    return analytic.Solver().simulate(problem, min(end, two_periods))


def truncation(history: History) -> float:
    """Error of a motion's impulses against nearly twice as many modes, over the largest one."""
    (count, _) = analytic.Solver().mode_counts(history.problem)
    many = analytic.Solver(n_modes=min(500, max(60, int(1.8 * count))))
    exact = impulses(many.simulate(history.problem, history.end))
    return float(np.abs(impulses(history) - exact).max() / np.abs(exact).max())


def strongest_pull(history: History) -> float:
    """The largest tensile force of any closed stop, over the largest force of all."""
    pull, push = 0.0, max(contact.peak_force for contact in history.contacts)
    for contact in history.contacts:
        stop = history.problem.stops[contact.stop]
        t = np.linspace(contact.start, contact.end, 103)[1:-1]
        z = np.ravel(history.displacement(x=stop.x, t=t))
        pull = max(pull, float(np.max(stop.stiffness * (stop.gap - stop.sign * z))))
    return pull / push


@pytest.mark.thorough
@pytest.mark.parametrize("drawn", few_and_many([(41, i) for i in range(5)], [(42, i) for i in range(200)]))
def test_random_joints_of_all_stiffnesses_hold_the_tolerance_and_no_stop_pulls(drawn: list[tuple[int, int]]) -> None:
    motions = [motion for one in drawn if (motion := first_contacts(stiff_joint(*one))) is not None]
    errors = np.array([truncation(motion) for motion in motions])
    assert np.count_nonzero(errors <= 1e-5) >= 0.9 * errors.size, np.sort(errors)[::-1][:10]
    assert errors.max() <= 1e-3  # a motion that multiplies a difference a hundredfold in six contacts
    pulls = [strongest_pull(motion) for motion in motions]
    assert max(pulls) <= 1e-5  # what the impulses are held to


PAPER = paper_joint(angular_frequency=100.0)
ONE_STOP = {
    **{f"a stop of {k:g} N/m at the tip": cantilever(k) for k in (1.0, 1e2, 1e4, 1e5, 1e6)},
    "one of the paper's, at a low frequency": PAPER.replace(stops=PAPER.stops[:1]),
}


@pytest.mark.parametrize("name", ONE_STOP)
def test_impulses_of_one_stop_hold_the_tolerance(name: str) -> None:
    problem = ONE_STOP[name]
    default = analytic.Solver().steady_state(problem, sensitivity=False)
    many = analytic.Solver(n_modes=2 * analytic.Solver().mode_counts(problem)[0])
    exact = many.steady_state(problem, sensitivity=False)
    np.testing.assert_allclose(default.impulses, exact.impulses, rtol=1e-5)


@pytest.mark.parametrize("gap", [0.0, 1e-6, 1e-4])
def test_stiff_stops_on_both_sides_with_little_room(gap: float) -> None:
    stops = tuple(Stop(x=1.0, side=side, gap=gap, stiffness=1e6) for side in ("top", "bottom"))
    problem = cantilever(1.0).replace(stops=stops)
    count = analytic.Solver().mode_counts(problem)[0]
    assert count < 90  # 102 with the room of the base's motion
    motion, many = (solver.simulate(problem, 0.9) for solver in (analytic.Solver(), analytic.Solver(n_modes=2 * count)))
    assert np.abs(impulses(motion) - impulses(many)).max() <= 1e-5 * np.abs(impulses(many)).max()


def test_the_papers_joint_needs_few_modes() -> None:
    counts = [
        analytic.Solver().mode_counts(paper_joint(angular_frequency=w))[0] for w in (100.0, 515.0, 2966.0, 5000.0)
    ]
    assert counts == sorted(counts)
    assert counts[1] <= 16  # with 15 the impulse of a tip stop is in error by 1.4e-5
    assert counts[3] <= 27


def test_the_number_grows_as_the_two_sevenths_power_of_the_stiffness() -> None:
    few, many = (analytic.Solver().mode_counts(cantilever(k))[0] for k in (1e4, 1e7))
    assert many / few == pytest.approx(1000 ** (2 / 7), rel=0.1)


def sudden_joint(seed: int, index: int) -> Problem:
    """A random joint without stops, any mode of which may be overdamped, whose base or sine load starts at once."""
    rng = np.random.default_rng((seed, index))
    problem = joint(seed, 2 * index + 1).replace(stops=())
    base = problem.base_motion
    assert isinstance(base, BaseMotion)
    phase = float(rng.uniform(0.3, 2.8))
    if index % 3 == 2:
        load = SineLoad(
            x=float(rng.uniform(0.3, 1.0)), force=1.0, angular_frequency=base.angular_frequency, phase=phase
        )
        problem = problem.replace(base_motion=None, point_loads=(load,))
    else:
        problem = problem.replace(base_motion=base.model_copy(update={"phase": phase}))
    ratios = tuple(float(10 ** rng.uniform(-2, 0.7)) for _ in range(3))
    return problem if index % 2 else problem.replace(damping=ModalDamping(ratio=ratios))


def start_error(problem: Problem, solver: analytic.Solver) -> float:
    """Error of displacements along the beam in a third of a period, against 200 modes, over the largest of them."""
    x, end = np.linspace(0.0, 1.0, 21), problem.require_excitation_period("test") / 3
    t = end * np.concatenate([[0.0], np.geomspace(1e-4, 1.0, 20)])
    some, many = (
        one.simulate(problem, end, errors=False).displacement(x, t) for one in (solver, analytic.Solver(n_modes=200))
    )
    return float(np.abs(some - many).max() / np.abs(many).max())


@pytest.mark.parametrize("drawn", few_and_many([(43, i) for i in range(6)], [(44, i) for i in range(150)]))
def test_sudden_starts_of_random_joints_hold_the_tolerance(drawn: list[tuple[int, int]]) -> None:
    errors = np.array([start_error(sudden_joint(*one), analytic.Solver()) for one in drawn])
    # A motion that damping or the phase keeps small in its first third of a period makes them larger.
    assert np.count_nonzero(errors <= 2e-5) >= 0.8 * errors.size, np.sort(errors)[::-1][:40]
    assert errors.max() <= 1e-4


def test_a_load_of_no_size_is_none() -> None:
    still = paper_joint(base_amplitude=0.0)
    assert analytic.Solver().mode_counts(still) == analytic.Solver().mode_counts(still.replace(base_motion=None))
    assert not analytic.Solver().simulate(still, 0.1).contacts


def test_most_closed_takes_the_stiffer_side_of_every_position() -> None:
    stops = (
        Stop(x=0.5, side="top", gap=1e-3, stiffness=10.0),
        Stop(x=0.5, side="bottom", gap=1e-3, stiffness=20.0),
        Stop(x=1.0, side="top", gap=1e-3, stiffness=30.0),
        Stop(x=1.0, side="top", gap=2e-3, stiffness=1.0),
        Stop(x=1.0, side="bottom", gap=2e-3, stiffness=30.5),
    )
    assert most_closed(cantilever(1.0).replace(stops=stops)) == ContactState((1, 2, 3))
    assert most_closed(cantilever(1.0).replace(stops=())) == FREE


@pytest.mark.parametrize(
    ("closed", "coordinates"),
    [
        ((7,), np.zeros((2, 4))),
        ((-1,), np.zeros((2, 4))),
        ((), np.full((2, 4), np.nan)),
        ((), np.zeros((3, 4))),
        ((), np.zeros(4)),
        ((), np.zeros((2, 0))),
        ((), np.zeros((2, 4), dtype=complex)),
        ((), np.array([["a"], ["b"]])),
    ],
)
def test_a_section_point_of_something_else_is_refused(closed: tuple[int, ...], coordinates: np.ndarray) -> None:
    with pytest.raises(InputError, match="start"):
        analytic.Solver().steady_state(cantilever(1.0), start=SectionPoint(ContactState(closed), coordinates))
