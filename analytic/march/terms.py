"""The motion within one state as a sum of terms: the constants of (32), and how the terms go on with time.

    q_i(s) = Re sum_{t of i} c_t exp(lambda_t s) + a_i0 + a_i1 s + a_i2 s^2 + Im sum_h P_hi exp(i theta_h)

The march and the field of a motion both take the constants from `start_terms`.  Arguments are named alike throughout:

tables : Tables
    The states of the joint.
slot : int
    The state.
theta : ndarray, complex, shape (H,)
    exp(i theta_h) of the harmonics, now.
term : ndarray, complex, shape (T,)
    c_t exp(lambda_t s) of each term, kg^1/2 m, now; the first `tables.terms[slot]` count.
poly : ndarray, shape (N, 3)
    The coefficients a_i, kg^1/2 m over powers of s.
q, v : ndarray, shape (N,)
    Modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s; the first `tables.modes[slot]` count.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.march.oscillator import DRIFTING, OSCILLATING, SPLIT
from analytic.march.tables import PARTS, Tables
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

SERIES = 0.25
"""|lambda tau| up to which exp is summed as a series: thirteen products of real numbers cost less than one exp."""
_ROUNDING = 1e-17  # a term below this changes no bit of a sum near 1
_RECIPROCALS = 1.0 / np.maximum(np.arange(14), 1)  # 0.25^13 / 13! is below `_ROUNDING`
_OF_COSH = _RECIPROCALS[0::2] * np.append(1.0, _RECIPROCALS[1:-1:2])  # 1 / (2 n (2 n - 1))
_OF_SINH = _RECIPROCALS[0::2] * _RECIPROCALS[1::2]  # 1 / (2 n (2 n + 1))


@njit_inner(inline="always")
def set_phases(tables: Tables, t: float, theta: ComplexArray) -> None:
    """Write the phases of the harmonics, exp(i theta_h), at the time `t`, s."""
    for h in range(theta.size):
        angle = tables.omega[h] * t + tables.phase[h]
        theta[h] = complex(math.cos(angle), math.sin(angle))


@njit_inner()
def start_terms(
    tables: Tables, slot: int, theta: ComplexArray, q: FloatArray, v: FloatArray, term: ComplexArray, poly: FloatArray
) -> None:
    """Write the constants of (32), `term`, ``(T,)``, and `poly`, ``(N, 3)``, of a state that starts from `q`, `v`."""
    n = tables.modes[slot]
    extra = n
    for i in range(n):
        for order in range(3):
            poly[i, order] = tables.static[slot, i, order]
        x, y = q[i] - poly[i, 0], v[i] - poly[i, 1]
        for h in range(theta.size):
            wave = tables.harmonic[slot, h, i] * theta[h]
            x -= wave.imag
            y -= tables.omega[h] * wave.real
        kind = tables.kind[slot, i]
        term[i] = 0.0
        if kind == OSCILLATING:
            root = tables.root[slot, i]
            term[i] = complex(x, -(y - root.real * x) / root.imag)
        elif kind == SPLIT:
            first, second = tables.root[slot, i].real, tables.root[slot, extra].real
            term[i] = (y - second * x) / (first - second)
            term[extra] = (first * x - y) / (first - second)
            extra += 1
        else:
            poly[i, 0] += x
            poly[i, 1] += y


@njit_called()
def start_all_terms(
    tables: Tables,
    slot: int,
    start: FloatArray,
    q: FloatArray,
    v: FloatArray,
    theta: ComplexArray,
    term: ComplexArray,
    poly: FloatArray,
) -> None:
    """Write phases and constants of ``M`` segments in one state that start at `start`, s, ``(M,)``.

    Row i of each array is the array of segment i, as `set_phases` and `start_terms` have it.
    """
    for i in range(start.size):
        set_phases(tables, start[i], theta[i])
        start_terms(tables, slot, theta[i], q[i], v[i], term[i], poly[i])


@njit_inner()
def state_from_terms(
    tables: Tables,
    slot: int,
    theta: ComplexArray,
    s: float,
    term: ComplexArray,
    poly: FloatArray,
    q: FloatArray,
    v: FloatArray,
) -> None:
    """Write the `q` and `v`, ``(N,)``, that belong to terms and phases `s` seconds after the start."""
    n, terms = tables.modes[slot], tables.terms[slot]
    for i in range(n):
        q[i] = poly[i, 0] + s * (poly[i, 1] + s * poly[i, 2])
        v[i] = poly[i, 1] + 2 * s * poly[i, 2]
        for h in range(theta.size):
            wave = tables.harmonic[slot, h, i] * theta[h]
            q[i] += wave.imag
            v[i] += tables.omega[h] * wave.real
    for t in range(terms):
        i = tables.mode_of[slot, t]
        q[i] += term[t].real
        v[i] += (tables.root[slot, t] * term[t]).real


@njit_inner()
def tabulated(tau: float, step: FloatArray) -> int:
    """Index of the longest tabulated step of `step`, s, ``(J,)``, up to `tau`, s, which is at least the shortest.

    See `analytic.march.tables.OCTAVES`: the step is at least four fifths of a `tau` up to twice the first step.
    """
    fraction, exponent = math.frexp(tau / step[0])  # tau = fraction 2^exponent of the first, fraction in [1/2, 1)
    if exponent > 1:
        return PARTS - 1
    j = (1 - exponent) * PARTS + int(2 * PARTS * fraction) - PARTS
    return min(j, step.size - 1)


@njit_inner()
def turn_by(
    turn: ComplexArray, harmonic_turn: ComplexArray, terms: int, term: ComplexArray, theta: ComplexArray
) -> None:
    """Advance terms and phases by a tabulated step, in place.

    `turn`, ``(T,)``, is exp(lambda tau) of each of the first `terms` terms, and `harmonic_turn`, ``(H,)``, exp(i Omega
    tau).
    """
    for t in range(terms):
        term[t] *= turn[t]
    for h in range(theta.size):
        theta[h] *= harmonic_turn[h]


@njit_called()
def turn_briefly(
    root: ComplexArray,
    omega: FloatArray,
    terms: int,
    fastest: float,
    tau: float,
    term: ComplexArray,
    theta: ComplexArray,
) -> None:
    """Advance terms and phases by `tau` seconds, in place, by a short series; `tau` times `fastest` is at most
    `SERIES`.

    `fastest`, 1/s, is the largest modulus of `root`; the other arguments are those of `turn_exactly`.
    """
    if fastest * tau > SERIES:
        turn_exactly(root, omega, terms, tau, term, theta)
        return
    order, left = 1, fastest * tau
    while left > _ROUNDING and order < _RECIPROCALS.size - 1:
        order += 1
        left *= fastest * tau * _RECIPROCALS[order]
    for t in range(terms):
        a, b = root[t].real * tau, root[t].imag * tau
        a2, b2 = a * a - b * b, 2 * a * b
        # cosh z and sinh z / z side by side, in powers of z^2: a processor works on both at a time
        c, d, x, y = 1.0, 0.0, 1.0, 0.0
        for n in range(order // 2, 0, -1):
            r, o = _OF_COSH[n], _OF_SINH[n]
            c, d = 1.0 + r * (c * a2 - d * b2), r * (c * b2 + d * a2)
            x, y = 1.0 + o * (x * a2 - y * b2), o * (x * b2 + y * a2)
        term[t] *= complex(c + x * a - y * b, d + x * b + y * a)
    for h in range(theta.size):
        theta[h] *= complex(math.cos(omega[h] * tau), math.sin(omega[h] * tau))


@njit_called()
def turn_exactly(
    root: ComplexArray, omega: FloatArray, terms: int, tau: float, term: ComplexArray, theta: ComplexArray
) -> None:
    """Advance terms and phases by any time `tau`, s, in place.

    `root`, 1/s, ``(T,)``, is lambda of each of the first `terms` terms, and `omega`, rad/s, ``(H,)``, the frequency of
    each harmonic.
    """
    for t in range(terms):
        a, b = root[t].real * tau, root[t].imag * tau
        size = math.exp(a)
        term[t] *= complex(size * math.cos(b), size * math.sin(b))
    for h in range(theta.size):
        theta[h] *= complex(math.cos(omega[h] * tau), math.sin(omega[h] * tau))


@njit_inner()
def drift_at_stops(tables: Tables, slot: int, poly: FloatArray, drift: FloatArray) -> None:
    """Write to `drift`, ``(U, 3)``, the coefficients of 1, s, s^2 of z at the stops, m divided by powers of s."""
    if tables.owner is not None:
        _drift_of_coupled(tables, slot, poly, drift)
        return
    for u in range(drift.shape[0]):
        drift[u, 0] = tables.constant[slot, u]
        drift[u, 1] = 0.0
        drift[u, 2] = 0.0
        for i in range(tables.modes[slot]):
            for order in range(3):
                drift[u, order] += tables.weight[slot, u, i] * poly[i, order]


@njit_inner()
def _drift_of_coupled(tables: Tables, slot: int, poly: FloatArray, drift: FloatArray) -> None:
    """`drift_at_stops` where a position reads displacements and velocities: modes that drift freely move beside
    `still`."""
    for u in range(drift.shape[0]):
        for order in range(3):
            drift[u, order] = tables.still[slot, u, order]
    for i in range(tables.modes[slot]):
        if tables.kind[slot, i] == DRIFTING:
            place, speed = poly[i, 0] - tables.static[slot, i, 0], poly[i, 1] - tables.static[slot, i, 1]
            for u in range(drift.shape[0]):
                by_q, by_v = tables.gradient[slot, u, 0, i], tables.gradient[slot, u, 1, i]
                drift[u, 0] += by_q * place + by_v * speed
                drift[u, 1] += by_q * speed
