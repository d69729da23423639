r"""The displacement at the stops along a recorded motion, and along its neighbours, as sums of exponentials.

Segments are those of `lapjoint.orbits.segments.Segment`: the free terms of the state come first, their weights in
kg^-1/2 and real but in coupled states, then the harmonics with lambda = i Omega.  Deviations (dq, dv) from the start of
the whole motion have the free terms alone, and a drift of undamped rigid-body modes.  The times at which segments begin
and end move too; the saltation matrices of `analytic.march.tangent` put these shifts into the deviations.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytic.march.linearised import carried_along
from analytic.march.march import March
from analytic.march.motion import Log
from analytic.march.oscillator import OSCILLATING, SPLIT
from analytic.march.tables import IntArray, Tables
from analytic.march.terms import drift_at_stops, set_phases, start_terms
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.orbits.segments import Segments
from lapjoint.problem import FloatArray


def gap_view(motion: March) -> Segments:
    """The segments of a recorded motion as sums of exponentials, in the order of time, with deviations."""
    outline, starts = outline_of(motion), carried_along(motion)
    (M, T, _), stops, n = outline.deviations.shape, outline.closed.shape[1], starts.shape[2]
    A, drift = np.empty((M, T, n), dtype=complex), np.zeros((M, stops, 2, n))
    _deviations(motion.joint.tables, motion.log.slot, starts, A, drift)
    return replace(outline, deviations=A, drift=drift)


def outline_of(motion: March) -> Segments:
    """The segments of a recorded motion as sums of exponentials, without the coordinates of deviations."""
    log, tables = motion.log, motion.joint.tables
    stops, harmonics = tables.sign.size, tables.omega.size
    free = tables.terms[log.slot]
    M, T = free.size, int(free.max())
    rates, amplitudes = np.zeros((2, M, T + harmonics), dtype=complex)
    weights, polynomial = np.zeros((M, stops, T + harmonics), dtype=complex), np.zeros((M, stops, 3))
    _outline(tables, log, rates, weights, amplitudes, polynomial)
    return Segments(
        start=log.start,
        end=log.end,
        closed=tables.closed[log.slot],
        terms=np.array((free + harmonics, free)).T,
        rates=rates,
        weights=weights,
        amplitudes=amplitudes,
        polynomial=polynomial,
        deviations=np.zeros((M, T, 0), dtype=complex),
        drift=np.zeros((M, stops, 2, 0)),
        switched=log.stop,
    )


@njit_called()
def _outline(
    tables: Tables,
    log: Log,
    rates: ComplexArray,
    weights: ComplexArray,
    amplitudes: ComplexArray,
    polynomial: FloatArray,
) -> None:
    """Write ``M`` segments: of the free terms of their states first, then of the harmonics.

    `rates` and `amplitudes` are ``(M, T + H)``, `weights` is ``(M, P, T + H)``, and `polynomial`, ``(M, P, 3)``, takes
    the coefficients of 1, tau, tau^2, as `lapjoint.orbits.segments.Segment` has them.
    """
    poly, at_positions = zeros((log.q.shape[1], 3)), zeros((tables.weight.shape[1], 3))
    theta = complex_zeros(tables.omega.size)
    for i in range(log.slot.size):
        slot = log.slot[i]
        free = tables.terms[slot]
        set_phases(tables, log.start[i], theta)
        start_terms(tables, slot, theta, log.q[i], log.v[i], amplitudes[i], poly)
        for t in range(free):
            rates[i, t] = tables.root[slot, t]
        for h in range(theta.size):
            rates[i, free + h], amplitudes[i, free + h] = complex(0.0, tables.omega[h]), theta[h]
        drift_at_stops(tables, slot, poly, at_positions)
        for k in range(tables.sign.size):
            u = tables.position[k]
            put(polynomial[i, k], at_positions[u])
            for t in range(free):
                weights[i, k, t] = tables.weight[slot, u, t]
                if tables.owner is not None:
                    weights[i, k, t] = complex(tables.weight[slot, u, t], tables.twist[slot, u, t])
            for h in range(theta.size):
                forced = tables.forced[slot, u, h]
                weights[i, k, free + h] = complex(forced.imag, -forced.real)


@njit_called()
def _deviations(tables: Tables, slots: IntArray, starts: FloatArray, A: ComplexArray, drift: FloatArray) -> None:
    """Write the parts of deviations in free terms, `A`, ``(M, T, n)``, and in rigid modes, `drift`, ``(M, P, 2, n)``.

    `slots`, ``(M,)``, holds the state of each segment, and `starts`, ``(M, 2 N, n)``, what `carried_along` gives.
    Terms that a state does not have become 0.
    """
    for i in range(slots.size):
        _deviation_terms(tables, slots[i], starts[i], A[i], drift[i])


@njit_inner()
def _deviation_terms(tables: Tables, slot: int, now: FloatArray, A: ComplexArray, drift: FloatArray) -> None:
    """The constants of (32) of deviations `now`, columns ``(2 N, m)`` of (dq, dv), that start in the state `slot`.

    `A`, shape ``(T, m)``, takes the free terms; `drift`, shape ``(P, 2, m)``, what rigid-body modes do at the stops.
    """
    n = tables.modes[slot]
    extra = n
    for i in range(n):
        kind, root = tables.kind[slot, i], tables.root[slot, i]
        if kind == OSCILLATING:
            inverse = 1 / root.imag  # a division takes as long as all the rest
            for j in range(now.shape[1]):
                x, y = now[i, j], now[n + i, j]
                A[i, j] = complex(x, (root.real * x - y) * inverse)
        elif kind == SPLIT:
            first, second = root.real, tables.root[slot, extra].real
            for j in range(now.shape[1]):
                x, y = now[i, j], now[n + i, j]
                A[i, j] = (y - second * x) / (first - second)
                A[extra, j] = (first * x - y) / (first - second)
            extra += 1
        else:
            for j in range(now.shape[1]):
                A[i, j] = 0.0
            for k in range(tables.sign.size):
                weight = tables.weight[slot, tables.position[k], i]
                by_rate = 0.0
                if tables.owner is not None:
                    weight = tables.gradient[slot, tables.position[k], 0, i]
                    by_rate = tables.gradient[slot, tables.position[k], 1, i]
                for j in range(now.shape[1]):
                    drift[k, 0, j] += weight * now[i, j] + by_rate * now[n + i, j]
                    drift[k, 1, j] += weight * now[n + i, j]
    for t in range(extra, A.shape[0]):
        for j in range(now.shape[1]):
            A[t, j] = 0.0
