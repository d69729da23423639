r"""One mode as an oscillator: its damping, its free motion, and its answer to constant and harmonic forces.

.. math:: \ddot q + 2 \zeta\omega\,\dot q + \omega^2 q = F_0 + \sum_h F_h \sin\theta_h(t)                     (26)

Arrays hold one entry for each of ``N`` modes; `decay` is zeta omega throughout.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from analytic.modes.beam_functions import ComplexArray
from lapjoint.problem import FloatArray, ModalDamping, Problem, ViscousDamping

OSCILLATING, SPLIT, DRIFTING = 0, 1, 2
"""How a mode moves freely: a complex pair of roots; two real ones; an undamped rigid body, both roots 0."""
_SEPARATE = 1e-7
"""Relative distance kept between coincident poles, without unit: the motion changes by its square, 1e-14, while
differences of the poles, by which constants are divided, keep half their digits."""


def damping_rates(problem: Problem, omega: FloatArray) -> FloatArray:
    """zeta_i omega_i of modes with the angular frequencies `omega`, rad/s, ``(N,)``; gives 1/s, ``(N,)`` (34)."""
    damping = problem.damping
    if isinstance(damping, ModalDamping):
        return damping.ratios(omega.size) * omega
    rate = damping.coefficient / (2 * problem.beam.m) if isinstance(damping, ViscousDamping) else 0.0
    return np.full(omega.size, rate)


def forced_answer(force: FloatArray, omega: FloatArray, decay: FloatArray, driven: FloatArray) -> ComplexArray:
    """Complex amplitudes of the answer to the harmonics (28), (29), with the off-diagonal entries C* omega of (29).

    `force` is ``(S, H, N)``, `omega` and `decay` are ``(S, N)``, for ``S`` states; the angular frequencies `driven` of
    the loads are ``(H,)``.  Gives ``(S, H, N)``: q_i = Im(answer exp(i theta)).
    """
    Omega = driven[:, None]
    return np.asarray(force / (omega[:, None, :] ** 2 - Omega**2 + 2j * decay[:, None, :] * Omega))


def away_from_resonance(omega: FloatArray, decay: FloatArray, driven: FloatArray) -> FloatArray:
    """Move an undamped frequency that a load meets exactly by 1e-7 of itself; the secular growth stays."""
    least = _SEPARATE * omega
    undamped, result = decay < least, omega
    for value in driven if undamped.any() else ():
        result = np.where(undamped & (np.abs(omega - value) < least), value * (1 + _SEPARATE), result)
    return result


def roots_of(omega: FloatArray, decay: FloatArray) -> ComplexArray:
    """The two roots lambda, 1/s, shape ``(N, 2)``; a critically damped pair is kept 1e-7 apart, relatively."""
    square = decay**2 - omega**2
    square = np.where((omega > 0) & (np.abs(square) < (_SEPARATE * omega) ** 2), -((_SEPARATE * omega) ** 2), square)
    split = np.sqrt(square.astype(complex))
    first = -decay + split
    # For strong damping the slow root is omega^2 over the fast one: no cancellation.
    slow = np.where(square > 0, -(omega**2) / np.where(decay + split.real == 0, 1, decay + split.real), first)
    return np.stack([slow, -decay - split], axis=1)


def kinds_of(roots: ComplexArray) -> npt.NDArray[np.int64]:
    """OSCILLATING, SPLIT or DRIFTING for each mode, from its two roots, shape ``(N, 2)``; gives ``(N,)``."""
    drifting = (roots == 0).all(axis=1)
    return np.where(roots[:, 0].imag > 0, OSCILLATING, np.where(drifting, DRIFTING, SPLIT))


def static_answer(F0: FloatArray, omega: FloatArray, decay: FloatArray) -> FloatArray:
    """Coefficients of 1, t, t^2 of the answer to a constant force (31), shape ``(N, 3)``.

    A rigid-body mode drifts: F0 t / (2 decay) with damping, F0 t^2 / 2 without.
    """
    answer = np.zeros((F0.size, 3))
    rigid = omega == 0
    answer[~rigid, 0] = F0[~rigid] / omega[~rigid] ** 2
    dragged = rigid & (decay > 0)
    answer[dragged, 1] = F0[dragged] / (2 * decay[dragged])
    free = rigid & (decay == 0)
    answer[free, 2] = F0[free] / 2
    return answer
