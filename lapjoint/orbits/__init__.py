"""Periodic motions of any solver: found by Newton's method on its period map, judged, and certified.

`period_map` is what a solver gives, `segments` its orbits from switch to switch, `finite_differences` what it need not
give; `half_periods` is the map over half periods.  `search` marches, and asks the others: `newton` for orbits,
`least_period` for their least period, `approach` and `watch` (inner loops in `compiled_intervals` and `compiled_watch`)
whether the march is bound for one, `unstable` how it leaves an unstable one, `wandering` and `exponent` what a march
shows that does not repeat.  `steady_state` makes an answer of what was found; `parameters` has the numbers of the
excitation; `arcs` is what a solver gives to continue motions with a given contact sequence.
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
