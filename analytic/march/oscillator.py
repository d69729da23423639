r"""One mode as an oscillator: its damping, its free motion, and its answer to constant and harmonic forces.

.. math:: \ddot q + 2 \zeta\omega\,\dot q + \omega^2 q = F_0 + \sum_h F_h \sin\theta_h(t)                     (26)

Arrays hold one entry for each of ``N`` modes; `damping_rate` is zeta omega throughout.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray, ModalDamping, Problem

OSCILLATING, SPLIT, DRIFTING = 0, 1, 2
"""How a mode moves freely: with two complex roots, with two real roots, or as an undamped rigid body, both roots 0."""
_SEPARATE = 1e-7
"""Relative distance kept between coincident poles: the motion changes by its square, 1e-14, while differences of the
poles, by which constants are divided, keep half their digits."""
ABOVE, BELOW = 1.0, -1.0
"""The side of the loads' frequencies to which `away_from_resonance` moves a mode."""
_NEARLY = 1e-6
"""Relative distance of mode and load below which their motions cancel to fewer than ten digits, 1e-16 / 1e-6."""
_DETUNE = 1e-8
"""Least relative distance kept between an undamped frequency and the frequency of a load.  Free and forced motion,
1 / (2e-8) static deflections each, cancel.  Their products with some hundred exponentials a period round by 1e-15: the
error is 1e-7 of the static deflection.  The phase is off by at most 2e-8 of itself, 1e-7 in a period."""


def damping_rates(problem: Problem, omega: FloatArray) -> FloatArray:
    """Damping rates zeta_i omega_i, 1/s, of modes (34) with angular frequencies `omega`, rad/s, shape ``(N,)``.

    Damping that couples the modes is not among them: `analytic.march.drag` has its matrix.
    """
    damping, even = problem.damping, problem.structure.even_decay
    return (damping.ratios(omega.size) * omega if isinstance(damping, ModalDamping) else np.zeros(omega.size)) + even


@njit_inner()
def forced_answer(force: float, omega: float, damping_rate: float, driven: float) -> complex:
    """Complex amplitude, kg^1/2 m, of a mode's answer to a harmonic (28), (29): q_i = Im(answer exp(i theta)).

    `force` is the modal force, kg^1/2 m/s2; `omega`, rad/s, and `damping_rate`, 1/s, are those of the mode, and
    `driven`, rad/s, is the frequency of the harmonic.  The off-diagonal entries of (29) are C* omega.
    """
    answer: complex = force / complex(omega * omega - driven * driven, 2 * damping_rate * driven)
    return answer


def may_resonate(omega: FloatArray, damping_rate: FloatArray) -> bool:
    """Whether `away_from_resonance` may move a mode, of given frequencies, rad/s, and damping rates, 1/s."""
    return bool((damping_rate < _NEARLY * omega).any())


@njit_inner()
def away_from_resonance(omega: float, damping_rate: float, driven: FloatArray, side: float) -> float:
    """Keep an undamped frequency at least `_DETUNE` of itself away from those of all loads; the secular growth stays.

    The frequencies of the mode and of the loads, `driven`, ``(H,)``, are in rad/s, the damping rate in 1/s.  `side` is
    ABOVE or BELOW; BELOW also lowers by `_DETUNE` a mode that is nearly resonant.  A motion with the modes moved above
    the loads and one with the modes moved below differ by the effect of the move and of rounding.
    """
    least, away = _DETUNE * omega, omega
    if side == BELOW and damping_rate < _NEARLY * omega:
        for h in range(driven.size):
            if abs(omega - driven[h]) < _NEARLY * omega:
                away = omega - least
    if damping_rate < least:
        for _ in range(driven.size):
            edge = away
            for h in range(driven.size):
                if abs(away - driven[h]) < least:
                    beside = driven[h] * (1 + side * _DETUNE)
                    edge = max(edge, beside) if side == ABOVE else min(edge, beside)
            away = edge
    return away


@njit_called()
def all_away_from_resonance(omega: FloatArray, damping_rate: FloatArray, driven: FloatArray, side: float) -> FloatArray:
    """`away_from_resonance` of ``N`` modes, rad/s, shape ``(N,)``."""
    away = omega.copy()
    for i in range(omega.size):
        away[i] = away_from_resonance(omega[i], damping_rate[i], driven, side)
    return away


def roots_of(omega: FloatArray, damping_rate: FloatArray) -> ComplexArray:
    """The two roots lambda, 1/s, of the free motion of each of ``N`` modes, shape ``(N, 2)``.

    The root with the positive imaginary part, or the slower one, is first.  A critically damped pair is kept 1e-7
    apart, relatively.
    """
    square = damping_rate**2 - omega**2
    square = np.where((omega > 0) & (np.abs(square) < (_SEPARATE * omega) ** 2), -((_SEPARATE * omega) ** 2), square)
    split = np.sqrt(square.astype(complex))
    first = -damping_rate + split
    # For strong damping the slow root is omega^2 over the fast one: no cancellation.
    fast = damping_rate + split.real
    slow = np.where(square > 0, -(omega**2) / np.where(square > 0, fast, 1), first)
    return np.stack([slow, -damping_rate - split], axis=1)


def kinds_of(roots: ComplexArray) -> npt.NDArray[np.int64]:
    """How each mode moves freely, OSCILLATING, SPLIT or DRIFTING, from its two roots, 1/s, shape ``(N, 2)``."""
    drifting = (roots == 0).all(axis=1)
    return np.where(roots[:, 0].imag > 0, OSCILLATING, np.where(drifting, DRIFTING, SPLIT))


def static_answer(F0: FloatArray, omega: FloatArray, damping_rate: FloatArray) -> FloatArray:
    """Coefficients of 1, t, t^2, kg^1/2 m over powers of s, ``(N, 3)``, of the answer to constant modal forces (31).

    A rigid-body mode, of frequency 0, drifts: F0 t / (2 damping_rate) with damping, F0 t^2 / 2 without.
    """
    answer = np.zeros((F0.size, 3))
    rigid = omega == 0
    answer[~rigid, 0] = F0[~rigid] / omega[~rigid] ** 2
    dragged = rigid & (damping_rate > 0)
    answer[dragged, 1] = F0[dragged] / (2 * damping_rate[dragged])
    free = rigid & (damping_rate == 0)
    answer[free, 2] = F0[free] / 2
    return answer
