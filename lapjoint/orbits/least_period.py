"""The least period of an orbit: an orbit found over some half periods may repeat after a part of them.

Truncated modes can make the map discontinuous, with a jump of size c.  At a jump Newton's method misses a stable motion
with multiplier mu, and a march visits several points, less than c / (1 - |mu|) apart, one after the other.  No motion
of a joint does this.  `_parted` tells such a march from a true motion of several periods.
"""

from __future__ import annotations

from lapjoint.orbits.half_periods import HalfPeriodMarch, HalfPeriods
from lapjoint.orbits.newton import Orbit, find_orbit

PARTED = 1e-3
"""Largest first step between two of the points into which a jump of the map splits one point, as a fraction of the
size of the motion; later steps may be twice as long.  Along longer steps it cannot be told whether the map bends or
jumps."""
_JUMP = 0.05
"""Fraction of a step by which the linearised map of a smooth map may miss a very short step."""
_BENDS = 500.0
"""Fraction of a step by which the linearised map of a smooth map may miss, divided by the length of the step before (as
a fraction of the size of the motion): a smooth map bends.  The larger of this fraction and `_JUMP` counts."""


def over_least_period(half_periods: HalfPeriods, orbit: Orbit) -> Orbit:
    """The motion of a stable orbit over the fewest half periods after which it repeats."""
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
    """The orbit over `count` half periods, if the motion would repeat after these but for a jump of the map; else None.

    It would if the steps are short, all multipliers lie within the unit circle, and yet some step is not the step
    before it carried by the linearised map.  The cause must show, too: in all parts of the motion the same stops switch
    equally often, but in different orders.
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
    """The stops that switch in a march, in the order of time."""
    return tuple(segment.switched for segment in found.linearised.segments if segment.switched >= 0)
