"""The rigid bar's witness against an integrator, and what it catches in solvers and ground."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from validation.cases import rigid_bar
from validation.references.rigid_bar import RigidBar
from validation.references.rigid_bar_orbits import mirrors_itself, multipliers, periodic


def integrated(bar: RigidBar, end: float) -> np.ndarray:
    """(u, v) by DOP853 with short steps, the contact state read off the gaps at every call."""
    n = bar.M.shape[0]
    inverse = np.linalg.inv(bar.M)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        u, v = y[:n], y[n:]
        closed = frozenset(k for k in range(len(bar.stops)) if bar.gap_function(k, u, t) > 0)
        C, K, rest = bar.matrices(closed)
        force = K @ rest + sum(f * np.sin(w * t + phase) for f, w, phase in bar.harmonics_in(closed))
        return np.concatenate([v, inverse @ (force - C @ v - K @ u)])

    start = np.concatenate(bar.initial)
    return np.asarray(solve_ivp(rates, (0, end), start, method="DOP853", rtol=1e-9, atol=1e-13, max_step=2e-3).y[:, -1])


@pytest.mark.parametrize("name", rigid_bar.BARS)
def test_the_witness_marches_as_an_integrator_does(name: str) -> None:
    bar = RigidBar.from_toml(rigid_bar.BARS[name].format(stiffness="inf"))
    motion = bar.march(0.6)
    assert len(motion.contacts) >= 2
    assert motion.y == pytest.approx(integrated(bar, 0.6), rel=1e-4, abs=1e-4 * np.abs(motion.u).max())


def test_the_witness_moves_no_more_than_its_multipliers_say() -> None:
    bar = RigidBar.from_toml(rigid_bar.MIRROR.format(stiffness="inf"))
    motion = periodic(bar)
    closed_form = np.exp(-6.0 / 4.0 * bar.period)  # viscous damping shrinks the area by exp(-C T / m)
    assert abs(np.prod(multipliers(motion))) == pytest.approx(closed_form, rel=1e-7)
    assert mirrors_itself(motion)
    assert np.abs(motion.impulses().sum()) < 1e-9 * np.abs(motion.impulses()).max()


def test_the_moment_over_a_torsional_spring_is_that_of_the_spring() -> None:
    bar = RigidBar.from_toml(rigid_bar.MIRROR.format(stiffness="inf"))
    motion = bar.march(0.6)
    for t in np.linspace(0.05, 0.6, 7):
        slope = motion.evaluate(bar.length, np.array([t]))[0] / bar.length
        assert motion.moment(0.0, float(t)) == pytest.approx(600.0 * slope, abs=1e-9)
