"""Whether a motion lies on a branch that is known.

Knots of a branch are its points and bifurcations.  At the parameter of the motion in question, the branch's motion is
solved for between two neighbouring knots.  Both motions must have the same number of events; all images of the branch's
motion by whole periods and mirrored half periods are compared with the motion in question.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.campaigns.branches.plain import problem_of, start_of, unknowns_of
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.point import section_from
from lapjoint.errors import InputError, SolverError
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.continuation import at_value
from lapjoint.orbits.branches.point import SAME, CurvePoint
from lapjoint.orbits.branches.resolution import Resolution
from lapjoint.orbits.branches.sequence_changes import nearest
from lapjoint.orbits.branches.starts import at_parameter
from lapjoint.orbits.branches.tracing import at_resolution
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.problem import FloatArray

_LOCATED = 1e-6, 1e-3
"""Largest differences of parameter, over its scale, and of motion, over its size, between two bifurcations or grazes
that are one.  Branches leave a bifurcation along a parabola, so an error of the parameter of 1e-6 shifts the motion by
its root."""


class Motion:
    """A motion that may lie on branches, from the values that `lapjoint.campaigns.branches.plain.plain_start` gives."""

    def __init__(self, spec: BranchSpec, plain: Mapping[str, Any]) -> None:
        self._of, self._plain = range_of(spec), plain

    @cached_property
    def start(self) -> Any:
        """The motion as a start."""
        return start_of(self._plain)

    @cached_property
    def point(self) -> CurvePoint | None:
        """The motion as a curve point, whether or not its contacts fit; None if Newton's method does not find the
        motion."""
        start = self.start
        problem = BoundaryProblem(
            self._of.resolution(start.value), start.sequence, start.half_periods, start.phase, start.tied
        )
        return at_parameter(problem, start.unknowns) or nearest(problem, start.unknowns)

    @cached_property
    def section(self) -> SectionPoint | None:
        """The motion at a multiple of the excitation period."""
        return None if self.point is None else self.point.section()

    @cached_property
    @in_one_thread
    def is_stable(self) -> bool:
        """Whether all multipliers lie within the unit circle; True if the motion was not found."""
        return self.point is None or bool((np.abs(self.point.multipliers) < 1).all())

    @in_one_thread
    def lies_on(self, curve: Curve) -> bool:
        """Whether the motion, or one of its images by whole periods or mirrored half periods, lies on a branch."""
        if curve.half_periods != self._plain["half_periods"]:
            return False
        if self._springs_with(curve):
            return True
        point, section = self.point, self.section
        if point is None or section is None:
            return False
        resolution = self._of.resolution(point.value)
        half = HalfPeriods(resolution.map(point.value))
        found = curve.motions_at(point.value, point.problem.events)
        if any(_is_one_of(section, one.sections(), half, SAME) for one in found):
            return True
        return any(_is_one_of(section, one.sections(), half, _LOCATED[1]) for one in curve.turns_at(point.value))

    def _springs_with(self, curve: Curve) -> bool:
        """Whether the motion and the branch spring from one bifurcation."""
        if self.start.away_from is None or not curve.springs:
            return False
        value, section = self.start.away_from
        resolution, (near, same) = self._of.resolution(value), _LOCATED
        there = [its for other, its in curve.springs if abs(other - value) <= near * resolution.scale(value)]
        if not there:
            return False
        half = HalfPeriods(resolution.map(value))
        images = [half.map.adopted(section)]
        for _ in range(half.least, self._plain["half_periods"] // 2, half.least):
            images.append(half.marched(images[-1], half.least))
        return any(_is_one_of(its, images, half, same) for its in there)


def _is_one_of(section: SectionPoint, images: list[SectionPoint], half: HalfPeriods, same: float) -> bool:
    """Whether a motion is one of the images of another motion."""
    try:
        mine = half.map.adopted(section)
        return any(half.apart(half.map.adopted(image), mine) <= same for image in images)
    except (InputError, SolverError):  # one solver's contact states may not be the other's
        return False


class Curve:
    """A branch that is known, from the values that `lapjoint.campaigns.branches.solve.solve_branch` gives."""

    def __init__(self, spec: BranchSpec, branch: Mapping[str, Any]) -> None:
        self._of = range_of(spec)
        self.half_periods: int = branch["half_periods"]
        """Half periods after which its motions repeat."""
        self.springs = [(float(value), section_from(section)) for value, section in branch["springs"]]
        """Where it springs from others: the parameter, and the motion."""
        self._equations, self._knots = branch["equations"], branch["knots"]
        self._values = np.array([knot[1][-1] for knot in self._knots])
        self._events = np.array([len(self._equations[knot[0]][2]) for knot in self._knots])
        self._turns = {i for i, (_, _, may_turn) in enumerate(self._knots) if may_turn}

    def motions_at(self, value: float, events: int) -> Iterator[CurvePoint]:
        """The motions of the branch at a parameter, in its SI unit, with a number of events; they are solved one by
        one."""
        first, last = self._values[:-1], self._values[1:]
        resolution = self._of.resolution(value)
        beside = _LOCATED[0] * resolution.scale(value)  # where contacts change both sides differ by what passages lose
        between = (np.minimum(first, last) - beside <= value) & (value <= np.maximum(first, last) + beside)
        alike = (self._events[:-1] == events) | (self._events[1:] == events)
        for i in np.flatnonzero(between & alike).tolist():
            yield from self._between(i, value, resolution)

    def turns_at(self, value: float) -> Iterator[CurvePoint]:
        """The knots of the branch near a parameter that are folds or changes of contacts."""
        resolution = self._of.resolution(value)
        near = np.flatnonzero(np.abs(self._values - value) <= _LOCATED[0] * resolution.scale(value))
        for k in sorted(self._turns.intersection(near.tolist())):
            problem = problem_of(self._of, self._equations[self._knots[k][0]], self.half_periods)
            if problem.resolution is resolution:
                found = nearest(problem, unknowns_of(self._knots[k]))
                if found is not None:
                    yield found

    def _between(self, i: int, value: float, resolution: Resolution) -> Iterator[CurvePoint]:
        """Motions between a knot and the next one."""
        (a, u, _), (b, w, _) = self._knots[i : i + 2]
        problem = problem_of(self._of, self._equations[a], self.half_periods)
        if a == b and problem.resolution is resolution:
            for share in self._shares(i, value):
                found = at_parameter(problem, _at(np.array(u) + share * (np.array(w) - np.array(u)), value))
                if found is not None:
                    yield found
            return
        for k in (i, i + 1):  # each has a section, or a resolution, of its own
            found = self._from(k, value, resolution)
            if found is not None:
                yield found

    def _shares(self, i: int, value: float) -> list[float]:
        """Fractions of the way from a knot to the next knot at which the parameter has a value."""
        way = self._values[i + 1] - self._values[i]
        share = min(max(float((value - self._values[i]) / way), 0.0), 1.0) if way else 0.0
        shares = [share]
        if i in self._turns:  # the parameter changes as the square of the way from a fold, or a graze
            shares.append(float(np.sqrt(share)))
        if i + 1 in self._turns:
            shares.append(1 - float(np.sqrt(1 - share)))
        return shares

    def _from(self, k: int, value: float, resolution: Resolution) -> CurvePoint | None:
        """The motion that a knot leads to."""
        problem = problem_of(self._of, self._equations[self._knots[k][0]], self.half_periods)
        here = at_parameter(problem, unknowns_of(self._knots[k]))
        if here is not None and problem.resolution is not resolution:
            here = at_resolution(here, resolution)
        if here is None:
            return None
        if (value - here.value) * float(here.tangent[-1]) < 0:
            here = here.turned()
        return at_value(here, value, resolution.options.largest_step)


def _at(u: FloatArray, value: float) -> FloatArray:
    """Unknowns with another value of the parameter."""
    u[-1] = value
    return u
