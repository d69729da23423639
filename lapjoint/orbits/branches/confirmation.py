"""Bifurcations and grazes of one solver, located again by another solver.

The other solver begins with the first solver's motion, sampled along the beam, with its contact sequence, durations and
parameter.  It locates the bifurcation by its own arcs and multipliers, and states an error by its own refinements.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Literal

import numpy as np

from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.errors import Located, Stated, again, resolution_of, stated, value_of, with_section
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange, Resolution
from lapjoint.problem import FloatArray
from lapjoint.problem.placing import sampled_start

Verdict = Literal["agrees", "apart", "not found", "no error stated"]
"""Whether two solvers locate a bifurcation at the same value of the parameter."""
_SAMPLES = 401
"""Number of places along the beam at which a motion is sampled; Newton's method corrects the error of sampling."""
_TRIED = 3
"""Largest number of resolutions of the other solver at which a search begins: the coarsest resolution may lack a
bifurcation that finer resolutions have."""


@dataclass(frozen=True)
class Confirmation:
    """The result of locating a bifurcation or graze by another solver."""

    verdict: Verdict
    """``agrees`` if the values differ by at most the sum of their errors, ``apart`` if they differ by more, ``not
    found``, or ``no error stated`` if an error is infinite."""
    other: Stated | None
    """The other solver's bifurcation or graze with its error; None if it is not found."""


def confirmed(one: Stated, other: ParameterRange) -> Confirmation:
    """Locate a bifurcation or graze by another solver, over the same range.

    The other solver begins with its coarsest resolution, and tries up to `_TRIED` resolutions until the verdict is
    ``agrees`` or ``apart``.  The verdict ``apart`` counts only if the first solver, from the other solver's motion,
    locates its own bifurcation again; otherwise the previous verdict remains, at first ``not found``.
    """
    best = Confirmation("not found", None)
    for resolution in islice(other.resolution(one.value).and_finer(), _TRIED):
        found = located(one.what, resolution)
        if found is not None:
            verdict = _verdict(one, found)
            if verdict != "apart" or _leads_back(one, found):
                best = Confirmation(verdict, found)
        if best.verdict in ("agrees", "apart") or (found is not None and not np.isfinite(one.error)):
            break
    return best


def located(what: Located, resolution: Resolution) -> Stated | None:
    """A bifurcation or graze by another solver, with its error from `resolution` and finer resolutions; None if it is
    not found nearby."""
    found = again(what, partial(shaped, resolution=resolution))
    return None if found is None else stated(found)


def shaped(point: CurvePoint, resolution: Resolution) -> tuple[BoundaryProblem, FloatArray] | None:
    """A motion of one solver as equations and a guess for another solver; None if the section has another contact state
    there."""
    problem, value = point.problem, point.value
    section = problem.arcs(point.u).point(problem.sequence.first, point.u[: point.coordinates])
    history = problem.resolution.map_from(value, problem.phase).history(section, 1)
    line = problem.arcs(point.u).problem.line
    share = (1 - np.cos(np.linspace(0.0, np.pi, _SAMPLES))) / 2  # dense at the ends, for the slopes there
    x = np.concatenate([a + (b - a) * share for a, b in zip(line.starts, line.ends, strict=True)])
    z, v = (np.asarray(f(x, history.start), dtype=float).ravel() for f in (history.displacement, history.velocity))
    begun = resolution.map_from(value, problem.phase, initial=sampled_start(line, x, z, v)).initial()
    return with_section(point, resolution, begun)


def _verdict(one: Stated, other: Stated) -> Verdict:
    """The verdict on two values with their errors."""
    if not np.isfinite(one.error + other.error):
        return "no error stated"
    return "agrees" if abs(other.value - one.value) <= one.error + other.error else "apart"


def _leads_back(one: Stated, other: Stated) -> bool:
    """Whether the first solver, from the other solver's motion, locates its own bifurcation again, and not a
    neighbour."""
    back = again(other.what, partial(shaped, resolution=resolution_of(one.what)))
    return back is not None and abs(value_of(back) - value_of(one.what)) <= one.error
