"""The parts of a search for branches, each solved by one process: a start, or a branch from a motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from typing import Any, Protocol, overload

from lapjoint.answers.branches import Branch, MotionThere
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.campaigns.branch_plan import BranchPlan
from lapjoint.campaigns.point import plain_section, point_of, section_from
from lapjoint.campaigns.random_start import random_initial
from lapjoint.errors import SolverError
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.free_motion import free_seed
from lapjoint.orbits.branches.run import Limits, Run
from lapjoint.orbits.branches.seeds import on_branch, seed_from, springs_where
from lapjoint.orbits.branches.tracing import Seed, trace
from lapjoint.solver import Solver


class Elsewhere(Protocol):
    """What tells where a curve lies on branches that are known: `lapjoint.campaigns.branch_overlap.Known`."""

    def on(self, value: float, section: dict[str, Any], count: int) -> frozenset[str]:
        """On which of them a motion of a curve lies that is under way.

        Parameters
        ----------
        value : float
            The number, in its SI unit.
        section : dict
            Section point, as `lapjoint.campaigns.point.plain_section` gives it.
        count : int
            Half periods.

        Returns
        -------
        frozenset of str
            Their names.
        """

    def parts(self, curve: Mapping[str, Any]) -> dict[str, Any]:
        """The parts of a curve that lie on some of them, before its bifurcations are known.

        Parameters
        ----------
        curve : mapping
            ``values``, ``sections``, ``count`` and ``ends`` of the curve, and its grazes as ``bifurcations``.

        Returns
        -------
        dict of str to Any
            ``elsewhere``, the index of the first and the last motion of each part, in sequence; ``joins``, the names of
            those that have such a part; ``asked``, the names of all; and ``probes``, the motions that were asked first,
            by which `lapjoint.campaigns.branch_overlap.may_lie_on` tells whether a further one would have a part.
        """


_ABOUT = 1e-5
"""Error of a graze over its number, about, before finer solvers have been asked."""
_A_FEW = 3
"""Number of points that tell whether all is compiled that a branch takes."""
_KEPT = 8
"""Number of plans of which the period maps are kept: values of a second number whose branches are followed at once."""


def family_of(plan: BranchPlan) -> Family:
    """The period maps of a plan.

    Parameters
    ----------
    plan : BranchPlan
        The plan.

    Returns
    -------
    Family
        Made once in each process.

    Raises
    ------
    InputError
        If the solver has no period map, or there is no valid problem at an end of the range.
    """
    return _family(_Known(plan))


class _Known:
    """A plan as a key: two plans with the same fingerprint are one."""

    def __init__(self, plan: BranchPlan) -> None:
        self.plan = plan

    def __hash__(self) -> int:
        return hash(self.plan.fingerprint)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Known) and other.plan.fingerprint == self.plan.fingerprint


@lru_cache(maxsize=_KEPT)
def _family(key: _Known) -> Family:
    plan = key.plan
    return Family(plan.check(), plan.problem_at, plan.path, *plan.axis.values)


@in_one_thread
def solve_start(plan: BranchPlan, number: int) -> dict[str, Any]:
    """The motion that a start leads to and, at an end of the range, that without contact.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    number : int
        Number of the start.

    Returns
    -------
    dict of str to Any
        ``seeds``, as `plain_seed` gives each.
    """
    family, value = family_of(plan), plan.value_of(number)
    problem, solver = plan.problem_at(value), family.solver_at(value)
    if number >= 2:
        assert isinstance(solver, Solver)
        problem = problem.replace(initial=random_initial(problem, solver, (plan.seed, number)))
    # A branch is followed from the motion without contact where there is one: from that side a first graze is sharp.
    found = [free_seed(family, value)] if number < 2 else []
    found.append(seed_from(family, value, solver.period_map(problem).initial(), plan.max_period_multiple))
    return {"seeds": [plain_seed(seed) for seed in found if seed is not None]}


@in_one_thread
def solve_branch(
    plan: BranchPlan,
    plain: Mapping[str, Any],
    progress: Callable[[float], None] | None = None,
    elsewhere: Elsewhere | None = None,
) -> dict[str, Any]:
    """The branch of a motion.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    plain : mapping
        The motion, as `plain_seed` gives it.
    progress : callable, optional
        Called with the share of the range, or of the effort, that is behind.
    elsewhere : Elsewhere, optional
        Says where the curve lies on branches that are known; without it none does.

    Returns
    -------
    dict of str to Any
        ``seeds`` of the branches that spring from it; ``unsprung``, kind and number of each bifurcation from which one
        springs that was not found; ``count``, half periods; ``springs``, where it springs from others; ``values``,
        ``points`` and ``sections`` of its motions; ``bifurcations``; and ``ends``; with what `elsewhere` says: of its
        parts, which have no bifurcations here, the first and the last point.  Without points if there is none; then
        ``message`` says why.
    """
    said = dict[str, Any]()

    def is_elsewhere(run: Run) -> frozenset[int]:
        if elsewhere is not None:
            said.update(elsewhere.parts(_plain_curve(run, plain["count"])))
        return frozenset(i for first, last in said.get("elsewhere", ()) for i in range(first + 1, last + 1))

    def known(place: Place) -> frozenset[str]:
        assert elsewhere is not None
        return elsewhere.on(float(place.value), plain_section(place.point), plain["count"])

    try:
        found = trace(
            family_of(plan),
            seed_of(plain),
            most_multiple=plan.max_period_multiple,
            errors=plan.errors,
            limits=Limits(plan.max_points, known=None if elsewhere is None else known, progress=progress),
            elsewhere=is_elsewhere,
        )
    except SolverError as error:
        return {"seeds": [], "points": [], "message": str(error)}
    if found is None:
        return {"seeds": [], "points": [], "message": "Newton's method does not find the motion again"}
    own = {
        "seeds": [plain_seed(seed) for seed in found.seeds],
        "unsprung": [[one.kind, float(one.value)] for one in found.unsprung],
        "count": plain["count"],
        "springs": [[float(value), plain_section(point)] for value, point in found.springs],
    }
    return own | said | {"elsewhere": _ranges(found.elsewhere)} | _plain(found.branch)


def _ranges(ways: frozenset[int]) -> list[list[int]]:
    """The first and the last place of each part of a curve, of the numbers of places up to which ways lead in it."""
    starts, ends = (sorted(i for i in ways if i + beside not in ways) for beside in (-1, 1))
    return [[first - 1, last] for first, last in zip(starts, ends, strict=True)]


def _plain_curve(run: Run, count: int) -> dict[str, Any]:
    """The motions of a curve that was followed, its ends, and its grazes; their errors are not known."""
    return {
        "ends": [run.begin, run.end],
        "values": [float(place.value) for place in run.places],
        "sections": [plain_section(place.point) for place in run.places],
        "count": count,
        "bifurcations": [
            {
                "index": graze.index,
                "kind": "grazing",
                "stop": graze.stop,
                "value": float(graze.value),
                "error": _ABOUT * abs(float(graze.value)),
            }
            for graze in run.grazes
        ],
    }


def follow_a_little(plan: BranchPlan, plain: Mapping[str, Any]) -> None:
    """Follow the branch of a motion for a few points, so that all that this takes is compiled and stored.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    plain : mapping
        The motion, as `plain_seed` gives it.
    """
    with suppress(SolverError):
        trace(family_of(plan), seed_of(plain), most_multiple=1, errors=False, limits=Limits(_A_FEW))


def is_known(plan: BranchPlan, plain: Mapping[str, Any], branch: Mapping[str, Any]) -> bool:
    """Whether a motion lies on a branch.

    Parameters
    ----------
    plan : BranchPlan
        The plan.
    plain : mapping
        The motion, as `plain_seed` gives it.
    branch : mapping
        The branch, as `solve_branch` gives it.

    Returns
    -------
    bool
        Whether it does, or its mirror image does.
    """
    if not branch["points"] or branch["count"] != plain["count"]:
        return False
    seed, count = seed_of(plain), branch["count"]
    family = family_of(plan).self_at(seed.level)
    springs = [(value, section_from(section)) for value, section in branch["springs"]]
    if springs_where(family, seed, springs, count):
        return True
    return lies_on(family, seed, branch)


def lies_on(family: Family, seed: Seed, branch: Mapping[str, Any]) -> bool:
    """Whether a motion is one of a branch.

    Parameters
    ----------
    family : Family
        The period maps.
    seed : Seed
        The motion.
    branch : mapping
        The branch, as `solve_branch` gives it.

    Returns
    -------
    bool
        Whether it is, or its mirror image is.
    """
    return on_branch(family, seed, branch["values"], _Sections(branch["sections"]), branch["count"])


class _Sections(Sequence[SectionPoint]):
    """Section points as values that JSON can hold; of a long branch, few are asked for."""

    def __init__(self, plain: Sequence[dict[str, Any]]) -> None:
        self._plain = plain

    def __len__(self) -> int:
        return len(self._plain)

    @overload
    def __getitem__(self, i: int) -> SectionPoint: ...
    @overload
    def __getitem__(self, i: slice) -> Sequence[SectionPoint]: ...
    def __getitem__(self, i: int | slice) -> SectionPoint | Sequence[SectionPoint]:
        return _Sections(self._plain[i]) if isinstance(i, slice) else section_from(self._plain[i])


def plain_seed(seed: Seed) -> dict[str, Any]:
    """A motion from which a branch is followed, as values that JSON can hold.

    Parameters
    ----------
    seed : Seed
        The motion.

    Returns
    -------
    dict of str to Any
        The values.
    """
    plain: dict[str, Any] = {"value": float(seed.value), "section": plain_section(seed.point), "count": seed.count}
    if seed.away_from is not None:
        plain["away"] = [float(seed.away_from[0]), plain_section(seed.away_from[1])]
    if seed.level:
        plain["level"] = seed.level
    return plain


def plain_motion(motion: MotionThere) -> list[Any]:
    """The motion at a bifurcation as values that JSON can hold.

    Parameters
    ----------
    motion : MotionThere
        The motion.

    Returns
    -------
    list
        The number, the section point, and the half periods.
    """
    return [float(motion.value), plain_section(motion.point), int(motion.half_periods)]


def motion_from(plain: Sequence[Any]) -> MotionThere:
    """The motion that `plain_motion` made values of.

    Parameters
    ----------
    plain : sequence
        The values.

    Returns
    -------
    MotionThere
        The motion, with the same bits.
    """
    return MotionThere(plain[0], section_from(plain[1]), plain[2])


def seed_of(plain: Mapping[str, Any]) -> Seed:
    """The motion that `plain_seed` made values of.

    Parameters
    ----------
    plain : mapping
        The values.

    Returns
    -------
    Seed
        The motion, with the same bits.
    """
    away = plain.get("away")
    away_from = None if away is None else (away[0], section_from(away[1]))
    return Seed(plain["value"], section_from(plain["section"]), plain["count"], away_from, plain.get("level", 0))


def _plain(branch: Branch) -> dict[str, Any]:
    return {
        "values": [float(point.value) for point in branch.points],
        "points": [vars(point_of(point.motion)) for point in branch.points],
        "sections": [plain_section(point.motion.section_point) for point in branch.points],
        "bifurcations": [
            {
                **vars(one),
                "value": float(one.value),
                "error": float(one.error) if math.isfinite(one.error) else math.inf,
                "motion": None if one.motion is None else plain_motion(one.motion),
            }
            for one in branch.bifurcations
        ],
        "ends": list(branch.ends),
    }
