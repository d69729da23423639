"""Where a march is, its scratch arrays, and the log of its segments, as flat arrays that compiled functions change."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from analytic.march.tables import BoolArray, IntArray, Tables
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.by_reference import by_reference
from lapjoint.problem import FloatArray

SLOT, PENDING, SWITCHES, PERIODS = 0, 1, 2, 3
"""Indices of `Motion.counts`: the slot; the stop that has yet to switch now, or NO_SWITCH; the number of switches made;
the number of periods done."""
NO_SWITCH = -1  # in place of a stop: no stop switches before the end
NO_PROGRESS = -2  # in place of a stop: the steps ran out


@by_reference
class Log(NamedTuple):
    """Room for ``M`` segments of a motion, one row each: ``N`` modes, ``P`` stops."""

    slot: IntArray
    """The state, shape ``(M,)``."""
    start: FloatArray
    """When each segment starts, s, shape ``(M,)``."""
    end: FloatArray
    """When each segment ends, s, shape ``(M,)``."""
    q: FloatArray
    """Modal displacements at the start, kg^1/2 m, shape ``(M, N)``."""
    v: FloatArray
    """Modal velocities at the start, kg^1/2 m/s, shape ``(M, N)``."""
    q_end: FloatArray
    """Modal displacements at the end, before the switch, kg^1/2 m, shape ``(M, N)``."""
    v_end: FloatArray
    """Modal velocities at the end, before the switch, kg^1/2 m/s, shape ``(M, N)``."""
    stop: IntArray
    """The stop that switches at the end, or NO_SWITCH, shape ``(M,)``."""
    rate: FloatArray
    """h' of the stop that switches, m/s, shape ``(M,)``."""
    area: FloatArray
    """Time integral of the penetration of each closed stop, m s, shape ``(M, P)``."""
    deepest: FloatArray
    """Deepest penetration of each closed stop, m, shape ``(M, P)``."""


@by_reference
class Motion(NamedTuple):
    """Where a march is, changed in place: ``N`` modes, ``P`` stops."""

    counts: IntArray
    """Slot, pending stop, switches and periods, shape ``(4,)``; see `SLOT`."""
    time: FloatArray
    """The time, s, and h' of the pending stop, m/s, shape ``(2,)``."""
    q: FloatArray
    """Modal displacements, kg^1/2 m, shape ``(N,)``."""
    v: FloatArray
    """Modal velocities, kg^1/2 m/s, shape ``(N,)``."""
    last_switch: FloatArray
    """Time of each stop's last switch, s, ``(P,)``.  If it is later than the present time, the stop may not switch
    before it."""
    total: FloatArray
    """Time integral of each stop's penetration, m s, shape ``(P,)``."""


@by_reference
class Work(NamedTuple):
    """Scratch arrays of a march."""

    theta: ComplexArray
    """exp(i theta_h), shape ``(H,)``."""
    term: ComplexArray
    """c_t exp(lambda_t s) of each term, kg^1/2 m, shape ``(2 N,)``."""
    poly: FloatArray
    """Coefficients of 1, s, s^2 of each mode, kg^1/2 m over powers of s, shape ``(N, 3)``."""
    deepest: FloatArray
    """Deepest penetration of each closed stop in the last segment, m, shape ``(P,)``."""
    area: FloatArray
    """Time integral of the penetration of each closed stop in the last segment, m s, shape ``(P,)``."""
    fresh: BoolArray
    """Whether each stop has just switched, shape ``(P,)``; see `analytic.march.compiled`."""
    held: BoolArray
    """Whether each stop may not switch yet, shape ``(P,)``."""


@lru_cache(maxsize=64)
def no_log(modes: int, stops: int) -> Log:
    """A log without room, to which nothing is ever written; cached, so that calls with the same arguments share it."""
    return new_log(0, modes, stops)


def new_log(rows: int, modes: int, stops: int) -> Log:
    """A log with room for `rows` segments of `modes` modes and `stops` stops, uninitialised: each row is written as a
    whole."""
    return Log(
        slot=np.empty(rows, dtype=np.int64),
        start=np.empty(rows),
        end=np.empty(rows),
        q=np.empty((rows, modes)),
        v=np.empty((rows, modes)),
        q_end=np.empty((rows, modes)),
        v_end=np.empty((rows, modes)),
        stop=np.empty(rows, dtype=np.int64),
        rate=np.empty(rows),
        area=np.empty((rows, stops)),
        deepest=np.empty((rows, stops)),
    )


def new_motion(slot: int, start: float, q: FloatArray, v: FloatArray, modes: int, stops: int) -> Motion:
    """A march at its beginning at `start`, s, from modal displacements and velocities `q` and `v`, ``(n,)``.

    There is room for `modes` modes, at least ``n``.  Every stop counts as one that has switched just then.
    """
    motion = Motion(
        counts=np.array([slot, NO_SWITCH, 0, 0], dtype=np.int64),
        time=np.array([start, 0.0]),
        q=np.zeros(modes),
        v=np.zeros(modes),
        last_switch=np.zeros(stops),
        total=np.zeros(stops),
    )
    motion.q[: q.size], motion.v[: v.size] = q, v
    motion.last_switch[:] = start
    return motion


def new_work(tables: Tables) -> Work:
    """Scratch arrays for marches on these tables, filled with zeros."""
    modes, stops = tables.kind.shape[1], tables.sign.size
    return Work(
        theta=np.zeros(tables.omega.size, dtype=complex),
        term=np.zeros(2 * modes, dtype=complex),
        poly=np.zeros((modes, 3)),
        deepest=np.zeros(stops),
        area=np.zeros(stops),
        fresh=np.zeros(stops, dtype=np.bool_),
        held=np.zeros(stops, dtype=np.bool_),
    )
