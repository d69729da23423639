"""The analytic march: its modal equation, what truncation loses at switches, and where loads act."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import analytic
from analytic.march.joint import Joint
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    ContactState,
    ModalDamping,
    NoDamping,
    Problem,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
    paper_joint,
)
from tests.helpers.beams import CLAMP, LONG


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


def test_displacement_and_velocity_are_continuous_at_switches_up_to_truncation() -> None:
    jumps = []
    for n_modes in (14, 28):
        history = analytic.Solver(n_modes=n_modes).simulate(paper_joint(), 0.05)
        t, x = history.switch_times, np.linspace(0.1, 2.5, 13)
        before = np.nextafter(t, 0)
        jumps.append(np.abs(history.displacement(x, t) - history.displacement(x, before)).max())
    assert jumps[0] < 1e-5  # of a motion of 0.1 m
    assert jumps[1] < jumps[0] / 2**5  # (44) loses what falls as the seventh power of the number of modes


def test_loads_and_gap_forces_act_where_they_are_though_lengths_round() -> None:
    # 0.9 / 1.5 * 1.5 is less than 0.9 by a rounding: the force must not act at the next node.
    beam = Beam(length=1.5, bending_stiffness=1e5, mass_per_length=10.0)
    tip = Support(x=1.5, translational=1e5)
    stop = Stop(x=0.9, side="top", gap=1e-4, stiffness=1e6)
    problem = Problem(beam=beam, supports=(CLAMP, tip), stops=(stop,), point_loads=(StepLoad(x=0.9, force=100.0),))
    free, closed = (Joint(problem, 8, 8).modal(state) for state in (FREE, ContactState((0,))))
    for modal, force in ((free, 100.0), (closed, 100.0 + stop.stiffness * stop.gap)):
        assert modal.force[0] == pytest.approx(force * modal.modes.shapes(np.array([0.9]))[:, 0], rel=1e-9)
