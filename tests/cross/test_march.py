"""Marches of both solvers: events, impulses, continuity and odd cases, each against something independent."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import pytest
from beams import CLAMP, LONG
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    History,
    InputError,
    ModalDamping,
    NoDamping,
    PolynomialShape,
    Problem,
    SineLoad,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
    initial_from_functions,
    paper_joint,
    sdnl104,
)

SOLVERS: dict[str, AnySolver] = {"analytic": analytic.Solver(n_modes=20), "fe": fe_lapjoint.Solver(elements=20)}
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
NODE, WEIGHT = np.polynomial.legendre.leggauss(4)  # exact for squares of cubics


def over_length(length: float, elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Points along a beam, and the weights of an integral over it."""
    h = length / elements
    x = (h * np.arange(elements)[:, None] + h * (NODE + 1) / 2).ravel()
    return x, np.tile(WEIGHT * h / 2, elements)


@pytest.mark.parametrize("solver", [analytic.Solver(), fe_lapjoint.Solver(elements=80)])
def test_sdnl104_comes_out_as_converged_elsewhere(solver: AnySolver) -> None:
    # Converged values from separate code, to the digits given; the published ones come from a coarse run.
    history = solver.simulate(sdnl104(), 0.165)
    first = history.contacts[0]
    assert first.start == pytest.approx(0.036141, abs=1e-6)
    assert first.end == pytest.approx(0.092560, abs=1e-6)
    assert first.impulse == pytest.approx(-107.21, abs=1e-2)
    x, w = over_length(history.problem.beam.length, 80)
    assert history.problem.beam.m / 2 * (w @ history.velocity(x, 0.16)[:, 0] ** 2) == pytest.approx(0.05138, abs=1e-5)


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=40), fe_lapjoint.Solver(elements=10)])
def test_a_contact_ends_where_the_force_vanishes_and_its_impulse_is_the_area(solver: AnySolver) -> None:
    history = solver.simulate(paper_joint(), 0.05)
    node, weight = np.polynomial.legendre.leggauss(12)
    complete = [contact for contact in history.contacts if not contact.open_end]
    assert len(complete) > 5
    for contact in complete:
        stop = history.problem.stops[contact.stop]
        ends = history.displacement(stop.x, [contact.start, contact.end])[0]
        # 2.2e-11 s at 100 m/s, the fastest impact here; truncation of 40 modes is below it
        np.testing.assert_allclose(stop.sign * ends, stop.gap, atol=2.2e-9)
        inner = history.switch_times[(history.switch_times > contact.start) & (history.switch_times < contact.end)]
        edges = np.unique([contact.start, *inner, contact.end])  # kinks where other stops switch
        # Panels shorter than a period of the highest mode of consequence.
        edges = np.unique(np.concatenate([np.linspace(a, b, 60) for a, b in itertools.pairwise(edges)]))
        h = np.diff(edges)
        force = history.contact_force((edges[:-1, None] + h[:, None] * (node + 1) / 2).ravel())[contact.stop]
        assert -(h[:, None] * weight / 2).ravel() @ force == pytest.approx(contact.impulse, rel=1e-6, abs=1e-6)
        assert contact.peak_force == pytest.approx(np.abs(force).max(), rel=1e-3)


@solvers
def test_velocity_and_acceleration_are_derivatives_of_displacement(solver: AnySolver) -> None:
    history = solver.simulate(paper_joint(), 0.02)
    x, t, h = np.array([0.4, 1.25, 2.5]), np.array([3e-4, 4e-3, 1.1e-2]), 1e-7
    for dt in (1, 2):
        difference = (history.evaluate(x, t + h, dt=dt - 1) - history.evaluate(x, t - h, dt=dt - 1)) / (2 * h)
        exact = history.evaluate(x, t, dt=dt)
        np.testing.assert_allclose(difference, exact, atol=1e-5 * np.abs(exact).max())


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=12), fe_lapjoint.Solver(elements=6)])
def test_ever_shorter_grazing_contacts_are_all_found(solver: AnySolver) -> None:
    """Gaps leave 1e-2 ... 1e-9 of the largest free deflection of the tip for penetration."""
    free = Problem(
        beam=LONG,
        supports=(CLAMP,),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=70.0),
        damping=ModalDamping(ratio=0.02),
    )
    history, t = solver.simulate(free, 0.5), np.linspace(0, 0.5, 20001)
    i = int(np.argmax(history.displacement(2.0, t)[0]))
    largest = history.displacement(2.0, np.linspace(t[i - 1], t[i + 1], 2001))[0].max()
    durations = []
    for depth in 10.0 ** -np.arange(2, 10):
        stop = Stop(x=2.0, side="top", gap=largest * (1 - depth), stiffness=1e5)
        motion = solver.simulate(free.replace(stops=(stop,)), 0.5)
        shortest = min(motion.contacts, key=lambda contact: contact.duration)
        durations.append(shortest.duration)
        if depth < 1e-4:  # a graze of depth d under the acceleration a lasts sqrt(8 d / |a|)
            a = motion.evaluate(2.0, shortest.start, dt=2)[0, 0]
            assert shortest.duration == pytest.approx(math.sqrt(8 * depth * stop.gap / abs(a)), rel=0.05)
    assert durations[-1] < 2e-6
    assert all(b < a for a, b in itertools.pairwise(durations))


