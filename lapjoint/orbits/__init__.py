"""Periodic motions of any solver: found by Newton's method on its period map, judged, and certified.

**Input.**  A solver gives a `period_map` and, in `segments`, its orbits from switch to switch; a switch is the opening
or closing of a stop.  If a solver gives no derivative, `finite_differences` are taken.  `half_periods` is the map over
half periods.

**Steady states.**  `search` marches, and finds orbits by `newton` and their `least_period`.  By `approach` and `watch`
(inner loops in `compiled_intervals` and `compiled_watch`) it tests whether the march is bound for an orbit, which means
certain to converge to it.  It pushes a march off an `unstable` orbit.  `wandering` and `exponent` judge a march that
does not repeat.  `steady_state` makes an answer of the motion found, with errors by `orbit_errors`, `contact_errors`
and `refinement`.  `binding` finds the ends of many starts (`displaced`, `ensemble`, `certified`, `trapping`).

**Branches.**  `parameters` has derivatives by the excitation, `arcs` motions with a given contact sequence, and
`compiled_extrema` the extrema of gap functions, at which motions graze.  `branches` follows them.
"""

from lapjoint.orbits.period_map import Followed, Follows, Linearised, Passage, PeriodMap, Tangent
from lapjoint.orbits.search import Effort
from lapjoint.orbits.segments import Segment
from lapjoint.orbits.steady_state import find_steady_state

__all__ = [
    "Effort",
    "Followed",
    "Follows",
    "Linearised",
    "Passage",
    "PeriodMap",
    "Segment",
    "Tangent",
    "find_steady_state",
]
