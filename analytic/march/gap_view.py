r"""The displacement at the stops along a recorded motion, and along its neighbours, as sums of exponentials.

In a segment that starts at t0, with tau = t - t0, the displacement at stop s is

    z_s(t) = Re sum_t W[s, t] c[t] exp(lambda_t tau) + polynomial[s, 0] + polynomial[s, 1] tau + polynomial[s, 2] tau^2

over the free terms of the state first, then the harmonics, lambda = i Omega.  To first order in a deviation
e = (dq, dv) from the start of the whole motion it moves by

    dz_s(t) = Re sum_t W[s, t] (A e)[t] exp(lambda_t tau) + drift[s, 0] e + drift[s, 1] e tau

over the free terms alone, as long as both are in that segment's state.  The times at which segments begin and end move
too; that is in A, by the saltation matrices of `analytic.march.tangent`.  A number p of the problem moves it by

    dz_s(t)/dp = Re sum_t (B[s, t] + C[s, t] tau) exp(lambda_t tau) + E[s, 0] + E[s, 1] tau

where B and C have the free terms and the harmonics; see `analytic.march.change`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.change import Change, add_forced_change, forced_change
from analytic.march.compiled import Log
from analytic.march.linearised import Carried, carried_along
from analytic.march.march import March
from analytic.march.oscillator import OSCILLATING, SPLIT
from analytic.march.tables import BoolArray, Tables
from analytic.march.terms import drift_at_stops, set_phases, start_terms
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled_arrays import put, zeros
from lapjoint.compiling import njit_called, njit_inner
from lapjoint.orbits.period_map import SegmentChange
from lapjoint.problem import FloatArray


@dataclass(frozen=True, eq=False)
class GapSegment:
    """One segment: ``P`` stops, ``T`` terms of which ``T_free`` are free, deviations in ``n`` coordinates."""

    start: float
    """s."""
    end: float
    """s."""
    closed: BoolArray
    """Whether each stop is closed, shape ``(P,)``."""
    rates: ComplexArray
    """lambda of each term, 1/s, shape ``(T,)``."""
    weights: ComplexArray
    """W, shape ``(P, T)``: real for the free terms, kg^-1/2; complex for the harmonics, m."""
    amplitudes: ComplexArray
    """c, kg^1/2 m for the free terms, without unit for the harmonics, shape ``(T,)``."""
    polynomial: FloatArray
    """Coefficients of 1, tau, tau^2, m over powers of s, shape ``(P, 3)``."""
    deviation_amplitudes: ComplexArray
    """A, from (dq, dv) at the start of the whole motion, shape ``(T_free, n)``."""
    drift: FloatArray
    """Coefficients of 1 and tau that undamped rigid-body modes add to a deviation, shape ``(P, 2, n)``."""
    stop: int
    """The stop that switches at the end, or -1."""
    rate: float
    """h' of that stop there, m/s; 0 without one."""
    change: SegmentChange | None = None
    """B, C and E, over the number's unit; None without a number."""


def gap_view(motion: March) -> list[GapSegment]:
    """The segments of a recorded motion as sums of exponentials.

    Parameters
    ----------
    motion : March
        The motion, recorded.

    Returns
    -------
    list of GapSegment
        In the order of time.
    """
    return gap_view_of(carried_along(motion))


