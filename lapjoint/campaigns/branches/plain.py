"""Motions of curves as values that JSON can hold, and back with the same bits."""

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
    """A motion from which a branch is followed, as values that JSON can hold.

    Parameters
    ----------
    start : Start
        The motion.

    Returns
    -------
    dict of str to Any
        The values; Python writes each float with the digits that give it back exactly.
    """
    away = start.away_from
    return {
        "closed": list(start.sequence.first.closed),
        "stops": list(start.sequence.stops),
        "half_periods": start.half_periods,
        "phase": start.phase,
        "unknowns": start.unknowns.tolist(),
        "tied": sorted(start.tied),
        "away_from": None if away is None else [float(away[0]), plain_section(away[1])],
        "direction": None if start.direction is None else start.direction.tolist(),
    }


def start_of(plain: Mapping[str, Any]) -> Start:
    """The motion that `plain_start` made values of.

    Parameters
    ----------
    plain : mapping
        The values.

    Returns
    -------
    Start
        The motion, with the same bits.
    """
    away, direction = plain["away_from"], plain["direction"]
    return Start(
        ContactSequence(ContactState(tuple(plain["closed"])), tuple(plain["stops"])),
        plain["half_periods"],
        plain["phase"],
        np.array(plain["unknowns"], dtype=float),
        frozenset(plain["tied"]),
        None if away is None else (away[0], section_from(away[1])),
        None if direction is None else np.array(direction, dtype=float),
    )


def plain_curve(of: ParameterRange, points: Sequence[tuple[CurvePoint, bool]]) -> dict[str, Any]:
    """Points of a curve as values that JSON can hold.

    Parameters
    ----------
    of : ParameterRange
        The range.
    points : sequence of tuple of CurvePoint and bool
        The points, each with whether the parameter may turn there.

    Returns
    -------
    dict of str to list
        ``equations``, each with the zone, the stops that are closed at the section, those that switch, the phase of
        the section, and the events that are tied; and ``knots``, each with the number of its equations, the unknowns,
        and whether the parameter may turn there.
    """
    zones = [resolution for _, resolution in of.zones]
    numbers, knots = dict[tuple[Any, ...], int](), list[list[Any]]()
    for point, may_turn in points:
        problem = point.problem
        zone = next(i for i, one in enumerate(zones) if one is problem.resolution)
        key = zone, problem.sequence.first.closed, problem.sequence.stops, problem.phase, problem.tied
        knots.append([numbers.setdefault(key, len(numbers)), point.u.tolist(), may_turn])
    equations = [[zone, list(closed), list(stops), phase, sorted(tied)] for zone, closed, stops, phase, tied in numbers]
    return {"equations": equations, "knots": knots}


def problem_of(of: ParameterRange, equations: Sequence[Any], half_periods: int) -> BoundaryProblem:
    """The equations of a knot of a curve.

    Parameters
    ----------
    of : ParameterRange
        The range.
    equations : sequence
        One of ``equations`` as `plain_curve` gives them.
    half_periods : int
        Half periods after which the motions repeat.

    Returns
    -------
    BoundaryProblem
        The equations.
    """
    zone, closed, stops, phase, tied = equations
    sequence = ContactSequence(ContactState(tuple(closed)), tuple(stops))
    return BoundaryProblem(of.zones[zone][1], sequence, half_periods, phase, frozenset(tied))


def unknowns_of(knot: Sequence[Any]) -> FloatArray:
    """The unknowns of a knot of a curve.

    Parameters
    ----------
    knot : sequence
        One of ``knots`` as `plain_curve` gives them.

    Returns
    -------
    FloatArray, shape (n + F + 1,)
        With the same bits.
    """
    return np.array(knot[1], dtype=float)


def plain_located(of: ParameterRange, what: Located) -> dict[str, Any] | None:
    """A bifurcation or graze as values that JSON can hold.

    Parameters
    ----------
    of : ParameterRange
        The range.
    what : Bifurcation or SequenceChange
        What was located, at a resolution of the range or one that is finer.

    Returns
    -------
    dict of str to Any, or None
        ``kind``; ``zone`` and ``finer``, the number of the zone and how many times finer its solver is made; and the
        motion, as `plain_start` gives it.  None of a graze whose motion with a contact more is not known.
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
    """The bifurcation or graze that `plain_located` made values of.

    Parameters
    ----------
    of : ParameterRange
        The range.
    plain : mapping
        The values.

    Returns
    -------
    Bifurcation or SequenceChange, or None
        A graze comes from the side with a contact more; None if Newton's method does not find the motion again.
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
