"""The extrema of gap functions between switches, compiled.

Each stop has its gap function h(t) = sign z - gap, negative in a flight and positive in a contact.  A motion grazes a
stop where an extremum of h is zero.
"""

from __future__ import annotations

import math

import numpy as np

from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.orbits.compiled_intervals import IndexArray, Motion, Stops
from lapjoint.problem import FloatArray

_BLOCK = 16
"""Number of points after which the spacing of points is chosen anew, because fast terms have decayed."""
_MISSED = 0.01
"""Largest error of the cubic between two points, as a fraction of the sum of the sizes of the rate's terms.  It
balances the number of points against the number of intervals that have to be halved."""
_OF_VALUE, _OF_SLOPE = 1 / 384, math.sqrt(3) / 216
"""Errors of a cubic through a function's values and slopes at two points, and of the cubic's slope, divided by the
function's fourth derivative and by the fourth, or third, power of the distance (Birkhoff and Priver 1967)."""
_HALVINGS = 9
"""Most halvings of an interval between points: two extrema within the shortest part have nearly the same value."""
_FAINT = 1e-6
"""A term of a rate below this fraction of the sum of all terms is not evaluated, and counts as an error instead."""
_GONE = -45.0
"""Exponent below which a term is neglected: 3e-20 of its first size is left."""
_STEPS = 60
"""Most steps of the search for an extremum, of which one or two are needed."""
_EXACT = 1e-9
"""Error in time, as a fraction of the first interval, at which an extremum is found: the error of the value goes with
its square."""
_ABOUT = 3
"""Steps of Newton's method for the zero of a cubic."""
_NEXT = 5.0
"""Factor of the first neglected term in the series of a step: this times the step and the cube of the ratio of
successive terms. 5 is the value for the inverse of a parabola."""
_OPEN = -1
"""Value of `_vanishes` if the bounds leave open how often a rate vanishes."""


@njit_called()
def gap_extrema(motion: Motion, stops: Stops) -> tuple[IndexArray, FloatArray, FloatArray, np.ndarray]:
    """All extrema of gap functions: stop, time, value and whether it is a maximum, each of shape (m,).

    Times count from the start of the orbit, s, and the times of one stop ascend; values are in m.  Points are so close
    that cubics with the rate's values and slopes at the points have a small, known error.  If the error leaves open how
    often the rate vanishes between two points, the interval between them is halved.  A change of contact state
    truncates the motion a little; if this changes the sign of a rate, there is an extremum at the start of the new
    segment.
    """
    stop, time, value, maximum = [0], [0.0], [0.0], [False]
    places, terms = motion.weights.shape[1], motion.rates.shape[1]
    waves, factors, weights = zeros((terms, 2)), zeros((terms, 2)), zeros((places, terms, 4))
    before, now, middle, ends = zeros((places, 3)), zeros(3), zeros(3), zeros((_HALVINGS + 1, 3))
    missed, hereafter = zeros((places, 3)), zeros((places, 3))
    has_begun = False
    for s in range(motion.duration.size):
        duration = motion.duration[s]
        if duration <= 0:  # between simultaneous switches there is no time
            continue
        tau, step, left, loud = 0.0, 0.0, 0, 0
        while True:
            anew = left == 0
            if anew:
                loud, width = _loud(motion, s, tau, waves, factors, weights, hereafter)
                count = max(1, math.ceil((duration - tau) / width))
                step, left = (duration - tau) / count, min(count, _BLOCK)
                for i in range(loud):
                    factor = np.exp(complex(factors[i, 0], factors[i, 1]) * step)
                    factors[i, 0], factors[i, 1] = factor.real, factor.imag
            for u in range(places):
                bend = 2 * motion.polynomial[s, u, 2]
                rate = motion.polynomial[s, u, 1] + tau * bend
                for i in range(loud):
                    rate += weights[u, i, 0] * waves[i, 0] - weights[u, i, 1] * waves[i, 1]
                    bend += weights[u, i, 2] * waves[i, 0] - weights[u, i, 3] * waves[i, 1]
                now[0], now[1], now[2] = tau, rate, bend
                start = before[u]
                if tau == 0:
                    if has_begun and _turns(start[1], rate):
                        z, _, _, _, _ = _derivatives(motion, s, u, 0.0)
                        for p in range(stops.sign.size):
                            if stops.place[p] == u:
                                stop.append(p)
                                time.append(motion.start[s])
                                value.append(stops.sign[p] * z - stops.gap[p])
                                maximum.append(stops.sign[p] * start[1] > 0)
                    put(start, now)
                if anew:  # terms that are faint at either end of the interval that leads here
                    missed[u, 1], missed[u, 2] = max(missed[u, 1], hereafter[u, 1]), max(missed[u, 2], hereafter[u, 2])
                # `ends` is a stack: the intervals still to be examined end at its points, the next one at the last
                put(ends[0], now)
                count, least = 1 if tau > 0 else 0, 1.5 * (tau - start[0]) * 0.5**_HALVINGS
                while count > 0:
                    end = ends[count - 1]
                    way = end[0] - start[0]
                    found = _vanishes(start, end, missed[u])
                    if found == _OPEN and way > least:
                        middle[0] = start[0] + 0.5 * way
                        _, middle[1], middle[2], _, _ = _derivatives(motion, s, u, middle[0])
                        put(ends[count], middle)
                        count += 1
                        continue
                    if found != 0 and _turns(start[1], end[1]):
                        t, z = _stationary(motion, s, u, start, end)
                        for p in range(stops.sign.size):
                            if stops.place[p] == u:
                                stop.append(p)
                                time.append(motion.start[s] + t)
                                value.append(stops.sign[p] * z - stops.gap[p])
                                maximum.append(stops.sign[p] * start[1] > 0)
                    put(start, end)
                    count -= 1
                if anew:
                    put(missed[u], hereafter[u])
            for i in range(loud):
                x, y, a, b = waves[i, 0], waves[i, 1], factors[i, 0], factors[i, 1]
                waves[i, 0], waves[i, 1] = x * a - y * b, x * b + y * a
            if tau >= duration:
                break
            tau, left = min(tau + step, duration), left - 1
            if duration - tau < 0.5 * step:
                tau = duration
        has_begun = True
    return np.array(stop)[1:], np.array(time)[1:], np.array(value)[1:], np.array(maximum)[1:]


