"""Integrals along the beams and over time of what a motion gives, by Gauss panels."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np

from lapjoint.answers import History
from lapjoint.problem import FloatArray
from lapjoint.problem.load_shape import LoadShape
from validation.references.panels import gauss_panels

_PANELS_X = 24  # Least number of panels along the beam: two for each half wave of the twelfth mode
_POINTS = 12  # Gauss points in a panel of time
_HALVINGS = 7
"""Number of halvings of the panels in time that any motion may take."""
_MOST_PANELS = 4096
"""Number of panels up to which the panels of a short motion are halved further: in a millisecond of contact the modes
of a fine mesh turn a thousand times."""


def panels(breaks: FloatArray, per_panel: float, pieces: int = 1) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights on panels no longer than `per_panel` between the breaks, each cut into `pieces`."""
    edges = [breaks[:1]]
    for a, b in itertools.pairwise(breaks):
        if b > a:
            edges.append(np.linspace(a, b, pieces * max(1, math.ceil((b - a) / per_panel)) + 1)[1:])
    return gauss_panels(np.concatenate(edges), _POINTS)


def along_beams(history: History) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights, m, along all beams, not on the spaces between them."""
    problem, line = history.problem, history.problem.line
    places = [support.x for support in problem.structure.supports] + [mass.x for mass in problem.structure.masses]
    places += [x for stop in problem.structure.stops for x, _ in stop.reading]
    places += [x for link in problem.structure.links for x in (link.first, link.second)]
    places += [x for force in problem.forces.every for x in force.shape.edges]
    breaks = np.unique([*line.edges, *(piece.end for piece in line.pieces), *places])
    beams = zip(line.starts, line.ends, strict=True)
    parts = [panels(breaks[(a <= breaks) & (breaks <= b)], (b - a) / _PANELS_X) for a, b in beams]
    x, w = zip(*parts, strict=True)
    return np.concatenate(x), np.concatenate(w)


def applied(shape: LoadShape, x: FloatArray, w: FloatArray, values: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Sum of a load's forces times `values` at their places, which gives ``(n, ...)``; `x`, `w` is the quadrature."""
    per_length = sum((force * ((x > start) & (x < end)) for start, end, force in shape.pieces), np.zeros(x.size))
    total = np.asarray((w * per_length) @ values(x))
    for place, force in shape.points:
        total = total + force * values(np.array([place]))[0]
    return total


def first_panel(history: History) -> float:
    """Length of the coarsest panels in time, s: a sixteenth of the motion or of its fastest excitation period."""
    whole, fastest = history.end - history.start, history.problem.forces.fastest
    return (min(whole, 2 * math.pi / fastest) if fastest else whole) / 16


def time_integral(
    function: Callable[[FloatArray], FloatArray], breaks: FloatArray, history: History, tolerance: float, scale: float
) -> tuple[float, float]:
    """Integral over time by Gauss panels, halved until four results differ by less than a tenth of the tolerance, or
    until there are `_MOST_PANELS`; and by how much the last four differ, which it leaves open.

    Fewer results may agree by chance while fast modes ring.  Panels end at the knots of a record, between which motions
    are smooth.
    """
    breaks = np.unique(np.concatenate([breaks, _knots(history, float(breaks[0]), float(breaks[-1]))]))
    values, halvings, points = [math.inf], 0, 0
    while halvings <= _HALVINGS or 2 * points <= _POINTS * _MOST_PANELS:
        t, w = panels(breaks, first_panel(history), 2**halvings)
        values.append(float(function(t) @ w))
        if np.ptp(values[-4:]) <= 0.1 * tolerance * scale:
            break
        halvings, points = halvings + 1, t.size
    return values[-1], float(np.ptp(values[-4:]))


def _knots(history: History, start: float, end: float) -> FloatArray:
    """Times of the knots of forces that are linear between knots; none if there are more knots than the finest
    panels."""
    ramps = history.problem.forces.ramps
    found = [np.zeros(0)] if ramps is None else [force.knots_within(start, end) for force in ramps.forces]
    knots = np.concatenate(found)
    inside = knots[(knots > start) & (knots < end)]
    return inside if inside.size <= _MOST_PANELS else inside[:0]
