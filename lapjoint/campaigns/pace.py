"""An early message on how long a sweep will take, if its first points are of the costliest kind."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

from lapjoint.files.plain_text import duration_text

LOGGER = logging.getLogger(__name__)
FEW = 4
"""Number of points, after the first, whose times give the pace; the time of the first point includes compiling."""
MANY = 64
"""Number of points after which the message is not given: progress shows the pace by then."""
WORTH_SAYING = 60.0
"""Remaining time below which the message is not given, s: a shorter wait needs no warning."""


@dataclass
class Pace:
    """Looks at points as they are delivered, and says once how long the others will take if most of them do not
    repeat."""

    noun: str
    """Name of the work in the message."""
    clock: Callable[[], float] = time.monotonic
    _since: float | None = field(default=None, init=False)
    _after: int = field(default=0, init=False)
    _seen: int = field(default=0, init=False)
    _wandering: int = field(default=0, init=False)
    _told: bool = field(default=False, init=False)

    def take(self, points: Iterable[Any], left: int) -> None:
        """Take answers that have just been found, and the number of cells that are left; answers that are not points
        are ignored."""
        multiples = [point.period_multiple for point in points if hasattr(point, "period_multiple")]
        now = self.clock()
        self._seen += len(multiples)
        self._wandering += multiples.count(0)
        if self._since is None:
            self._since, self._after = now, self._seen
            return
        found = self._seen - self._after
        if self._told or found < FEW or self._seen > MANY or 2 * self._wandering <= self._seen:
            return
        each = (now - self._since) / found
        if each * left >= WORTH_SAYING:
            self._told = True
            LOGGER.info(
                f"{self.noun}: {self._wandering} of the first {self._seen} points do not repeat, which takes longest "
                f"to establish: {each:.2g} s a point at this pace, {duration_text(each * left)} for the other {left}"
            )
