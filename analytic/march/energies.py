r"""The energy that damped stops take from the beam, in closed form.

While a stop presses with the force F = k d + c d', it takes

    integral of F d' = k d e + c integral of d'^2,

where d is the mean of the penetrations at both ends, and e their difference.  The rate d' is a sum of exponentials, see
`analytic.march.coupled`.  With d' = Re sum_i b_i exp(r_i s),

    e = Re sum_i b_i g(r_i),    g(r) = (exp(r T) - 1) / r,
    integral of d'^2 = Re sum_ij (b_i b_j g(r_i + r_j) + b_i b_j* g(r_i + r_j*)) / 2,

where g is a series for small r T.  Near a double root the amplitudes are large and cancel: the energy comes with the
rounding of the sum, and where that is too large, `lapjoint.answers.dissipation` integrates by quadrature.
"""

from __future__ import annotations

import math

from analytic.march.motion import Log
from analytic.march.tables import Tables
from analytic.march.terms import drift_at_stops, set_phases, start_terms
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import complex_zeros, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

_SHORT = 0.1  # |r T| up to which g is summed as a series: above it, the difference keeps all digits but one
_SERIES = 12  # terms of that series: the next term is 0.1^12 / 13!, below any bit
_ROUNDING = 1e-15  # of a product of two amplitudes and g, relative: a few times that of a number


@njit_called()
def energies_of(tables: Tables, log: Log, delay: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The integral of F d' / k over each of ``M`` segments, m2, for each row of the tables, and its rounding: ``(M,
    P)``.

    They are 0 but for the rows of forces that act; `delay`, s, ``(P,)``, is c / k of these.  The rounding is infinite
    where rigid-body modes drift.
    """
    energy, rounding, most = zeros(log.area.shape), zeros(log.area.shape), tables.root.shape[1] + tables.omega.size
    if tables.owner is None:
        return energy, rounding
    theta, drift = complex_zeros(tables.omega.size), zeros((tables.constant.shape[1], 3))
    term, poly = complex_zeros(tables.root.shape[1]), zeros((tables.kind.shape[1], 3))
    rate, wave, speed = complex_zeros(most), complex_zeros(most), complex_zeros(most)
    for i in range(log.slot.size):
        slot, T, begun = log.slot[i], log.end[i] - log.start[i], False
        for row in range(tables.sign.size):
            if tables.owner[row] < 0 or not tables.closed[slot, row]:
                continue
            if not begun:
                set_phases(tables, log.start[i], theta)
                start_terms(tables, slot, theta, log.q[i], log.v[i], term, poly)
                drift_at_stops(tables, slot, poly, drift)
                begun = True
            u, own = tables.position[tables.owner[row]], tables.terms[slot]
            if drift[u, 1] != 0.0 or drift[u, 2] != 0.0:
                rounding[i, row] = math.inf
                continue
            before = drift[u, 0] - tables.sign[row] * tables.gap[row]
            change, sizes, count = 0.0, 0.0, own + theta.size
            for t in range(count):
                if t < own:
                    r, place = tables.root[slot, t], complex(tables.weight[slot, u, t], tables.twist[slot, u, t])
                    place *= term[t]
                else:  # the imaginary part of a harmonic is the real part of -i times it
                    r, place = complex(0.0, tables.omega[t - own]), tables.forced[slot, u, t - own] * theta[t - own]
                    place = complex(place.imag, -place.real)
                size, angle = math.exp(r.real * T), r.imag * T
                rate[t], wave[t] = r, complex(size * math.cos(angle), size * math.sin(angle))
                speed[t] = place * r
                before += place.real
                gone = speed[t] * _integral(r, wave[t], T)
                change += gone.real
                sizes += abs(gone)
            square, error = _square(rate, wave, speed, count, T)
            middle = before + change / 2
            energy[i, row] = middle * change + delay[row] * square
            rounding[i, row] = _ROUNDING * abs(middle) * sizes + delay[row] * error
    return energy, rounding


@njit_inner()
def _square(rate: ComplexArray, wave: ComplexArray, speed: ComplexArray, count: int, T: float) -> tuple[float, float]:
    """The integral over `T` seconds of the square of a sum of `count` exponentials, and its rounding.

    `rate`, 1/s, ``(count,)``, is that of each exponential, `wave` its value at the end, and `speed` its amplitude.
    """
    total, size = 0.0, 0.0
    for j in range(count):
        b = speed[j]
        modulus = math.sqrt(b.real * b.real + b.imag * b.imag)
        for side in (1.0, -1.0):  # times exponential j, and times its conjugate
            r, w = complex(rate[j].real, side * rate[j].imag), complex(wave[j].real, side * wave[j].imag)
            re, im, most = 0.0, 0.0, 0.0
            for i in range(j + 1):
                a, half = speed[i], 0.5 if i == j else 1.0  # all other pairs count twice
                area = a * _integral(rate[i] + r, wave[i] * w, T)
                re += half * area.real
                im += half * area.imag
                most += abs(area.real) + abs(area.imag)
            total += re * b.real - side * im * b.imag
            size += most * modulus
    return total, _ROUNDING * size


@njit_inner()
def _integral(rate: complex, wave: complex, T: float) -> complex:
    """The integral of exp(rate s) over `T` seconds, s; `wave` is exp(rate T)."""
    square = rate.real * rate.real + rate.imag * rate.imag
    if square * T * T > _SHORT * _SHORT:
        return (wave - 1.0) * complex(rate.real / square, -rate.imag / square)
    total, term = complex(T, 0.0), complex(T, 0.0)
    for n in range(2, _SERIES + 2):
        term *= rate * (T / n)
        total += term
    return total
