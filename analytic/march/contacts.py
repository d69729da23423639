"""The contacts of a marched motion: from the switch that closes a stop to the one that opens it."""

from __future__ import annotations

import numpy as np

from analytic.march.coupled import damped_rows
from analytic.march.depths import depths
from analytic.march.energies import energies_of
from analytic.march.joint import Joint
from analytic.march.motion import Log
from analytic.march.tables import BoolArray, IntArray
from lapjoint.answers import Contact
from lapjoint.compiled.arrays import bool_zeros, int_zeros, zeros
from lapjoint.compiled.compiling import njit_called
from lapjoint.problem import FloatArray

_LEAST_SHARP = 1e-9
"""Rounding of an energy, relative to it, beyond which it is left to quadrature, which keeps about as many digits."""


def contacts_of(joint: Joint, log: Log) -> tuple[Contact, ...]:
    """All contacts, by start time, of a motion that was marched with ``depth=True``, which records penetrations.

    An energy is not a number where there is no closed form that keeps its digits.
    """
    stops, closed = joint.problem.structure.stops, joint.tables.closed[log.slot[0]]
    switched, areas, most = log.stop, log.area, log.deepest
    if joint.damped:
        closed, switched = closed[joint.force_rows], _force_switches(joint, log)
        areas, most = (np.ascontiguousarray(part[:, joint.force_rows]) for part in (areas, most))
    stop, rows, open_at, area, deepest = find_contacts(closed, switched, areas, most)
    start, end = log.start[rows[:, 0]], log.end[rows[:, 1]]
    stiffness = np.array([it.stiffness for it in stops])
    impulse = np.array([it.sign * it.stiffness for it in stops])[stop] * area
    order = np.lexsort((stop, start))
    columns = [stop, start, end, impulse, stiffness[stop] * deepest, open_at[:, 0], open_at[:, 1]]
    if joint.damped:
        energy = _energies(joint, log, closed, switched) - _stored(joint, log, stop, open_at)
        columns += [*np.full((3, stop.size), None), stiffness[stop] * energy]
    return tuple(map(Contact, *(column[order].tolist() for column in columns)))


def _energies(joint: Joint, log: Log, closed: BoolArray, switched: IntArray) -> FloatArray:
    """The integral of F d' / k over each contact, m2, ``(C,)``, in the order of `find_contacts`.

    It is not a number where sampled loads act, or rounding spoils it.
    """
    stops, damped = joint.problem.structure.stops, damped_rows(joint.problem)
    delay = np.array([0.0] * len(stops) + [stops[k].damping / stops[k].stiffness for k in damped.tolist()])
    energy, rounding = energies_of(joint.tables, log, delay)
    if joint.sampled:
        rounding[:, len(stops) :] = np.inf
    parts = (np.ascontiguousarray(part[:, joint.force_rows]) for part in (energy, rounding))
    _, _, _, total, most = find_contacts(closed, switched, *parts)
    return np.where(most > _LEAST_SHARP * np.abs(total), np.nan, total)


def _stored(joint: Joint, log: Log, stop: IntArray, open_at: BoolArray) -> FloatArray:
    """What the springs of damped stops store at a cut end of each contact less what they store at a cut start, over the
    stiffness, m2, ``(C,)``; `stop` and `open_at` are as in `find_contacts`.

    Where loads are sampled it is 0, because energies are left to quadrature.
    """
    cut = open_at & (np.array([it.damping for it in joint.problem.structure.stops]) > 0)[stop, None]
    if joint.sampled or not cut.any():
        return np.zeros(stop.size)
    first = depths(joint.tables, log.slot[0], log.start[0], log.q[0], log.v[0])
    last = depths(joint.tables, log.slot[-1], log.end[-1], log.q_end[-1], log.v_end[-1])
    return np.asarray((cut[:, 1] * last[stop] ** 2 - cut[:, 0] * first[stop] ** 2) / 2)


def _force_switches(joint: Joint, log: Log) -> IntArray:
    """The stop whose force begins or ends at the end of each of the ``M`` segments, or -1, shape ``(M,)``."""
    last = log.slot[-1] if log.stop[-1] < 0 else joint.tables.next_slot[log.slot[-1], log.stop[-1]]
    closed = joint.tables.closed[np.append(log.slot, last)][:, joint.force_rows]
    segment, stop = np.nonzero(closed[1:] != closed[:-1])
    switched = np.full(log.stop.size, -1)
    switched[segment[::-1]] = stop[::-1]
    return switched


@njit_called()
def find_contacts(
    closed: BoolArray, stop: IntArray, area: FloatArray, deepest: FloatArray
) -> tuple[IntArray, IntArray, BoolArray, FloatArray, FloatArray]:
    """The ``C`` contacts in a log of ``M`` segments, in the order of their ends.

    `closed`, ``(P,)``, says which stops are closed in the first segment; `stop`, ``(M,)``, which one switches at the
    end of each segment, negative for none; `area`, m s, and `deepest`, m, ``(M, P)``, are as in `Log`.  Returned are
    the stop of each contact, ``(C,)``; its first and last segment, ``(C, 2)``; whether it was there at the start
    already and is there at the end still, ``(C, 2)``; and its area, m s, and deepest penetration, m, ``(C,)``.
    """
    stops, room = closed.size, stop.size + closed.size
    which, rows, open_at = int_zeros(room), int_zeros((room, 2)), bool_zeros((room, 2))
    total, most, found = zeros(room), zeros(room), 0
    since, begun = int_zeros(stops), closed.copy()
    for k in range(stops):
        if not closed[k]:
            since[k] = -1
    so_far, depth = zeros(stops), zeros(stops)
    for i in range(stop.size):
        last = i == stop.size - 1
        for k in range(stops):
            if since[k] < 0:
                continue
            so_far[k] += area[i, k]
            depth[k] = max(depth[k], deepest[i, k])
            if stop[i] == k or last:
                which[found], rows[found, 0], rows[found, 1] = k, since[k], i
                open_at[found, 0], open_at[found, 1] = begun[k], stop[i] != k
                total[found], most[found] = so_far[k], depth[k]
                found += 1
        k = stop[i]
        if k >= 0:
            since[k] = i + 1 if since[k] < 0 else -1
            begun[k], so_far[k], depth[k] = False, 0.0, 0.0
    return which[:found], rows[:found], open_at[:found], total[:found], most[:found]