@njit_inner()
def _loud(
    motion: Motion,
    s: int,
    tau: float,
    waves: FloatArray,
    rates: FloatArray,
    weights: FloatArray,
    missed: FloatArray,
) -> tuple[int, float]:
    """The terms that are not faint after a time: their number, and the largest spacing of points, s.

    The arrays are filled.  `waves` and `rates`, ``(K, 2)``, get real and imaginary parts of the terms of the rate at
    this time, and of their exponents.  `weights`, ``(U, K, 4)``, gets those of the weights, and of the products of
    weights and exponents.  `missed`, ``(U, 3)``, gets bounds on the fourth derivative of the rate at a place, and on
    the part of the faint terms in the rate and in its slope.
    """
    places, terms = motion.weights.shape[1], waves.shape[0]
    wave, sizes, total = complex_zeros(terms), zeros((terms, places)), zeros((places, 2))
    for u in range(places):
        missed[u, 0] = missed[u, 1] = missed[u, 2] = 0.0
    for k in range(terms):
        root = motion.rates[s, k]
        if root.real * tau < _GONE:
            continue
        wave[k] = motion.amplitudes[s, k] * root * np.exp(root * tau)
        size, speed = _size(wave[k]), _size(root)
        for u in range(places):
            sizes[k, u] = size * _size(motion.weights[s, u, k])
            total[u, 0] += sizes[k, u]
            total[u, 1] += sizes[k, u] * speed
            missed[u, 0] += sizes[k, u] * speed**4
    count = 0
    for k in range(terms):
        root, loud = motion.rates[s, k], False
        speed = _size(root)
        for u in range(places):
            loud |= sizes[k, u] > _FAINT * total[u, 0] or sizes[k, u] * speed > _FAINT * total[u, 1]
        if loud:
            waves[count, 0], waves[count, 1] = wave[k].real, wave[k].imag
            rates[count, 0], rates[count, 1] = root.real, root.imag
            for u in range(places):
                weight = motion.weights[s, u, k]
                weights[u, count, 0], weights[u, count, 1] = weight.real, weight.imag
                weight *= root
                weights[u, count, 2], weights[u, count, 3] = weight.real, weight.imag
            count += 1
        else:
            for u in range(places):
                missed[u, 1] += sizes[k, u]
                missed[u, 2] += sizes[k, u] * speed
    width = math.inf
    for u in range(places):
        if missed[u, 0] > 0:
            width = min(width, math.sqrt(math.sqrt(_MISSED / _OF_VALUE * total[u, 0] / missed[u, 0])))
    return count, width


@njit_inner()
def _size(x: complex) -> float:
    """|x|, faster than `abs`: no number here is so large or small that its square over- or underflows."""
    return math.sqrt(x.real**2 + x.imag**2)


