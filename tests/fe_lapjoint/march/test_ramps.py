"""The march along records: no switch is missed, pieces stay few, and their motion is that of the equations."""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from itertools import pairwise

import numpy as np
import pytest
from dense_march import dense_march
from few_and_many import few_and_many
from population import recorded_joint
from scipy.integrate import fixed_quad, solve_ivp

import fe_lapjoint
from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.ramp_march import LONGEST
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import FREE, History, InputError, ModalDamping, Problem, Stop, paper_joint
from lapjoint.errors import RecordWarning
from lapjoint.problem import RecordBaseMotion

SEED = 1
FEW = (1, 2, 3, 6, 11, 17, 21)  # joints that turn, creep or ring, with knots as many and as few as they come
MOST = 14  # switches compared
ELEMENTS = 3  # of a mesh; tiny steps follow its fastest mode
pytestmark = pytest.mark.filterwarnings("ignore::lapjoint.errors.RecordWarning")


def by_stops(history: History) -> list[tuple[int, float]]:
    """Each switch of a motion: the stop, and when, s."""
    changes = zip(history.states, history.states[1:], history.switch_times.tolist(), strict=False)
    return [((set(a.closed) ^ set(b.closed)).pop(), t) for a, b, t in changes]


def worst(index: int) -> tuple[int, float]:
    """Switches compared with those of tiny steps, and the largest difference over the duration."""
    problem, duration = recorded_joint(SEED, index)
    mesh = Assembly(problem, mesh_nodes(problem, ELEMENTS, None))
    model = Model(problem, mesh, "exact", 1e-9, 1e-12)
    state = initial_state(model)
    start = initial_coordinates(mesh, model.system(state))
    tiny = dense_march(model, state, start, duration, most=MOST).switches
    found = by_stops(fe_lapjoint.Solver(elements=ELEMENTS).simulate(problem, duration, errors=False))[:MOST]
    assert [k for k, _ in found] == [k for k, _ in tiny], problem.title
    return len(tiny), max((abs(a - b) / duration for (_, a), (_, b) in zip(found, tiny, strict=True)), default=0.0)


@pytest.mark.parametrize("indices", few_and_many(FEW, range(80)))
def test_tiny_steps_find_the_same_switches(indices: Iterable[int]) -> None:
    counts, errors = zip(*(worst(index) for index in indices), strict=True)
    assert sum(counts)
    assert max(errors) < 1e-7  # chaos makes of it what it will, in fourteen switches


def shaken(rate: float, duration: float, *stops: Stop) -> Problem:
    """The paper's joint, moved by noise, m/s2, at a rate in Hz."""
    noise = np.random.default_rng(2).standard_normal(int(rate * duration) + 1) * 300.0
    record = RecordBaseMotion(quantity="acceleration", rate=rate, values=noise)
    problem = paper_joint()
    return problem.replace(base_motion=record, stops=stops or problem.stops)


@pytest.fixture(scope="module")
def history() -> History:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        return fe_lapjoint.Solver(elements=4).simulate(shaken(4000.0, 0.25), 0.25, errors=False)


def test_the_motion_between_switches_obeys_the_equations(history: History) -> None:
    model, checked = history.field.model, 0
    for piece in history.field.pieces[::9]:
        system, t = model.system(piece.state), np.linspace(piece.start, piece.end, 40)
        q, v, a = (piece.coordinates(t, dt) for dt in (0, 1, 2))
        exact = np.array([system.rates(s, np.concatenate([q[:, i], v[:, i]])) for i, s in enumerate(t)]).T
        assert np.allclose(a[:, 1:-1], exact[q.shape[0] :, 1:-1], atol=1e-7 * np.abs(a).max())
        again = piece.coordinates(t[::-1], 0)[:, ::-1]
        assert np.array_equal(again, q)
        checked += 1
    assert checked
    times = np.array([piece.end for piece in history.field.pieces[:-1]])
    before, after = history.displacement(2.0, times - 1e-12), history.displacement(2.0, times)
    assert np.allclose(before, after, atol=1e-9 * np.abs(after).max())


