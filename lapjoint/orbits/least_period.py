"""The least period of an orbit: an orbit found over some half periods may repeat after fewer half periods.

Truncation to N modes can make the map discontinuous, with a jump of size c.  If a stable fixed point with multiplier mu
lies at the jump, Newton's method does not find it, and a march visits several points in turn, less than c / (1 - |mu|)
apart.  The march then seems to repeat after several periods only, which is an effect of truncation.  `_parted` tells
this march from a true motion of several periods.
"""

from __future__ import annotations

from lapjoint.orbits.half_periods import HalfPeriodMarch, HalfPeriods
from lapjoint.orbits.newton import Orbit, find_orbit

PARTED = 1e-3
"""Largest first step, divided by the size of the motion, between two of the points into which a jump of the map splits
a fixed point; later steps may be twice as long.  Over longer steps, a bend of the map cannot be told from a jump."""
_JUMP = 0.05
"""Largest error of the linearised map over a very short step of a smooth map, divided by the step."""
_BENDS = 500.0
"""Largest error of the linearised map over a step of a smooth map, divided by the step and by the previous step (as a
fraction of the size of the motion): a smooth map bends.  The larger of this error and `_JUMP` counts."""


def over_least_period(half_periods: HalfPeriods, orbit: Orbit) -> Orbit:
    """A stable orbit over the least number of half periods after which it repeats."""
    for count in range(half_periods.least, orbit.half_periods, half_periods.least):
        if orbit.half_periods % count:
            continue
        if half_periods.apart(half_periods.marched(orbit.point, count), orbit.point) > PARTED:
            continue
        shorter = find_orbit(half_periods, orbit.point, count, PARTED)
        if shorter is not None and shorter.stable and half_periods.apart(shorter.point, orbit.point) <= 10 * PARTED:
            return shorter
        parted = _parted(half_periods, orbit, count)
        if parted is not None:
            return parted
    return orbit


def _parted(half_periods: HalfPeriods, orbit: Orbit, count: int) -> Orbit | None:
    """The orbit over `count` half periods, if only a jump of the map keeps the motion from repeating so soon; else
    None.

    A step is the difference between the points after and before `count` half periods.  A jump is the reason if all
    steps are short and all multipliers lie within the unit circle, and yet some step is not the linearised map of the
    previous step.  The cause of the jump must show, too: each part of the motion has equally many switches of each
    stop, but in different orders.
    """
    map_, point = half_periods.map, orbit.point
    now = half_periods.linearised(point, count)
    step = map_.difference(now.end, point)
    first = residual = half_periods.relative(step, point)
    if not 0 < first <= PARTED:
        return None
    found = Orbit(count, point, first, now)
    if not found.stable:
        return None
    jumps, orders = False, [switch_order(now)]
    for _ in range(orbit.half_periods // count - 1):
        before, linearised = now.end, now.matrix @ step
        now = half_periods.linearised(before, count)
        step = map_.difference(now.end, before)
        orders.append(switch_order(now))
        bend, residual = max(_JUMP, _BENDS * residual), half_periods.relative(step, before)
        if not residual <= 2 * PARTED or step.shape != linearised.shape:
            return None
        jumps |= map_.norm(step - linearised) > bend * map_.norm(step)
    swapped = len(set(orders)) > 1 and len({tuple(sorted(order)) for order in orders}) == 1
    return found if jumps and swapped else None


def switch_order(found: HalfPeriodMarch) -> tuple[int, ...]:
    """The stops that switch during a march, in the order of time."""
    return tuple(segment.switched for segment in found.linearised.segments if segment.switched >= 0)