def gap_view_of(carried: Carried) -> list[GapSegment]:
    """The same of a motion along which deviations have been carried.

    Parameters
    ----------
    carried : Carried
        The motion, and its deviations.

    Returns
    -------
    list of GapSegment
        In the order of time.
    """
    motion, change, starts = carried.motion, carried.change, carried.starts
    log, tables = motion.log, motion.joint.tables
    n, stops, harmonics = starts.shape[2], tables.sign.size, tables.omega.size
    M, T = log.slot.size, int(tables.terms[log.slot].max())
    c, theta = np.zeros((M, T), dtype=complex), np.zeros((M, harmonics), dtype=complex)
    A, drift = np.zeros((M, T, n), dtype=complex), np.zeros((M, stops, 2, n))
    polynomial, forced = np.zeros((M, stops, 3)), np.zeros((M, stops, harmonics), dtype=complex)
    _view(tables, change, log, starts, c, theta, polynomial, A, drift, forced)
    at_stops = tables.weight[:, tables.position], -1j * tables.forced[:, tables.position]
    n = n if change is None else n - 1
    segments = []
    for i, slot in enumerate(log.slot):
        free = int(tables.terms[slot])
        by_number = None
        if change is not None:
            turning = 1j * change.omega * tables.omega * at_stops[1][slot] * theta[i]
            waves = np.zeros((stops, free + harmonics), dtype=complex)
            waves[:, :free] = at_stops[0][slot, :, :free] * A[i, :free, n]
            waves[:, free:] = -1j * forced[i] * theta[i] + log.start[i] * turning
            secular = np.zeros_like(waves)
            secular[:, free:] = turning
            slope = np.zeros((stops, 3))
            slope[:, :2] = drift[i, :, :, n]
            by_number = SegmentChange(waves, secular, slope)
        segments.append(
            GapSegment(
                start=float(log.start[i]),
                end=float(log.end[i]),
                closed=tables.closed[slot].copy(),
                rates=np.concatenate([tables.root[slot, :free], 1j * tables.omega]),
                weights=np.concatenate([at_stops[0][slot, :, :free], at_stops[1][slot]], axis=1),
                amplitudes=np.concatenate([c[i, :free], theta[i]]),
                polynomial=polynomial[i],
                deviation_amplitudes=A[i, :free, :n],
                drift=drift[i, :, :, :n],
                stop=int(log.stop[i]),
                rate=float(log.rate[i]) if log.stop[i] >= 0 else 0.0,
                change=by_number,
            )
        )
    return segments


@njit_called()
def _view(
    tables: Tables,
    change: Change | None,
    log: Log,
    starts: FloatArray,
    c: ComplexArray,
    theta: ComplexArray,
    polynomial: FloatArray,
    A: ComplexArray,
    drift: FloatArray,
    forced: ComplexArray,
) -> None:
    """Write the parts of ``M`` segments that depend on where each starts.

    Parameters
    ----------
    tables, change, log : Tables, Change or None, Log
        The states of the joint, how its harmonics change with a number, and the motion.
    starts : FloatArray, shape (M, 2 N, m)
        Deviations (dq, dv) at the start of each segment, as columns.
    c : ComplexArray, shape (M, T)
        Takes the amplitudes of the free terms.
    theta : ComplexArray, shape (M, H)
        Takes the amplitudes of the harmonics.
    polynomial : FloatArray, shape (M, P, 3)
        Takes the coefficients of 1, tau, tau^2.
    A : ComplexArray, shape (M, T, m)
        Takes what the deviations do to the free terms.
    drift : FloatArray, shape (M, P, 2, m)
        Takes what the deviations do to the rigid-body modes.
    forced : ComplexArray, shape (M, P, H)
        Takes the derivatives of the complex amplitudes of the forced motion at the stops, if there is a number.
    """
    poly, at_positions = zeros((log.q.shape[1], 3)), zeros((tables.weight.shape[1], 3))
    for i in range(log.slot.size):
        slot, now = log.slot[i], starts[i].copy()
        set_phases(tables, log.start[i], theta[i])
        start_terms(tables, slot, theta[i], log.q[i], log.v[i], c[i], poly)
        drift_at_stops(tables, slot, poly, at_positions)
        for k in range(tables.sign.size):
            put(polynomial[i, k], at_positions[tables.position[k]])
        if change is not None:
            add_forced_change(tables, change, slot, log.start[i], -1.0, now)
            for k in range(tables.sign.size):
                for h in range(tables.omega.size):
                    forced[i, k, h] = forced_change(tables, change, slot, tables.position[k], h)
        _deviation_terms(tables, slot, now, A[i], drift[i])


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
            for j in range(now.shape[1]):
                x, y = now[i, j], now[n + i, j]
                A[i, j] = complex(x, -(y - root.real * x) / root.imag)
        elif kind == SPLIT:
            first, second = root.real, tables.root[slot, extra].real
            for j in range(now.shape[1]):
                x, y = now[i, j], now[n + i, j]
                A[i, j] = (y - second * x) / (first - second)
                A[extra, j] = (first * x - y) / (first - second)
            extra += 1
        else:
            for k in range(tables.sign.size):
                weight = tables.weight[slot, tables.position[k], i]
                for j in range(now.shape[1]):
                    drift[k, 0, j] += weight * now[i, j]
                    drift[k, 1, j] += weight * now[n + i, j]
