"""Periodic motions of any solver: found by Newton's method on its period map, judged, and certified.

A solver gives a `period_map` and, in `segments`, its orbits from switch to switch; `finite_differences` take the place
of a derivative that it does not give.  `half_periods` is the map over half periods.  `search` marches; it finds orbits
by `newton` and their `least_period`, tests by `approach` and `watch` (inner loops in `compiled_intervals` and
`compiled_watch`) whether the march is bound for one, and pushes a march off an `unstable` one.  `wandering` and
`exponent` judge a march that does not repeat.  `steady_state` makes an answer of the motion found, with errors by
`orbit_errors`, `contact_errors` and `refinement`.  `binding` finds the ends of many starts (`displaced`, `ensemble`,
`certified`, `trapping`).  For branches, `parameters` has derivatives by the excitation, and `arcs` motions with a given
contact sequence.
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
