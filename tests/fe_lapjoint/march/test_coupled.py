"""Damped stops on a mesh: flows, motions, switches, deviations and energies against brute force."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
import scipy.linalg

from fe_lapjoint import Solver
from fe_lapjoint.march.coupled import Coupled, exponentials, flow_from
from fe_lapjoint.march.field import history_of
from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.march import march
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.tangent import Carried
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import InputError
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.problem import FloatArray, Problem
from tests.helpers.damped_mesh import MeshForWitness, model_of, random_damped_mesh
from tests.helpers.damped_stops import random_damped_joint, witnessed

Draw = Callable[[np.random.Generator], Model]
"""Draws a random joint on a mesh."""
BEGIN = 0.3  # s: when deviations begin, after a motion that has met its stops


def random_state(seed: int) -> Coupled | None:
    """A state of a random joint on a mesh in which all damped stops are closed, and some of them released."""
    rng = np.random.default_rng(seed)
    problem = random_damped_joint(rng)
    model = model_of(problem, int(rng.integers(2, 8)))
    closed = tuple(k for k in range(len(problem.stops)) if k in model.damped or rng.random() < 0.5)
    may = [k for k in model.damped if not problem.stops[k].may_pull]
    system = model.system(ContactState(closed, tuple(k for k in may if rng.random() < 0.4)))
    return system if isinstance(system, Coupled) else None


def first_order(system: Coupled) -> tuple[FloatArray, FloatArray]:
    """The matrix of (omega q, q'), 1/s, ``(2 n, 2 n)``, and the factors of (q, q')."""
    n, omega = system.omega.size, system.omega
    A = np.block([[np.zeros((n, n)), np.diag(omega)], [-np.diag(omega), -system.D]])
    return A, np.concatenate([omega, np.ones(n)])


def check_flow(seed: int) -> None:
    system = random_state(seed)
    if system is None:
        return
    rng = np.random.default_rng([seed, 1])
    (A, size), t = first_order(system), 10 ** rng.uniform(-3, -1)
    here = system.flown(t, np.diag(1 / size)) * size[:, None]
    assert np.abs(scipy.linalg.expm(A * t) - here).max() < 1e-9
    y = rng.normal(size=size.size) / size
    flow = flow_from(system, 0.3, y)
    later, at = flow.at(0.3 + t), np.array([0.3 + t])
    n, acceleration = system.omega.size, system.rates(0.3 + t, later)[system.omega.size :]
    amount = 1.0 + float(np.abs(system.still * size).max())  # what free and forced motion cancel from
    spread = float(system.omega.max() / system.omega.min())  # eigenvalues are known to rounding of the fastest
    assert np.abs((flow.at(0.3) - y) * size).max() < (1e-9 + 4 * np.finfo(float).eps * spread) * amount
    assert flow(at, 1)[:, 0] == pytest.approx(later[n:], abs=1e-12)
    assert np.abs(flow(at, 2)[:, 0] - acceleration).max() < 1e-9 * np.abs(acceleration).max()
    P = system.stops.shape[0]
    seen = system.stops @ later[:n] + system.seen_motion(at)[:P, 0]
    assert flow.at_stops(at)[:P, 0] == pytest.approx(seen, abs=1e-9)


def test_flows_are_the_matrix_exponential() -> None:
    for seed in range(20):
        check_flow(seed)


@pytest.mark.slow
def test_many_flows_are_the_matrix_exponential() -> None:
    for seed in range(20, 300):
        check_flow(seed)


@pytest.mark.parametrize("apart", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_flow_at_and_near_a_double_root(apart: float) -> None:
    omega, t = np.array([3.0]), 0.7
    D = np.array([[6.0 * (1 + apart)]])  # critical damping is 2 omega
    it = exponentials(omega, np.zeros((1, 1)), D)
    exact = scipy.linalg.expm(np.array([[0.0, 1.0], [-9.0, -D[0, 0]]]) * t)
    here = np.concatenate([it.modes, it.modes * it.rates]) * np.exp(it.rates * t) @ it.back
    assert np.abs(here.real - exact).max() < 1e-9


def test_flow_of_a_rigid_body_beside_a_damped_stop() -> None:
    """Modal damping stays that of the closed stop when its force has ended; the bar then turns freely, with drag."""
    problem = pinned_bar(5.0).replace(damping={"kind": "modal", "ratio": 0.05})
    for state in (ContactState((0,)), ContactState((0,), (0,))):
        system = model_of(problem, 1).system(state)
        assert isinstance(system, Coupled)
        n, t = system.omega.size, 0.2
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(system.omega**2), -system.D]])
        load = np.zeros((2 * n + 1, 2 * n + 1))
        load[: 2 * n, : 2 * n], load[n : 2 * n, 2 * n] = A, system.constant
        y = np.array([0.3, *np.zeros(n - 1), -0.7, *np.zeros(n - 1)])
        slow = np.concatenate([[0], [n]])
        exact = (scipy.linalg.expm(load * t) @ np.append(y, 1.0))[: 2 * n]
        flow = flow_from(system, 0.0, y)
        assert flow.at(t)[slow] == pytest.approx(exact[slow], rel=1e-8)
        times, weights = np.polynomial.legendre.leggauss(40)
        inside = (times + 1) * t / 2
        reads = flow.at_stops(inside)
        if not state.released:
            reads = reads + 0.05 * flow.at_stops(inside, 1)
            assert flow.integral_at_stops(t)[0] == pytest.approx(float(reads[0] @ weights) * t / 2, rel=1e-6)


def pinned_bar(damping: float, may_pull: bool = False) -> Problem:
    """A bar on a pin whose tip moves as 1 kg under 10 m/s2, with a stop 2 m below: SDND108 of Code_Aster."""
    stop = {"x": 1.0, "side": "bottom", "gap": 2.0, "stiffness": 100.0, "damping": damping, "may_pull": may_pull}
    return Problem.model_validate(
        {
            "beam": {"length": 1.0, "bending_stiffness": 1e7, "mass_per_length": 3.0},
            "supports": [{"x": 0.0, "translational": math.inf}],
            "stops": [stop],
            "point_loads": [{"kind": "step", "x": 1.0, "force": -10.0}],
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
    # `end` and `z` are mpmath's roots of the closed form; bending moves them by 1e-5
    motion = Solver(elements=1).simulate(pinned_bar(damping, may_pull), 1.0, errors=False)
    (contact,) = motion.contacts
    assert contact.start == pytest.approx((math.sqrt(41) - 1) / 10, abs=2e-5)
    assert contact.end == pytest.approx(end, abs=2e-5)
    assert motion.evaluate(1.0, 1.0)[0, 0] == pytest.approx(z, abs=2e-4)


def check_motion(seed: int, end: float = 2.0, draw: Draw = random_damped_mesh) -> int:
    """Compare a march to `end`, s, with the witness; the number of switches that end or begin a force alone."""
    model = draw(np.random.default_rng(seed))
    problem, state, P = model.problem, initial_state(model), len(model.problem.stops)
    y = initial_coordinates(model.assembly, model.system(state))
    motion, mesh = march(model, state, y, 0.0, end), MeshForWitness(model)
    witness = witnessed(mesh, state, *mesh.in_modes(state, y), end)  # type: ignore[arg-type]
    switched = [piece for piece in motion.pieces if piece.switched >= 0]
    indices = [it.switched if it.switched < P else ~model.damped[it.switched - P] for it in switched]
    assert tuple(indices) == witness.indices
    assert [it.end for it in switched] == pytest.approx(witness.times, abs=1e-8)
    assert motion.state == witness.state
    q, v = mesh.in_modes(motion.state, motion.y)
    assert np.abs(q - witness.q).max() < 1e-7 * np.abs(witness.q).max()
    assert np.abs(v - witness.v).max() < 1e-7 * np.abs(witness.v).max()
    history = history_of("", model, [motion], end)
    assert history.impulses() == pytest.approx(witness.impulses, rel=1e-7, abs=1e-9)
    lost = np.zeros(P)
    for contact in history.contacts:
        lost[contact.stop] += contact.dissipated
    damped = list(model.damped)
    assert lost[damped] == pytest.approx(witness.dissipated[damped], rel=1e-6, abs=1e-9)
    inside = history.contact_force(np.linspace(0, end, 2001))
    for k in model.damped:
        stop = problem.stops[k]
        if not stop.may_pull:
            peak = max((c.peak_force for c in history.contacts if c.stop == k), default=0.0)
            assert np.max(-stop.sign * inside[k]) <= peak * (1 + 1e-9) + 1e-12
    return sum(index < 0 for index in indices)


def test_motions_switch_where_brute_force_finds_it() -> None:
    assert check_motion(3, 0.6) > 0


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(8), *range(9, 60)])
def test_many_motions_switch_where_brute_force_finds_it(seed: int) -> None:
    check_motion(seed)


def marched(model: Model, state: ContactState, y: FloatArray, end: float) -> tuple[FloatArray, list[int]]:
    """(q, q') at the end, and what switches."""
    motion = march(model, state, y, BEGIN, end, record=False)
    return motion.y, [piece.switched for piece in motion.pieces if piece.switched >= 0]


def check_tangent(seed: int, draw: Draw = random_damped_mesh) -> None:
    """Compare the derivative of a march over 1.2 s with central differences of fourth order."""
    model = draw(np.random.default_rng(seed))
    state = initial_state(model)
    first = march(model, state, initial_coordinates(model.assembly, model.system(state)), 0.0, BEGIN)
    state, start, n, end = first.state, first.y, first.y.size // 2, 1.5
    motion = march(model, state, start, BEGIN, end, record=False)
    rows = [piece.switched for piece in motion.pieces if piece.switched >= 0]
    matrix = Carried(model, motion, np.eye(2 * n)).end
    weight, best = 1 / np.concatenate([np.ones(n), np.full(n, 30.0)]), math.inf
    for size in (1e-6, 1e-7, 1e-8):
        columns = []
        for i in range(2 * n):
            ends = []
            for far in (2, 1, -1, -2):
                y = start.copy()
                y[i] += far * size * (1 if i < n else 5)
                moved, others = marched(model, state, y, end)
                ends.append(moved if others == rows else np.full(2 * n, np.nan))
            columns.append((8 * (ends[1] - ends[2]) - ends[0] + ends[3]) / (12 * size * (1 if i < n else 5)))
        apart = np.abs((np.array(columns).T - matrix) * weight[:, None]).max()
        if np.isfinite(apart):
            best = min(best, float(apart / np.abs(matrix * weight[:, None]).max()))
    assert best < 1e-7


@pytest.mark.parametrize("seed", [3, 12])
def test_deviations_travel_as_finite_differences(seed: int) -> None:
    check_tangent(seed)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [*range(3), *range(4, 12), *range(13, 30)])
