"""The parts of a search for branches, each solved by one process: a start, or the branch of a motion."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np

from lapjoint.answers.branches import BifurcationKind
from lapjoint.answers.contact_state import stop_of
from lapjoint.answers.steady_state import SteadyState, impulses_per_period, periodic_outcome
from lapjoint.campaigns.branches.plain import plain_curve, plain_located, plain_start, start_of
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.point import Point, plain_section, point_of
from lapjoint.campaigns.random_start import random_initial
from lapjoint.errors import SolverError
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.branches.bifurcations import Bifurcation
from lapjoint.orbits.branches.errors import stated
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import start_from, without_contact
from lapjoint.orbits.branches.tracing import Found, Limits, Traced, trace
from lapjoint.orbits.steady_state import mirrors_itself
from lapjoint.solver import Solver

_A_FEW = 3
"""Number of points of a branch after which every function that a branch needs is compiled."""


@in_one_thread
def solve_start(spec: BranchSpec, number: int) -> dict[str, Any]:
    """The motion to which a start leads, as ``starts``.  At an end of the range, the motion without contact is added.

    Starts 0 and 1 are the ends of the range, further starts are random.
    """
    of, value = range_of(spec), spec.value_of(number)
    problem, solver = spec.problem_at(value), of.resolution(value).solver
    if number >= 2:
        assert isinstance(solver, Solver)
        problem = problem.replace(initial=random_initial(problem, solver, (spec.seed, number)))
    found = [without_contact(of, value)] if number < 2 else []
    found.append(start_from(of, value, solver.period_map(problem).initial(), spec.max_period_multiple))
    return {"starts": [plain_start(start) for start in found if start is not None]}


@in_one_thread
def solve_branch(
    spec: BranchSpec, plain: Mapping[str, Any], progress: Callable[[float], None] | None = None
) -> dict[str, Any]:
    """The branch of a motion, as values that JSON can hold.

    ``half_periods``; ``values`` and ``points`` of its motions; ``bifurcations``; ``ends``; ``starts`` of other
    branches; ``springs``, where the branch springs from others; ``unsprung``, kind and parameter of each bifurcation
    whose springing branch was not found; ``equations`` and ``knots``, by which a motion of the branch is known again.
    Without points, a ``message`` says why.  `progress` is called with the share of the range, or of the points allowed,
    that is done.
    """
    of = range_of(spec)
    try:
        found = trace(
            of, start_of(plain), spec.max_period_multiple, Limits(spec.max_points, progress, spec.from_grazes)
        )
        if found is None:
            return {"starts": [], "points": [], "message": "Newton's method does not find the motion again"}
        return _plain(of, found, spec.errors)
    except SolverError as error:
        return {"starts": [], "points": [], "message": str(error)}


def follow_a_little(spec: BranchSpec, plain: Mapping[str, Any]) -> None:
    """Follow the branch of a motion for a few points, so that every function that a branch needs is compiled and
    cached."""
    with suppress(SolverError):
        in_one_thread(trace)(range_of(spec), start_of(plain), 1, Limits(_A_FEW))


def _plain(of: ParameterRange, found: Traced, errors: bool) -> dict[str, Any]:
    """A branch as values that JSON can hold."""
    return {
        "half_periods": found.points[0].problem.half_periods,
        "values": [point.value for point in found.points],
        "points": [vars(_point(point)) for point in found.points],
        "bifurcations": [_row(of, one, errors) for one in found.found],
        "ends": list(found.ends),
        "starts": [plain_start(start) for start in found.starts],
        "springs": [[float(value), plain_section(section)] for value, section in found.springs],
        "unsprung": [[_kind(one), one.point.value] for one in found.unsprung],
        **plain_curve(of, _knots(found)),
    }


def _point(point: CurvePoint) -> Point:
    """The numbers of a motion that the dataset holds."""
    try:
        return point_of(steady_state(point))
    except SolverError as error:  # the march stops where the arcs go on
        unknown = (math.nan,) * len(point.problem.arcs(point.u).problem.structure.stops)
        return Point(period_multiple=_multiple(point), impulses=unknown, message=str(error))


def steady_state(point: CurvePoint) -> SteadyState:
    """The motion of a curve point with the contacts of the solver's own march; `SolverError` if the march stops.

    Multipliers and residual are those of the arcs.
    """
    period_map, section = point.problem.resolution.map(point.value), point.section()
    multiple, is_odd = _multiple(point), point.problem.half_periods % 2 == 1
    history, multipliers = period_map.history(section, multiple), point.multipliers
    if is_odd:
        multipliers = multipliers**2
    n = point.coordinates
    closure = point.problem.residual(point.u)[:n] / point.scale[:n]
    return SteadyState(
        problem=period_map.problem,
        solver=point.problem.resolution.solver.name,
        outcome=periodic_outcome(history),
        period_multiple=multiple,
        symmetric=is_odd or mirrors_itself(history),
        residual=float(np.linalg.norm(closure)),
        multipliers=multipliers[np.argsort(-np.abs(multipliers), kind="stable")],
        exponent=None,
        section_point=section,
        history=history,
        impulses=impulses_per_period(history, multiple),
    )


def _multiple(point: CurvePoint) -> int:
    """Excitation periods after which a motion repeats; a motion of an odd number of half periods is mirrored after half
    of them."""
    half_periods = point.problem.half_periods
    return half_periods if half_periods % 2 else half_periods // 2


def _row(of: ParameterRange, one: Found, errors: bool) -> dict[str, Any]:
    """A bifurcation as the dataset has it."""
    what, stop = one.what, -1
    if isinstance(what, Bifurcation):
        kind, point = _kind(what), what.point
    else:
        kind, point = "grazing", what.fewer
        stop = stop_of(what.stops[0])
        stop = stop if point.twins is None else min(stop, point.twins[stop])
    known = stated(what) if errors else None
    value, error = (point.value, math.inf) if known is None else (known.value, known.error)
    period_map, section, multiple = point.problem.resolution.map(point.value), point.section(), _multiple(point)
    try:
        impulses = (period_map.march(section, 2 * multiple).impulses / multiple).tolist()
    except SolverError:
        impulses = []
    return {
        "kind": kind,
        "value": float(value),
        "error": float(error),
        "index": one.index,
        "stop": int(stop),
        "after": one.after,
        "impulses": impulses,
        "motion": [point.value, plain_section(section), point.problem.half_periods],
        "arcs": plain_located(of, what if known is None else known.what),
    }


def _kind(one: Bifurcation) -> BifurcationKind:
    """What a bifurcation is called: a flip over an odd number of half periods breaks the motion's symmetry."""
    is_broken = one.kind == "flip" and one.point.problem.half_periods % 2 == 1
    return "symmetry breaking" if is_broken else one.kind


def _knots(found: Traced) -> list[tuple[CurvePoint, bool]]:
    """The points of a branch with its bifurcations between them, and whether the parameter may turn at each."""
    knots, at = list[tuple[CurvePoint, bool]](), 0
    for one in found.found:
        knots += ((point, False) for point in found.points[at : one.index])
        at = max(at, one.index)
        if isinstance(one.what, Bifurcation):
            knots.append((one.what.point, one.what.kind == "fold"))
            continue
        sides = [one.what.before] if one.what.after is None else [one.what.before, one.what.after]
        is_turned = bool(knots) and knots[-1][0].problem.events == sides[-1].problem.events
        knots += ((side, True) for side in (sides[::-1] if is_turned else sides))
    return [*knots, *((point, False) for point in found.points[at:])]
