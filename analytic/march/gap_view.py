r"""The displacement at the stops along a recorded motion, and along its neighbours, as sums of exponentials.

What `lapjoint.orbits.segments.Segment` asks for: the free terms of the state come first, their weights real and in
kg^-1/2, then the harmonics with lambda = i Omega.  Deviations (dq, dv) from the start of the whole motion have the free
terms alone; what undamped rigid-body modes add to them is the drift.  The times at which segments begin and end move
too; that is in the deviations, by the saltation matrices of `analytic.march.tangent`.  A number p of the problem moves
the free terms and the harmonics, see `analytic.march.change`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytic.march.change import Change, changes_of_answers, forced_change
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
    return with_deviations(outline_of(motion), carried_along(motion))


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


def with_deviations(outline: Segments, carried: Carried) -> Segments:
    """A motion with the deviations that have been carried along it.

    Parameters
    ----------
    outline : Segments
        `outline_of` the motion.
    carried : Carried
        The motion, and its deviations.

    Returns
    -------
    Segments
        In the order of time; but for deviations the arrays of the outline.  Of those segments alone of which the
        deviations have been kept.
    """
    log, tables, change = carried.motion.log, carried.motion.joint.tables, carried.change
    (M, _, count), first = carried.starts.shape, carried.first
    if M < len(outline):
        outline = outline.part(first, first + M)
    (_, stops, K), T = outline.weights.shape, outline.deviations.shape[1]
    waves, secular = np.zeros((2, M, stops, K), dtype=complex)
    A, drift = np.empty((M, T, count), dtype=complex), np.zeros((M, stops, 2, count))
    _deviations(tables, change, log, first, carried.starts, A, drift, waves, secular)
    if change is None:
        return replace(outline, deviations=A, drift=drift)
    n, slope = count - 1, np.zeros((M, stops, 3))
    slope[:, :, :2] = drift[:, :, :, n]
    return replace(
        outline, deviations=A[:, :, :n], drift=drift[:, :, :, :n], change=SegmentChange(waves, secular, slope)
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
    """Write the parts of ``M`` segments.

    Parameters
    ----------
    tables, log : Tables, Log
        The states of the joint, and the motion.
    rates, amplitudes : ComplexArray, shape (M, T + H)
        Take those of the free terms of its state, and after these of the harmonics.
    weights : ComplexArray, shape (M, P, T + H)
        Takes those of the same terms.
    polynomial : FloatArray, shape (M, P, 3)
        Takes the coefficients of 1, tau, tau^2.
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
            for h in range(theta.size):
                forced = tables.forced[slot, u, h]
                weights[i, k, free + h] = complex(forced.imag, -forced.real)


@njit_called()
def _deviations(
    tables: Tables,
    change: Change | None,
    log: Log,
    first: int,
    starts: FloatArray,
    A: ComplexArray,
    drift: FloatArray,
    waves: ComplexArray,
    secular: ComplexArray,
) -> None:
    """Write what deviations do in ``M`` segments that follow each other.

    Parameters
    ----------
    tables, change, log : Tables, Change or None, Log
        The states of the joint, how its harmonics change with a number, and the motion.
    first : int
        Index of the first of these.
    starts : FloatArray, shape (M, 2 N, m)
        `Carried.starts`.
    A : ComplexArray, shape (M, T, m)
        Takes what the deviations do to the free terms, and zeros for terms that a state does not have.
    drift : FloatArray, shape (M, P, 2, m)
        Takes what the deviations do to the rigid-body modes.
    waves, secular : ComplexArray, shape (M, P, T + H)
        Take what the number does to the same terms at the stops, if there is one; see `SegmentChange`.
    """
    theta, changes = complex_zeros(tables.omega.size), complex_zeros((0, 0, 0))
    if change is not None:
        changes = changes_of_answers(tables, change, log.slot)
    for i in range(starts.shape[0]):
        slot, start = log.slot[first + i], log.start[first + i]
        _deviation_terms(tables, slot, starts[i], A[i], drift[i])
        if change is not None:
            set_phases(tables, start, theta)
            _changed_terms(tables, change, changes, slot, start, theta, A[i], waves[i], secular[i])


@njit_inner()
def _changed_terms(
    tables: Tables,
    change: Change,
    changes: ComplexArray,
    slot: int,
    start: float,
    theta: ComplexArray,
    A: ComplexArray,
    waves: ComplexArray,
    secular: ComplexArray,
) -> None:
    """What a number does to the terms at the stops, ``(P, K)``, in a segment that starts at a time.

    Its part in the free terms is in the last column of `A`, ``(T, m)``; `theta`, ``(H,)``, are the phases at the
    start, and `changes`, ``(S, H, N)``, `changes_of_answers`.
    """
    free, last = tables.terms[slot], A.shape[1] - 1
    for k in range(tables.sign.size):
        u = tables.position[k]
        for t in range(free):
            waves[k, t] = tables.weight[slot, u, t] * A[t, last]
        for h in range(theta.size):
            rise = change.omega * tables.omega[h] * tables.forced[slot, u, h] * theta[h]
            slope = forced_change(tables, change, changes, slot, u, h) * theta[h]
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
