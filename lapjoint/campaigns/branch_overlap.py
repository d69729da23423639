"""What of a branch is its own, and not one over again that was followed before it.

Two branches that spring at two bifurcations and come together at a part that is not resolved go on as one from there.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

from lapjoint.campaigns.branch_parts import family_of, lies_on
from lapjoint.campaigns.branch_plan import BranchPlan
from lapjoint.campaigns.point import section_from
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.tracing import Seed

_PROBES = (0.5, 0.25, 0.75)
"""Shares of the way along a branch at which its motions are compared with another one at first."""
_MORE = tuple(i / 16 for i in range(1, 16))
"""The same once one of those lies on it."""
_INWARD = 3
"""Number of points, or a quarter of them, between either end and the first motion that is asked then.  Those beyond are
not: two branches that end at one bifurcation end at some distance from it."""
_JOINS = "joins"
"""Why a part ends where it comes to another branch."""
_BREAKS_OFF = frozenset({"lost", "effort"})
"""Why a branch ends beyond which another one along it may go on."""
_LEAST = 1 / 16
"""Share of a branch that a part of it must have at least if none of its bifurcations is its own: of what one branch
goes through step by step, another may leave a little out."""


@in_one_thread
def own_parts(plan: BranchPlan, branch: Mapping[str, Any], others: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The parts of a branch that lie on none of some others, as motions all along it tell.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    branch : mapping
        The branch, as `lapjoint.campaigns.branch_parts.solve_branch` gives it.
    others : sequence of mapping
        The others, likewise.

    Returns
    -------
    list of dict
        Likewise, in sequence; each goes on to the first motion on another one, and ends there as ``joins``.  The branch
        as it is, if it is all its own; empty, if nothing of it is.
    """
    whole, alike = _Whole(plan, branch), [other for other in others if other["count"] == branch["count"]]
    parts = [
        part
        for part in _outside(_Part(0, len(branch["points"]) - 1, *branch["ends"]), branch["elsewhere"])
        if not branch["elsewhere"] or all(whole.is_worth(part, other) for other in alike)
    ]
    for other in alike:
        parts = [own for part in parts for own in whole.without(part, other)]
    return [whole.cut(part) for part in parts]


class Known:
    """Branches that are known, on which parts of a curve may lie.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    others : mapping of str to mapping
        ``values``, ``sections``, ``count``, ``bifurcations`` and ``ends`` of the branches, by their names.
    """

    def __init__(self, plan: BranchPlan, others: Mapping[str, Mapping[str, Any]]) -> None:
        self._plan, self._others = plan, others
        self._asked = list[list[Any]]()

    @in_one_thread
    def on(self, value: float, section: dict[str, Any], count: int) -> frozenset[str]:
        """Those on which a motion lies, but for what breaks off. See `lapjoint.campaigns.branch_parts.Elsewhere.on`.

        Along such a one, the curve may lead beyond.
        """
        self._asked.append([value, section])
        there = _Whole(self._plan, {"values": [value], "sections": [section], "count": count})
        whole = {name: other for name, other in self._others.items() if _BREAKS_OFF.isdisjoint(other["ends"])}
        return frozenset(name for name, other in whole.items() if there.lies_on(0, other))

    @in_one_thread
    def parts(self, curve: Mapping[str, Any]) -> dict[str, Any]:
        """The parts of a curve that lie on them. See `lapjoint.campaigns.branch_parts.Elsewhere.parts`."""
        whole, last = _Whole(self._plan, curve), len(curve["values"]) - 1
        every = _Part(0, last, "", "")
        ends = [i for i, end in zip((0, last), curve["ends"], strict=True) if end == _JOINS]
        own, joins = [every], list[str]()
        for name, other in self._others.items():
            if other["count"] == curve["count"]:
                left = [one for part in own for one in whole.without(part, other, ends)]
                joins += [name] if left != own else []
                own = left
        edges = [(-1, 0), *((one.first, one.last) for one in own), (last, last + 1)]
        parts = [[max(a, 0), min(b, last)] for (_, a), (b, _) in pairwise(edges) if b > a]
        probes = [[curve["values"][i], curve["sections"][i]] for i in _indices(every, _PROBES)]
        return {"elsewhere": parts, "joins": joins, "asked": list(self._others), "probes": [*self._asked, *probes]}


