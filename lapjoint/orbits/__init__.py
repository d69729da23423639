"""Periodic motions of any solver: found by Newton's method on its period map, judged, and certified."""

from lapjoint.orbits.period_map import Followed, Follows, Linearised, Passage, PeriodMap, Segment, Tangent
from lapjoint.orbits.search import Effort
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