def test_impulses_and_peaks_are_those_of_the_force_over_time(history: History) -> None:
    def force_of(t: np.ndarray, stop: int) -> np.ndarray:
        return np.asarray(history.contact_force(t)[stop])

    complete = [c for c in history.contacts if not c.open_end]
    assert len(complete) > 20
    for contact in complete:
        edges = np.linspace(contact.start, contact.end, 30)
        area = sum(fixed_quad(force_of, a, b, (contact.stop,), n=8)[0] for a, b in pairwise(edges))
        assert contact.impulse == pytest.approx(-area, rel=1e-4)  # knots within leave kinks in the third derivative
        force = np.abs(history.contact_force(np.linspace(contact.start, contact.end, 1000))[contact.stop])
        assert contact.peak_force >= force.max() * (1 - 1e-9)
        assert contact.peak_force <= force.max() * (1 + 1e-3)


def test_a_long_record_keeps_few_pieces() -> None:
    problem = shaken(4000.0, 2.0)
    open_wide = problem.replace(stops=tuple(s.model_copy(update={"gap": 10.0}) for s in problem.stops))
    history = fe_lapjoint.Solver(elements=3).simulate(open_wide, 2.0, errors=False)
    assert len(history.field.pieces) <= 8000 / LONGEST + 2


@pytest.mark.thorough
@pytest.mark.parametrize("ratio", [0.02, 5.0])
def test_a_library_method_finds_the_same_contacts(ratio: float) -> None:
    problem = shaken(2000.0, 0.05).replace(damping=ModalDamping(ratio=ratio))
    one, other = (
        fe_lapjoint.Solver(elements=2, method=method, rtol=1e-10, atol=1e-14).simulate(problem, 0.05, errors=False)
        for method in ("exact", "DOP853")
    )
    assert [c.stop for c in one.contacts] == [c.stop for c in other.contacts]
    assert len(one.contacts) > 3 * (ratio < 1)
    for a, b in zip(one.contacts, other.contacts, strict=True):
        assert a.start == pytest.approx(b.start, abs=1e-8)
        assert a.impulse == pytest.approx(b.impulse, rel=1e-4, abs=1e-9)
        assert a.peak_force == pytest.approx(b.peak_force, rel=1e-4, abs=1e-6)


def test_the_exact_propagator_steps_over_knots() -> None:
    problem = shaken(2000.0, 0.05).replace(stops=())
    system = build_system(Assembly(problem, mesh_nodes(problem, 2, None)), FREE)
    n = system.omega.size
    y = np.concatenate([np.full(n, 1e-3), np.zeros(n)])
    t = np.linspace(0.0, 0.05, 33)
    exact = solve_ivp(system.rates, (0.0, 0.05), y, fe_lapjoint.ExactPropagator, t_eval=t, system=system)
    knots = problem.forces.ramps
    assert knots is not None
    now = y
    for a, b in pairwise(knots.block_at(0.0).time):  # a step that crosses a knot has no order
        now = solve_ivp(system.rates, (a, b), now, "DOP853", rtol=1e-11, atol=1e-16).y[:, -1]
    assert np.allclose(exact.y[:, -1], now, atol=1e-8 * np.abs(now).max())
    with pytest.raises(InputError, match="forward in time"):
        solve_ivp(system.rates, (0.05, 0.0), y, fe_lapjoint.ExactPropagator, system=system)


@pytest.mark.thorough
@pytest.mark.parametrize("ratio", [1.0, 1 - 1e-9, 1.001])
def test_critically_damped_modes_keep_their_digits(ratio: float) -> None:
    problem, t = shaken(2000.0, 0.05).replace(damping=ModalDamping(ratio=ratio)), np.linspace(0.0, 0.05, 400)
    one, other = (
        fe_lapjoint.Solver(elements=2, method=method, rtol=1e-11, atol=1e-15).simulate(problem, 0.05, errors=False)
        for method in ("exact", "DOP853")
    )
    assert one.contacts
    here, there = one.displacement(2.0, t), other.displacement(2.0, t)
    # a critically damped mode changes by 1e-10 of itself, and five contacts magnify the change
    assert np.abs(here - there).max() < 1e-8 * np.abs(here).max()