@solvers
@pytest.mark.parametrize("side", ["top", "bottom"])
def test_a_mirrored_problem_has_the_mirrored_answer(side: str, solver: AnySolver) -> None:
    stop = Stop(x=1.4, side=side, gap=1e-3, stiffness=1e6)
    phase = 0.0 if side == "top" else math.pi
    problem = Problem(
        beam=LONG,
        supports=(CLAMP,),
        stops=(stop,),
        damping=ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=0.01, angular_frequency=50.0, phase=phase),
    )
    contacts = solver.simulate(problem, 0.5).contacts
    assert len(contacts) > 2
    mirrored = problem.replace(
        stops=(stop.model_copy(update={"side": "bottom" if side == "top" else "top"}),),
        base_motion=BaseMotion(amplitude=0.01, angular_frequency=50.0, phase=phase + math.pi),
    )
    others = solver.simulate(mirrored, 0.5).contacts
    np.testing.assert_allclose([c.impulse for c in contacts], [-c.impulse for c in others], rtol=1e-9)


ODD: dict[str, dict[str, Any]] = {
    "gap zero on both sides": dict(
        stops=(Stop(x=1.0, side="top", gap=0, stiffness=1e4), Stop(x=1.0, side="bottom", gap=0, stiffness=1e4))
    ),
    "two stops that close together": dict(
        stops=(
            Stop(x=2.0, side="top", gap=1e-3, stiffness=1e4),
            Stop(name="b", x=2.0, side="top", gap=1e-3, stiffness=1e5),
        )
    ),
    "critically damped": dict(damping=ModalDamping(ratio=1.0)),
    "overdamped": dict(damping=ModalDamping(ratio=(3.0, 1.5, 0.1))),
    "pinned with a rigid-body mode": dict(supports=(Support(x=0.0, translational=math.inf),)),
    "free in space": dict(supports=(), damping=ViscousDamping(coefficient=5.0)),
    "no stops": dict(stops=()),
    "undamped at resonance of a point load": dict(
        damping=NoDamping(),
        point_loads=(StepLoad(x=0.7, force=-3.0), SineLoad(x=1.1, force=5.0, angular_frequency=88.0)),
    ),
    "starting deep in a stop": dict(initial=PolynomialShape(displacement=(0, 0, 0.01))),
    "thrown from a callable": dict(initial=initial_from_functions(2.0, velocity=lambda x: x**2)),
}


@solvers
@pytest.mark.parametrize("name", ODD)
def test_odd_problems_keep_to_their_gaps(name: str, solver: AnySolver) -> None:
    base = Problem(
        beam=LONG,
        supports=(CLAMP,),
        stops=(
            Stop(x=2.0, side="top", gap=2e-3, stiffness=1e5),
            Stop(x=1.0, side="bottom", gap=1e-3, stiffness=1e6),
        ),
        damping=ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=0.005, angular_frequency=35.0),
    )
    history = solver.simulate(base.replace(**ODD[name]), 0.6)
    t = np.linspace(0, 0.6, 3001)
    size = np.abs(history.displacement([1.0, 2.0], t)).max()
    for k, stop in enumerate(history.problem.stops):
        beyond = stop.sign * history.displacement(stop.x, t)[0] - stop.gap
        inside = np.zeros(t.size, dtype=bool)
        for contact in history.contacts:
            if contact.stop == k:
                inside |= (t >= contact.start) & (t <= contact.end)
        assert np.all(beyond[inside] >= -1e-5 * size)  # truncation of 20 modes at the switches
        assert np.all(beyond[~inside] <= 1e-5 * size)


@solvers
@pytest.mark.parametrize("damping", [NoDamping(), ModalDamping(ratio=1.0), ModalDamping(ratio=3.0)])
def test_free_motion_obeys_the_equation_of_one_oscillator(damping: NoDamping | ModalDamping, solver: AnySolver) -> None:
    """The first mode of a pinned beam is a sine: below, at and above critical damping."""
    L, EI, m = 1.0, 100.0, 2.0
    points = np.linspace(0, L, 41)
    problem = Problem(
        beam=Beam(length=L, bending_stiffness=EI, mass_per_length=m),
        supports=tuple(Support(x=x, translational=math.inf) for x in (0.0, L)),
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
    z = solver.simulate(problem, 0.2).displacement(points, t)
    # The mesh's first frequency is off by (pi h)^4 / 1440 = 4e-7, over 14 radians.
    assert z == pytest.approx(1e-3 * np.outer(np.sin(math.pi * points / L), wave), abs=1e-8)


@solvers
@pytest.mark.parametrize("damping", [NoDamping(), ViscousDamping(coefficient=4.0)])
def test_a_free_beam_moves_as_a_rigid_body(damping: NoDamping | ViscousDamping, solver: AnySolver) -> None:
    """m z_tt + C z_t = 0: with C / m = 2 /s the velocity falls as exp(-2 t)."""
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=50.0, mass_per_length=2.0),
        damping=damping,
        initial=PolynomialShape(velocity=(0.5, 1.0)),
    )
    t, x = np.linspace(0, 0.3, 7), np.array([0.0, 0.4, 1.0])
    travel = t if isinstance(damping, NoDamping) else (1 - np.exp(-2 * t)) / 2
    z = solver.simulate(problem, 0.3).displacement(x, t)
    assert z == pytest.approx(np.outer(0.5 + x, travel), abs=1e-9)  # rounding in the modes of zero frequency


