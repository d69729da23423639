"""Events, contacts and fields of the finite element march."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from beams import CLAMP
from scipy.integrate import solve_ivp

import fe_lapjoint
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import (
    FREE,
    Beam,
    History,
    ModalDamping,
    NoDamping,
    PolynomialShape,
    Problem,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
    initial_from_functions,
    paper_joint,
    sdnl104,
)


def kinetic_energy(history: History, t: float, elements: int) -> float:
    """Integral of m z_t^2 / 2 by Gauss's rule, exact for cubics on equal elements."""
    node, weight = np.polynomial.legendre.leggauss(4)
    h = history.problem.beam.length / elements
    x = (h * np.arange(elements)[:, None] + h * (node + 1) / 2).ravel()
    speed = history.velocity(x, t)[:, 0]
    return float(np.tile(weight * h / 2, elements) @ (history.problem.beam.m * speed**2 / 2))


def test_sdnl104_comes_out_as_separate_code_has_it() -> None:
    history = fe_lapjoint.Solver(elements=80).simulate(sdnl104(), 0.165)
    (contact,) = history.contacts
    # The reference values are given to these digits.
    assert contact.start == pytest.approx(0.036141, abs=1e-6)
    assert contact.end == pytest.approx(0.092560, abs=1e-6)
    assert contact.impulse == pytest.approx(-107.21, abs=0.01)
    assert kinetic_energy(history, 0.16, 80) == pytest.approx(0.05138, abs=1e-5)


def grazing(depth: float) -> tuple[Problem, float]:
    """A cantilever under a step load whose highest point exceeds the gap by `depth`, relative; and a duration."""
    beam = Beam(length=1.0, bending_stiffness=100.0, mass_per_length=1.0)
    open_ = Problem(
        beam=beam,
        supports=(CLAMP,),
        damping=ModalDamping(ratio=0.05),
        point_loads=(StepLoad(x=1.0, force=10.0),),
    )
    duration = 0.2  # s: past the first maximum of the tip, before its first minimum
    free = fe_lapjoint.Solver(elements=6).simulate(open_, duration)
    t = np.linspace(0, duration, 4001)
    z = free.displacement(1.0, t)[0]
    i = int(np.argmax(z))
    near = np.linspace(t[i - 1], t[i + 1], 4001)
    highest = float(np.max(free.displacement(1.0, near)))
    stop = Stop(x=1.0, side="top", gap=highest * (1 - depth), stiffness=1e3)
    return open_.replace(stops=(stop,)), duration


def test_ever_shorter_contacts_are_all_found() -> None:
    durations = []
    for depth in (1e-3, 1e-5, 1e-7, 1e-9):
        problem, duration = grazing(depth)
        contacts = fe_lapjoint.Solver(elements=6).simulate(problem, duration).contacts
        assert len(contacts) >= 1, f"a contact of relative depth {depth:g} was missed"
        durations.append(max(contact.duration for contact in contacts))
    # Time over the gap goes with the square root of the depth: a tenth for each hundredth.
    assert np.array(durations[1:]) / durations[:-1] == pytest.approx(0.1, rel=0.2)


def test_the_exact_propagator_agrees_with_a_library_method_of_tight_tolerance() -> None:
    problem = paper_joint()
    system = build_system(Assembly(problem, mesh_nodes(problem, 4, None)), FREE)
    y0 = np.concatenate([np.full(8, 1e-3), np.full(8, 0.1)])
    times = np.linspace(0, 0.02, 50)
    exact = solve_ivp(
        system.rates,
        (0, 0.02),
        y0,
        method=fe_lapjoint.ExactPropagator,
        system=system,
        dense_output=True,
        max_step=3e-3,
    )
    other = solve_ivp(system.rates, (0, 0.02), y0, method="DOP853", rtol=1e-11, atol=1e-14, t_eval=times)
    scale = np.max(np.abs(other.y), axis=1)
    # Fifty times the tolerance, for the error gathered over some hundred steps.
    assert np.all(np.abs(exact.sol(times) - other.y).max(axis=1) <= 1e-8 * scale + 1e-12)


