"""Points of solution curves, motions with their parameters, as values that JSON can hold, and back to the last bit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import islice
from typing import Any, get_args

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.campaigns.point import plain_section, section_from
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.bifurcations import Bifurcation, Kind
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.errors import Located, resolution_of
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.sequence_changes import nearest, with_ended_arc
from lapjoint.orbits.branches.starts import Start
from lapjoint.problem import FloatArray


def plain_start(start: Start) -> dict[str, Any]:
    """A motion from which a branch is followed, as values that JSON can hold; floats keep all their bits."""
    away = start.away_from
    return {
        "closed": list(start.sequence.first.closed),
        "released": list(start.sequence.first.released),
        "stops": list(start.sequence.stops),
        "half_periods": start.half_periods,
        "phase": start.phase,
        "unknowns": start.unknowns.tolist(),
        "tied": sorted(start.tied),
        "away_from": None if away is None else [float(away[0]), plain_section(away[1])],
        "direction": None if start.direction is None else start.direction.tolist(),
    }


def start_of(plain: Mapping[str, Any]) -> Start:
    """The motion whose values `plain_start` gave, to the last bit."""
    away, direction = plain["away_from"], plain["direction"]
    return Start(
        ContactSequence(ContactState(tuple(plain["closed"]), tuple(plain.get("released", ()))), tuple(plain["stops"])),
        plain["half_periods"],
        plain["phase"],
        np.array(plain["unknowns"], dtype=float),
        frozenset(plain["tied"]),
        None if away is None else (away[0], section_from(away[1])),
        None if direction is None else np.array(direction, dtype=float),
    )


def plain_curve(of: ParameterRange, points: Sequence[tuple[CurvePoint, bool]]) -> dict[str, Any]:
    """Curve points, each with whether the parameter may reverse along the curve there, as values that JSON can hold.

    ``equations`` holds the index of the zone, a part of the range that has one resolution; the stops that are closed at
    the section; the stops that switch; the phase of the section; the events that happen together,
    `BoundaryProblem.tied`; and, if there are any, the closed stops that are released at the section.  ``knots`` holds,
    for each point, the number of its equations, the unknowns, and whether the parameter may reverse there.
    """
    zones = [resolution for _, resolution in of.zones]
    numbers, knots = dict[tuple[Any, ...], int](), list[list[Any]]()
    for point, may_turn in points:
        problem = point.problem
        zone = next(i for i, one in enumerate(zones) if one is problem.resolution)
        first = problem.sequence.first
        key = zone, first.closed, first.released, problem.sequence.stops, problem.phase, problem.tied
        knots.append([numbers.setdefault(key, len(numbers)), point.u.tolist(), may_turn])
    equations = [
        [zone, list(closed), list(stops), phase, sorted(tied), *([list(released)] if released else [])]
        for zone, closed, released, stops, phase, tied in numbers
    ]
    return {"equations": equations, "knots": knots}


def problem_of(of: ParameterRange, equations: Sequence[Any], half_periods: int) -> BoundaryProblem:
    """The boundary value problem of one entry of the ``equations`` of `plain_curve`."""
    zone, closed, stops, phase, tied, *released = equations
    sequence = ContactSequence(ContactState(tuple(closed), *map(tuple, released)), tuple(stops))
    return BoundaryProblem(of.zones[zone][1], sequence, half_periods, phase, frozenset(tied))


def unknowns_of(knot: Sequence[Any]) -> FloatArray:
    """The unknowns, shape (n + F + 1,), of one entry of the ``knots`` of `plain_curve`."""
    return np.array(knot[1], dtype=float)


def plain_located(of: ParameterRange, what: Located) -> dict[str, Any] | None:
    """A bifurcation or graze as values that JSON can hold; None for a graze whose motion with one contact more is not
    known.

    ``kind`` names it.  ``zone`` is its zone of the range, and ``finer`` the number of its resolution in the zone, from
    the coarsest.  The motion is added as `plain_start` gives it.
    """
    point = what.point if isinstance(what, Bifurcation) else what.more
    if point is None:
        return None
    zone, finer = next(
        (i, k)
        for i, (_, coarsest) in enumerate(of.zones)
        for k, one in enumerate(coarsest.and_finer())
        if one is resolution_of(what)
    )
    return {"kind": what.kind, "zone": zone, "finer": finer, **plain_start(Start.at(point))}


def located_of(of: ParameterRange, plain: Mapping[str, Any]) -> Located | None:
    """The bifurcation or graze whose values `plain_located` gave.

    None if Newton's method does not find the motion again, or its resolution no longer exists.  A graze is located from
    the side with one contact more.
    """
    start = start_of(plain)
    resolution = next(islice(of.zones[plain["zone"]][1].and_finer(), plain["finer"], None), None)
    if resolution is None:
        return None
    problem = BoundaryProblem(resolution, start.sequence, start.half_periods, start.phase, start.tied)
    if plain["kind"] not in get_args(Kind):
        return with_ended_arc(problem, start.unknowns)
    point = nearest(problem, start.unknowns)
    return None if point is None else Bifurcation(plain["kind"], point)
