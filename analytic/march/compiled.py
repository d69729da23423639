"""The compiled march: each contact state in closed form up to its first switch, then on in the next state.

`advance` marches to a given time, `analytic.march.carried.advance_periods` over whole periods, each as a march of its
own.  Both come back when they need something of Python: a switch that the tables do not know yet, or room in the log.
They change a `Motion` in place, so that a call with the same arguments goes on where the last one came back.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from analytic.march.ramp_segment import carry_ramps
from analytic.march.ramps import RampTables
from analytic.march.segment import NO_PROGRESS, NO_SWITCH, follow
from analytic.march.switching import Frozen, freeze, switch, switch_frozen
from analytic.march.tables import BoolArray, IntArray, Tables
from analytic.march.terms import set_phases
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import put
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

DONE, MISSING_SWITCH, LOG_FULL, TOO_MANY, STUCK = 0, 1, 2, 3, 4
"""Why a march came back: it is at its end; the tables lack a switch; the log has no room; there were too many switches;
a state took too many steps."""
SLOT, PENDING, SWITCHES, PERIODS = 0, 1, 2, 3
"""The entries of `Motion.counts`: the slot; the stop that has yet to switch now, or NO_SWITCH; the number of switches
made; the number of periods done."""
_FRESH = 1e-6
"""Time, over the unit of time, within which a stop that has switched must leave its gap, or pass a threshold of
rounding size, before it can switch again.  A switch is located to 1e-10 of the unit, and the shortest contacts found in
grazing series last 5e-4 of it."""


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
    """Time of each stop's last switch, s, ``(P,)``; if it lies ahead, the stop may not switch before."""
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
    """Whether each stop switched just now, shape ``(P,)``."""
    held: BoolArray
    """Whether each stop may not switch yet, shape ``(P,)``."""


@lru_cache(maxsize=64)
def no_log(modes: int, stops: int) -> Log:
    """A log without room, to which nothing is ever written; kept, so that calls with the same arguments share it."""
    return new_log(0, modes, stops)


def new_log(rows: int, modes: int, stops: int) -> Log:
    """A log with room for segments of so many modes and stops, not filled, as each row is written as a whole."""
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


@njit_inner()
def enter(tables: Tables, frozen: Frozen | None, ramps: RampTables | None, motion: Motion, work: Work) -> bool:
    """Let the pending stop switch, if there is one, and write the phases of this moment to `work.theta`.

    `frozen` is the published scheme's frozen shape, None for the present solver's rule, see `analytic.march.switching`;
    `ramps` are the sampled forces, if there are any, see `analytic.march.ramps`.  `motion` is changed in place.  False
    means that the tables do not know the switch, and then nothing has switched.
    """
    set_phases(tables, motion.time[0], work.theta)
    slot, stop = motion.counts[SLOT], motion.counts[PENDING]
    if stop >= 0:
        target = tables.next_slot[slot, stop]
        if target < 0:
            return False
        if frozen is None:
            switch(tables, slot, stop, work.theta, motion.q, motion.v)
        else:
            switch_frozen(tables, frozen, slot, target, motion.q, motion.v)
        if ramps is not None:
            carry_ramps(tables, ramps, slot, stop, motion.time[0], work.theta.size, motion.q, motion.v)
            ramps.goes_on[0] = False
        motion.counts[SLOT], motion.counts[PENDING] = target, NO_SWITCH
        motion.last_switch[stop] = motion.time[0]
    return True


@njit_inner()
def leave(
    tables: Tables,
    frozen: Frozen | None,
    ramps: RampTables | None,
    motion: Motion,
    work: Work,
    end: float,
    shortest: float,
    depth: bool,
) -> bool:
    """Follow the present state to its first switch, which is then pending, or to the time `end`, s, at the latest.

    The state may end between with no stop pending: along ramps at a knot, and where a stop that was held may switch
    again.  `motion`, with no stop pending, is changed in place.  `work` has the phases of this moment, and takes the
    areas and the deepest penetrations of the segment, the latter if `depth` is true.  No state but the last ends before
    it has lasted `shortest`, s; 0 for no such rule.  `depth` is an argument because a constant in the call would
    compile another function.  False means that the march makes no progress.
    """
    slot, t, last = motion.counts[SLOT], motion.time[0], end
    for k in range(work.fresh.size):
        work.fresh[k] = t - motion.last_switch[k] < _FRESH * tables.unit
        work.held[k] = t < motion.last_switch[k]
        if work.held[k]:
            end = min(end, motion.last_switch[k])
    if frozen is not None:
        freeze(tables, frozen, slot)
    fresh, held, theta, term, poly = work.fresh, work.held, work.theta, work.term, work.poly
    q, v, area, deepest = motion.q, motion.v, work.area, work.deepest
    found = follow(tables, ramps, slot, t, end, shortest, fresh, held, depth, theta, term, poly, q, v, area, deepest)
    motion.time[0], motion.counts[PENDING], motion.time[1] = found
    if ramps is not None and motion.time[0] == end < last:
        ramps.goes_on[0] = False  # the stops that were held are looked at as where a state begins
    return count_switch(motion, work)


@njit_inner()
def count_switch(motion: Motion, work: Work) -> bool:
    """Count the pending stop, and add the areas of the segment to the totals; False if the march makes no progress."""
    if motion.counts[PENDING] == NO_PROGRESS:
        motion.counts[PENDING] = NO_SWITCH
        return False
    if motion.counts[PENDING] != NO_SWITCH:
        motion.counts[SWITCHES] += 1
    for k in range(motion.total.size):
        motion.total[k] += work.area[k]
    return True


@njit_called()
def advance(
    tables: Tables,
    frozen: Frozen | None,
    ramps: RampTables | None,
    motion: Motion,
    work: Work,
    end: float,
    log: Log,
    depth: bool,
    shortest: float,
    most: int,
) -> tuple[int, int]:
    """March to the time `end`, s, switching from state to state; `motion` is changed in place.

    `log` takes every segment, if it has room at all.  `most` is the most switches in all, those that `motion` has made
    before included.  The other arguments are as in `enter` and `leave`.  Returned are the reason to come back, see
    `DONE`, and the number of segments logged.
    """
    room, logged = log.slot.size, 0
    while True:
        if not enter(tables, frozen, ramps, motion, work):
            return MISSING_SWITCH, logged
        if room > 0:
            if logged == room:
                return LOG_FULL, logged
            log.slot[logged], log.start[logged] = motion.counts[SLOT], motion.time[0]
            put(log.q[logged], motion.q)
            put(log.v[logged], motion.v)
        if not leave(tables, frozen, ramps, motion, work, end, shortest, depth):
            return STUCK, logged
        if room > 0:
            log.end[logged], log.stop[logged], log.rate[logged] = motion.time[0], motion.counts[PENDING], motion.time[1]
            put(log.q_end[logged], motion.q)
            put(log.v_end[logged], motion.v)
            put(log.area[logged], work.area)
            put(log.deepest[logged], work.deepest)
            logged += 1
        if motion.counts[PENDING] == NO_SWITCH and motion.time[0] >= end:
            return DONE, logged
        if motion.counts[SWITCHES] > most:
            return TOO_MANY, logged