@pytest.mark.parametrize(
    "method", [*(pytest.param(it, marks=pytest.mark.thorough) for it in ("Radau", "BDF")), "LSODA", "DOP853"]
)
def test_library_methods_give_the_same_contacts(method: str) -> None:
    problem = paper_joint()
    duration = 2 * math.pi / 515
    exact = fe_lapjoint.Solver(elements=2).simulate(problem, duration).contacts
    assert len(exact) > 3
    found = fe_lapjoint.Solver(elements=2, method=method, rtol=1e-8, atol=1e-11).simulate(problem, duration).contacts
    assert [c.stop for c in found] == [c.stop for c in exact]
    # Errors of 1e-8 a step grow over the steps and switches of the period, those of BDF most.
    assert [c.start for c in found] == pytest.approx([c.start for c in exact], rel=1e-5)
    largest = max(abs(c.impulse) for c in exact)
    assert [c.impulse for c in found] == pytest.approx([c.impulse for c in exact], abs=1e-4 * largest)


def test_impulse_is_the_integral_of_the_contact_force() -> None:
    history = fe_lapjoint.Solver(elements=10).simulate(paper_joint(), 0.03)
    node, weight = np.polynomial.legendre.leggauss(12)
    for contact in history.contacts:
        if contact.open_end:
            continue
        switches = history.switch_times
        inner = switches[(switches > contact.start) & (switches < contact.end)]
        edges = np.unique(np.concatenate(([contact.start], inner, [contact.end])))
        # Panels shorter than a period of the highest mode of consequence.
        edges = np.unique(np.concatenate([np.linspace(a, b, 60) for a, b in itertools.pairwise(edges)]))
        h = np.diff(edges)
        t = (edges[:-1, None] + h[:, None] * (node + 1) / 2).ravel()
        total = -(h[:, None] * weight / 2).ravel() @ history.contact_force(t)[contact.stop]
        assert total == pytest.approx(contact.impulse, rel=1e-6, abs=1e-6)  # quadrature of fast, faint modes


def test_displacement_and_velocity_are_continuous_and_gaps_vanish_at_switches() -> None:
    history = fe_lapjoint.Solver(elements=10).simulate(paper_joint(), 0.05)
    assert history.switch_times.size > 10
    x = np.linspace(0, 2.5, 7)
    before, after = history.switch_times - 1e-11, history.switch_times
    speed = np.max(np.abs(history.velocity(x, after)))
    assert history.displacement(x, before) == pytest.approx(history.displacement(x, after), abs=1e-10 * speed)
    jump = np.abs(history.velocity(x, before) - history.velocity(x, after))
    assert np.max(jump) < 1e-5 * speed  # acceleration over 1e-11 s
    for contact in history.contacts:
        stop = history.problem.stops[contact.stop]
        z = stop.sign * history.displacement(stop.x, contact.start)[0, 0]
        assert z - stop.gap == pytest.approx(0, abs=2.2e-11 * speed)  # events to 2.2e-11 s


