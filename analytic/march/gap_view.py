r"""The displacement at the stops along a recorded motion, and along its neighbours, as sums of exponentials.

What `lapjoint.orbits.segments.Segment` asks for: the free terms of the state come first, their weights real and in
kg^-1/2, then the harmonics with lambda = i Omega.  Deviations (dq, dv) from the start of the whole motion have the free
terms alone; what undamped rigid-body modes add to them is the drift.  The times at which segments begin and end move
too; that is in the deviations, by the saltation matrices of `analytic.march.tangent`.  A number p of the problem moves
the free terms and the harmonics, see `analytic.march.change`.
"""

from __future__ import annotations

import numpy as np

from analytic.march.change import Change, add_forced_change, forced_change
from analytic.march.compiled import Log
from analytic.march.linearised import Carried, carried_along
from analytic.march.march import March
from analytic.march.oscillator import OSCILLATING, SPLIT
from analytic.march.tables import Tables
from analytic.march.terms import drift_at_stops, set_phases, start_terms
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled_arrays import complex_zeros, put, zeros
from lapjoint.compiling import njit_called, njit_inner
from lapjoint.orbits.segments import SegmentChange, Segments
from lapjoint.problem import FloatArray


def gap_view(motion: March) -> Segments:
    """The segments of a recorded motion as sums of exponentials.

    Parameters
    ----------
    motion : March
        The motion, recorded.

    Returns
    -------
    Segments
        In the order of time.
    """
    return gap_view_of(carried_along(motion))


def outline_of(motion: March) -> Segments:
    """The same without deviations.

    Parameters
    ----------
    motion : March
        The motion, recorded.

    Returns
    -------
    Segments
        In the order of time; deviations have no coordinates.
    """
    none = np.zeros((motion.log.slot.size, 2 * motion.joint.tables.kind.shape[1], 0))
    return gap_view_of(Carried(motion, None, none, none[0]))


def gap_view_of(carried: Carried) -> Segments:
    """The same of a motion along which deviations have been carried.

    Parameters
    ----------
    carried : Carried
        The motion, and its deviations.

    Returns
    -------
    Segments
        In the order of time.
    """
    motion, change, starts = carried.motion, carried.change, carried.starts
    log, tables = motion.log, motion.joint.tables
    count, stops, harmonics = starts.shape[2], tables.sign.size, tables.omega.size
    free = tables.terms[log.slot]
    M, T = free.size, int(free.max())
    rates, amplitudes = np.zeros((2, M, T + harmonics), dtype=complex)
    weights, waves, secular = np.zeros((3, M, stops, T + harmonics), dtype=complex)
    polynomial, slope = np.zeros((2, M, stops, 3))
    A, drift = np.empty((M, T, count), dtype=complex), np.zeros((M, stops, 2, count))
    _view(tables, change, log, starts, rates, weights, amplitudes, polynomial, A, drift, waves, secular)
    n = count if change is None else count - 1
    if change is not None:
        slope[:, :, :2] = drift[:, :, :, n]
    return Segments(
        start=log.start,
        end=log.end,
        closed=tables.closed[log.slot],
        terms=np.stack([free + harmonics, free], axis=1),
        rates=rates,
        weights=weights,
        amplitudes=amplitudes,
        polynomial=polynomial,
        deviations=A[:, :, :n],
        drift=drift[:, :, :, :n],
        switched=log.stop,
        change=None if change is None else SegmentChange(waves, secular, slope),
    )


@njit_called()
def _view(
    tables: Tables,
    change: Change | None,
    log: Log,
    starts: FloatArray,
    rates: ComplexArray,
    weights: ComplexArray,
    amplitudes: ComplexArray,
    polynomial: FloatArray,
    A: ComplexArray,
    drift: FloatArray,
    waves: ComplexArray,
    secular: ComplexArray,
) -> None:
    """Write the parts of ``M`` segments.

    Parameters
    ----------
    tables, change, log : Tables, Change or None, Log
        The states of the joint, how its harmonics change with a number, and the motion.
    starts : FloatArray, shape (M, 2 N, m)
        Deviations (dq, dv) at the start of each segment, as columns.
    rates, amplitudes : ComplexArray, shape (M, T + H)
        Take those of the free terms of its state, and after these of the harmonics.
    weights : ComplexArray, shape (M, P, T + H)
        Takes those of the same terms.
    polynomial : FloatArray, shape (M, P, 3)
        Takes the coefficients of 1, tau, tau^2.
    A : ComplexArray, shape (M, T, m)
        Takes what the deviations do to the free terms, and zeros for terms that a state does not have.
    drift : FloatArray, shape (M, P, 2, m)
        Takes what the deviations do to the rigid-body modes.
    waves, secular : ComplexArray, shape (M, P, T + H)
        Take what the number does to the same terms at the stops, if there is one; see `SegmentChange`.
    """
    poly, at_positions = zeros((log.q.shape[1], 3)), zeros((tables.weight.shape[1], 3))
    theta = complex_zeros(tables.omega.size)
    for i in range(log.slot.size):
        slot, now = log.slot[i], starts[i].copy()
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
            for h in range(theta.size):
                forced = tables.forced[slot, u, h]
                weights[i, k, free + h] = complex(forced.imag, -forced.real)
        if change is not None:
            add_forced_change(tables, change, slot, log.start[i], -1.0, now)
        _deviation_terms(tables, slot, now, A[i], drift[i])
        if change is not None:
            _changed_terms(tables, change, slot, log.start[i], theta, A[i], waves[i], secular[i])


@njit_inner()
def _changed_terms(
    tables: Tables,
    change: Change,
    slot: int,
    start: float,
    theta: ComplexArray,
    A: ComplexArray,
    waves: ComplexArray,
    secular: ComplexArray,
) -> None:
    """What a number does to the terms at the stops, ``(P, K)``, in a segment that starts at a time.

    Its part in the free terms is in the last column of `A`, ``(T, m)``; `theta`, ``(H,)``, are the phases at the start.
    """
    free, last = tables.terms[slot], A.shape[1] - 1
    for k in range(tables.sign.size):
        u = tables.position[k]
        for t in range(free):
            waves[k, t] = tables.weight[slot, u, t] * A[t, last]
        for h in range(theta.size):
            rise = change.omega * tables.omega[h] * tables.forced[slot, u, h] * theta[h]
            slope = forced_change(tables, change, slot, u, h) * theta[h]
            waves[k, free + h] = complex(slope.imag, -slope.real) + start * rise
            secular[k, free + h] = rise


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
                for j in range(now.shape[1]):
                    drift[k, 0, j] += weight * now[i, j]
                    drift[k, 1, j] += weight * now[n + i, j]
    for t in range(extra, A.shape[0]):
        for j in range(now.shape[1]):
            A[t, j] = 0.0
