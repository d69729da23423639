"""Damped stops in the analytic solver: flows, motions, switches, deviations and energies against brute force."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy.linalg

from analytic.march import Joint, march, march_linearised
from analytic.march.coordinates import Coordinates
from analytic.march.coupled import oscillators
from analytic.march.field import history_of
from analytic.march.initial_state import initial_coordinates, started
from analytic.solver import Solver
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import InputError
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.problem import FloatArray, Problem
from tests.helpers.damped_stops import Witnessed, random_damped_joint, sampled_joint, witnessed


def pinned_bar(damping: float, may_pull: bool = False, stiffness: float = 100.0, force: float = -10.0) -> Problem:
    """A bar on a pin whose tip moves as 1 kg under 10 m/s2, with a stop 2 m below: SDND108 of Code_Aster."""
    return Problem.model_validate(
        {
            "beam": {"length": 1.0, "bending_stiffness": 1e12, "mass_per_length": 3.0},
            "supports": [{"x": 0.0, "translational": math.inf}],
            "stops": [
                {
                    "x": 1.0,
                    "side": "bottom",
                    "gap": 2.0,
                    "stiffness": stiffness,
                    "damping": damping,
                    "may_pull": may_pull,
                }
            ],
            "point_loads": [{"kind": "step", "x": 1.0, "force": force}] if force else [],
            "initial": {"kind": "polynomial", "velocity": [0.0, -1.0]},
        }
    )


@pytest.mark.parametrize(
    ("damping", "may_pull", "end", "z"),
    [
        (0.0, False, 0.88545615307643, -1.3321629818551),
        (5.0, True, 0.92403882486238, -1.8821407968322),
        (5.0, False, 0.86570174672577, -1.8511084325939),
    ],
)
def test_a_bar_on_a_pin_moves_as_its_closed_form(damping: float, may_pull: bool, end: float, z: float) -> None:
    # `end` and `z` are mpmath's roots of the closed form; the bar's own mode leaves 2e-10
    motion = Solver(n_modes=1).simulate(pinned_bar(damping, may_pull), 1.0, errors=False)
    (contact,) = motion.contacts
    assert contact.start == pytest.approx((math.sqrt(41) - 1) / 10, abs=1e-9)
    assert contact.end == pytest.approx(end, abs=1e-9)
    assert motion.displacement(1.0, 1.0).item() == pytest.approx(z, abs=1e-9)


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


@pytest.mark.parametrize(
    ("ratio", "may_pull"),
    [*((r, False) for r in (0.02, 0.3, 0.9, 1.0, 1.5, 4.0)), (0.02, True), (0.3, True), (0.9, True)],
)
def test_one_degree_of_freedom_rebounds_with_the_closed_coefficient_of_restitution(
    ratio: float, may_pull: bool
) -> None:
    omega = 10.0
    motion = Solver(n_modes=1).simulate(pinned_bar(2 * ratio * omega, may_pull, force=0.0), 8.0, errors=False)
    (contact,) = motion.contacts
    end, rebound = rebound_of(ratio, may_pull)
    assert contact.duration == pytest.approx(end / omega, rel=1e-7)  # the bar bends by 1e-8
    assert motion.velocity(1.0, 8.0).item() == pytest.approx(rebound, rel=1e-7)
    assert contact.dissipated == pytest.approx((1 - rebound**2) / 2, rel=1e-7)
    assert contact.impulse == pytest.approx(-(1 + rebound), rel=1e-7)


def test_a_critically_damped_stop_that_may_pull_keeps_the_bar() -> None:
    (contact,) = Solver(n_modes=1).simulate(pinned_bar(30.0, True, force=0.0), 8.0, errors=False).contacts
    assert contact.open_end


def test_a_stop_of_vanishing_damping_acts_as_one_without() -> None:
    plain, damped = (Solver(n_modes=1).simulate(pinned_bar(c), 1.0, errors=False) for c in (0.0, 1e-11))
    assert damped.displacement(1.0, 1.0).item() == pytest.approx(plain.displacement(1.0, 1.0).item(), abs=1e-11)


def matrices(rng: np.random.Generator) -> tuple[FloatArray, FloatArray, FloatArray]:
    """D, K and natural frequencies of modes that dampers couple, and from which some springs are taken."""
    n = int(rng.integers(1, 13))
    omega = np.sort(10 ** rng.uniform(0, 3.5, n))
    K, D = np.diag(omega**2), np.diag(2 * omega * rng.uniform(0, 0.1, n) * (rng.random() < 0.7))
    for _ in range(rng.integers(1, 4)):
        phi = rng.normal(size=n)
        if rng.random() < 0.3:
            without = K - rng.uniform(0.1, 0.9) / np.sum(phi**2 / np.diag(K)) * np.outer(phi, phi)
            K = without if np.linalg.eigvalsh(without)[0] > 1e-6 else K
        else:
            D = D + 10 ** rng.uniform(-3, 4) * np.outer(phi, phi)
    return D, K, omega


def flow_error(D: FloatArray, K: FloatArray, scale: FloatArray, t: float) -> float:
    """Largest error of the oscillators' flow over `t` seconds against scipy's expm of the first-order matrix."""
    n, (roots, to, back) = scale.size, oscillators(D, K, scale)
    inner = np.zeros((2 * n, 2 * n))
    for i, (a, b) in enumerate(roots):
        pair = np.array([[0, 1], [-(a * b).real, (a + b).real]])
        inner[np.ix_([i, n + i], [i, n + i])] = scipy.linalg.expm(pair * t)
    A, size = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -D]]), np.concatenate([scale, np.ones(n)])
    exact = scipy.linalg.expm(A / size * t * size[:, None])
    return float(np.abs(exact - to @ inner @ back / size * size[:, None]).max())


def test_oscillators_flow_as_the_matrix_exponential() -> None:
    rng = np.random.default_rng(1)
    assert max(flow_error(*matrices(rng), 10 ** rng.uniform(-3, 0)) for _ in range(60)) < 1e-9


@pytest.mark.slow
def test_many_oscillators_flow_as_the_matrix_exponential() -> None:
    rng = np.random.default_rng(2)
    assert max(flow_error(*matrices(rng), 10 ** rng.uniform(-3, 0)) for _ in range(2000)) < 1e-9


@pytest.mark.parametrize("apart", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_flow_at_and_near_a_double_root(apart: float) -> None:
    problem = pinned_bar(20.0 * (1 + apart))  # 2 sqrt(k m) is 20 N s/m
    joint = Joint(problem, 1, 1)
    it, modal = joint.coupled(ContactState((0,))), joint.modal(ContactState((0,)))
    assert it is not None
    phi, omega, t = modal.at_stops[0], modal.modes.omega, 0.3
    A = np.block([[np.zeros((1, 1)), np.eye(1)], [-np.diag(omega**2), -problem.stops[0].damping * np.outer(phi, phi)]])
    (a, b) = it.roots[0]
    inner = scipy.linalg.expm(np.array([[0, 1], [-(a * b).real, (a + b).real]]) * t)
    assert np.abs(scipy.linalg.expm(A * t) - it.to @ inner @ it.back).max() < 1e-9 * omega[0]


def marched(seed: int, sampled: bool, end: float) -> tuple[Problem, Joint, Any, Witnessed]:
    """A random joint with damped stops, its march to `end`, s, and the witness's; `sampled` drives it along ramps."""
    rng = np.random.default_rng(seed)
    problem, n = random_damped_joint(rng), int(rng.integers(3, 7))
    problem = sampled_joint(seed) if sampled else problem
    joint = Joint(problem, n, n)
    start = started(joint)
    motion = march(joint, start, 0.0, end, depth=True)
    q, v = initial_coordinates(problem, joint.modal(start.state).modes)
    return problem, joint, motion, witnessed(joint, start.state, q, v, end)


