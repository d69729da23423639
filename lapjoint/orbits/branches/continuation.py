"""A branch of periodic motions followed from one of them: steps along the curve by its curvature, and across grazes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from lapjoint.orbits.branches.closing import Marks, Start, has_been_at, is_back_where_it_was
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.grazing import AT_GRAZE, across, leaves_at, slow_switch
from lapjoint.orbits.branches.jumping import WIDTHS, across_jump, jumped
from lapjoint.orbits.branches.locating import between_two
from lapjoint.orbits.branches.passings import Coming, Rates, coming, passed, rates_of
from lapjoint.orbits.branches.run import Graze, Jump, Limits, Run
from lapjoint.orbits.branches.stepping import WIDEST, at_boundary, bend_of, share_to_shorter, stepped
from lapjoint.problem import FloatArray

_FIRST, _LONGEST, _SHORTEST = 0.02, 0.25, 1e-7
"""Arc length of the first step, and of the longest and shortest: motions change by so much of their size."""
_SHARE = 0.1
"""Share of the length that a curve may have at most that its first step is."""
_TURN = 0.2
"""Angle between a step and the tangent at its end that is aimed at, rad: the curve is then known to some 1e-2 of a step
between its points."""
_GROWS = 2.5
"""By how much a step is lengthened at most: of longer ones, one in seven turns too far and is not taken."""
_RISES = 1.5
"""By how much what a step may be at most is raised after each, once one was not taken."""
_SHORTER = 1 / 3
"""By how much a step is shortened that is not taken."""
_SHORTEST_SHARE = 0.1
"""The same where the angle that is too wide says by how much."""
_AFRESH = 2e-3
"""Arc length of the first step after a graze."""
_AT_END = 1e-12
"""Distance from an end of the range, over the scale of the number, up to which a place is at it."""
_NOTHING = 1
"""Number of the widest of `WIDTHS`, 1e-5, that is next to nothing where a graze has been located before it."""
_LATELY = 1.0
"""Distance from such a part, over its width, within which another one is due to the same cause."""
_WHOLE = 2
"""Number of places that are added at most in a step: only the last one is kept as a whole."""
_FEW = 40
"""Number of places after such a part within which a curve that comes back to it folds there, or is led round."""
_KNOWN = 20
"""Number of places after which it is asked on which known branches the curve lies: on one twice in turn, it ends."""
_DISTINCT = 1e-4
"""Length of a step up to which grazes of several stops are taken as they come."""
_TOWARDS = 0.8
"""Share of the way to a graze, as the rates have it, that a step takes that is not to cross it."""
_CONFIRMED = 2.0
"""Largest ratio of the way to a graze and of what it was to be after the last step, at which it is looked for."""
_NEAR = 1e-3
"""Arc length to a graze within which it is looked for without that."""
_SURE = 0.5
"""Share of a step as long as the curve allows within which it is looked for without that, too."""
_SLOWER = 2.0
"""Largest ratio of the way to a graze and of what the rates had."""
_TRIES = 4
"""Number of steps that may be tried for each point that is allowed: in the hardest ranges known two are needed."""
_GRAZE_TRIES = 5
"""Number of steps that the search for a graze counts for, as it takes about as long."""
_TOO_NEAR = 1e-5
"""Arc length to a graze that cannot be located within which what lies around it is left out: from 1e-4, where the curve
turns before a graze, it is found from nearer in one of three cases."""
_TOLD = 1e-4
"""Least that a motion misses to repeat in half the time, over its size, by which it is told from one that does: beside
the bifurcation at which they part, what is left of a motion that does not close is the cube of this, and rounds."""
_TOLD_AT_FIRST = 0.1
"""The same over what the motion misses from which the branch is followed, where that is less: so near to where it
springs that a finer solver found it."""
_CLOSER, _MOST_CLOSER = 0.7, 8
"""Share of the way to a motion that repeats sooner that a step takes which would lead past it; most such in turn."""
_AT_LAST = 1.3
"""What the last motion before such a one misses, at most, over what tells the two apart."""
_UP_TO = (0.99, 0.995, 0.98, 0.95, 0.9)
"""Shares of the way to a motion that repeats sooner at which a curve ends if a graze lies between, in the sequence in
which they are tried: the number then lacks some 1e-4 of its way."""
_TRIED_AGAIN = 0.2
"""By how much nearer a graze must be that was not crossed, until it is tried again."""


def follow(family: Family, start: Place, limits: Limits) -> Run:
    """Follow a curve from a place, in the direction of its tangent.

    Parameters
    ----------
    family : Family
        The period maps.
    start : Place
        Where to begin.
    limits : Limits
        How far.

    Returns
    -------
    Run
        All places, with `start` as the first.
    """
    return _Follower(family, start, limits).run()


class _Follower:
    """A curve under way."""

    def __init__(self, family: Family, start: Place, limits: Limits) -> None:
        self._family, self._limits = family, limits
        self._places, self._grazes, self._jumps = [start], list[Graze](), list[Jump]()
        self._rates = rates_of(family, start)
        self._bend: FloatArray | None = None
        self._ceiling = _LONGEST
        self._refused = math.inf
        self._before_fold: Jump | None = None
        self._expected, self._closer = 0.0, 0
        self._end, self._tries, self._marches = "", 0, family.marches
        self._marks, self._looked, self._missed = Marks(family, start), 0, _missed(start)
        self._told = _TOLD if self._missed > _TOLD else _TOLD_AT_FIRST * self._missed
        self._asks, self._known = _KNOWN, frozenset[str]()
        self._until = None if limits.until is None else Start(family, limits.until, itself=True)
        self._step, self._length, self._measured = min(_FIRST, _SHARE * limits.length, limits.first), 0.0, 0

    def run(self) -> Run:
        """Follow it to its end."""
        if _outward(self._family, self._places[0]):
            self._end = "boundary"
        while not self._end:
            if self._spent:
                self._end = "effort"
            else:
                self._advance()
                self._look_back()
                if not self._end and self._limits.enough is not None and self._limits.enough(self._so_far):
                    self._end = "enough"
                if not self._end and self._goes_on_as_known():
                    self._end = "joins"
        return self._so_far

    @property
    def _so_far(self) -> Run:
        return Run(self._places, self._grazes, self._jumps, self._end)

    @property
    def _here(self) -> Place:
        return self._places[-1]

    @property
    def _spent(self) -> bool:
        """Whether it is as long as it may be."""
        most = self._limits.most
        if math.isfinite(self._limits.length):
            ways = (b.chord(self._family, a) for a, b in pairwise(self._places[self._measured :]))
            self._length += sum(float(np.linalg.norm(way)) for way in ways)
            self._measured = len(self._places) - 1
        if self._family.marches - self._marches >= self._limits.marches:
            return True
        return len(self._places) >= most or self._tries >= _TRIES * most or self._length >= self._limits.length

    def _goes_on_as_known(self) -> bool:
        """Whether the curve has gone along a branch that is known for some places."""
        if self._limits.known is None or len(self._places) < self._asks:
            return False
        before, self._known, self._asks = self._known, self._limits.known(self._here), len(self._places) + _KNOWN
        return not before.isdisjoint(self._known)

    def _look_back(self) -> None:
        """End the curve where it has come to its start, to a later mark, or to motions of the curve it springs from."""
        for i in range(self._looked, len(self._places) - 1):
            new = self._places[i + 1]
            there = None if self._until is None else self._until.between(self._places[i], new)
            if there is not None:
                self._end_at(i, there, "until")
                break
            if self._limits.enough is None and self._goes_round(i):
                break
            missed = _missed(new)
            if missed <= self._told < self._missed:
                self._end_at(i, None, "bifurcation")
                break
            self._missed = max(self._missed, missed)
        self._looked = len(self._places) - 1

    def _goes_round(self, i: int) -> bool:
        """Whether the curve comes back between two places, or was led back by a part left out; it ends there then."""
        connected = all(jump.index != i + 1 for jump in self._jumps)
        back = self._marks.come_back(self._places, i, connected)
        if back is None and connected:
            return False
        led_back = self._led_back(i) if back is None else self._jumped_back()
        if led_back is not None:
            self._end_at(led_back - 1, None, "lost")
        elif back is not None:
            self._end_at(*back, "closed")
        return led_back is not None or back is not None

    def _jumped_back(self) -> int | None:
        """The index of the first place beyond a part that was left out at which the curve has been before.

        Then that part did not lead there, and the curve has not closed.
        """
        for jump in self._jumps:
            if has_been_at(self._family, self._places[: jump.index], self._places[jump.index]):
                return jump.index
        return None

    def _led_back(self, i: int) -> int | None:
        """The index of the first place beyond a part left out from where the curve came back to before it, if it did.

        It would be left out again, and again.  Such a ring may be smaller than what tells two motions apart.
        """
        for jump in self._jumps:
            if i + 1 - _FEW <= jump.index <= i and is_back_where_it_was(
                self._family, self._places[: i + 1], jump.index
            ):
                return jump.index
        return None

    def _end_at(self, i: int, last: Place | None, why: str) -> None:
        """End the curve at a place that follows the one with number `i`, or at that."""
        self._places[i + 1 :] = [] if last is None else [last]
        self._grazes = [graze for graze in self._grazes if graze.index <= i]
        self._jumps = [jump for jump in self._jumps if jump.index <= i]
        self._end = why

    def _advance(self) -> None:
        """Take a step, or a shorter one next time; where none can be taken, go across what is in the way."""
        self._tries += 1
        soon = coming(self._here, self._rates)
        if soon is not None and soon.length <= self._step:
            expected, self._expected = self._expected, soon.length * (1 - _TOWARDS)
            confirmed = max(soon.length, expected) <= _CONFIRMED * min(soon.length, expected)
            if (confirmed or soon.length <= max(_NEAR, _SURE * self._step)) and self._cross(
                soon, _SLOWER * soon.length
            ):
                return
            if soon.length <= _TOO_NEAR and self._jump(self._widened()):
                return
            self._step = max(min(self._step, _TOWARDS * soon.length), 0.5 * _SHORTEST)
        new, angle = stepped(self._family, self._here, self._step, self._bend)
        if new is not None:
            rates = rates_of(self._family, new)
            seen = passed(self._here, self._rates, new, rates, self._step)
            if seen.nothing and (self._comes_closer_to_shorter(new) or self._take(new, rates, angle)):
                return
            if (len(seen.grazes) == 1 or (seen.grazes and self._step <= _DISTINCT)) and self._cross(
                seen.grazes[0], self._step
            ):
                return
        turned = angle > WIDEST  # not so if it is not known
        self._ceiling = max(_SHORTER * self._step, _AFRESH)
        self._step *= max(_TURN / angle, _SHORTEST_SHARE) if turned else _SHORTER
        if self._step < _SHORTEST and self._closer:
            self._end = "bifurcation"
        elif self._step < _SHORTEST:
            self._pass_what_is_near()

    def _cross(self, graze: Coming, farthest: float) -> bool:
        """Go across a graze, if it is the first and there is a motion beyond it; whether that was done."""
        if graze.length > self._refused:  # it is another one
            self._refused = math.inf
        if graze.length > _TRIED_AGAIN * self._refused:
            return False
        self._refused = graze.length
        self._tries += _GRAZE_TRIES
        found = across(self._family, self._here, graze, len(self._places))
        if found is None:
            return False
        before = found[0].before.place.going_on_from(self._here)
        chord = before.chord(self._family, self._here)
        length = float(np.linalg.norm(chord))
        if length > max(farthest, AT_GRAZE):
            return False
        if self._ends_at_shorter(before):
            return True
        if length > AT_GRAZE and float(chord @ before.tangent) < 0 and not self._turns_sharply(before):
            return False  # it lies behind
        if passed(self._here, self._rates, before, None, length).grazes:
            return False
        if not self._family.covers(found[0].value):
            return self._ends_at_boundary(before, found[0].value)
        if not found[1]:
            if self._jump_over(found[0], before):
                return True
            if not found[0].before.close:  # from nearer, there may be a motion beyond it
                return False
        self._pass(*found)
        return True

    def _turns_sharply(self, before: Place) -> bool:
        """Whether the curve comes to a graze from the other side, without a fold: where the map changes as a root.

        The number goes on as before, but the motion turns as soon as the root outweighs what is smooth.
        """
        here = self._here
        ahead = float(here.chord(self._family, before) @ here.tangent) < 0
        on = (before.value - here.value) * here.tangent[-1] > 0
        return ahead and on and before.tangent[-1] * here.tangent[-1] > 0

    def _jump_over(self, graze: Graze, before: Place) -> bool:
        """Leave out what lies just beyond a graze where the curve cannot be followed; whether that was done.

        If that is next to nothing, the branch persists at the graze.
        """
        self._places.append(before)
        if not (self._jump(0, past=True) or self._jump(self._widened())):
            self._places.pop()
            return False
        if self._end:
            return True
        self._resolve_at(replace(graze, before=replace(graze.before, place=before)))
        return True

    def _take(self, new: Place, rates: Rates, angle: float) -> bool:
        """Take a step to a place with the same contacts; whether that was done."""
        if not self._family.covers(new.value):
            return self._ends_at_boundary(new, new.value)
        if not (self._turned_back(new) and self._leave_out_more()):
            self._bend = bend_of(self._family, self._here, new)
            self._come_to(new, rates)
            grown = self._step * float(np.clip(_TURN / max(angle, 1e-9), 0.4, _GROWS))
            self._step, self._ceiling = min(grown, self._ceiling), min(_RISES * self._ceiling, _LONGEST)
        return True

    def _ends_at_boundary(self, new: Place, value: float) -> bool:
        """End the curve at the end of the range on the way to a place whose number leads out; whether it is found."""
        end = min(max(value, self._family.low), self._family.high)
        last = at_boundary(self._family, self._here, new, end)
        self._places += [] if last is None else [last]
        self._end = "" if last is None else "boundary"
        return last is not None

    def _comes_closer_to_shorter(self, beyond: Place) -> bool:
        """Whether a motion that repeats sooner lies before a place; then the next step is a shorter one, or the last.

        Beside it, the number changes as the square of the way, so that it is come to step by step.
        """
        here = self._here
        if here.missed is None or beyond.missed is None or not self._family.covers(beyond.value):
            return False
        missed, there = (float(np.linalg.norm(one)) for one in (here.missed, beyond.missed))
        share = share_to_shorter(self._family, here, beyond)
        if share is None and not there <= _TOLD < missed:  # else Newton's method came to such a motion itself
            return False
        self._closer += 1
        if missed <= _AT_LAST * _TOLD or self._closer > _MOST_CLOSER:
            self._end = "bifurcation"
        closer = min(_CLOSER, 1 - _AT_LAST * _TOLD / missed)
        way = 1.0 if share is None else share
        self._step = closer * way * float(np.linalg.norm(beyond.chord(self._family, here)))
        return True

    def _ends_at_shorter(self, beyond: Place) -> bool:
        """End the curve just before a motion that repeats sooner, if one lies between here and a place beyond."""
        here = self._here
        share = share_to_shorter(self._family, here, beyond)
        if share is None:
            return False
        length = float(np.linalg.norm(beyond.chord(self._family, here)))
        for part in _UP_TO:  # so near to where two curves meet, Newton's method may find neither
            last = between_two(self._family, here, beyond, part * share, length)
            if last is None or last.closings != here.closings:
                continue
            if last.missed is None or float(np.linalg.norm(last.missed)) <= _TOLD:
                continue
            if last.tangent[-1] * here.tangent[-1] > 0:  # else it is beyond, where the curve comes back
                self._places.append(last)
                break
        self._end = "bifurcation"
        return True

    def _pass(self, graze: Graze, beyond: tuple[Place, ...]) -> None:
        """Go across a graze, or end there."""
        if not self._family.covers(graze.value):
            if not self._ends_at_boundary(graze.before.place, graze.value):
                self._end = "lost"
            return
        before, ends = graze.before.place.going_on_from(self._here), False
        if not beyond:
            ends = leaves_at(self._family, graze.before, graze.rate)
            graze = replace(graze, kind="ends" if ends else "lost")
        graze = replace(graze, before=replace(graze.before, place=before.light()))
        self._refused = math.inf
        self._places.append(before)
        if not beyond and not ends and self._go_across_jump():
            self._resolve_at(graze)
            return
        self._grazes.append(graze)
        if not beyond:
            self._end = "graze" if ends else "lost"
        else:
            self._places += [one.light() for one in beyond[:-1]]
            self._come_to(beyond[-1])
            self._step, self._bend = max(self._step, _AFRESH), None

    def _resolve_at(self, graze: Graze) -> None:
        """Have the last part that was left out as a graze just before it, if that part is next to nothing."""
        before, here = graze.before.place, self._here
        if self._jumps[-1].width > _NOTHING or here.closings == before.closings:
            return
        self._jumps.pop()
        kind = "persists" if before.tangent[-1] * here.tangent[-1] > 0 else "folds"
        self._grazes.append(replace(graze, kind=kind))

    def _come_to(self, place: Place, rates: Rates | None = None) -> None:
        """Go on from a place; of those before, the motion between switches is not needed any more."""
        for i in range(max(len(self._places) - _WHOLE, 0), len(self._places)):
            self._places[i] = self._places[i].light()
        self._places.append(place)
        self._closer = 0
        if self._limits.progress is not None:
            self._limits.progress(self._share())
        self._rates = rates_of(self._family, place) if rates is None else rates

    def _share(self) -> float:
        """Share of the range, or of the effort, that is behind."""
        way = abs(self._here.value - self._places[0].value) / (self._family.high - self._family.low)
        most = self._limits.most
        return min(1.0, max(way, len(self._places) / most, self._tries / (_TRIES * most)))

    def _near_grazes(self) -> Iterator[Coming | None]:
        """The graze at which an extremum vanishes, and that at which a switch does, each found when it is asked for."""
        yield coming(self._here, self._rates)
        yield slow_switch(self._family, self._here)

    def _pass_what_is_near(self) -> None:
        """Go across the graze that is so near that no step leads past it, or leave out what cannot be resolved."""
        passed: tuple[Graze, tuple[Place, ...]] | None = None
        for soon in self._near_grazes():
            there = None if soon is None else across(self._family, self._here, soon, len(self._places))
            if there is not None and there[1]:
                self._pass(*there)
                return
            passed = there or passed
        if self._jump(self._widened()):
            return
        if passed is not None:
            self._pass(*passed)
        elif not self._go_across_jump():
            self._end = "lost"

    def _widened(self) -> int:
        """Number of the width from which on a part is left out: wider than others just before, of the same cause."""
        here = self._here.value
        lately = [one.width for one in self._jumps if abs(here - one.last) <= _LATELY * abs(one.last - one.first)]
        return min(max(lately, default=-1) + 1, len(WIDTHS) - 1)

    def _go_across_jump(self) -> bool:
        """Go on from the motion next to this one beyond a jump of the map; whether there is one."""
        beyond = across_jump(self._family, self._here)
        if beyond is None:
            return False
        share = abs(beyond.value - self._here.value) / self._family.scale(beyond.value)
        self._leave_out(beyond, int(np.searchsorted(WIDTHS[:-1], share)))
        self._before_fold = self._jumps[-1]
        return True

    def _jump(self, width: int, *, past: bool = False) -> bool:
        """Leave out a part that cannot be resolved, of some width or more; whether there is a motion beyond it.

        One that is to lead `past` a graze is next to nothing, or there is none.
        """
        found = jumped(self._family, self._places, width)
        if found is None or (past and (found[1] > _NOTHING or self._has_contacts_of(found[0]))):
            return False
        beyond, width = found
        if share_to_shorter(self._family, self._here, beyond) is not None:
            self._end = "bifurcation"
            return True
        self._leave_out(beyond, width)
        return True

    def _has_contacts_of(self, other: Place) -> bool:
        return other.closings == self._here.closings

    def _leave_out(self, beyond: Place, width: int) -> None:
        """Go on from a motion beyond a part that is not resolved."""
        self._jumps.append(Jump(self._here.value, beyond.value, len(self._places), width))
        self._come_to(beyond)
        self._step, self._bend = _AFRESH, None

    def _turned_back(self, new: Place) -> bool:
        """Whether the curve comes back, soon after a part that was left out, to where that begins: it folds there."""
        if not self._jumps or len(self._places) - self._jumps[-1].index >= _FEW:
            return False
        last = self._jumps[-1]
        if last is self._before_fold:
            return False
        return (new.value - last.last) * (last.last - last.first) < 0

    def _leave_out_more(self) -> bool:
        """Leave out a wider part instead of the last one; whether there is a motion beyond it.

        If there is none, the curve has a fold just beyond that part, and goes on.
        """
        places, grazes, last = self._places, self._grazes, self._jumps.pop()
        self._places = places[: last.index]
        self._grazes = [graze for graze in grazes if graze.index < last.index]
        if self._jump(last.width + 1):
            self._marks.forget_from(last.index)
            self._looked = min(self._looked, last.index - 1)
            return True
        self._places, self._grazes, self._before_fold = places, grazes, last
        self._jumps.append(last)
        return False


def _outward(family: Family, place: Place) -> bool:
    """Whether a place lies at an end of the range, and its tangent points out of it."""
    out = family.high if place.tangent[-1] > 0 else family.low
    return abs(place.value - out) <= _AT_END * family.scale(place.value)


def _missed(place: Place) -> float:
    """Size of what a motion misses to repeat in half the time; 1 where there is no such motion."""
    return 1.0 if place.missed is None else float(np.linalg.norm(place.missed))
