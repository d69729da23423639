"""The compiled heart of the march: follow one contact state in closed form up to the first switch.

Between switches every stop sees a gap function

    h(s) = Re sum_t c_t exp(lambda_t s) + a0 + a1 s + a2 s^2,    h <= 0,

oriented so that h rising through 0 is the next switch (an open stop closes, a closed stop opens).  From h, h', h''
at s and the bound |h'''| <= B = sum |c_t exp(lambda_t s)| |lambda_t|^3, which holds from s on because no term
grows, the cubic

    h + h' tau + h'' tau^2 / 2 + B tau^3 / 6

lies above h(s + tau).  Up to the first root of the cubic no switch is possible: that is the step.  Close to a
switch the root converges to it cubically from below; elsewhere the steps are as long as the bound allows.  No
impact, rebound or graze can be stepped over.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

OSCILLATING, SPLIT, DRIFTING = 0, 1, 2  # complex pair; two real roots; free rigid body
NO_SWITCH = -1
STUCK = -2
_RESOLUTION = 1e-12  # s: a switch certified to lie within this time is there
_MAX_STEPS = 10_000_000


@njit(cache=True)
def amplitudes(
    q: Any, v: Any, theta: Any, omega: Any, kind: Any, roots: Any, static: Any, harmonic: Any
) -> tuple[Any, Any]:
    """Constants of (32) from the state at the start: complex ``(N, 2)``, and polynomials ``(N, 3)``."""
    n = q.size
    c = np.zeros((n, 2), dtype=np.complex128)
    poly = static.copy()
    for i in range(n):
        x, y = q[i] - static[i, 0], v[i] - static[i, 1]
        for h in range(theta.size):
            wave = harmonic[h, i] * np.exp(1j * theta[h])
            x -= wave.imag
            y -= (1j * omega[h] * wave).imag
        if kind[i] == 0:
            root = roots[i, 0]
            c[i, 0] = complex(x, -(y - root.real * x) / root.imag)
        elif kind[i] == 1:
            first, second = roots[i, 0].real, roots[i, 1].real
            c[i, 0] = (y - second * x) / (first - second)
            c[i, 1] = (first * x - y) / (first - second)
        else:
            poly[i, 0] += x
            poly[i, 1] += y
    return c, poly


@njit(cache=True)
def state_at(
    s: float, c: Any, poly: Any, theta: Any, omega: Any, kind: Any, roots: Any, harmonic: Any
) -> tuple[Any, Any]:
    """Modal displacements and velocities, shape ``(N,)``, at the time `s` after the start."""
    n = kind.size
    q, v = np.zeros(n), np.zeros(n)
    for i in range(n):
        q[i] = poly[i, 0] + s * (poly[i, 1] + s * poly[i, 2])
        v[i] = poly[i, 1] + 2 * s * poly[i, 2]
        for j in range(2 if kind[i] == 1 else 1):
            wave = c[i, j] * np.exp(roots[i, j] * s)
            q[i] += wave.real
            v[i] += (roots[i, j] * wave).real
        for h in range(theta.size):
            forced = harmonic[h, i] * np.exp(1j * (theta[h] + omega[h] * s))
            q[i] += forced.imag
            v[i] += (1j * omega[h] * forced).imag
    return q, v


@njit(cache=True)
def gap_functions(
    c: Any,
    poly: Any,
    theta: Any,
    omega: Any,
    kind: Any,
    roots: Any,
    at_stops: Any,
    stop_harmonic: Any,
    stop_constant: Any,
    sign: Any,
    gap: Any,
    closed: Any,
) -> tuple[Any, Any, Any]:
    """Exponents ``(T,)``, coefficients ``(P, T)`` and polynomials ``(P, 3)`` of the gap functions h."""
    stops, n, harmonics = sign.size, kind.size, theta.size
    split = 0
    for i in range(n):
        split += kind[i] == 1
    exponents = np.zeros(n + split + harmonics, dtype=np.complex128)
    coefficients = np.zeros((stops, exponents.size), dtype=np.complex128)
    polynomials = np.zeros((stops, 3))
    orientation = np.zeros(stops)
    for k in range(stops):
        orientation[k] = -sign[k] if closed[k] else sign[k]
        polynomials[k, 0] = orientation[k] * stop_constant[k] + (gap[k] if closed[k] else -gap[k])
    t = 0
    for i in range(n):
        for k in range(stops):
            weight = orientation[k] * at_stops[k, i]
            for order in range(3):
                polynomials[k, order] += weight * poly[i, order]
        for j in range(2 if kind[i] == 1 else 1):
            exponents[t] = roots[i, j]
            for k in range(stops):
                coefficients[k, t] = orientation[k] * at_stops[k, i] * c[i, j]
            t += 1
    for h in range(harmonics):
        exponents[t] = 1j * omega[h]
        for k in range(stops):  # Im w = Re(-i w)
            coefficients[k, t] = -1j * orientation[k] * stop_harmonic[k, h] * np.exp(1j * theta[h])
        t += 1
    return exponents, coefficients, polynomials


@njit(cache=True)
def first_root_of_bound(h: float, h1: float, h2: float, b3: float) -> float:
    """A time just below the first tau >= 0 where h + h1 tau + h2 tau^2/2 + b3 tau^3/6 rises through 0; h <= 0."""
    lo, hi = 0.0, -1.0
    discriminant = h2 * h2 - 2 * b3 * h1
    if discriminant > 0:
        split = math.sqrt(discriminant)
        # the smaller and the larger root of the derivative, without cancellation
        if h2 > 0:
            r1 = (-h2 - split) / b3
            r2 = -2 * h1 / (h2 + split)
        else:
            r2 = (-h2 + split) / b3
            r1 = 2 * h1 / (-h2 + split)
        if r1 > 0 and h + r1 * (h1 + r1 * (h2 / 2 + r1 * b3 / 6)) >= 0:
            hi = r1
        elif r2 > 0:
            lo = r2
    if hi < 0:
        step = max(lo, 1e-12)
        hi = lo + step
        while h + hi * (h1 + hi * (h2 / 2 + hi * b3 / 6)) < 0:
            lo = hi
            hi = 2 * hi
    for _ in range(60):
        if hi - lo <= 1e-3 * hi:
            break
        middle = 0.5 * (lo + hi)
        if h + middle * (h1 + middle * (h2 / 2 + middle * b3 / 6)) < 0:
            lo = middle
        else:
            hi = middle
    return lo


@njit(cache=True)
def _evaluate(s: float, k: int, exponents: Any, coefficients: Any, polynomials: Any) -> tuple[float, float, float]:
    """h, h' and h'' of stop `k` at `s`."""
    h = polynomials[k, 0] + s * (polynomials[k, 1] + s * polynomials[k, 2])
    h1 = polynomials[k, 1] + 2 * s * polynomials[k, 2]
    h2 = 2 * polynomials[k, 2]
    for t in range(exponents.size):
        wave = coefficients[k, t] * np.exp(exponents[t] * s)
        h += wave.real
        wave *= exponents[t]
        h1 += wave.real
        wave *= exponents[t]
        h2 += wave.real
    return h, h1, h2


