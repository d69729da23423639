"""Why two solvers that are each right about their own march may still come to different motions.

Where motions exist side by side, rounding decides to which of them a chaotic transient leads.  The motion of one solver
is therefore handed to the other as an initial shape: if the second solver settles to it, both motions exist in both
solvers.  If not, the motion may exist in one solver only, because it is about to lose its stability.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint import Outcome, Problem, SteadyState, initial_from_functions
from lapjoint.problem import BeamsStart, BeamStart, FloatArray
from lapjoint.solver import Solver

SAME = 1e-2
"""Largest difference of two equal motions over the largest impulse; motions side by side differ by far more."""
CRITICAL = 5e-2
"""Distance of the leading multiplier's modulus from one within which the error of either solver may decide on
stability."""


_SAMPLES = 1601
"""Number of positions on a beam at which a motion is handed over.  Waves after an impact are short: a spline through
401 positions turned a clamp by a millionth of the largest slope, and was refused."""


@dataclass(frozen=True)
class Motion:
    """A steady state, and the solver that found it."""

    solver: Solver
    found: SteadyState


def same_motion(one: SteadyState, other: SteadyState) -> bool:
    """Whether two steady states agree in class, period and, to `SAME` of the largest, impulses; mirror images
    differ."""
    if (one.outcome is Outcome.NO_CONTACT) != (other.outcome is Outcome.NO_CONTACT):
        return False
    if one.period_multiple != other.period_multiple:
        return False
    if not one.period_multiple:
        return one.outcome is other.outcome
    size = float(np.abs([*one.impulses, *other.impulses]).max(initial=0.0))
    return bool(np.abs(one.impulses - other.impulses).max(initial=0.0) <= SAME * size)


def started_from(problem: Problem, found: SteadyState) -> Problem:
    """The problem with the section point of a motion as its initial state."""
    history = found.history

    def displacement(x: FloatArray) -> FloatArray:
        return np.asarray(history.displacement(x, history.start)[:, 0])

    def velocity(x: FloatArray) -> FloatArray:
        return np.asarray(history.velocity(x, history.start)[:, 0])

    line = problem.line
    if not line.several:
        return problem.replace(initial=initial_from_functions(line.length, displacement, velocity, _SAMPLES))
    beams = []
    for name, start, beam in zip(line.names, line.starts, line.beams, strict=True):
        x = np.linspace(0.0, beam.length, _SAMPLES)
        on = np.minimum(start + x, start + beam.length)
        z, v = (tuple(np.asarray(f(on)).tolist()) for f in (displacement, velocity))
        beams.append(BeamStart(beam=name, x=tuple(x.tolist()), displacement=z, velocity=v))
    return problem.replace(initial=BeamsStart(beams=tuple(beams)))


def why_they_differ(problem: Problem, one: Motion, other: Motion) -> str:
    """Why two solvers end on different motions, in a sentence; empty if nothing was found that explains it."""
    exists = [_exists(problem, here, there) for here, there in ((one, other), (other, one))]
    if all(exists):
        return f"Both motions exist in both solvers, side by side: {_named(one)}; {_named(other)}."
    for (here, there), found in zip(((one, other), (other, one)), exists, strict=True):
        if found:
            return f"{_named(there)} exists beside {_named(here)} in the latter solver too."
    for motion in (one, other):
        multipliers = motion.found.multipliers
        if multipliers.size and abs(multipliers[0]) > 1 - CRITICAL:
            leading = f"{abs(multipliers[0]):.4f}"
            return f"{_named(motion)} is all but critical: its leading multiplier has the modulus {leading}."
    return ""


def _exists(problem: Problem, here: Motion, there: Motion) -> bool:
    """Whether the solver of `here`, started from the motion of `there`, stays on it."""
    if not there.found.period_multiple:
        return False
    return same_motion(here.solver.steady_state(started_from(problem, there.found), errors=False), there.found)


def _named(motion: Motion) -> str:
    found = motion.found
    what = f"{found.outcome.name.lower().replace('_', ' ')}"
    if found.period_multiple:
        what += f", {found.period_multiple} excitation period{'s' if found.period_multiple > 1 else ''}"
    return f"that of {motion.solver.name} ({what})"
