"""A search for branches: starts first, then the branches of the motions that they lead to.

Motions are taken in the sequence in which starts and branches give them, and each is left out if it lies on a branch
taken before.  Workers may follow branches ahead of that sequence; what they find is dropped at its turn if it is known
by then.  So neither the number of workers nor an interruption changes what is found, or in what sequence.
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
"""Number of motions among which the one is chosen that is followed next ahead of its turn."""


@dataclass(frozen=True)
class Part:
    """A part of the work, that one process does."""

    value: int
    """Number of the value of the second parameter."""
    number: int
    """Number of the start, or of the motion among all that are found at this value."""
    start: Mapping[str, Any] | None = None
    """The motion whose branch is followed, as `lapjoint.campaigns.branches.plain.plain_start` gives it; or None."""

    @cached_property
    def name(self) -> str:
        """What the journal calls it."""
        own = f"{'start' if self.start is None else 'branch'} {self.number}"
        return f"value {self.value}: {own}" if self.value else own

    @property
    def is_random(self) -> bool:
        """Whether it is a random start, and not one at an end of the range."""
        return self.start is None and self.number >= 2

    def solved(self, spec: BranchSpec, progress: Progress | None = None) -> dict[str, Any]:
        """What it comes to.

        Parameters
        ----------
        spec : BranchSpec
            What is asked, at all values.
        progress : callable, optional
            Called with the share of a branch that is followed, and with one.

        Returns
        -------
        dict of str to Any
            As `solve_start` or `solve_branch` gives it.
        """
        own = spec.at(self.value)
        if self.start is None:
            return solve_start(own, self.number)
        return solve_branch(own, self.start, None if progress is None else lambda share: progress(share, 1.0))


@dataclass(frozen=True)
class Diagram:
    """All that a search has found at one value of the second parameter."""

    branches: Sequence[dict[str, Any]]
    """The branches, as `lapjoint.campaigns.branches.solve.solve_branch` gives them, in sequence."""
    failures: Sequence[str] = ()
    """Why starts, or motions that were found, or branches that spring from others, could not be followed."""
    left_out: int = 0
    """Number of motions whose branches were not followed, as the effort was spent."""
    reached: Reached = field(default_factory=Reached)
    """What the random starts led to."""


@dataclass(frozen=True)
class _Waiting:
    """A motion whose branch may be followed."""

    part: Part
    """The part of the work that follows it."""
    motion: Motion = field(compare=False)
    """The motion."""
    source: Part
    """The start that leads to it, or the part whose branch it was found on."""

    @property
    def kin(self) -> tuple[int, int]:
        """What motions of one branch often have in common: where they come from, and their half periods."""
        assert self.part.start is not None
        mother = -1 if self.source.start is None else self.source.number
        return mother, int(self.part.start["half_periods"])


class Search:
    """The search at one value of the second parameter.

    Parameters
    ----------
    spec : BranchSpec
        What is asked, at all values.
    value : int
        Number of the value.
    ahead : int
        Number of branches that may be under way, be it that some of them wait for a worker.
    """

    def __init__(self, spec: BranchSpec, value: int, ahead: int) -> None:
        self._spec, self._value, self._ahead = spec.at(value), value, ahead
        self._starts = [Part(value, i) for i in range(self._spec.size)]
        self._waiting = list[_Waiting]()
        """Motions whose turn has not come."""
        self._number = 0
        """Number of motions that have been found."""
        self._given = set[str]()
        """Names of all parts that have been given."""
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
        """Parts that have not been given before."""
        new = [part for part in parts if part.name not in self._given]
        self._given |= {part.name for part in new}
        return new

    def _chosen(self, found: Mapping[str, dict[str, Any]]) -> list[Part]:
        """Branches to be followed next: the one whose turn has come, then others ahead of their turn.

        Where one process alone works, nothing is ahead.  A motion that may lie on a branch under way waits for it while
        there are others.
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
        """Take what a start has come to."""
        one = found[part.name]
        if one.get("message"):
            self._fail(f"start {part.number} {self._where(self._spec.value_of(part.number))}: {one['message']}")
        self._wait_for(one["starts"], part)

    def _take_branch(self, waiting: _Waiting, one: dict[str, Any]) -> str | None:
        """Take the branch whose turn has come, and give its name; None if it could not be followed."""
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
        """Put motions at the end of the sequence."""
        for start in starts:
            part = Part(self._value, self._number, start)
            self._waiting.append(_Waiting(part, Motion(self._spec, start), source))
            self._number += 1

    def _branch_of(self, waiting: _Waiting, branches: Mapping[str, dict[str, Any]]) -> str | None:
        """The one among some branches that a motion lies on, by the name of its part; None if it lies on none."""
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
        """Whether the branches have as many points as are allowed, each counted by its period multiple."""
        return self._points >= self._spec.effort

    def _where(self, value: float) -> str:
        return f"at {self._spec.axis.path} = {value:.9g}"

    def _fail(self, why: str) -> None:
        """Keep why something could not be followed, once."""
        if why not in self._failures:
            self._failures.append(why)


def _reached(motions: Sequence[tuple[_Waiting, str | None]]) -> Reached:
    """What random starts led to, of motions each with the branch that it lies on."""
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
