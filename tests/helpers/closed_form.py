"""The motion that remains of a damped beam without stops, under forces of any frequencies: closed forms.

Under viscous damping of coefficient C a force of frequency w leaves EI Z'''' = (m w^2 - i w C) Z between the nodes of
the beam, with a complex beta; its four constants in every span follow from the springs and the loads at the nodes, by
50 digits.  Under modal damping the motion is the sum over the modes.
"""

from __future__ import annotations

import mpmath as mp
import numpy as np

import analytic
from lapjoint import FREE, BaseMotion, ModalDamping, Problem
from lapjoint.problem import FloatArray, ViscousDamping
from lapjoint.problem.forces import HarmonicForce

_DIGITS = 50
_MODES = 160  # of the sum; what is left out is below 1e-7 of the motion at a load, as its terms fall with n^4


def answer(problem: Problem, x: FloatArray, t: FloatArray) -> FloatArray:
    """z(x, t) of the steady motion without stops, m: ``x``, ``(n,)``, ascending, ``t``, ``(m,)``, give ``(n, m)``."""
    amplitude = _by_span if isinstance(problem.damping, ViscousDamping) else _by_mode
    total = np.zeros((x.size, t.size))
    for force in problem.forces.harmonic:
        wave = np.exp(1j * (force.angular_frequency * t + force.phase))
        total += np.outer(amplitude(problem, force, x), wave).imag
    return total


def reached(problem: Problem, omega: float) -> FloatArray:
    """The amplitude of the base at which each stop is first reached without contact, m: gap over |H|."""
    base = problem.base_motion
    assert isinstance(base, BaseMotion)
    unit = problem.replace(base_motion=base.model_copy(update={"angular_frequency": omega, "amplitude": 1.0}))
    x = np.array(sorted({stop.x for stop in problem.stops}))
    response = np.hypot(*answer(unit, x, np.array([0.0, np.pi / 2 / omega])).T)
    return np.array([stop.gap / response[np.searchsorted(x, stop.x)] for stop in problem.stops])


def _by_mode(problem: Problem, force: HarmonicForce, x: FloatArray) -> np.ndarray:
    """Complex amplitudes, m, shape ``(n,)``, as a sum over modes."""
    damping, L = problem.damping, problem.beam.length
    assert isinstance(damping, ModalDamping)
    modes = analytic.Solver().modes(problem.replace(stops=(), point_loads=()), FREE, _MODES)
    omega = np.asarray(modes.angular_frequencies)
    if force.of_base:
        s, w = np.polynomial.legendre.leggauss(400)
        share = problem.beam.m * np.asarray(modes.shapes((s + 1) * L / 2)) @ (w * L / 2)
    else:
        share = np.asarray(modes.shapes(np.array([force.shape.points[0][0]])))[:, 0]
    square = omega**2 - force.angular_frequency**2 + 2j * damping.ratios(_MODES) * omega * force.angular_frequency
    return np.asarray((force.amplitude * share / square) @ np.asarray(modes.shapes(x)))


def _by_span(problem: Problem, force: HarmonicForce, x: FloatArray) -> np.ndarray:
    """Complex amplitudes, m, shape ``(n,)``, from the equation of the beam."""
    beam, damping, supports, w = problem.beam, problem.damping, problem.supports, force.angular_frequency
    assert isinstance(damping, ViscousDamping)
    with mp.workdps(_DIGITS):
        EI, inertia = mp.mpf(beam.EI), mp.mpc(mp.mpf(beam.m) * w**2, -w * damping.coefficient)
        beta = (inertia / EI) ** (mp.mpf(1) / 4)
        loaded = [] if force.of_base else [force.shape.points[0][0]]
        nodes = sorted({0.0, beam.length, *(support.x for support in supports), *loaded})
        particular = -force.amplitude * beam.m / inertia if force.of_base else mp.mpf(0)
        size = 4 * (len(nodes) - 1)
        matrix, right = mp.zeros(size, size), mp.zeros(size, 1)
        row = 0
        for k, node in enumerate(nodes):
            first, last = k == 0, k == len(nodes) - 1
            before = [] if first else [(4 * (k - 1), _waves(beta, node - nodes[k - 1]), mp.mpf(-1))]
            after = [] if last else [(4 * k, _waves(beta, 0.0), mp.mpf(1))]
            if before and after:
                for d in (0, 1):
                    _add(matrix, row + d, [*before, *after], d, mp.mpf(1))
                row += 2
            here = (after or before)[:1]
            ones = [(column, values, mp.mpf(1)) for column, values, _ in here]
            for d, spring, sign in ((0, "translational", -1), (1, "torsional", 1)):
                k_here = [getattr(support, spring) for support in supports if support.x == node]
                if any(np.isinf(k_here)):
                    _add(matrix, row, ones, d, mp.mpf(1))
                    right[row] = -particular if d == 0 else 0
                else:
                    # EI [z'''] + k z = F, and EI [z''] - k_t z' = 0, with the jump [] from before to after
                    _add(matrix, row, [*before, *after], 3 - d, EI)
                    _add(matrix, row, ones, d, -sign * mp.fsum(k_here))
                    if d == 0:
                        right[row] = (force.amplitude if node in loaded else 0) - mp.fsum(k_here) * particular
                row += 1
        constants = mp.lu_solve(matrix, right)
        values = []
        for at in x.tolist():
            k = min(int(np.searchsorted(nodes, at, side="right")) - 1, len(nodes) - 2)
            waves = _waves(beta, at - nodes[k])[0]
            values.append(complex(particular + mp.fsum(constants[4 * k + i] * waves[i] for i in range(4))))
    return np.array(values)


def _waves(beta: mp.mpc, s: float) -> list[list[mp.mpc]]:
    """sin, cos, sinh and cosh of beta s, and their first three derivatives by s."""
    b = beta * mp.mpf(s)
    sin, cos, sinh, cosh = mp.sin(b), mp.cos(b), mp.sinh(b), mp.cosh(b)
    plain = ([sin, cos, sinh, cosh], [cos, -sin, cosh, sinh], [-sin, -cos, sinh, cosh], [-cos, sin, cosh, sinh])
    return [[beta**d * value for value in values] for d, values in enumerate(plain)]


def _add(matrix: mp.matrix, row: int, sides: list[tuple[int, list[list[mp.mpc]], mp.mpf]], d: int, by: mp.mpf) -> None:
    """Add the d-th derivative on some sides of a node, times a factor, to a row."""
    for column, waves, sign in sides:
        for i in range(4):
            matrix[row, column + i] += by * sign * waves[d][i]
