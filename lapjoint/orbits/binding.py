"""The ends of many starts: each start is bound to a certified motion, or found not to be bound to any.

All starts march together.  From time to time each march is compared with every known motion.  A start is *bound* to a
motion if its march is certain to converge to the motion: if the deviation is certain to decay
(`lapjoint.orbits.trapping`), and the next step is that of the linearised map (`lapjoint.orbits.search.as_linearised`).
Closeness alone is not enough.

A start that is not bound after some time is marched alone by `lapjoint.orbits.search`.  A motion that this search
finds, and its mirror image, are known from then on, and the other starts continue together.  If the march does not
settle, its outcome is that of the search: quasi-periodic, aperiodic or undecided.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from lapjoint.answers.steady_state import Outcome, SectionPoint
from lapjoint.errors import SolverError
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.certified import CertifiedMotion, certified, mirrored_motion, same_motion, traps_of
from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.orbits.ensemble import Ensemble, ensemble_of
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import Orbit
from lapjoint.orbits.period_map import PeriodMap, decay_periods
from lapjoint.orbits.search import FIRST_LOOK, FIRST_LOOK_NEAR, Effort, SteadyStateSearch, as_linearised
from lapjoint.orbits.trapping import Trap
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

_STRIDE = 4
"""Least number of periods between two comparisons; later the interval is an eighth of the periods marched, so that
comparisons cost little."""
_PATIENCE = 64
"""Least number of periods after which a start that is not bound is searched alone."""
_DECAY_TIMES = 8.0
"""Least time before a start is searched alone, in decay times of the slowest free vibration: exp(-8) = 3e-4 of a
transient is then left."""


@dataclass(frozen=True)
class StartEnd:
    """The end of a start."""

    motion: int | None
    """Index of the certified motion to which the start is bound; None if it is not bound."""
    outcome: Outcome | None
    """Kind of motion in which the start ends; None if the march failed."""
    periods: int
    """Excitation periods marched until the end was established."""
    pushes: int = 0
    """Number of times that the march was pushed off an unstable motion, which it could not leave by itself."""
    message: str = ""
    """Message of a march that failed; empty for other marches."""


class Binder:
    """The known motions of one problem, to which starts are bound; the growth of deviations is not measured."""

    def __init__(self, period_map: PeriodMap, effort: Effort, motions: Iterable[CertifiedMotion] = ()) -> None:
        self._map, self._effort, self._half_periods = period_map, effort, HalfPeriods(period_map)
        self.motions: list[CertifiedMotion] = []
        """The motions, in the order in which they became known."""
        self._traps: list[tuple[int, Trap]] = []
        for motion in motions:
            self._take(motion)

    def again(self) -> Binder:
        """A copy that knows the present motions; motions that the copy finds later are not added to the original."""
        other = Binder(self._map, self._effort)
        other.motions, other._traps = list(self.motions), list(self._traps)
        return other

    @in_one_thread
    def ends(self, starts: Sequence[SectionPoint], progress: Progress | None = None) -> list[StartEnd]:
        """The end of each start; motions that are found on the way are added to `motions`.

        `progress` is called with the number of starts that have ended, and of all.
        """
        group = _StartGroup(ensemble_of(self._map, starts), len(starts))
        while group.marching.size:
            self._march(group, group.marched + self._patience)
            found = False
            while group.marching.size and not found:
                found = self._search(group, int(group.marching[0]))
                if progress is not None:
                    progress(len(starts) - group.marching.size, len(starts))
        return [end for end in group.ends if end is not None]

    @property
    def _patience(self) -> int:
        """Periods that starts march together before one of them is searched alone."""
        most = max(1, self._effort.max_periods // 2)
        return min(max(_PATIENCE, decay_periods(self._map, _DECAY_TIMES, most)), most)

    def _march(self, group: _StartGroup, until: int) -> None:
        """March all starts together up to a number of periods, and bind the starts that a known motion traps."""
        until = min(until, self._effort.max_periods)
        while self._traps and group.marching.size:
            self._bind(group)
            left = until - group.marched
            if left <= 0:
                break
            group.march(group.marching, min(max(_STRIDE, group.marched // 8), left))

    def _bind(self, group: _StartGroup) -> None:
        """Bind the starts that a known motion traps: first by its linearised map, then by the next step."""
        for motion, trap in self._traps:
            orbit, which = trap.orbit, group.marching
            if not which.size:
                return
            before = group.ensemble.deviations(which, orbit.point)
            held = trap.holds(before)
            which, before = which[held], before[held]
            if not which.size:
                continue
            which, before = group.stepped(which, before, self.motions[motion].period_multiple)
            after = group.ensemble.deviations(which, orbit.point)
            for j, i in enumerate(which.tolist()):
                if as_linearised(self._half_periods, orbit, before[j], partial(after.__getitem__, j)):
                    group.end(i, motion, self.motions[motion].outcome)

    def _search(self, group: _StartGroup, i: int) -> bool:
        """Search one start alone from its present point; return whether the search found a new motion."""
        left = max(self._effort.max_periods - group.periods(i), 1)
        effort = Effort(self._effort.max_period_multiple, left, self._effort.max_switches, growth=False)
        first_look = FIRST_LOOK_NEAR if group.periods(i) else FIRST_LOOK
        try:
            found = SteadyStateSearch(self._map, effort).run(group.ensemble.point(i), min(first_look, left))
        except SolverError as error:
            group.fail(i, str(error))
            return False
        accepted, motion = found.acceptance, found.motion
        group.count(i, accepted.periods)
        if not isinstance(motion, Orbit):
            group.end(i, None, motion.outcome, accepted.pushes)
            return False
        before = len(self.motions)
        index = self._take(certified(self._half_periods, motion))
        group.end(i, index, self.motions[index].outcome, accepted.pushes)
        return len(self.motions) > before

    def _take(self, motion: CertifiedMotion) -> int:
        """The index of a motion; a new motion is added with its mirror image."""
        for i, known in enumerate(self.motions):
            if same_motion(self._half_periods, motion, known):
                return i
        image = mirrored_motion(self._half_periods, motion)
        index = len(self.motions)
        for one in (motion,) if image is None else (motion, image):
            self._traps += [(len(self.motions), trap) for trap in traps_of(self._half_periods, one)]
            self.motions.append(one)
        return index


class _StartGroup:
    """Starts that march together, and the known ends of starts."""

    def __init__(self, ensemble: Ensemble, count: int) -> None:
        self.ensemble = ensemble
        self.ends: list[StartEnd | None] = [None] * count
        self.marching: IndexArray = np.arange(count)
        """The starts without a known end."""
        self.marched = 0
        """Number of periods that all starts without an end have marched together."""
        self._more: IndexArray = np.zeros(count, dtype=np.intp)
        """Number of periods that each start has marched alone, in addition to `marched`."""

    def periods(self, i: int) -> int:
        """Periods that a start has marched."""
        return self.marched + int(self._more[i])

    def march(self, which: IndexArray, periods: int) -> None:
        """March some starts, and count the periods for all starts without an end."""
        failed = self.ensemble.march(which, periods)
        self.marched += periods
        for i, message in failed.items():
            self.fail(i, message)

    def stepped(self, which: IndexArray, before: FloatArray, periods: int) -> tuple[IndexArray, FloatArray]:
        """March some starts alone; return the starts whose march did not fail, and their rows of `before`."""
        failed = self.ensemble.march(which, periods)
        self._more[which] += periods
        for i, message in failed.items():
            self.fail(i, message)
        kept = np.array([i not in failed for i in which.tolist()], dtype=np.bool_)
        return which[kept], before[kept]

    def count(self, i: int, periods: int) -> None:
        """Count periods that a search has marched."""
        self._more[i] += periods

    def fail(self, i: int, message: str) -> None:
        """End a start whose march failed."""
        self.end(i, None, None, message=message)

    def end(self, i: int, motion: int | None, outcome: Outcome | None, pushes: int = 0, message: str = "") -> None:
        """Give a start its end."""
        self.ends[i] = StartEnd(motion, outcome, self.periods(i), pushes, message)
        self.marching = self.marching[self.marching != i]