def check_motion(seed: int, sampled: bool = False, end: float = 2.0) -> int:
    """Compare a march with the witness; the number of switches that end or begin a force alone."""
    problem, joint, motion, witness = marched(seed, sampled, end)
    rows = motion.log.stop[motion.log.stop >= 0].tolist()
    indices = tuple(joint.index_of(row) for row in rows)
    assert indices == witness.indices
    assert motion.log.end[motion.log.stop >= 0] == pytest.approx(witness.times, abs=1e-8)
    assert motion.end.state == witness.state
    end = motion.log.end[-1]
    q, v = joint.in_modes(motion.end.state, motion.end.q, motion.end.v, end)
    assert np.abs(q - witness.q).max() < 1e-7 * np.abs(witness.q).max()  # the witness keeps some nine digits
    assert np.abs(v - witness.v).max() < 1e-7 * np.abs(witness.v).max()
    history = history_of("", joint, motion.log)
    assert history.impulses() == pytest.approx(witness.impulses, rel=1e-7, abs=1e-9)
    lost = np.zeros(len(problem.stops))
    for contact in history.contacts:
        lost[contact.stop] += contact.dissipated
    damped = np.array([stop.damping > 0 for stop in problem.stops])
    assert lost[damped] == pytest.approx(witness.dissipated[damped], rel=1e-6, abs=1e-9)
    inside = history.contact_force(np.linspace(0, end, 2001))
    for k, stop in enumerate(problem.stops):
        if damped[k] and not stop.may_pull:
            peak = max((c.peak_force for c in history.contacts if c.stop == k), default=0.0)
            assert np.max(-stop.sign * inside[k]) <= peak * (1 + 1e-9) + 1e-12
            assert np.min(-stop.sign * inside[k]) >= 0
    return sum(index < 0 for index in indices)