def test_many_deviations_travel_as_finite_differences(seed: int) -> None:
    check_tangent(seed)


def check_steady(seed: int, draw: Draw = random_damped_mesh) -> bool:
    """Whether a random joint comes to a certified motion; one that does is still there 60 decay times later."""
    solver, problem = Solver(elements=2, max_periods=400), draw(np.random.default_rng(seed)).problem
    found = solver.steady_state(problem, errors=False)
    if not found.period_multiple:
        return False
    period_map, count = solver.period_map(problem), 2 * found.period_multiple
    half_periods, point = HalfPeriods(period_map), found.section_point
    leading = float(np.abs(found.multipliers).max(initial=0.0))
    assert leading < 1
    later = point
    for _ in range(min(400, math.ceil(60 / -math.log(max(leading, 1e-9))))):
        later = period_map.march(later, count).end
    assert half_periods.apart(point, later) < 1e-6
    return True


def test_a_certified_motion_stays() -> None:
    assert all(check_steady(seed) for seed in (5, 7, 9, 11))


@pytest.mark.slow
def test_certified_motions_stay() -> None:
    assert sum(check_steady(seed) for seed in range(12, 60)) >= 30


def test_what_damped_stops_do_not_reach_is_refused() -> None:
    problem = random_damped_joint(np.random.default_rng(0))
    with pytest.raises(InputError, match=r"stops\[0\]\.damping = .*method = 'exact', and not with 'Radau'"):
        Solver(elements=2, method="Radau").simulate(problem, 1.0)
    record = {"kind": "record", "times": [0.0, 0.1, 0.2, 0.3], "values": [0.0, 1.0, -1.0, 0.0], "x": 1.0}
    shaken = problem.model_dump() | {"base_motion": None, "point_loads": [record]}
    with pytest.raises(InputError, match=r"stops\[0\]\.damping = .*not with records or random motion"):
        Solver(elements=2).simulate(Problem.model_validate(shaken), 0.3)
