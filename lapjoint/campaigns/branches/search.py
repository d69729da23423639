"""A search for branches: starts first, then the branches of the motions that the starts lead to.

Motions wait in a queue, in the sequence in which starts and branches give them.  When a motion's turn comes, it is
dropped if it lies on a branch taken before.  Workers may follow branches ahead of their turn.  When the turn of such a
branch comes, it is dropped if it is known by then.  The result and its sequence therefore depend neither on the number
of workers nor on interruptions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from lapjoint.campaigns.branches.known import Curve, Motion
from lapjoint.campaigns.branches.solve import solve_branch, solve_start
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.branches.unknown import Reached, reached
from lapjoint.solver import Progress

_LOOKED_AHEAD = 32
"""Number of waiting motions among which the next branch to be followed ahead of its turn is chosen."""


@dataclass(frozen=True)
class Part:
    """A part of a search that one process does: a start, or the branch of a motion."""

    value: int
    """Number of the value of the second parameter."""
    number: int
    """Number of the start, or of the motion among all motions found at this value."""
    start: Mapping[str, Any] | None = None
    """The motion whose branch is followed, as `lapjoint.campaigns.branches.plain.plain_start` gives it; None for a
    start."""

    @cached_property
    def name(self) -> str:
        """The name of the part in the journal."""
        own = f"{'start' if self.start is None else 'branch'} {self.number}"
        return f"value {self.value}: {own}" if self.value else own

    @property
    def is_random(self) -> bool:
        """Whether the part is a random start, and not a start at an end of the range."""
        return self.start is None and self.number >= 2

    def solved(self, spec: BranchSpec, progress: Progress | None = None) -> dict[str, Any]:
        """The result of the part, as `solve_start` or `solve_branch` gives it.

        `progress` is called with the fraction of a branch that is followed, and with 1, the whole.
        """
        own = spec.at(self.value)
        if self.start is None:
            return solve_start(own, self.number)
        return solve_branch(own, self.start, None if progress is None else lambda share: progress(share, 1.0))


@dataclass(frozen=True)
class Diagram:
    """The result of a search at one value of the second parameter."""

    branches: Sequence[dict[str, Any]]
    """The branches, as `lapjoint.campaigns.branches.solve.solve_branch` gives them, in sequence."""
    failures: Sequence[str] = ()
    """Why a start, a motion that was found, or a branch that springs from another could not be followed."""
    left_out: int = 0
    """Number of motions whose branches were not followed because the limit of effort was reached."""
    reached: Reached = field(default_factory=Reached)
    """Counts of the branches to which the random starts led."""


@dataclass(frozen=True)
class _Waiting:
    """A motion whose branch waits to be followed."""

    part: Part
    """The part that follows the branch."""
    motion: Motion = field(compare=False)
    """The motion."""
    source: Part
    """The start that leads to the motion, or the part that follows the branch on which the motion was found."""

    @property
    def kin(self) -> tuple[int, int]:
        """Source and half periods of the motion: motions of one branch often have both in common."""
        assert self.part.start is not None
        mother = -1 if self.source.start is None else self.source.number
        return mother, int(self.part.start["half_periods"])


class Search:
    """The search at one value of the second parameter; up to `ahead` branches may be under way or wait for a worker."""

    def __init__(self, spec: BranchSpec, value: int, ahead: int) -> None:
        self._spec, self._value, self._ahead = spec.at(value), value, ahead
        self._starts = [Part(value, i) for i in range(self._spec.size)]
        self._waiting = list[_Waiting]()
        """Motions whose turn has not come."""
        self._number = 0
        """Number of motions that have been found."""
        self._given = set[str]()
        """Names of all parts that `go_on` has returned."""
        self._taken: dict[str, dict[str, Any]] = {}
        """The branches that have been taken, by the names of their parts."""
        self._curves: dict[str, Curve] = {}
        """Branches that have been followed, by the names of their parts."""
        self._asked: dict[tuple[str, str], bool] = {}
        """Whether the motion of one part lies on the branch of another, by their names."""
        self._points = 0
        """Number of points of the branches that have been taken, each counted by its period multiple."""
        self._failures: list[str] = []
        self._left_out: list[_Waiting] = []
        self._passed: list[tuple[_Waiting, str | None]] = []
        """Motions whose turn has come, each with the branch that it lies on; None if its branch was not followed."""

    @property
    def diagram(self) -> Diagram:
        """What is found so far."""
        left_out = [(one, self._branch_of(one, self._taken)) for one in self._left_out]
        count = sum(branch is None for _, branch in left_out)
        return Diagram(list(self._taken.values()), self._failures, count, _reached([*self._passed, *left_out]))

    def go_on(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """Take results of parts, by their names, and return the parts that can be done next, each only once.

        Results may come from an earlier run.
        """
        while self._starts and self._starts[0].name in found:
            self._take_start(self._starts.pop(0), found)
        if self._starts:
            return self._give([part for part in self._starts if part.name not in found])
        while self._waiting:
            next_ = self._waiting[0]
            if self._is_spent:
                self._left_out.append(next_)
            else:
                branch = self._branch_of(next_, self._taken)
                if branch is None:
                    if next_.part.name not in found:
                        break
                    branch = self._take_branch(next_, found[next_.part.name])
                self._passed.append((next_, branch))
            self._waiting.remove(next_)
        return self._give(self._chosen(found))

    def _give(self, parts: list[Part]) -> list[Part]:
        """Those of `parts` that have not been given out before; they count as given out now."""
        new = [part for part in parts if part.name not in self._given]
        self._given |= {part.name for part in new}
        return new

    def _chosen(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """The branches to be followed next: the branch whose turn has come, then branches ahead of their turn.

        With one process no branch is followed ahead.  A motion that may lie on a branch under way waits for that branch
        while other motions are left.
        """
        if not self._waiting:
            return []
        first, *others = self._waiting[:_LOOKED_AHEAD]
        chosen = [] if first.part.name in self._given else [first]
        under_way = [one for one in self._waiting if one.part.name in self._given and one.part.name not in found]
        done = {one.part.name: found[one.part.name] for one in self._waiting if one.part.name in found}
        spent = self._points + sum(map(_points_of, done.values()))
        room = self._ahead - len(under_way) - len(chosen) if spent < self._spec.effort else 0
        while room > 0:
            kin = {one.kin for one in (*under_way, *chosen)}
            left = (one for one in others if one not in chosen and one.part.name not in {*self._given, *found})
            free = [one for one in left if self._branch_of(one, {**self._taken, **done}) is None]
            if not free:
                break
            chosen.append(min(free, key=lambda one: one.kin in kin))
            room -= 1
        return [one.part for one in chosen]

    def _take_start(self, part: Part, found: Mapping[str, dict[str, Any]]) -> None:
        """Take the result of a start: its motions wait from now on."""
        one = found[part.name]
        if one.get("message"):
            self._fail(f"start {part.number} {self._where(self._spec.value_of(part.number))}: {one['message']}")
        self._wait_for(one["starts"], part)

    def _take_branch(self, waiting: _Waiting, one: dict[str, Any]) -> str | None:
        """Take the branch whose turn has come, and return its name; None if the branch could not be followed."""
        if one.get("message"):
            self._fail(f"a motion {self._where(waiting.motion.start.value)}: {one['message']}")
            return None
        self._taken[waiting.part.name] = one
        self._points += _points_of(one)
        for kind, value in one["unsprung"]:
            self._fail(f"{kind} {self._where(value)}: no motion was found of the branch that springs there")
        self._wait_for(one["starts"], waiting.part)
        return waiting.part.name

    def _wait_for(self, starts: Sequence[Mapping[str, Any]], source: Part) -> None:
        """Put motions at the end of the queue."""
        for start in starts:
            part = Part(self._value, self._number, start)
            self._waiting.append(_Waiting(part, Motion(self._spec, start), source))
            self._number += 1

    def _branch_of(self, waiting: _Waiting, branches: Mapping[str, dict[str, Any]]) -> str | None:
        """The name of the branch on which a motion lies; None if it lies on none."""
        followed = (name for name, one in branches.items() if not one.get("message"))
        return next((name for name in followed if self._lies_on(waiting, name, branches[name])), None)

    def _lies_on(self, waiting: _Waiting, name: str, branch: Mapping[str, Any]) -> bool:
        key = waiting.part.name, name
        if key not in self._asked:
            if name not in self._curves:
                self._curves[name] = Curve(self._spec, branch)
            self._asked[key] = waiting.motion.lies_on(self._curves[name])
        return self._asked[key]

    @property
    def _is_spent(self) -> bool:
        """Whether the branches taken have as many points as the effort allows, each counted by its period multiple."""
        return self._points >= self._spec.effort

    def _where(self, value: float) -> str:
        return f"at {self._spec.axis.path} = {value:.9g}"

    def _fail(self, why: str) -> None:
        """Keep why something could not be followed, once."""
        if why not in self._failures:
            self._failures.append(why)


def _reached(motions: Sequence[tuple[_Waiting, str | None]]) -> Reached:
    """The counts of branches to which random starts led, from motions with the names of the branches on which they
    lie."""
    stable, others, leads, known = list[str | None](), list[str | None](), dict[str, set[str]](), set[str]()
    for one, branch in motions:
        if one.source.is_random:
            (stable if one.motion.is_stable else others).append(branch)
        elif branch is None:
            continue
        elif one.source.start is None:
            known.add(branch)
        else:
            leads.setdefault(one.source.name, set()).add(branch)
    return reached(stable, others, leads, known)


def _points_of(one: Mapping[str, Any]) -> int:
    """The points of a branch, each counted by its period multiple."""
    return sum(int(point["period_multiple"]) for point in one["points"])