def test_motions_switch_where_brute_force_finds_it() -> None:
    assert sum(check_motion(seed) for seed in range(4)) > 5


def test_motions_along_ramps_switch_where_brute_force_finds_it() -> None:
    # a displacement record with stops in space and beside them, and random motion with a stop in space
    assert check_motion(1, True, 0.7) + check_motion(2, True, 1.0) > 2


@pytest.mark.slow
@pytest.mark.parametrize("first", range(0, 40, 4))
def test_motions_of_many_joints_along_ramps_switch_where_brute_force_finds_it(first: int) -> None:
    for seed in range(first, first + 4):
        check_motion(seed, True, 1.5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4, 110))
def test_many_motions_switch_where_brute_force_finds_it(seed: int) -> None:
    check_motion(seed)


def check_tangent(seed: int) -> None:
    """Compare the derivative of a march over 1.2 s with central differences of fourth order."""
    rng = np.random.default_rng(seed)
    problem, n = random_damped_joint(rng), int(rng.integers(2, 7))
    joint = Joint(problem, n, n)
    first = march(joint, started(joint), 0.0, 0.3).end
    start, end = Coordinates(first.state, first.q, first.v), 1.2
    whole = march(joint, start, 0.0, end)
    rows = whole.log.stop.tolist()
    found, matrix = march_linearised(joint, start, end, np.eye(2 * n))
    assert found.y == pytest.approx(whole.end.y, rel=1e-9, abs=1e-13)
    weight, best = 1 / np.concatenate([np.ones(n), np.full(n, 30.0)]), math.inf
    for size in (1e-5, 1e-6, 1e-7):
        columns = []
        for i in range(2 * n):
            ends = []
            for far in (2, 1, -1, -2):
                y = start.y.copy()
                y[i] += far * size * (1 if i < n else 5)
                motion = march(joint, start.moved(y), 0.0, end)
                ends.append(motion.end.y if motion.log.stop.tolist() == rows else np.full(found.y.size, np.nan))
            columns.append((8 * (ends[1] - ends[2]) - ends[0] + ends[3]) / (12 * size * (1 if i < n else 5)))
        apart = np.abs((np.array(columns).T - matrix) * weight[:, None]).max()
        if np.isfinite(apart):
            best = min(best, float(apart / np.abs(matrix * weight[:, None]).max()))
    assert best < 1e-7


@pytest.mark.parametrize("seed", [3, 10])
def test_deviations_travel_as_finite_differences(seed: int) -> None:
    check_tangent(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(3), *range(4, 10), *range(11, 60)])
def test_many_deviations_travel_as_finite_differences(seed: int) -> None:
    check_tangent(seed)


def check_steady(seed: int) -> bool:
    """Whether a random joint comes to a certified motion; one that does is still there 60 decay times later."""
    rng = np.random.default_rng(seed)
    problem, n = random_damped_joint(rng), int(rng.integers(4, 9))
    solver = Solver(n_modes=n, max_periods=2000)
    found = solver.steady_state(problem, errors=False)
    if not found.period_multiple:
        return False
    period_map, count = solver.period_map(problem), 2 * found.period_multiple
    half_periods, point = HalfPeriods(period_map), found.section_point
    leading = float(np.abs(found.multipliers).max(initial=0.0))
    assert leading < 1
    later = point
    for _ in range(min(400, math.ceil(60 / -math.log(max(leading, 1e-9))))):
        later = half_periods.linearised(later, count).end  # in one piece, as the certificate has it
    assert half_periods.apart(point, later) < 1e-6
    return True


def test_a_certified_motion_stays() -> None:
    assert sum(check_steady(seed) for seed in range(1, 4)) >= 2


@pytest.mark.slow
def test_certified_motions_stay() -> None:
    assert sum(check_steady(seed) for seed in range(4, 90)) >= 60


def test_what_damped_stops_do_not_reach_yet_is_refused() -> None:
    problem = random_damped_joint(np.random.default_rng(0))
    with pytest.raises(InputError, match=r"stops\[0\]\.damping = .*branches need stops without damping"):
        _ = Solver(n_modes=3).period_map(problem).arcs