@in_one_thread
def may_lie_on(plan: BranchPlan, branch: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether a part of a branch would have been left to another one, had that been known.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    branch : mapping
        The branch, as `lapjoint.campaigns.branch_parts.solve_branch` gives it, of which nothing was left to others.
    other : mapping
        The other, as `Known` takes it.

    Returns
    -------
    bool
        Whether one of its probes lies on the other.
    """
    values, sections = zip(*branch["probes"], strict=True)
    whole = _Whole(plan, {"values": values, "sections": sections, "count": branch["count"]})
    return other["count"] == branch["count"] and any(whole.lies_on(i, other) for i in range(len(values)))


def _outside(whole: _Part, ranges: Sequence[Sequence[int]]) -> list[_Part]:
    """What of a branch lies outside of some parts of it that lie on others."""
    parts, left = list[_Part](), whole
    for first, last in ranges:
        if first > left.first:
            parts.append(replace(left, last=first, end=_JOINS))
        left = replace(left, first=last, begin=_JOINS)
    return [*parts, left] if left.last > left.first or not ranges else parts


@dataclass(frozen=True)
class _Part:
    """A part of a branch."""

    first: int
    """Index of its first point."""
    last: int
    """Index of its last point."""
    begin: str
    """Why it ends at its first point."""
    end: str
    """Why it ends at its last point."""


@dataclass(frozen=True)
class _Whole:
    """A branch of which parts may lie on others."""

    plan: BranchPlan
    branch: Mapping[str, Any]

    def without(self, part: _Part, other: Mapping[str, Any], ends: Sequence[int] = ()) -> list[_Part]:
        """What of a part does not lie on another branch, but for what has nothing of its own that this one has not.

        Ends of the branch at which it was seen to go on as another are asked first, too.
        """
        first_of_all = [*_indices(part, _PROBES), *(i for i in ends if part.first <= i <= part.last)]
        lie = {i: self.lies_on(i, other) for i in first_of_all}
        if not any(lie.values()):
            return [part]
        beside = {one["index"] - by for one in self.branch["bifurcations"] for by in (0, 1)}
        inward = min(_INWARD, (part.last - part.first + 2) // 4)
        first, last = part.first + inward, part.last - inward
        more = {*lie, *_indices(part, _MORE), *beside, first, last}
        lie = {i: self.lies_on(i, other) for i in sorted(more) if first <= i <= last}
        left = list(self._own(part, lie, other))
        return left if left == [part] else [own for own in left if self.is_worth(own, other)]

    def is_worth(self, part: _Part, other: Mapping[str, Any]) -> bool:
        """Whether a part has more than what another branch, of which it comes and to which it goes, leaves out."""
        if part.last - part.first > _LEAST * len(self.branch["values"]):
            return True
        return any(not _is_one_of(one, other["bifurcations"]) for one in self._bifurcations(part))

    def _bifurcations(self, part: _Part) -> list[dict[str, Any]]:
        """Those of a part: each lies before the point of its index, or at it."""
        begins = part.first if part.first == 0 else part.first + 1
        return [one for one in self.branch["bifurcations"] if begins <= one["index"] <= part.last]

    def _own(self, part: _Part, lie: Mapping[int, bool], other: Mapping[str, Any]) -> Iterator[_Part]:
        """The parts between motions that lie on another branch."""
        left = None if lie[next(iter(lie))] else part
        for i, j in pairwise(lie):
            if lie[i] == lie[j]:
                continue
            inside, outside = self._edge(i, j, other) if lie[i] else self._edge(j, i, other)
            if outside > inside:
                left = replace(part, first=inside, begin=_JOINS)
            elif left is not None:
                yield replace(left, last=inside, end=_JOINS)
                left = None
        if left is not None:
            yield left

    def _edge(self, inside: int, outside: int, other: Mapping[str, Any]) -> tuple[int, int]:
        """Two neighbours of which the first lies on another branch and the second does not, between two that are so."""
        while abs(outside - inside) > 1:
            between = (inside + outside) // 2
            inside, outside = (between, outside) if self.lies_on(between, other) else (inside, between)
        return inside, outside

    def lies_on(self, i: int, other: Mapping[str, Any]) -> bool:
        if i not in self._seeds:
            family, value, count = family_of(self.plan), self.branch["values"][i], self.branch["count"]
            guess = family.adopted(value, section_from(self.branch["sections"][i]))
            place = corrected(family, value, guess, count, fixed=True)  # a finer solver may have followed it there
            self._seeds[i] = None if place is None else Seed(value, place.point, count)
        seed = self._seeds[i]
        return seed is not None and lies_on(family_of(self.plan), seed, other)

    @cached_property
    def _seeds(self) -> dict[int, Seed | None]:
        """Its motions, by their indices, as far as they have been asked for."""
        return {}

    def cut(self, part: _Part) -> dict[str, Any]:
        """A part as a branch, with the bifurcations on it."""
        first, last, branch = part.first, part.last, self.branch
        kept = {key: branch[key][first : last + 1] for key in ("values", "points", "sections")}
        moved = [one | {"index": one["index"] - first} for one in self._bifurcations(part)]
        return {**branch, **kept, "bifurcations": moved, "ends": [part.begin, part.end], "elsewhere": []}


def _is_one_of(one: Mapping[str, Any], others: Sequence[Mapping[str, Any]]) -> bool:
    """Whether a bifurcation is among others, or is not surely one."""
    if one["kind"] == "unresolved" or one["error"] == math.inf:
        return True
    alike = (other for other in others if (other["kind"], other["stop"]) == (one["kind"], one["stop"]))
    return any(abs(other["value"] - one["value"]) <= one["error"] + other["error"] for other in alike)


def _indices(part: _Part, shares: Sequence[float]) -> list[int]:
    return list(dict.fromkeys(part.first + int(share * (part.last - part.first)) for share in shares))
