"""A bar between two equally loose pins: symmetries hold its march at motions that no such bar can keep to.

The problem is its own mirror image, left for right and top for bottom, and a march from rest begins where every
symmetry is kept.  Where the symmetric motion repels what is not symmetric, the answer is the motion next to it.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from analytic.maps import Map

import analytic
import fe_lapjoint
from analytic import held
from analytic.march import Coordinates, Joint, March, march
from analytic.tangent import monodromy
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    Circle,
    Material,
    ModalDamping,
    Outcome,
    PolynomialShape,
    Problem,
    SteadyState,
    Stop,
    Support,
    paper_joint,
)
from lapjoint.problem import FloatArray


def bar(omega: float, gap: float = 0.2e-3, amplitude: float = 1e-3) -> Problem:
    """The pinned beam of the gallery with equal bores."""
    ends = (("left", 0.0), ("right", 1.0))
    return Problem(
        title="Bar between two equally loose pins",
        beam=Beam(length=1.0, material=Material(youngs_modulus=2.05e11, density=7850.0), section=Circle(diameter=0.02)),
        supports=tuple(Support(x=x, translational=2e3) for _, x in ends),
        stops=tuple(
            Stop(name=f"{name}, {side}", x=x, side=side, gap=gap, stiffness=5e6)
            for name, x in ends
            for side in ("bottom", "top")
        ),
        damping=ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=amplitude, angular_frequency=omega),
    )


def by_end(impulses: FloatArray) -> FloatArray:
    """Impulses at the bottom and the top of the end that is struck less, then of the other."""
    return np.array(sorted(impulses.reshape(2, 2).tolist(), key=lambda end: float(end[1])))


def marched(problem: Problem, solver: analytic.Solver, periods: int) -> FloatArray:
    """Impulses of the last period of a march that begins a little askew, the bar's ends 20 and 10 um off."""
    period = problem.require_excitation_period("march")
    askew = problem.replace(initial=PolynomialShape(displacement=(2e-5, -1e-5)))
    history, total = solver.simulate(askew, periods * period), np.zeros(4)
    for contact in history.contacts:  # no contact of this motion is under way at the end of a period
        if history.end - period <= contact.start:
            total[contact.stop] += contact.impulse
    return total


def lopsided(section: Coordinates, joint: Joint) -> float:
    """How much farther the left end is out than the right one, m."""
    z = joint.model(section.state).at_stops @ section.q
    return float(z[0] - z[2])


def from_rest(joint: Joint, period: float, periods: int) -> Coordinates:
    n = joint.count(FREE)
    rest = Coordinates(FREE, np.zeros(n), np.zeros(n))
    return march(joint, rest, 0.0, periods * period, record=False).end


@pytest.fixture(scope="module")
def certified() -> SteadyState:
    return analytic.Solver().steady_state(bar(300.0))


def test_a_march_that_repeats_is_not_called_aperiodic(certified: SteadyState) -> None:
    assert (certified.outcome, certified.order) == (Outcome.PERIODIC, 1)
    assert certified.stable
    assert certified.exponent is None


def test_what_remains_is_what_a_march_from_a_start_askew_comes_to(certified: SteadyState) -> None:
    # 60 periods leave 0.71^60 = 1e-9 of the transient; bisections of truncation, 1e-5 each, remain.
    last = marched(bar(300.0), analytic.Solver(), 60)
    assert by_end(last) == pytest.approx(by_end(certified.impulses), rel=1e-3)
    left, right = by_end(certified.impulses)[:, 1]
    assert right > 1.2 * left


def test_more_modes_and_finite_elements_find_the_same_motion(certified: SteadyState) -> None:
    for solver in (analytic.Solver(n_modes=30), fe_lapjoint.Solver(elements=24)):
        other = solver.steady_state(bar(300.0))
        assert (other.outcome, other.order, other.symmetric) == (Outcome.PERIODIC, 1, certified.symmetric)
        # 11 modes by a criterion of 1e-5, of impulses that a near-by bifurcation makes some ten times as sensitive
        assert by_end(other.impulses) == pytest.approx(by_end(certified.impulses), rel=2e-3)


def test_truncation_holds_a_march_at_a_motion_that_repels_it() -> None:
    joint, period = Joint(bar(300.0), 11, 11), 2 * math.pi / 300.0
    held_at = from_rest(joint, period, 200)
    motion: March = march(joint, held_at, 0.0, period)
    matrix = monodromy(motion)
    values, vectors = np.linalg.eig(matrix)
    leading = int(np.argmax(np.abs(values)))
    growth, along = float(values[leading].real), vectors[:, leading].real
    assert growth == pytest.approx(1.64, abs=0.01)
    # By this a deviation would be 1e21 times as large after 100 periods; yet the march stays within 1e-7 m.
    assert abs(lopsided(from_rest(joint, period, 300), joint)) < 1e-7
    # Once it is larger than truncation makes it, it grows as it must.
    along = along * 1e-6 / abs(lopsided(held_at.moved(along), joint))
    now, sizes = held_at.moved(held_at.y + along), []
    for _ in range(4):
        now = march(joint, now, 0.0, period, record=False).end
        sizes.append(abs(lopsided(now, joint)))
    # 1e-6 m is a hundred times the jumps' 1e-8 m; at 7e-6 m, a thirtieth of the gap, the growth begins to bend.
    assert np.array(sizes[1:]) / sizes[:-1] == pytest.approx(growth, rel=0.05)


