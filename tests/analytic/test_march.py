"""The analytic march: events, impulses, continuity and odd cases, each against something independent."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import analytic
from analytic.march.joint import Joint
from analytic.march.step_bound import first_root_of_bound
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    ContactState,
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
from tests.helpers.beams import CLAMP, LONG


def test_sdnl104_comes_out_as_converged_elsewhere() -> None:
    # Converged values from separate code, to the digits given; the published ones come from a coarse run.
    history = analytic.Solver().simulate(sdnl104(), 0.2)
    first = history.contacts[0]
    assert first.start == pytest.approx(0.036141, abs=5e-7)
    assert first.end == pytest.approx(0.092560, abs=5e-7)
    assert abs(first.impulse) == pytest.approx(107.21, abs=5e-3)
    x, w = np.polynomial.legendre.leggauss(60)
    speed = history.velocity((x + 1) / 2, 0.16)[:, 0]
    assert sdnl104().beam.m / 2 * (speed**2 @ (w / 2)) == pytest.approx(0.05138, abs=5e-6)


@pytest.mark.parametrize("damping", [ModalDamping(ratio=0.08), ViscousDamping(coefficient=30.0), NoDamping()])
def test_one_mode_before_contact_is_the_textbook_oscillator(damping: object) -> None:
    problem = Problem(
        beam=LONG,
        supports=(CLAMP,),
        damping=damping,
        base_motion=BaseMotion(amplitude=0.01, angular_frequency=40.0),
    )
    modes = analytic.Solver().modes(problem, FREE, 1)
    history = analytic.Solver(n_modes=1).simulate(problem, 1.0)
    omega = modes.angular_frequencies[0]
    part = 10.0 * quad(lambda x: modes.shapes(np.array([x]))[0, 0], 0, 2, epsabs=1e-13)[0]
    ratio = {"modal": 0.08, "viscous": 30.0 / (2 * 10.0 * omega), "none": 0.0}[problem.damping.kind]
    solution = solve_ivp(
        lambda t, y: [y[1], part * 0.01 * 40**2 * math.sin(40 * t) - 2 * ratio * omega * y[1] - omega**2 * y[0]],
        (0, 1.0),
        [0, 0],
        rtol=1e-11,
        atol=1e-14,
        method="DOP853",
    )
    # The tip also moves by the residual of the left-out modes, known in closed form and 4e-4 of the motion here.
    tip = history.displacement(2.0, 1.0)[0, 0] - residual_at_tip(problem, 1.0)
    assert tip == pytest.approx(modes.shapes(np.array([2.0]))[0, 0] * solution.y[0, -1], rel=1e-8)


def residual_at_tip(problem: Problem, t: float) -> float:
    residual = Joint(problem, 1, 1).residual(FREE)
    return float(residual(np.array([2.0]))[1, 0] * math.sin(40.0 * t))


def test_a_contact_ends_where_the_force_vanishes_and_its_impulse_is_the_area() -> None:
    history = analytic.Solver(n_modes=40).simulate(paper_joint(), 0.05)
    problem = history.problem
    for contact in history.contacts:
        if contact.open_end:
            continue
        stop = problem.stops[contact.stop]
        ends = history.displacement(stop.x, [contact.start, contact.end])[0]
        # 2.2e-11 s at 100 m/s, the fastest impact here; truncation of 40 modes is below it
        np.testing.assert_allclose(stop.sign * ends, stop.gap, atol=2e-9)
        t, w = np.polynomial.legendre.leggauss(400)
        times = contact.start + (t + 1) / 2 * contact.duration
        area = history.contact_force(times)[contact.stop] @ w * contact.duration / 2
        assert -area == pytest.approx(contact.impulse, rel=1e-6)  # kinks where other stops switch
        assert contact.peak_force == pytest.approx(np.abs(history.contact_force(times)[contact.stop]).max(), rel=1e-3)


def test_displacement_and_velocity_are_continuous_at_switches_up_to_truncation() -> None:
    jumps = []
    for n_modes in (14, 28):
        history = analytic.Solver(n_modes=n_modes).simulate(paper_joint(), 0.05)
        t, x = history.switch_times, np.linspace(0.1, 2.5, 13)
        before = np.nextafter(t, 0)
        jumps.append(np.abs(history.displacement(x, t) - history.displacement(x, before)).max())
    assert jumps[0] < 1e-5  # of a motion of 0.1 m
    assert jumps[1] < jumps[0] / 2**5  # (44) loses what falls as the seventh power of the number of modes


def test_velocity_and_acceleration_are_derivatives_of_displacement() -> None:
    history = analytic.Solver().simulate(paper_joint(), 0.02)
    x, t, h = np.array([0.4, 1.25, 2.5]), np.array([3e-4, 4e-3, 1.1e-2]), 1e-7
    for dt in (1, 2):
        difference = (history.evaluate(x, t + h, dt=dt - 1) - history.evaluate(x, t - h, dt=dt - 1)) / (2 * h)
        exact = history.evaluate(x, t, dt=dt)
        np.testing.assert_allclose(difference, exact, atol=1e-5 * np.abs(exact).max())


def grazing_series() -> list[tuple[float, Problem]]:
    """Gaps that leave 1e-2 ... 1e-9 of the largest free deflection of the tip for penetration."""
    free = Problem(
        beam=LONG, supports=(CLAMP,), base_motion=BaseMotion(amplitude=1e-3, angular_frequency=70.0),
        damping=ModalDamping(ratio=0.02),
    )  # fmt: skip
    history = analytic.Solver(n_modes=12).simulate(free, 0.5)
    t = np.linspace(0, 0.5, 20001)
    z = history.displacement(2.0, t)[0]
    i = int(np.argmax(z))
    fine = np.linspace(t[i - 1], t[i + 1], 2001)
    largest = history.displacement(2.0, fine)[0].max()
    series = []
    for n in range(2, 10):
        gap = largest * (1 - 10.0**-n)
        series.append((10.0**-n, free.replace(stops=(Stop(x=2.0, side="top", gap=gap, stiffness=1e5),))))
    return series


def test_ever_shorter_grazing_contacts_are_all_found() -> None:
    durations = []
    for depth, problem in grazing_series():
        history = analytic.Solver(n_modes=12).simulate(problem, 0.5)
        shortest = min(history.contacts, key=lambda contact: contact.duration)
        durations.append(shortest.duration)
        if depth < 1e-4:  # a graze of depth d under the acceleration a lasts sqrt(8 d / |a|)
            a = history.evaluate(2.0, shortest.start, dt=2)[0, 0]
            assert shortest.duration == pytest.approx(math.sqrt(8 * depth * problem.stops[0].gap / abs(a)), rel=0.05)
    assert durations[-1] < 2e-6
    assert all(b < a for a, b in itertools.pairwise(durations))


def test_the_step_bound_never_passes_the_first_root() -> None:
    rng = np.random.default_rng(1)
    for _ in range(2000):
        h, h1, h2 = -abs(rng.normal()) * 10.0 ** rng.integers(-9, 1), rng.normal(), rng.normal() * 10.0
        b3 = abs(rng.normal()) * 10.0 ** rng.integers(-1, 4) + 1e-9
        tau = first_root_of_bound(h, h1, h2, b3, np.inf)
        s = np.linspace(0, tau, 200)
        assert np.all(h + s * (h1 + s * (h2 / 2 + s * b3 / 6)) <= 1e-12)
        after = tau * 1.01 + 1e-9
        assert h + after * (h1 + after * (h2 / 2 + after * b3 / 6)) > 0 or tau == 0
        assert first_root_of_bound(h, h1, h2, b3, tau / 2) == tau / 2


@pytest.mark.parametrize("side", ["top", "bottom"])
def test_a_mirrored_problem_has_the_mirrored_answer(side: str) -> None:
    stop = Stop(x=1.4, side="top" if side == "top" else "bottom", gap=1e-3, stiffness=1e6)
    phase = 0.0 if side == "top" else math.pi
    problem = Problem(
        beam=LONG,
        supports=(CLAMP,),
        stops=(stop,),
        damping=ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=0.01, angular_frequency=50.0, phase=phase),
    )
    contacts = analytic.Solver(n_modes=20).simulate(problem, 0.5).contacts
    assert len(contacts) > 2
    mirrored = problem.replace(
        stops=(stop.model_copy(update={"side": "bottom" if side == "top" else "top"}),),
        base_motion=BaseMotion(amplitude=0.01, angular_frequency=50.0, phase=phase + math.pi),
    )
    others = analytic.Solver(n_modes=20).simulate(mirrored, 0.5).contacts
    np.testing.assert_allclose([c.impulse for c in contacts], [-c.impulse for c in others], rtol=1e-9)


ODD = {
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


@pytest.mark.parametrize("name", ODD)
def test_odd_problems_keep_to_their_gaps(name: str) -> None:
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
    problem = base.replace(**ODD[name])
    history = analytic.Solver(n_modes=20).simulate(problem, 0.6)
    t = np.linspace(0, 0.6, 3001)
    size = np.abs(history.displacement([1.0, 2.0], t)).max()
    for k, stop in enumerate(problem.stops):
        beyond = stop.sign * history.displacement(stop.x, t)[0] - stop.gap
        inside = np.zeros(t.size, dtype=bool)
        for contact in history.contacts:
            if contact.stop == k:
                inside |= (t >= contact.start) & (t <= contact.end)
        assert np.all(beyond[inside] >= -1e-5 * size)  # truncation of 20 modes at the switches
        assert np.all(beyond[~inside] <= 1e-5 * size)


def test_bad_options_and_durations_are_named() -> None:
    for call, word in (
        (lambda: analytic.Solver(n_modes=10**6), "n_modes = 1000000"),
        (lambda: analytic.Solver(n_modes=0), "n_modes = 0"),
        (lambda: analytic.Solver(tolerance=2.0), "tolerance = 2.0"),
        (lambda: analytic.Solver().simulate(paper_joint(), -1.0), "duration = -1.0"),
        (lambda: analytic.Solver().simulate(paper_joint(), math.nan), "duration = nan"),
        (lambda: analytic.Solver().modes(paper_joint(), FREE, 10**6), "count = 1000000"),
        (lambda: analytic.Solver().steady_state(sdnl104()), "angular_frequency"),
    ):
        with pytest.raises(InputError, match=word):
            call()


def test_loads_and_gap_forces_act_where_they_are_though_lengths_round() -> None:
    # 0.9 / 1.5 * 1.5 is less than 0.9 by a rounding: the force must not act at the next node.
    beam = Beam(length=1.5, bending_stiffness=1e5, mass_per_length=10.0)
    tip = Support(x=1.5, translational=1e5)
    stop = Stop(x=0.9, side="top", gap=1e-4, stiffness=1e6)
    problem = Problem(beam=beam, supports=(CLAMP, tip), stops=(stop,), point_loads=(StepLoad(x=0.9, force=100.0),))
    free, closed = (Joint(problem, 8, 8).modal(state) for state in (FREE, ContactState((0,))))
    for modal, force in ((free, 100.0), (closed, 100.0 + stop.stiffness * stop.gap)):
        assert modal.force[0] == pytest.approx(force * modal.modes.shapes(np.array([0.9]))[:, 0], rel=1e-9)
