"""Motions of curves as values that JSON can hold, and back with the same bits."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.campaigns.point import plain_section, section_from
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.curves.boundary_problem import BoundaryProblem
from lapjoint.orbits.curves.point import CurvePoint
from lapjoint.orbits.curves.resolution import ParameterRange
from lapjoint.orbits.curves.starts import Start
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
