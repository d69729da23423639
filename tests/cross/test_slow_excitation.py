"""Excitation that is slow against the decay of free vibration: nothing is left of a transient after a period."""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import UNIT

import analytic
import fe_lapjoint
from lapjoint import Axis, BaseMotion, Beam, ModalDamping, Outcome, Problem, Stop, Support, ViscousDamping, sweep

PINNED = (Support(x=0.0, translational=math.inf), Support(x=1.0, translational=math.inf))
FIRST = math.pi**2  # rad/s, of a pinned beam with EI = m = L = 1
SOLVERS = {"analytic": analytic.Solver(n_modes=4), "fe": fe_lapjoint.Solver(elements=8)}
MOST_SLOW = 1e-6  # of the first frequency


def slow_joint(seed: int) -> tuple[Problem, bool]:
    """A pinned beam between stops, shaken at 1e-6 to 0.3 of its first frequency; and whether it reaches a stop."""
    rng = np.random.default_rng((25, seed))
    share, ratio = 10 ** rng.uniform(math.log10(MOST_SLOW), -0.5), 10 ** rng.uniform(-2.0, math.log10(5.0))
    viscous = ViscousDamping(coefficient=2 * ratio * FIRST)
    dampings = ModalDamping(ratio=ratio), ModalDamping(ratio=(ratio, 0.1)), viscous
    reaches = bool(rng.random() < 0.3)
    amplitude = 1e-3 * share**2  # of the middle, but for the quasi-static factor of 1.27 and the resonance
    gap = amplitude * (rng.uniform(0.2, 0.5) if reaches else rng.uniform(3.0, 1e3))
    sides = ("top", "bottom") if rng.random() < 0.5 else ("top",)
    problem = Problem(
        beam=UNIT,
        supports=PINNED,
        stops=tuple(Stop(x=0.5, side=side, gap=gap, stiffness=10 ** rng.uniform(0.0, 3.0)) for side in sides),
        damping=dampings[int(rng.integers(3))],
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=share * FIRST),
    )
    return problem, reaches


@pytest.mark.parametrize("seed", [*range(20), *(pytest.param(i, marks=pytest.mark.slow) for i in range(20, 200))])
def test_a_joint_that_is_slowly_shaken_has_a_steady_state(seed: int) -> None:
    problem, reaches = slow_joint(seed)
    found = {name: solver.steady_state(problem, errors=False) for name, solver in SOLVERS.items()}
    for name, steady in found.items():
        assert np.isfinite(steady.impulses).all()
        assert (np.abs(steady.multipliers) < 1).all()
        if not reaches and problem.base_motion.angular_frequency < 0.1 * FIRST:
            assert steady.outcome is Outcome.NO_CONTACT, name
            z = steady.history.displacement(0.5, np.linspace(0.0, steady.history.end, 101))
            # At rest under its inertial load, 5 m Y w^2 L^4 / (384 EI), but for (w / w1)^2 and for damping.
            still = 5 / 384 * 1e-3 * problem.base_motion.angular_frequency**2
            assert np.abs(z).max() == pytest.approx(still, rel=0.15)
    np.testing.assert_allclose(found["fe"].impulses, found["analytic"].impulses, rtol=0.05, atol=1e-30)


@pytest.mark.parametrize("name", SOLVERS)
@pytest.mark.parametrize(("frequency", "ratio"), [(0.1, 0.02), (5.0, 0.5), (20.0, 1.0), (1e-4, 5.0)])
def test_a_slowly_shaken_beam_touches_nothing(name: str, frequency: float, ratio: float) -> None:
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=450.0, mass_per_length=2.4),
        supports=PINNED,
        stops=tuple(Stop(x=0.5, side=side, gap=1e-3, stiffness=1e5) for side in ("top", "bottom")),
        damping=ModalDamping(ratio=ratio),
        base_motion=BaseMotion(amplitude=2e-3, angular_frequency=frequency),
    )
    steady = SOLVERS[name].steady_state(problem)
    assert (steady.outcome, steady.period_multiple, steady.symmetric) == (Outcome.NO_CONTACT, 1, True)
    assert np.abs(steady.multipliers).max() < 1e-9
    z = np.abs(steady.history.displacement(0.5, np.linspace(0.0, steady.history.end, 101))).max()
    assert z == pytest.approx(5 / 384 * 2.4 * 2e-3 * frequency**2 / 450.0, rel=0.05)


@pytest.mark.parametrize(("name", "options"), [("analytic", {"n_modes": 4}), ("fe", {"elements": 8})])
def test_a_sweep_that_begins_near_zero_ends(name: str, options: dict[str, int]) -> None:
    problem, _ = slow_joint(0)
    problem = problem.replace(damping=ModalDamping(ratio=0.3))
    frequencies = FIRST * np.array([1e-6, 1e-4, 1e-2, 0.3])
    table = sweep(problem, [Axis("base_motion.angular_frequency", frequencies)], solver=name, options=options)
    assert not (table["impulse"].isnull()).any()
