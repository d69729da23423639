"""A search for branches: starts first, then the branches of the motions that they lead to.

Several branches may be followed at the same time, ahead of what has been taken.  Motions that lie on a branch that is
known are left out, by the sequence of the motions and not of the work; so neither the number of workers nor an
interruption changes what is found, or in what sequence.

Branches that spring from one branch often come together, or are one that springs there twice: a fifth of the work on
the diagram of a lightly damped joint was done twice.  So each waits for those before it while there is other work, the
likeliest longest, and is left to them where it goes on as one of them.  One that was followed before they were known,
and is in part one of them, is followed once more; so is one that was left in part to another which is left out itself.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Container, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from lapjoint.campaigns.branch_overlap import Known, may_lie_on, own_parts
from lapjoint.campaigns.branch_parts import is_known, solve_branch, solve_start
from lapjoint.campaigns.branch_plan import BranchPlan
from lapjoint.solver import Progress

_BESIDE = ("joins", "asked", "probes")
"""What of a branch depends on which others were known when it was followed."""
_FAR = 4
"""Difference of numbers from which on two motions of those that spring from one branch hardly are of one: of 110 that
were, 60 were neighbours, 22 the next but one, and nine the one after that."""


@dataclass(frozen=True)
class Part:
    """A part of the work, that one process does."""

    value: int
    """Number of the value of the second number."""
    number: int
    """Number of the start, or of the motion among all that are found at this value."""
    seed: Mapping[str, Any] | None = None
    """The motion whose branch is followed, as `lapjoint.campaigns.branch_parts.plain_seed` gives it; or None."""
    others: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    """The branches on which parts of it may lie, as `lapjoint.campaigns.branch_overlap.Known` takes them."""
    again: int = 0
    """How often it has been done with other ones."""

    @cached_property
    def name(self) -> str:
        """What the journal calls it."""
        own = f"{'start' if self.seed is None else 'branch'} {self.number}" + ", again" * self.again
        return f"value {self.value}: {own}" if self.value else own

    def solved(self, plan: BranchPlan, progress: Progress | None = None) -> dict[str, Any]:
        """What it comes to.

        Parameters
        ----------
        plan : BranchPlan
            The plan, of all values.
        progress : callable, optional
            Called with the share of a branch that is followed, and with one.

        Returns
        -------
        dict of str to Any
            As `solve_start` or `solve_branch` gives it.
        """
        own = plan.at(self.value)
        if self.seed is None:
            return solve_start(own, self.number)
        share = None if progress is None else lambda share: progress(share, 1.0)
        return solve_branch(own, self.seed, share, Known(own, self.others))


@dataclass(frozen=True)
class Diagram:
    """All that a search has found at one value of the second number."""

    branches: Sequence[dict[str, Any]]
    """The branches, as `lapjoint.campaigns.branch_parts.solve_branch` gives them, in sequence."""
    failures: Sequence[str] = ()
    """Why starts, or motions that were found, or branches that spring from others, could not be followed."""
    left_out: int = 0
    """Number of motions whose branches were not followed, as the effort was spent."""


@dataclass(frozen=True)
class _Motion:
    """A motion whose branch is to be followed."""

    seed: dict[str, Any]
    """As `lapjoint.campaigns.branch_parts.plain_seed` gives it."""
    parent: int | None = None
    """Number of the part whose branch it springs from; None if a start leads to it."""
    number: int = 0
    """Number of its own part."""

    def may_share_its_branch_with(self, other: _Motion) -> bool:
        """Whether one branch may have both: most starts lead to the same few, and many spring at two bifurcations."""
        return self.parent == other.parent and self.seed["count"] == other.seed["count"]

    def faces(self, other: _Motion) -> bool:
        """Whether both lead from where they spring towards where the other does: a third of such neighbours are one."""
        if "away" not in self.seed or "away" not in other.seed:
            return False
        mine, its = float(self.seed["away"][0]), float(other.seed["away"][0])
        here, there = float(self.seed["value"]), float(other.seed["value"])
        return (here - mine) * (its - mine) > 0 and (there - its) * (mine - its) > 0


class Search:
    """The search at one value of the second number.

    Parameters
    ----------
    plan : BranchPlan
        The plan, of all values.
    value : int
        Number of the value.
    ahead : int
        Number of branches that may be under way, be it that some of them wait for a worker.
    at_once : int
        Number of branches that can be followed at the same time: so many are under way if there are any.
    """

    def __init__(self, plan: BranchPlan, value: int, ahead: int, at_once: int) -> None:
        self._plan, self._value, self._ahead, self._at_once = plan.at(value), value, ahead, at_once
        self._waiting = deque[_Motion]()
        self._open = deque[Part]()
        self._motions: dict[str, _Motion] = {}
        """The motions of open parts, by their names."""
        self._held = set[str]()
        """Names of open parts that wait for those before them, as they may lie on the same branches."""
        self._asked: dict[tuple[str, str], bool] = {}
        """Whether the motion of one part lies on the branch of another, by their names."""
        self._dropped = set[str]()
        """Names of held parts that lie on a branch that has been followed, and so will not be followed themselves."""
        self._taken: dict[str, dict[str, Any]] = {}
        """The branches that have been taken, by the names of their parts."""
        self._seen = 0
        self._begun = False
        self._points = 0
        """Number of points of these, each counted by its period multiple."""
        self._counted: dict[str, int] = {}
        """The same of branches that were done before it was their turn, by the names of their parts."""
        self._failures: list[str] = []
        self._over: list[Mapping[str, Any]] = []

    @property
    def diagram(self) -> Diagram:
        """What is found so far."""
        seeds = (*self._over, *(one.seed for one in self._waiting))
        left_out = sum(not self._is_known(seed) for seed in seeds) if self._spent else 0
        return Diagram(list(self._taken.values()), self._failures, left_out)

    def go_on(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """Take what has been found, and give what can be done next.

        Parameters
        ----------
        found : mapping of str to dict
            What parts have come to, by their names; also of those that were done by an earlier run.

        Returns
        -------
        list of Part
            Parts that have not been given before; none of them is among `found`.
        """
        new: list[Part] = []
        while True:
            while self._open and self._open[0].name in found:
                part = self._open.popleft()
                self._held.discard(part.name)
                self._take(part, found)
            opened = self._released(found) or self._next(found) or self._so_as_not_to_idle(found)
            if not opened and not (self._open and self._open[0].name in found):
                return [self._with_others(part, found) for part in new if part.name not in found]
            new += opened

    def _is_as_if_all_were_known(self, part: Part, one: Mapping[str, Any], found: Mapping[str, dict[str, Any]]) -> bool:
        """Whether a branch is what it is beside all those before it that spring from the same one and were taken."""
        if not self._taken.keys() >= set(one["joins"]):
            return False
        others = [name for name in self._akin(part) if name in self._taken and name not in one["asked"]]
        return not others or not (one["joins"] or any(may_lie_on(self._plan, one, found[name]) for name in others))

    def _akin(self, part: Part) -> list[str]:
        """The names of all parts before one whose branches may have motions in common with its own, in sequence."""
        mine = self._motions[part.name]
        akin = [(one.number, name) for name, one in self._motions.items() if mine.may_share_its_branch_with(one)]
        return [name for number, name in sorted(akin) if number < part.number]

    def _with_others(self, part: Part, found: Mapping[str, dict[str, Any]]) -> Part:
        """A part with the branches on which it may lie in part: those that were taken, and those that may be."""
        if part.seed is None:
            return part
        names = self._taken.keys() | {one.name for one in self._open if one.name in found} - self._dropped
        curves = {name: found[name] for name in self._akin(part) if name in names and "values" in found[name]}
        return replace(part, others={name: _curve_of(one) for name, one in curves.items()})

    def _released(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """Open parts that were held, and for which nothing that comes earlier is to be waited for any more."""
        while self._open and self._open[0].name in self._held:  # all before it is taken
            part = self._open[0]
            assert part.seed is not None
            self._held.remove(part.name)
            if not self._spent and not self._lies_on_one_of(part, self._taken):
                return [part]
            self._open.popleft()
            self._over += [part.seed] if self._spent else []
        free, before, room = list[Part](), list[Part](), self._room_beside(found)
        for part in self._open:
            if len(free) >= room:
                break
            if part.name in self._held and not self._may_be_known(part, before, found):
                self._held.remove(part.name)
                free.append(part)
            before.append(part)
        return free

    def _so_as_not_to_idle(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """An open part that is held, if too few are under way: one that is hardly on the branch of an earlier one."""
        under_way = self._under_way(found)
        held = [part for part in self._open if part.name in self._held and part.name not in self._dropped]
        if not held or len(under_way) >= self._at_once or not self._room_beside(found):
            return []
        left = {part.name for part in self._open if part.name not in found} - self._dropped
        far = (part for part in held if self._apart(part, under_way) >= _FAR)
        part = next((part for part in far if not self._leads_to_the_one_before(part, left)), None) or max(
            held, key=lambda one: (not self._leads_to_the_one_before(one, left), self._apart(one, under_way))
        )
        self._held.remove(part.name)
        return [part]

    def _apart(self, part: Part, others: Iterable[Part]) -> float:
        """Least difference of a part's number and those of others whose branches may be its own."""
        mine, motions = self._motions[part.name], (self._motions[other.name] for other in others)
        akin = (other for other in motions if mine.may_share_its_branch_with(other))
        return min((abs(mine.number - other.number) for other in akin), default=math.inf)

    def _leads_to_the_one_before(self, part: Part, left: Container[str]) -> bool:
        """Whether a part faces the last one before it that may be on its branch and is left to be followed.

        `left` has the names of those.
        """
        before = [name for name in self._akin(part) if name in left]
        return bool(before) and self._motions[part.name].faces(self._motions[before[-1]])

    def _next(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """Parts to be opened: all starts; or branches, as many as may be ahead, once all starts are taken."""
        if not self._begun:
            self._begun = True
            self._open += (starts := [Part(self._value, i) for i in range(self._plan.size)])
            return starts
        if self._open and self._open[0].seed is None:
            return []
        parts: list[Part] = []
        while self._waiting and self._room_beside(found):
            motion = self._waiting.popleft()
            part = Part(self._value, self._seen, motion.seed)
            if not self._lies_on_one_of(part, self._taken):
                self._motions[part.name] = replace(motion, number=part.number)
                if self._may_be_known(part, self._open, found):
                    self._held.add(part.name)
                else:
                    parts.append(part)
                self._open.append(part)
            self._seen += 1
        return parts

    def _may_be_known(self, part: Part, before: Iterable[Part], found: Mapping[str, dict[str, Any]]) -> bool:
        """Whether a part's motion lies on a branch that comes earlier, or may lie on one that is under way."""
        motion, earlier = self._motions[part.name], [one for one in before if one.seed is not None]
        followed = {one.name: found[one.name] for one in earlier if one.name in found}
        if self._lies_on_one_of(part, self._taken | followed):
            self._dropped.add(part.name)
            return True
        under_way = (one.name for one in earlier if one.name not in found and one.name not in self._dropped)
        return any(motion.may_share_its_branch_with(self._motions[name]) for name in under_way)

    def _lies_on_one_of(self, part: Part, branches: Mapping[str, dict[str, Any]]) -> bool:
        """Whether a part's motion lies on one of some branches, by the names of their parts."""
        assert part.seed is not None
        for name, one in branches.items():
            key = part.name, name
            if key not in self._asked:
                self._asked[key] = is_known(self._plan, part.seed, one)
            if self._asked[key]:
                return True
        return False

    def _take(self, part: Part, found: Mapping[str, dict[str, Any]]) -> None:
        """Take what the next part in the sequence has come to."""
        one = found[part.name]
        if part.seed is not None and self._spent:
            self._over.append(part.seed)
        elif part.seed is not None and self._lies_on_one_of(part, self._taken):
            return
        elif one.get("message"):
            self._fail(self._failure(part, one["message"]))
        elif part.seed is None:
            self._waiting += [_Motion(seed) for seed in one["seeds"]]
        elif not self._is_as_if_all_were_known(part, one, found):
            again = replace(part, again=part.again + 1)
            self._motions[again.name] = self._motions[part.name]
            self._open.appendleft(again)
            self._held.add(again.name)
        elif own := own_parts(self._plan, one, list(self._taken.values())):
            for i, piece in enumerate(own):
                self._taken[f"{part.name}, part {i}" if i else part.name] = {
                    key: value for key, value in piece.items() if key not in _BESIDE
                }
                self._points += _points_of(piece)
            for kind, value in one["unsprung"]:
                where = f"{kind} at {self._plan.axis.path} = {value:.9g}"
                self._fail(f"{where}: no motion was found of the branch that springs there")
            self._waiting += [_Motion(seed, part.number) for seed in one["seeds"]]

    def _room_beside(self, found: Mapping[str, dict[str, Any]]) -> int:
        """How many branches more may be under way; none if those that are done leave no effort for any."""
        done = [part.name for part in self._open if part.name in found]
        self._counted |= {name: _points_of(found[name]) for name in done if name not in self._counted}
        if self._points + sum(self._counted[name] for name in done) >= self._plan.effort:
            return 0
        return max(self._ahead - len(self._under_way(found)), 0)

    def _under_way(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """Open parts that have been given, and are not done."""
        return [part for part in self._open if part.name not in found and part.name not in self._held]

    @property
    def _spent(self) -> bool:
        """Whether the branches have as many points as are allowed, each counted by its period multiple."""
        return self._points >= self._plan.effort

    def _is_known(self, seed: Mapping[str, Any]) -> bool:
        return any(is_known(self._plan, seed, one) for one in self._taken.values())

    def _fail(self, why: str) -> None:
        """Keep why something could not be followed, once."""
        if why not in self._failures:
            self._failures.append(why)

    def _failure(self, part: Part, reason: str) -> str:
        """Why nothing came of a part, with where that is."""
        value = self._plan.value_of(part.number) if part.seed is None else part.seed["value"]
        what = f"start {part.number}" if part.seed is None else "a motion"
        return f"{what} at {self._plan.axis.path} = {value:.9g}: {reason}"


def _points_of(one: Mapping[str, Any]) -> int:
    """The points of a branch, each counted by its period multiple; none of a start."""
    return sum(int(point["period_multiple"]) for point in one.get("points", ()))


def _curve_of(one: Mapping[str, Any]) -> dict[str, Any]:
    """What of a branch tells whether others go on as it does."""
    known = [{key: its[key] for key in ("kind", "stop", "value", "error")} for its in one["bifurcations"]]
    return {**{key: one[key] for key in ("values", "sections", "count", "ends")}, "bifurcations": known}
