"""The compiled march: each contact state in closed form up to its first switch, then on in the next state.

`advance` marches to a given time, `analytic.march.carried.advance_periods` over whole periods, each as a march of its
own.  Both come back when they need something of Python: a switch that the tables do not know yet, or room in the log.
They change a `Motion` in place, so that a call with the same arguments goes on where the last one came back.
"""

from __future__ import annotations

from analytic.march.motion import NO_PROGRESS, NO_SWITCH, PENDING, SLOT, SWITCHES, Log, Motion, Work
from analytic.march.ramp_segment import carry_ramps
from analytic.march.ramps import RampTables
from analytic.march.segment import follow
from analytic.march.switching import Frozen, freeze, switch, switch_frozen
from analytic.march.tables import Tables
from analytic.march.terms import set_phases
from lapjoint.compiled.arrays import put
from lapjoint.compiled.compiling import njit_called, njit_inner

DONE, MISSING_SWITCH, LOG_FULL, TOO_MANY, STUCK = 0, 1, 2, 3, 4
"""Why a march returned: it is at its end; the tables lack a switch; the log has no room; there were too many switches;
a state took too many steps."""
_FRESH = 1e-6
"""Time, as a fraction of the unit of time, after a switch of a stop in which the stop counts as fresh: it must leave
its gap, or pass a threshold of rounding size, before it can switch again.  A switch is located to 1e-10 of the unit,
and the shortest contacts found in grazing series last 5e-4 of it."""


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
        if tables.owner is not None:
            for row in range(tables.owner.size):
                if tables.owner[row] == stop:
                    motion.last_switch[row] = motion.time[0]
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
        work.held[k] = work.held[k] or tables.asleep[slot, k]
    if frozen is not None:
        freeze(tables, frozen, slot)
    follow(tables, ramps, motion, work, end, shortest, depth)
    if ramps is not None and motion.time[0] == end < last:
        ramps.goes_on[0] = False  # the stops that were held are looked at as where a state begins
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
