"""Errors of bifurcations and grazes: each is located again at finer resolutions, each time from the previous one.

The stated value is the value at the finest resolution used.  Its error is the bound by the last refinement or, if
larger, the bound by the previous refinement, reduced by the order of convergence (see `lapjoint.orbits.refinement`),
because two resolutions may agree by chance.  For a graze, the distance between the values on both sides is added.
Resolutions are refined at least twice, until the error is at most `AIM`.  The error is infinite if a resolution does
not locate the bifurcation nearby.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.bifurcations import Bifurcation, Kind, Stretch, beside, is_critical, located_in, test_of
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.continuation import centred
from lapjoint.orbits.branches.point import SAME, CurvePoint
from lapjoint.orbits.branches.resolution import Resolution
from lapjoint.orbits.branches.sequence_changes import SECANTS, SequenceChange, nearest, violated, with_ended_arc
from lapjoint.orbits.refinement import ROUNDING, Refinement
from lapjoint.problem import FloatArray

AIM = 1e-5
"""Error of a value, divided by the scale of the parameter, at which refinement ends."""
_MOST = 5
"""Largest number of refinements: the fifth has seven times the resolution."""
_NEAR = 0.05
"""Largest arclength between a bifurcation at two resolutions; a bifurcation farther away may be another one."""

Located = Bifurcation | SequenceChange
Carry = Callable[[CurvePoint], tuple[BoundaryProblem, FloatArray] | None]
"""A function that converts a motion to another resolution: its equations there, and a guess of the unknowns, shape (n +
F + 1,); None if the motion does not exist there."""


@dataclass(frozen=True)
class Stated:
    """The value of a bifurcation or graze, with its error."""

    value: float
    """The parameter, in its SI unit."""
    error: float
    """Bound on the value's error, in the unit of the value; infinite if no error can be stated."""
    what: Located = field(repr=False)
    """The bifurcation or graze at the finest resolution."""


def stated(what: Located) -> Stated:
    """The value of a bifurcation or graze, with its error."""
    value, error, bound = value_of(what), np.inf, np.inf
    scale = resolution_of(what).scale(value)
    for asked in range(1, _MOST + 1):
        finer = resolution_of(what).finer
        if finer is None:
            break
        found = again(what, partial(carried, resolution=finer[1]))
        if found is None:
            return Stated(value, np.inf, what)
        left = bound / finer[0].ratio ** finer[0].order if asked > 1 else 0.0
        bound = max(_bound(finer[0], value_of(found) - value), left)
        what, value = found, value_of(found)
        error = bound + _offset(what) + ROUNDING * scale
        if asked > 1 and error <= AIM * scale:
            break
    return Stated(value, error, what)


def value_of(what: Located) -> float:
    """The parameter at a bifurcation, or at a graze on the side with fewer events, in its SI unit."""
    return what.point.value if isinstance(what, Bifurcation) else what.value


def resolution_of(what: Located) -> Resolution:
    """The resolution at which a bifurcation or graze was located."""
    return (what.point if isinstance(what, Bifurcation) else what.before).problem.resolution


def again(what: Located, carry: Carry) -> Located | None:
    """A bifurcation or graze, located at another resolution or by another solver; None if it is not found nearby.

    A graze is located from the side with more events.
    """
    try:
        return _bifurcation(what, carry) if isinstance(what, Bifurcation) else _graze(what, carry)
    except (InputError, SolverError):
        return None


def carried(point: CurvePoint, resolution: Resolution) -> tuple[BoundaryProblem, FloatArray] | None:
    """A motion converted to another resolution of its solver; None if the section has another contact state there."""
    section = point.problem.arcs(point.u).point(point.problem.sequence.first, point.u[: point.coordinates])
    there = resolution.map_from(point.value, point.problem.phase)
    return with_section(point, resolution, there.adopted(section))


def with_section(
    point: CurvePoint, resolution: Resolution, section: SectionPoint
) -> tuple[BoundaryProblem, FloatArray] | None:
    """A motion at another resolution, where its section is known, with unchanged durations and parameter."""
    if section.state != point.problem.sequence.first:
        return None
    coordinates = resolution.arcs(point.value).coordinates(section)
    return replace(point.problem, resolution=resolution), np.concatenate([coordinates, point.u[point.coordinates :]])


def _bound(refinement: Refinement, apart: float) -> float:
    """Bound on the error of a value that differs by `apart` at a finer resolution."""
    return float(refinement.bounds(np.array([apart]), abs(apart))[0])


def _offset(what: Located) -> float:
    """Distance of the parameter between both sides of a graze, in its SI unit; 0 for a bifurcation."""
    return 0.0 if isinstance(what, Bifurcation) else what.offset


def _bifurcation(what: Bifurcation, carry: Carry) -> Bifurcation | None:
    """The zero of the test function nearest to the guess, along the curve at the other resolution."""
    guess = carry(what.point)
    near = None if guess is None else nearest(*guess)
    if guess is None or near is None:
        return None
    point = _by_secants(near, what.kind) or _by_bracket(near, what.kind)
    if point is None or _far(point, guess[1]) or violated(point) or not is_critical(what.kind, point):
        return None
    return Bifurcation(what.kind, point)


def _by_secants(near: CurvePoint, kind: Kind) -> CurvePoint | None:
    """The zero of a test function to which secants lead from a point of its curve."""
    test, tolerance = test_of(kind), near.problem.resolution.options.newton_tolerance
    here, before, at = test(near), 0.0, SAME
    for _ in range(SECANTS):
        point = beside(near, at)
        there = here if point is None else test(point)
        if point is None or there == here:
            return None
        step = -there * (at - before) / (there - here)
        if abs(step) <= tolerance:
            return point
        here, before, at = there, at, at + step
        if abs(at) > _NEAR:
            return None
    return None


def _by_bracket(near: CurvePoint, kind: Kind) -> CurvePoint | None:
    """The zero of a test function that changes its sign between two arclengths from a point, in tenfold steps."""
    test = test_of(kind)
    for way in (1.0, -1.0):
        before, at, here = 0.0, way * SAME, test(near)
        while abs(at) <= _NEAR:
            point = beside(near, at)
            if point is None:
                break
            if test(point) * here < 0:
                found = located_in(Stretch(near, point, at), kind, before, at)
                if found is not None and is_critical(kind, found[1]):
                    return found[1]
                break
            before, at = at, 10 * at
    return None


def _graze(what: SequenceChange, carry: Carry) -> SequenceChange | None:
    """The graze at the other resolution: the motion with an arc of zero duration, and from it the motion without that
    arc."""
    more = what.more
    guess = None if more is None else carry(centred(more))
    found = None if guess is None else with_ended_arc(*guess)
    if guess is None or found is None or _far(found.before, guess[1]):
        return None
    return None if found.after is not None and violated(found.after) else found


def _far(point: CurvePoint, guess: FloatArray) -> bool:
    """Whether a point is farther from its guess than a bifurcation may move between two resolutions."""
    return float(np.linalg.norm((point.u - guess) / point.scale)) > _NEAR


__all__ = ["AIM", "Located", "Stated", "again", "carried", "resolution_of", "stated", "value_of", "with_section"]