def test_a_march_is_pushed_off_only_where_deviations_grow() -> None:
    period = 2 * math.pi / 300.0
    maps = Map(Joint(bar(300.0), 11, 11), period)
    held_at = from_rest(maps.joint, period, 200)
    returns = maps.returns(held_at, 4)
    assert returns[1::2].max() < held.REPEATS
    away = held.pushed(maps, held_at, returns, 0)
    assert away is not None
    assert held.REPEATS / 2 < maps.distance(away, held_at) / maps.norm(held_at.y) < held.NARROW
    assert held.pushed(maps, held_at, returns, held.PUSHES) is None
    stable = Map(Joint(paper_joint(), 12, 12), 2 * math.pi / 515.0)
    settled = from_rest(stable.joint, stable.period, 60)
    assert held.pushed(stable, settled, stable.returns(settled, 4), 0) is None


def test_chaos_may_be_held_by_a_symmetry_too() -> None:
    """From rest, left and right move alike and never repeat; askew, the bar settles to a period of one."""
    problem = bar(375.0)
    steady = analytic.Solver().steady_state(problem)
    assert (steady.outcome, steady.order) == (Outcome.PERIODIC, 1)
    # The slowest multiplier is 0.94: 300 periods leave 1e-8 of what is there after some hundred of chaos.
    last = marched(problem, analytic.Solver(), 500)
    assert np.sort(np.abs(last)) == pytest.approx(np.sort(np.abs(steady.impulses)), rel=1e-5)


def test_narrow_chaos_is_told_from_a_march_that_is_held() -> None:
    """It wanders by 0.3 % only; pushed ten times as far it comes back, as it does with more modes."""
    for n_modes in (None, 16):
        steady = analytic.Solver(n_modes=n_modes).steady_state(bar(212.5, 1e-3, 3e-3))
        assert steady.outcome is Outcome.APERIODIC
        assert steady.exponent is not None
        assert steady.exponent.value == pytest.approx(14.7, abs=2.0)  # finite elements: 14.7 +- 0.6


@pytest.mark.parametrize("omega", [190.0, 220.0])  # left and right part in the first, top and bottom in the second
def test_finite_elements_leave_a_motion_that_repels_too_slowly_for_rounding(omega: float) -> None:
    """The multipliers are 1.035 and 1.043: from 1e-16 it takes a thousand periods to be seen."""
    steady = fe_lapjoint.Solver(elements=2).steady_state(bar(omega))
    assert (steady.outcome, steady.order) == (Outcome.PERIODIC, 1)
    assert steady.stable
    ends = np.abs(steady.impulses.reshape(2, 2))
    assert np.ptp(ends, axis=0 if omega == 190.0 else 1).min() > 1e-4 * ends.max()


@pytest.mark.parametrize(
    ("omega", "gap", "amplitude", "n_modes", "outcome", "symmetric"),
    [
        (100.0, 1e-3, 5e-3, None, Outcome.CHATTERING, False),
        (100.0, 1e-3, 10e-3, 30, Outcome.PERIODIC, False),
        (220.0, 0.2e-3, 1e-3, None, Outcome.PERIODIC, True),
        (150.0, 0.2e-3, 1e-3, None, Outcome.PERIODIC, True),
        (150.0, 1e-3, 3e-3, None, Outcome.PERIODIC, True),
    ],
)
def test_the_order_is_the_least_and_the_half_period_that_mirrors_is_found(
    omega: float, gap: float, amplitude: float, n_modes: int | None, outcome: Outcome, symmetric: bool
) -> None:
    """Jumps of truncation part these motions into two or three, 1e-7 to 2e-4 of their size from each other."""
    one = analytic.Solver(n_modes=n_modes).steady_state(bar(omega, gap, amplitude))
    other = fe_lapjoint.Solver(elements=12).steady_state(bar(omega, gap, amplitude))
    for steady in (one, other):
        assert steady.outcome is outcome
        assert steady.order == 1
        assert steady.stable
        assert steady.residual <= 1e-3  # what truncation may part
    assert one.symmetric is symmetric
    x, half = np.linspace(0.0, 1.0, 5), one.history.end / 2
    t = np.linspace(0.01, 0.99, 20) * half
    z, later = one.history.displacement(x, t), one.history.displacement(x, t + half)
    assert bool(np.abs(z + later).max() < 1e-3 * np.abs(z).max()) is symmetric


def test_a_true_motion_of_several_periods_is_not_taken_for_one() -> None:
    omega = 300.0  # with a damping ratio of 0.01 the paper's joint repeats after three periods
    problem = paper_joint(angular_frequency=omega, damping_ratio=0.01)
    steady = analytic.Solver(n_modes=14).steady_state(problem)
    maps = Map(Joint(problem, 14, 14), 2 * math.pi / omega)
    begin = Coordinates(steady.section.state, *steady.section.coordinates)
    assert steady.order == 3
    assert all(held.parted_by_a_jump(maps, begin, turns, 6 // turns) is None for turns in (1, 2))