@njit(cache=True)
def _extremum(lo: float, hi: float, k: int, exponents: Any, coefficients: Any, polynomials: Any) -> float:
    """h of stop `k` at the minimum between `lo`, where h' < 0, and `hi`, where h' >= 0."""
    h = 0.0
    s = 0.5 * (lo + hi)
    for _ in range(60):
        h, h1, h2 = _evaluate(s, k, exponents, coefficients, polynomials)
        if h1 < 0:
            lo = s
        else:
            hi = s
        newton = s - h1 / h2 if h2 > 0 else lo
        s_next = newton if lo < newton < hi else 0.5 * (lo + hi)
        if abs(s_next - s) < 1e-13 + 1e-9 * abs(s):
            break
        s = s_next
    return h


@njit(cache=True)
def first_switch(
    exponents: Any, coefficients: Any, polynomials: Any, closed: Any, fresh: Any, horizon: float
) -> tuple[float, int, Any, int]:
    """The first switch within `horizon`.

    ``fresh`` marks stops that switched a moment ago: one that does not leave 0 at once has to pass a threshold
    of rounding size before it can switch again.  Returns the time, the stop (`NO_SWITCH` if none, `STUCK` if the
    steps ran out), the deepest penetration of each closed stop, ``(P,)``, and the number of steps.
    """
    stops, terms = closed.size, exponents.size
    shift, deepest = np.zeros(stops), np.zeros(stops)
    previous = np.zeros(stops)
    cubes = np.abs(exponents) ** 3
    s, s_previous = 0.0, 0.0
    for step in range(_MAX_STEPS):
        tau, which = horizon - s, NO_SWITCH
        h, h1, h2, b3 = np.zeros(stops), np.zeros(stops), np.zeros(stops), np.zeros(stops)
        for k in range(stops):
            h[k] = polynomials[k, 0] + s * (polynomials[k, 1] + s * polynomials[k, 2])
            h1[k] = polynomials[k, 1] + 2 * s * polynomials[k, 2]
            h2[k] = 2 * polynomials[k, 2]
        for t in range(terms):
            factor, root = np.exp(exponents[t] * s), exponents[t]
            size = abs(factor) * cubes[t]
            for k in range(stops):
                wave = coefficients[k, t] * factor
                h[k] += wave.real
                b3[k] += abs(coefficients[k, t]) * size
                wave *= root
                h1[k] += wave.real
                wave *= root
                h2[k] += wave.real
        for k in range(stops):
            if closed[k]:
                deepest[k] = max(deepest[k], -h[k])
                if step > 0 and previous[k] < 0 <= h1[k]:
                    low = _extremum(s_previous, s, k, exponents, coefficients, polynomials)
                    deepest[k] = max(deepest[k], -low)
            previous[k] = h1[k]
            if step == 0:
                # The modes of two states differ by their truncation: start from 0 what starts above it.
                shift[k] = max(h[k], 0.0)
                threshold = 1e-13 * np.sum(np.abs(coefficients[k])) + 1e-300
                if fresh[k] and h[k] - shift[k] > -threshold and h1[k] >= 0:
                    shift[k] += threshold
            value = min(h[k] - shift[k], 0.0)
            bound = first_root_of_bound(value, h1[k], h2[k], b3[k] + 1e-300)
            if bound < tau:
                tau, which = bound, k
        if which == NO_SWITCH:
            if tau > 0 and s < horizon:
                for k in range(stops):
                    if closed[k]:
                        end_h, end_h1, _ = _evaluate(horizon, k, exponents, coefficients, polynomials)
                        deepest[k] = max(deepest[k], -end_h)
                        if previous[k] < 0 <= end_h1:
                            low = _extremum(s, horizon, k, exponents, coefficients, polynomials)
                            deepest[k] = max(deepest[k], -low)
            return horizon, NO_SWITCH, deepest, step
        if tau < _RESOLUTION:
            return s + tau, which, deepest, step
        s_previous = s
        s += tau
    return s, STUCK, deepest, _MAX_STEPS


@njit(cache=True)
def gap_integrals(s: float, exponents: Any, coefficients: Any, polynomials: Any) -> Any:
    """Integrals of the gap functions from 0 to `s`, closed form, shape ``(P,)``."""
    stops = polynomials.shape[0]
    total = np.zeros(stops)
    for k in range(stops):
        total[k] = s * (polynomials[k, 0] + s * (polynomials[k, 1] / 2 + s * polynomials[k, 2] / 3))
    for t in range(exponents.size):
        w = exponents[t] * s
        if abs(w) < 1e-2:
            ratio = s * (1 + w / 2 * (1 + w / 3 * (1 + w / 4 * (1 + w / 5 * (1 + w / 6)))))
        else:
            ratio = (np.exp(w) - 1) / exponents[t]
        for k in range(stops):
            total[k] += (coefficients[k, t] * ratio).real
    return total
