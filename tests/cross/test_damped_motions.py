"""Motions with damped stops by both solvers: closed forms, brute force, and derivatives against differences."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from damped_stops import Draw, Marched, by_elements, by_modes, loose_beam, pinned_bar, sampled_joint
from random_joints import damped_cantilever, dragged_cantilever

import analytic
import fe_lapjoint
from lapjoint import Problem
from lapjoint.problem import Mass, ViscousDamping

Solver = analytic.Solver | fe_lapjoint.Solver
BARS = (
    pytest.param(analytic.Solver(n_modes=1), 1e12, 1e-9, id="analytic"),  # the bar's own mode leaves 2e-10
    pytest.param(fe_lapjoint.Solver(elements=1), 1e7, 2e-4, id="fe"),  # bending moves the end by 1e-5, z by 1e-4
)


@pytest.mark.parametrize(("solver", "EI", "off"), BARS)
@pytest.mark.parametrize(
    ("damping", "may_pull", "end", "z"),
    [
        (0.0, False, 0.88545615307643, -1.3321629818551),
        (5.0, True, 0.92403882486238, -1.8821407968322),
        (5.0, False, 0.86570174672577, -1.8511084325939),
    ],
)
def test_a_bar_on_a_pin_moves_as_its_closed_form(
    solver: Solver, EI: float, off: float, damping: float, may_pull: bool, end: float, z: float
) -> None:
    # `end` and `z` are mpmath's roots of the closed form
    motion = solver.simulate(pinned_bar(damping, may_pull, EI=EI), 1.0, errors=False)
    (contact,) = motion.contacts
    assert contact.start == pytest.approx((math.sqrt(41) - 1) / 10, abs=off)
    assert contact.end == pytest.approx(end, abs=off)
    assert motion.displacement(1.0, 1.0).item() == pytest.approx(z, abs=off)


def rebound_of(ratio: float, may_pull: bool) -> tuple[float, float]:
    """Duration times omega, and speed of the rebound over that of the impact, of one damped degree of freedom.

    The solution of d'' + 2 ratio d' + d = 0 from d = 0, d' = 1 ends at d = 0, or without tension at d'' = 0.
    """
    w = np.sqrt(complex(1 - ratio**2))
    if may_pull:
        return math.pi / w.real, math.exp(-ratio * math.pi / w.real)
    if ratio == 1:
        return 2.0, math.exp(-2.0)
    lag = np.log((ratio + 1j * w) / (ratio - 1j * w)) / 1j  # d'' is proportional to sin(w t - lag)
    t = (lag / w).real
    return t, ((ratio * np.sin(w * t) / w - np.cos(w * t)) * math.exp(-ratio * t)).real


@pytest.mark.parametrize(("solver", "EI", "off"), BARS)
@pytest.mark.parametrize(("ratio", "may_pull"), [(r, pulls) for r in (0.02, 0.3, 0.9) for pulls in (False, True)])
def test_one_degree_of_freedom_rebounds_with_the_closed_coefficient_of_restitution(
    solver: Solver, EI: float, off: float, ratio: float, may_pull: bool
) -> None:
    omega, off = 10.0, 100 * off  # the impact excites the bending of the bar, whose share is larger than of rest
    problem = pinned_bar(2 * ratio * omega, may_pull, EI=EI, force=0.0)
    motion = solver.simulate(problem, 8.0, errors=False)
    (contact,) = motion.contacts
    end, rebound = rebound_of(ratio, may_pull)
    assert contact.duration == pytest.approx(end / omega, rel=off)
    assert motion.velocity(1.0, 8.0).item() == pytest.approx(rebound, rel=off)
    assert contact.dissipated == pytest.approx((1 - rebound**2) / 2, rel=off)
    assert contact.impulse == pytest.approx(-(1 + rebound), rel=off)


@pytest.mark.parametrize("ratio", [1.0, 1.5, 4.0])
def test_a_bar_that_does_not_bend_rebounds_from_a_stop_damped_beyond_its_critical_damping(ratio: float) -> None:
    """The softer bar of the FE solver touches such a stop several times as it rings."""
    test_one_degree_of_freedom_rebounds_with_the_closed_coefficient_of_restitution(*BARS[0].values, ratio, False)


@pytest.mark.parametrize(("solver", "EI", "off"), BARS)
def test_a_critically_damped_stop_that_may_pull_keeps_the_bar(solver: Solver, EI: float, off: float) -> None:
    (contact,) = solver.simulate(pinned_bar(30.0, True, EI=EI, force=0.0), 8.0, errors=False).contacts
    assert contact.open_end


@pytest.mark.parametrize(("solver", "EI", "off"), BARS)
def test_a_stop_of_vanishing_damping_acts_as_one_without(solver: Solver, EI: float, off: float) -> None:
    plain, damped = (solver.simulate(pinned_bar(c, EI=EI), 1.0, errors=False) for c in (0.0, 1e-11))
    assert damped.displacement(1.0, 1.0).item() == pytest.approx(plain.displacement(1.0, 1.0).item(), abs=1e-2 * off)


March = Callable[..., Marched]


def check_motion(marched: March, seed: int, end: float = 2.0, draw: Draw = damped_cantilever) -> int:
    """Compare a march to `end`, s, with brute force; the number of switches that end or begin a force alone."""
    it = marched(seed, end, draw)
    witness, stops = it.witness, it.history.problem.stops
    assert it.indices == witness.indices
    assert it.times == pytest.approx(witness.times, abs=1e-8)
    assert it.state == witness.state
    for found, exact in ((it.q, witness.q), (it.v, witness.v)):
        assert np.abs(found - exact).max() < 1e-7 * np.abs(exact).max()  # the witness keeps some nine digits
    assert it.history.impulses() == pytest.approx(witness.impulses, rel=1e-7, abs=1e-9)
    lost = np.zeros(len(stops))
    for contact in it.history.contacts:
        lost[contact.stop] += contact.dissipated
        for cut, t, share in ((contact.open_start, 0.0, -0.5), (contact.open_end, end, 0.5)):
            if cut:  # what the spring stores is not lost, and the witness's integral has it
                depth = it.history.penetration(t)[contact.stop, 0]
                lost[contact.stop] += share * stops[contact.stop].stiffness * depth**2
    damped = [k for k, stop in enumerate(stops) if stop.damping > 0]
    assert lost[damped] == pytest.approx(witness.dissipated[damped], rel=1e-6, abs=1e-9)
    inside = it.history.contact_force(np.linspace(0, end, 2001))
    for k in damped:
        if not stops[k].may_pull:
            peak = max((c.peak_force for c in it.history.contacts if c.stop == k), default=0.0)
            assert np.max(-stops[k].sign * inside[k]) <= peak * (1 + 1e-9) + 1e-12
            assert np.min(-stops[k].sign * inside[k]) >= 0
    return sum(index < 0 for index in it.indices)


@pytest.mark.parametrize(("marched", "seeds", "end"), [(by_modes, range(2), 1.5), (by_elements, (3,), 0.6)])
def test_motions_switch_where_brute_force_finds_it(marched: March, seeds: range, end: float) -> None:
    assert sum(check_motion(marched, seed, end) for seed in seeds) > 0


@pytest.mark.slow
@pytest.mark.parametrize(
    ("marched", "seed"), [*((by_modes, seed) for seed in range(110)), *((by_elements, seed) for seed in range(60))]
)
def test_many_motions_switch_where_brute_force_finds_it(marched: March, seed: int) -> None:
    check_motion(marched, seed)


@pytest.mark.thorough
def test_motions_whose_damping_couples_modes_switch_where_brute_force_finds_it() -> None:
    check_motion(by_modes, 5, 0.7, dragged_cantilever)
    check_motion(by_elements, 0, 0.6, dragged_cantilever)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("marched", "seed"), [*((by_modes, seed) for seed in range(110)), *((by_elements, seed) for seed in range(60))]
)
def test_many_motions_whose_damping_couples_modes_do(marched: March, seed: int) -> None:
    check_motion(marched, seed, draw=dragged_cantilever)


def along_ramps(rng: np.random.Generator, **options: bool) -> Problem:
    """A random cantilever that a record or random motion drives, with stops in space as frequent as others."""
    return sampled_joint(int(rng.integers(1000)), **options)


def dragged_along_ramps(rng: np.random.Generator, **options: bool) -> Problem:
    """The same with a mass at its tip, under viscous damping, which couples its modes."""
    return along_ramps(rng, **options).replace(
        masses=(Mass(x=1.0, mass=0.3),), damping=ViscousDamping(coefficient=float(rng.uniform(0.1, 3)))
    )


@pytest.mark.thorough
def test_motions_along_ramps_switch_where_brute_force_finds_it() -> None:
    check_motion(by_modes, 0, 0.6, dragged_along_ramps)


@pytest.mark.slow
@pytest.mark.parametrize("draw", [along_ramps, dragged_along_ramps])
@pytest.mark.parametrize("seed", range(60))
def test_many_motions_along_ramps_do(draw: Draw, seed: int) -> None:
    check_motion(by_modes, seed, 1.2, draw)


@pytest.mark.parametrize(
    ("draw", "seed"),
    [
        pytest.param(dragged_along_ramps, 9, marks=pytest.mark.thorough),
        pytest.param(along_ramps, 9, marks=pytest.mark.slow),
        *(
            pytest.param(draw, k, marks=pytest.mark.slow)
            for draw in (along_ramps, dragged_along_ramps)
            for k in range(9)
        ),
    ],
)
def test_meshes_along_ramps_switch_where_brute_force_finds_it(draw: Draw, seed: int) -> None:
    check_motion(by_elements, seed, 1.0, draw)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(6))
def test_loose_meshes_meet_damped_stops_where_brute_force_finds_it(seed: int) -> None:
    check_motion(by_elements, seed, 0.5, lambda rng, **options: loose_beam(seed))


def check_derivative(solver: Solver, seed: int, draw: Draw = damped_cantilever) -> None:
    """Compare the derivative of the period map, in some random directions, with differences of fourth order.

    Steps are all decades of the motion's size from a hundredth down to rounding, and the best one is judged.  What a
    period magnifies more than a thousandfold is left out: of its end, marches themselves keep fewer digits.
    """
    problem, rng = draw(np.random.default_rng(seed)), np.random.default_rng((seed, 1))
    map_: Any = solver.period_map(problem)
    point = map_.march(map_.initial(), 4).end  # two periods: the stops have been met
    passage = map_.linearised(point, 2)
    matrix, size = passage.derivative().matrix, map_.size(point)
    for _ in range(3):
        e = rng.standard_normal(matrix.shape[1])
        e = map_.difference(map_.moved(point, e), point)
        e /= map_.norm(e)
        if map_.norm(matrix @ e) > 1e3:
            continue
        apart = []
        for step in size * 10.0 ** -np.arange(2.0, 9.0):
            ends = [map_.march(map_.moved(point, far * step * e), 2) for far in (2, 1, -1, -2)]
            moved = [map_.difference(it.end, point) for it in ends]  # the matrix is in coordinates of the start
            found = (8 * (moved[1] - moved[2]) - moved[0] + moved[3]) / (12 * step)
            apart.append(map_.norm(found - matrix @ e))
        assert min(apart) < 1e-7 * max(1.0, map_.norm(matrix @ e))


SMALL = (analytic.Solver(n_modes=5), fe_lapjoint.Solver(elements=2))


@pytest.mark.parametrize("solver", SMALL)
@pytest.mark.parametrize(
    "seed", [3, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (*range(3), *range(4, 45)))]
)
def test_deviations_travel_as_finite_differences(solver: Solver, seed: int) -> None:
    check_derivative(solver, seed)


@pytest.mark.parametrize("solver", SMALL)
@pytest.mark.parametrize("seed", [1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (0, *range(2, 45)))])
def test_deviations_travel_as_finite_differences_where_damping_couples_modes(solver: Solver, seed: int) -> None:
    check_derivative(solver, seed, dragged_cantilever)