@pytest.mark.parametrize("damping", [NoDamping(), ModalDamping(ratio=1.0), ModalDamping(ratio=3.0)])
def test_free_motion_obeys_the_equation_of_one_oscillator(damping: NoDamping | ModalDamping) -> None:
    """The first mode of a pinned beam is a sine: below, at and above critical damping."""
    L, EI, m = 1.0, 100.0, 2.0
    pins = tuple(Support(x=x, translational=math.inf) for x in (0.0, L))
    points = np.linspace(0, L, 41)
    problem = Problem(
        beam=Beam(length=L, bending_stiffness=EI, mass_per_length=m),
        supports=pins,
        damping=damping,
        initial=initial_from_functions(L, lambda x: 1e-3 * np.sin(math.pi * x / L)),
    )
    omega = (math.pi / L) ** 2 * math.sqrt(EI / m)
    t = np.linspace(0, 0.2, 40)
    wave = {
        "none": np.cos(omega * t),
        1.0: (1 + omega * t) * np.exp(-omega * t),
        3.0: np.exp(-3 * omega * t) * (np.cosh(8**0.5 * omega * t) + 3 / 8**0.5 * np.sinh(8**0.5 * omega * t)),
    }[damping.ratio if isinstance(damping, ModalDamping) else "none"]  # type: ignore[index]
    z = fe_lapjoint.Solver(elements=20).simulate(problem, 0.2).displacement(points, t)
    # The mesh's first frequency is off by (pi h)^4 / 1440 = 4e-7, over 14 radians.
    assert z == pytest.approx(1e-3 * np.outer(np.sin(math.pi * points / L), wave), abs=1e-8)


@pytest.mark.parametrize("damping", [NoDamping(), ViscousDamping(coefficient=4.0)])
def test_a_free_beam_moves_as_a_rigid_body(damping: NoDamping | ViscousDamping) -> None:
    """m z_tt + C z_t = 0: with C / m = 2 /s the velocity falls as exp(-2 t)."""
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=50.0, mass_per_length=2.0),
        damping=damping,
        initial=PolynomialShape(velocity=(0.5, 1.0)),
    )
    t, x = np.linspace(0, 0.3, 7), np.array([0.0, 0.4, 1.0])
    travel = t if isinstance(damping, NoDamping) else (1 - np.exp(-2 * t)) / 2
    z = fe_lapjoint.Solver(elements=8).simulate(problem, 0.3).displacement(x, t)
    assert z == pytest.approx(np.outer(0.5 + x, travel), abs=1e-9)  # rounding in the modes of zero frequency


def test_undamped_motion_between_springs_conserves_energy() -> None:
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=100.0, mass_per_length=1.0),
        supports=(CLAMP,),
        stops=(
            Stop(x=1.0, side="top", gap=1e-3, stiffness=1e4),
            Stop(x=1.0, side="bottom", gap=2e-3, stiffness=3e3),
        ),
        initial=PolynomialShape(velocity=(0.0, 0.0, 1.0)),
    )
    elements = 8
    history = fe_lapjoint.Solver(elements=elements).simulate(problem, 0.5)
    assert len(history.contacts) > 4
    node, weight = np.polynomial.legendre.leggauss(4)
    h = 1.0 / elements
    x = (h * np.arange(elements)[:, None] + h * (node + 1) / 2).ravel()
    w = np.tile(weight * h / 2, elements)
    t = np.linspace(0, 0.5, 60)
    kinetic = w @ history.velocity(x, t) ** 2 / 2
    bending = w @ history.moment(x, t) ** 2 / (2 * 100.0)
    force = history.contact_force(t)
    springs = np.array([1e4, 3e3])
    stored = np.sum(force**2 / (2 * springs[:, None]), axis=0)
    total = kinetic + bending + stored
    assert total == pytest.approx(np.full(t.size, total[0]), rel=1e-8)  # rounding in high modes, and event times


def test_coincident_stops_switch_as_one_of_their_summed_stiffness() -> None:
    single = sdnl104()
    stop = single.stops[0]
    double = single.replace(
        stops=tuple(stop.model_copy(update={"name": name, "stiffness": stop.stiffness / 2}) for name in "ab")
    )
    solver = fe_lapjoint.Solver(elements=10)
    (one,) = solver.simulate(single, 0.1).contacts
    two = solver.simulate(double, 0.1).contacts
    assert sum(c.impulse for c in two) == pytest.approx(one.impulse, rel=1e-7)  # they switch within 1e-9 s
    assert two[0].end == pytest.approx(one.end, abs=1e-8)