def energy(history: History, t: np.ndarray) -> np.ndarray:
    """Of motion, bending and pressed stops, J, at times, s."""
    beam, (x, w) = history.problem.beam, over_length(history.problem.beam.length, 80)
    springs = np.array([[stop.stiffness] for stop in history.problem.stops])
    stored = np.sum(history.contact_force(t) ** 2 / (2 * springs), axis=0)
    return w @ (beam.m * history.velocity(x, t) ** 2 + history.moment(x, t) ** 2 / beam.EI) / 2 + stored


@pytest.mark.parametrize(
    ("solver", "lost"), [(analytic.Solver(n_modes=40), 1e-4), (fe_lapjoint.Solver(elements=8), 1e-8)]
)
def test_undamped_motion_between_springs_conserves_energy(solver: AnySolver, lost: float) -> None:
    """Up to what 40 modes lose at the switches, and to rounding in the high modes of a mesh."""
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=100.0, mass_per_length=1.0),
        supports=(CLAMP,),
        stops=(
            Stop(x=1.0, side="top", gap=1e-3, stiffness=1e4),
            Stop(x=1.0, side="bottom", gap=2e-3, stiffness=3e3),
        ),
        initial=PolynomialShape(velocity=(0.0, 0.0, 1.0)),
    )
    history = solver.simulate(problem, 0.5)
    assert len(history.contacts) > 4
    total = energy(history, np.linspace(0, 0.5, 60))
    assert total == pytest.approx(np.full(total.size, total[0]), rel=lost)


@solvers
def test_coincident_stops_switch_as_one_of_their_summed_stiffness(solver: AnySolver) -> None:
    single = sdnl104()
    stop = single.stops[0]
    double = single.replace(
        stops=tuple(stop.model_copy(update={"name": name, "stiffness": stop.stiffness / 2}) for name in "ab")
    )
    (one,), two = (solver.simulate(problem, 0.1).contacts for problem in (single, double))
    assert sum(c.impulse for c in two) == pytest.approx(one.impulse, rel=1e-7)  # they switch within 1e-9 s
    assert two[0].end == pytest.approx(one.end, abs=1e-8)


@pytest.mark.parametrize(
    ("solver", "options", "word"),
    [
        (analytic.Solver, {"n_modes": 10**6}, "n_modes = 1000000"),
        (analytic.Solver, {"n_modes": 0}, "n_modes = 0"),
        (analytic.Solver, {"tolerance": 2.0}, "tolerance = 2.0"),
        (fe_lapjoint.Solver, {"elements": 0}, "elements = 0"),
        (fe_lapjoint.Solver, {"elements": 10**6}, "elements = 1000000"),
        (fe_lapjoint.Solver, {"elements": 2.5}, "elements = 2.5"),
        (fe_lapjoint.Solver, {"method": "Euler"}, "method"),
        (fe_lapjoint.Solver, {"rtol": -1.0}, "rtol = -1.0"),
        (analytic.PublishedScheme, {"free_modes": 0}, "free_modes = 0"),
        (analytic.PublishedScheme, {"tolerance": 1.0}, "tolerance = 1.0"),
        (analytic.PublishedScheme, {"patience": 0}, "patience = 0"),
        (analytic.PublishedScheme, {"max_periods": True}, "max_periods"),
        (analytic.PublishedScheme, {"shortest": -1.0}, "shortest = -1.0"),
    ],
)
def test_bad_options_are_named(solver: Any, options: dict[str, Any], word: str) -> None:
    with pytest.raises(InputError, match=word):
        solver(**options)


@solvers
def test_bad_questions_are_named(solver: AnySolver) -> None:
    for call, word in (
        (lambda: solver.simulate(paper_joint(), -1.0), "duration = -1.0"),
        (lambda: solver.simulate(paper_joint(), math.nan), "duration = nan"),
        (lambda: solver.modes(paper_joint(), FREE, 0), "count = 0"),
        (lambda: solver.modes(paper_joint(), FREE, 10**6), "count = 1000000"),
        (lambda: solver.steady_state(sdnl104()), "angular_frequency"),
    ):
        with pytest.raises(InputError, match=word):
            call()