@njit_inner()
def _vanishes(start: FloatArray, end: FloatArray, missed: FloatArray) -> int:
    """How often a rate vanishes between two points: 0, 1, or `_OPEN`.

    `start` and `end`, ``(3,)``, are the time, the rate and its slope at both points; `missed`, ``(3,)``, is filled by
    `_loud`.  Apart from the error of the cubic, the rate lies between the least and the largest Bernstein coefficient
    of the cubic, and it is monotone if these coefficients are.
    """
    way = end[0] - start[0]
    first, last = start[1], end[1]
    if missed[0] == 0.0 and first == 0.0 and last == 0.0:  # nothing moves a place that no gap function reads
        return 0
    second, third = first + way / 3 * start[2], last - way / 3 * end[2]
    bend = missed[0] * way**3
    # the rates at points of halving have the faint terms, the rates at the other points lack them
    of_value = _OF_VALUE * bend * way + missed[1] + way * missed[2]
    if min(first, second, third, last) > of_value or max(first, second, third, last) < -of_value:
        return 0
    of_slope = (_OF_SLOPE * bend + 2 * missed[2]) * way / 3 + missed[1]
    rises = min(second - first, third - second, last - third) > of_slope
    falls = max(second - first, third - second, last - third) < -of_slope
    if rises or falls:
        return 1 if _turns(first, last) else 0
    return _OPEN


@njit_inner()
def _turns(before: float, now: float) -> bool:
    """Whether a rate vanishes between two times."""
    return (before > 0 and now <= 0) or (before < 0 and now >= 0)


@njit_inner()
def _stationary(motion: Motion, s: int, u: int, start: FloatArray, end: FloatArray) -> tuple[float, float]:
    """Time at which the rate at a place vanishes between two points where its signs differ, s, and z there, m.

    `start` and `end`, ``(3,)``, are the time, the rate and its slope at both points.  Newton's method, kept between the
    points, begins at the zero of the cubic with these values.  With z1 to z4 the derivatives of z, its steps follow the
    series of the rate, where the series converges:

        step = x - c x^2 + (2 c^2 - d) x^3,    x = -z1 / z2,    c = z3 / (2 z2),    d = z4 / (6 z2)
    """
    a, b, rising = start[0], end[0], start[1] < 0
    width = b - a
    t = a + width * _vanishing(start[1], end[1], start[2] * width, end[2] * width)
    z = 0.0
    for _ in range(_STEPS):
        z, rate, bend, third, fourth = _derivatives(motion, s, u, t)
        if (rate > 0) == rising:
            b = t
        else:
            a = t
        step = -rate / bend if bend != 0.0 else math.inf
        error = abs(step)
        if abs(third * step) <= abs(bend) and abs(fourth * step * step) <= abs(bend):
            c, d = 0.5 * third / bend, fourth / (6 * bend)
            error *= _NEXT * max(abs(c * step), math.sqrt(abs(d)) * error) ** 3
            step *= 1 - step * (c - step * (2 * c * c - d))
        if not a <= t + step <= b:
            step = 0.5 * (a + b) - t
            error = abs(step)
        z += step * (rate + step / 2 * (bend + step / 3 * (third + step / 4 * fourth)))
        t += step
        if error <= _EXACT * width or b - a <= _EXACT * width:
            break
    return t, z


@njit_inner()
def _vanishing(before: float, now: float, before_slope: float, now_slope: float) -> float:
    """Estimate of the zero in (0, 1) of the cubic with these values and slopes at 0 and 1; the values' signs differ."""
    x = before / (before - now)
    low, high = 0.0, 1.0
    bend, twist = 3 * (now - before) - 2 * before_slope - now_slope, 2 * (before - now) + before_slope + now_slope
    for _ in range(_ABOUT):
        value = before + x * (before_slope + x * (bend + x * twist))
        slope = before_slope + x * (2 * bend + 3 * x * twist)
        if (value > 0) == (before < 0):
            high = x
        else:
            low = x
        x = x - value / slope if slope != 0.0 else low
        if not low < x < high:
            x = 0.5 * (low + high)
    return x


@njit_inner()
def _derivatives(motion: Motion, s: int, u: int, tau: float) -> tuple[float, float, float, float, float]:
    """z at a place, `tau` after the start of a segment, m, and its first four derivatives, m/s to m/s4."""
    one, two, three = motion.polynomial[s, u, 0], motion.polynomial[s, u, 1], motion.polynomial[s, u, 2]
    z, rate, bend, third, fourth = one + tau * (two + tau * three), two + 2 * tau * three, 2 * three, 0.0, 0.0
    for k in range(motion.rates.shape[1]):
        r = motion.rates[s, k]
        wave = motion.weights[s, u, k] * motion.amplitudes[s, k]
        if r.real * tau < _GONE or (wave.real == 0.0 and wave.imag == 0.0):
            continue
        wave *= np.exp(r * tau)
        z += wave.real
        wave *= r
        rate += wave.real
        wave *= r
        bend += wave.real
        wave *= r
        third += wave.real
        fourth += (wave * r).real
    return z, rate, bend, third, fourth
