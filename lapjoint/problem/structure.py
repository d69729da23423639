"""The joint without its excitation and its initial state: the part shared by all problems of a sweep over these two."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

from lapjoint.problem.beam import Beam
from lapjoint.problem.damping import Damping
from lapjoint.problem.supports_and_stops import Stop, Support

_KEPT = 64
"""Number of structures that are cached: problems of one campaign mostly share one."""


@dataclass(frozen=True, eq=False)
class Structure:
    """A beam with its supports, stops and damping.

    Equal ones are one object as long as it is cached: caches keyed by it need not compare its parts.
    """

    beam: Beam
    supports: tuple[Support, ...]
    stops: tuple[Stop, ...]
    damping: Damping

    def __reduce__(self) -> tuple[object, ...]:
        return structure_of, (self.beam, self.supports, self.stops, self.damping)


@lru_cache(maxsize=_KEPT)
def structure_of(beam: Beam, supports: tuple[Support, ...], stops: tuple[Stop, ...], damping: Damping) -> Structure:
    """The structure of these parts: one object for equal parts, as long as it is cached."""
    return Structure(beam, supports, stops, damping)
