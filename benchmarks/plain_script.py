"""The joint as a user would write it with scipy alone: beam elements, penalty forces in the right-hand side.

Viscous damping, because damping ratios of the modes of the present contact state have no place in such a script.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from lapjoint import Problem, ViscousDamping


def element_matrices(EI: float, m: float, h: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, consistent mass and uniform load of a Hermite beam element (textbook, e.g. Logan, chapter 4)."""
    K = EI / h**3 * np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2]])
    K = np.vstack([K, -K[0], EI / h**3 * np.array([6 * h, 2 * h**2, -6 * h, 4 * h**2])])
    M = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2]])
    M = np.vstack([M, [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h**2, -22 * h, 4 * h**2]]) * m * h / 420
    return K, M, h / 12 * np.array([6, h, 6, -h])


def plain_impulses(problem: Problem, elements: int, duration: float, method: str, rtol: float) -> np.ndarray:
    """Impulse of each stop over the first `duration` seconds, N s, shape ``(stops,)``."""
    beam, base, n = problem.beam, problem.base_motion, 2 * (elements + 1)
    assert base is not None
    assert isinstance(problem.damping, ViscousDamping)
    K, M, load = np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
    k, m, f = element_matrices(beam.EI, beam.m, beam.length / elements)
    for e in range(elements):
        at = slice(2 * e, 2 * e + 4)
        K[at, at] += k
        M[at, at] += m
        load[at] += f
    K, M, load = K[2:, 2:], M[2:, 2:], load[2:]  # clamped
    inverse = np.linalg.inv(M)
    dofs = [2 * round(stop.x / beam.length * elements) - 2 for stop in problem.stops]
    sign = np.array([stop.sign for stop in problem.stops])
    gap = np.array([stop.gap for stop in problem.stops])
    stiffness = np.array([stop.stiffness for stop in problem.stops])
    size, rate = n - 2, problem.damping.coefficient / beam.m

    def forces(z: np.ndarray) -> np.ndarray:
        return -sign * stiffness * np.maximum(sign * z[dofs] - gap, 0.0)

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        z, v, contact = y[:size], y[size : 2 * size], forces(y[:size])
        p = load * beam.m * base.amplitude * base.angular_frequency**2 * np.sin(base.angular_frequency * t) - K @ z
        np.add.at(p, dofs, contact)
        return np.concatenate([v, inverse @ p - rate * v, -contact])

    y = solve_ivp(rates, (0, duration), np.zeros(2 * size + len(dofs)), method=method, rtol=rtol, atol=1e-9).y
    return np.asarray(y[2 * size :, -1])
