"""A solver that gives only the required part of a period map gets certified orbits, and they are right."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import fsolve
from settled import amplification
from toy import Bar, bar

from lapjoint import Outcome, Problem, SteadyState
from lapjoint.orbits import Follows, Tangent
from lapjoint.orbits.finite_differences import FiniteDifferences
from lapjoint.problem import FloatArray
from lapjoint.solver import Solver

pytestmark = pytest.mark.long_march


def marched(problem: Problem, periods: int, multiple: int) -> FloatArray:
    """Impulses a period over the last `multiple` periods of a march from rest, shape ``(stops,)``."""
    map_ = Bar().period_map(problem)
    settled = map_.march(map_.initial(), 2 * periods).end
    return map_.march(settled, 2 * multiple).impulses / multiple


def test_it_is_a_solver_and_gives_nothing_beyond_the_required_part() -> None:
    assert isinstance(Bar(), Solver)
    map_ = Bar().period_map(bar(0.8, (0.5, 5.0)))
    assert not isinstance(map_, Tangent)
    assert not isinstance(map_, Follows)


def test_motion_without_contact_is_the_linear_response_and_what_a_transient_meets_is_waited_for() -> None:
    omega, ratio = 0.8, 0.05
    amplitude = amplification(omega, ratio)
    found = Bar().steady_state(bar(omega, (1.01 * abs(amplitude), 5.0), ratio=ratio))
    assert (found.outcome, found.period_multiple, found.symmetric) == (Outcome.NO_CONTACT, 1, True)
    z, v = found.section_point.coordinates[:, 0]
    assert z == pytest.approx(amplitude.imag, rel=1e-7)
    assert v == pytest.approx((1j * omega * amplitude).imag, rel=1e-7)
    # Free vibration turns by its own frequency, and decays as the damping says.
    free = complex(-ratio, math.sqrt(1 - ratio**2))
    assert np.abs(found.multipliers) == pytest.approx(np.full(2, abs(np.exp(free * 2 * math.pi / omega))), rel=1e-7)
    assert found.stable
    # The motion exists by a hair; a march from rest overshoots it, meets the stop, and comes back.
    assert found.acceptance is not None
    map_ = Bar().period_map(found.problem)
    assert map_.march(map_.initial(), 2 * found.acceptance.periods).switches > 0
    assert map_.march(found.acceptance.point, 200).switches == 0


def bilinear(omega: float, ratio: float, stiffness: float, guess: tuple[float, float, float]) -> FloatArray:
    """(phase, speed and duration of the contact) of a bar on a stop without gap, touched once a period.

    Both halves are linear in (z, z', sin, cos); the orbit touches at z = 0 and comes back there with the same speed.
    """

    def flow(K: float, time: float) -> FloatArray:
        A = np.zeros((4, 4))
        A[0, 1], A[1, :3] = 1.0, (-K, -2 * ratio, omega**2)
        A[2, 3], A[3, 2] = omega, -omega
        return np.asarray(expm(A * time))

    def misses(unknown: FloatArray) -> FloatArray:
        phase, speed, duration = unknown
        touch = np.array([0.0, speed, math.sin(phase), math.cos(phase)])
        leave = flow(1 + stiffness, duration) @ touch
        again = flow(1.0, 2 * math.pi / omega - duration) @ leave
        return np.array([leave[0], again[0], again[1] - speed])

    solved, info, found, _ = fsolve(misses, guess, full_output=True, xtol=1e-14)
    assert found == 1 or np.abs(info["fvec"]).max() < 1e-12
    return np.asarray(solved)


@pytest.mark.parametrize(("omega", "stiffness"), [(1.3, 9.0), (2.0, 20.0)])
def test_the_orbit_of_a_bilinear_oscillator_is_that_of_its_closed_form(omega: float, stiffness: float) -> None:
    found = Bar().steady_state(bar(omega, (0.0, stiffness)))
    assert (found.outcome, found.period_multiple, found.symmetric) == (Outcome.PERIODIC, 1, False)
    contact = max(found.history.contacts, key=lambda one: one.duration)
    history = found.history
    assert len({one.start for one in history.contacts if not one.open_start}) == 1
    start = next(one.start for one in history.contacts if not one.open_start)
    speed = history.velocity(0.5, start)[0, 0]
    duration = sum(one.duration for one in history.contacts)
    phase, exact_speed, exact_duration = bilinear(omega, 0.05, stiffness, (omega * start, speed, duration))
    # Newton's method stops within 1e-9 of the motion, which the stop makes sqrt(1 + stiffness) times as large in time.
    assert omega * start == pytest.approx(phase, abs=1e-7)
    assert speed == pytest.approx(exact_speed, rel=1e-7)
    assert duration == pytest.approx(exact_duration, rel=1e-7)
    assert contact.peak_force > 0
    # Momentum: over a period the springs of bar and stop give nothing together, so k_bar int z = -impulse ...
    t = np.linspace(0, history.end, 20_001)
    assert np.trapezoid(history.displacement(0.5, t)[0], t) == pytest.approx(-found.impulses[0], rel=1e-5)


@pytest.mark.parametrize(
    ("problem", "periods", "multiple", "symmetric"),
    [
        pytest.param(bar(0.8, (0.5, 5.0)), 60, 1, False, id="one stop"),
        pytest.param(bar(0.8, (0.5, 5.0), (-0.5, 5.0)), 60, 1, True, id="a pair of stops"),
        pytest.param(bar(0.8, (0.5, 5.0), (-0.5, 5.0), viscous=False), 60, 1, True, id="damped by contact state"),
        pytest.param(bar(0.8, (0.5, 5.0), (-0.6, 5.0)), 60, 1, False, id="an uneven pair"),
        pytest.param(bar(3.0, (0.0, 20.0), ratio=0.03), 400, 2, False, id="two periods"),
        pytest.param(bar(2.3, (0.0, 20.0), ratio=0.03), 600, 3, False, id="three, beside a stable motion of one"),
    ],
)
def test_orbits_are_those_that_long_marches_come_to(
    problem: Problem, periods: int, multiple: int, symmetric: bool
) -> None:
    found = Bar().steady_state(problem)
    assert (found.outcome, found.period_multiple, found.symmetric) == (Outcome.PERIODIC, multiple, symmetric)
    assert found.stable
    assert found.residual <= 1e-9
    # The multipliers, below 0.7 a period or 0.89 for two, leave less than 1e-9 of the transient.
    assert found.impulses == pytest.approx(marched(problem, periods, multiple), rel=1e-7)
    if symmetric:
        assert found.impulses[0] == pytest.approx(-found.impulses[1], rel=1e-8)
    # At rest nothing says how large a small deviation is; the first period does.
    assert found.acceptance is not None
    assert found.acceptance.growth is not None
    assert found.acceptance.growth < 100
    assert found.acceptance.sensitive is False


CHAOTIC = bar(2.6, (0.3, 30.0), ratio=0.02)


@pytest.fixture(scope="module")
def chaos() -> SteadyState:
    return Bar().steady_state(CHAOTIC, sensitivity=False)


def test_chaos_is_certified_by_the_exponent_of_two_marches_side_by_side(chaos: SteadyState) -> None:
    assert chaos.outcome is Outcome.APERIODIC
    assert (chaos.period_multiple, chaos.multipliers.size, chaos.stable) == (0, 0, None)
    assert chaos.exponent is not None
    assert chaos.exponent.positive


def test_the_mean_impulse_of_chaos_carries_its_standard_error(chaos: SteadyState) -> None:
    assert chaos.impulse_errors is not None
    assert "standard error of the mean" in chaos.error_source
    map_, point, means = Bar().period_map(CHAOTIC), chaos.section_point, []
    for _ in range(4):
        passage = map_.march(point, 2 * 250)
        point = passage.end
        means.append(passage.impulses[0] / 250)
    # Stretches of 250 periods scatter at least as much as one of twice the length; five errors are as good as certain.
    assert 0 < chaos.impulse_errors[0] < 2 * np.std(means, ddof=1)
    both = math.hypot(chaos.impulse_errors[0], np.std(means, ddof=1) / math.sqrt(4))
    assert abs(np.mean(means) - chaos.impulses[0]) <= 5 * both


def test_the_exponent_of_two_marches_is_that_of_the_saltation_matrices(chaos: SteadyState) -> None:
    """Flow of a deviation in closed form; at a switch of a continuous force it passes as it is."""
    map_ = Bar().period_map(CHAOTIC)
    point, d, total, periods = chaos.section_point, np.array([1.0, 0.3]), 0.0, 400
    history = map_.history(point, periods)
    spans = np.diff(np.concatenate([[0.0], history.switch_times, [history.end]]))
    K = np.array([1 + sum(CHAOTIC.stops[k].stiffness for k in state.closed) for state in history.states])
    A = np.zeros((K.size, 2, 2))
    A[:, 0, 1], A[:, 1, 0], A[:, 1, 1] = 1.0, -K, -0.04
    for flow in expm(A * spans[:, None, None]):
        d = flow @ d
        size = float(np.linalg.norm(d))
        total, d = total + math.log(size), d / size
    assert chaos.exponent is not None
    # Two independent stretches of 400 and 512 periods or more; each has its error.
    assert total / history.end == pytest.approx(chaos.exponent.value, abs=6 * chaos.exponent.standard_error)


def test_deviations_that_are_followed_grow_as_the_matrix_says() -> None:
    problem = bar(0.8, (0.5, 5.0))
    found = Bar().steady_state(problem)
    differences = FiniteDifferences(Bar().period_map(problem))
    map_ = differences.map
    deviation = np.array([0.6, -0.2])
    deviation /= map_.norm(deviation)
    matrix = differences.linearised(found.section_point, 2).matrix
    followed = differences.followed(found.section_point, deviation, 3)
    for i in range(3):
        after = matrix @ deviation
        # The march that is followed lies 1e-7 beside the other, and the orbit repeats to 1e-9.
        assert math.exp(followed.growth[i]) == pytest.approx(map_.norm(after), rel=1e-5)
        deviation = after / map_.norm(after)
    assert followed.deviation == pytest.approx(deviation, abs=1e-5)
    assert len(followed.points) == 3
    assert followed.switches == map_.march(found.section_point, 6).switches
    assert followed.impulses.sum(axis=0) == pytest.approx(map_.march(found.section_point, 6).impulses, rel=1e-12)


def test_the_derivative_by_differences_is_that_of_the_closed_form() -> None:
    """Also where the state at the start is in contact, and over half a period of a symmetric bar."""
    problem = bar(0.8, (0.5, 5.0), (-0.5, 5.0))
    map_ = Bar().period_map(problem)
    point = map_.march(map_.initial(), 40).end
    for half_periods in (1, 2):
        found = FiniteDifferences(map_).linearised(point, half_periods)
        history = map_.history(point, 1)
        until = half_periods * map_.period / 2
        switches = history.switch_times[history.switch_times < until]
        times = np.concatenate([[0.0], switches, [until]])
        exact = np.eye(2)
        for (a, b), state in zip(pairwise(times), history.states, strict=False):
            K = 1 + 5.0 * len(state.closed)
            exact = expm(np.array([[0.0, 1.0], [-K, -0.1]]) * (b - a)) @ exact
        assert found.matrix == pytest.approx(exact, abs=1e-8 * np.abs(exact).max())
        assert found.segments[0].start == 0.0
        assert found.segments[-1].end == pytest.approx(until, rel=1e-14)
        assert [s.switched for s in found.segments if s.switched >= 0] == [
            next(iter(set(a.closed) ^ set(b.closed))) for a, b in pairwise(history.states[: switches.size + 1])
        ]
        for before, after in pairwise(found.segments):
            assert before.end == after.start
