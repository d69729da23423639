"""Bifurcations and grazes of one solver, located again by another from the first one's motions as sampled shapes.

The other solver takes over where along the beam the motion begins, its contact sequence, its durations and the
parameter, and locates the same by its own arcs and multipliers.  Its error comes from its own refinements.
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
from lapjoint.problem import FloatArray, SampledShape

Verdict = Literal["agrees", "apart", "not found", "no error stated"]
"""Whether both solvers have the same at the same value of the parameter."""
_SAMPLES = 401
"""Number of places at which a motion is sampled: Newton's method does the rest."""
_TRIED = 3
"""Largest number of the other solver's resolutions that are begun with: the coarsest may lack what finer ones have."""


@dataclass(frozen=True)
class Confirmation:
    """What another solver has for a bifurcation or graze."""

    verdict: Verdict
    """``agrees`` if the values differ by at most the sum of their errors, ``apart`` if by more; ``no error stated``
    where an error is infinite, and ``not found``."""
    other: Stated | None
    """What the other solver has; None where it does not find it."""


def confirmed(one: Stated, other: ParameterRange) -> Confirmation:
    """Look for a bifurcation or graze by another solver.

    Parameters
    ----------
    one : Stated
        By the first solver.
    other : ParameterRange
        The same range by the other solver.

    Returns
    -------
    Confirmation
        By the first of its resolutions, each finer than the one before, from which an error can be stated.  What is
        apart counts only if the first solver locates the same from there.
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
    """A bifurcation or graze of one solver by another, from a resolution of that one on.

    Parameters
    ----------
    what : Bifurcation or SequenceChange
        What the first solver located.
    resolution : Resolution
        The other solver.

    Returns
    -------
    Stated, or None
        None if the other solver does not find it nearby.
    """
    found = again(what, partial(shaped, resolution=resolution))
    return None if found is None else stated(found)


def shaped(point: CurvePoint, resolution: Resolution) -> tuple[BoundaryProblem, FloatArray] | None:
    """A motion taken to another solver.

    Parameters
    ----------
    point : CurvePoint
        The motion.
    resolution : Resolution
        The other solver.

    Returns
    -------
    tuple of BoundaryProblem and FloatArray, or None
        Its equations there, and a guess of the unknowns, shape ``(n + F + 1,)``; None if the section has another
        contact state there.
    """
    problem, value = point.problem, point.value
    section = problem.arcs(point.u).point(problem.sequence.first, point.u[: point.coordinates])
    history, length = problem.resolution.map(value).history(section, 1), problem.arcs(point.u).problem.beam.length
    x = length * (1 - np.cos(np.linspace(0.0, np.pi, _SAMPLES))) / 2  # close at the ends, for their slopes
    x[0], x[-1] = 0.0, length
    z, v = (np.asarray(f(x, history.start), dtype=float).ravel() for f in (history.displacement, history.velocity))
    shape = SampledShape(x=tuple(x.tolist()), displacement=tuple(z.tolist()), velocity=tuple(v.tolist()))
    begun = resolution.solver.period_map(resolution.problem_at(value).replace(initial=shape)).initial()
    return with_section(point, resolution, resolution.map(value).adopted(begun))


def _verdict(one: Stated, other: Stated) -> Verdict:
    """What two values with their errors say of each other."""
    if not np.isfinite(one.error + other.error):
        return "no error stated"
    return "agrees" if abs(other.value - one.value) <= one.error + other.error else "apart"


def _leads_back(one: Stated, other: Stated) -> bool:
    """Whether the first solver locates the same from what the other one has: else that is another one nearby."""
    back = again(other.what, partial(shaped, resolution=resolution_of(one.what)))
    return back is not None and abs(value_of(back) - value_of(one.what)) <= one.error
