"""Parameters of the excitation: derivatives of the forces by a parameter, and period maps at other values of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from lapjoint.orbits.period_map import PeriodMap
from lapjoint.problem import BaseMotion, FloatArray, Problem
from lapjoint.problem.excitation import HarmonicsBaseMotion

FREQUENCY, AMPLITUDE = "base_motion.angular_frequency", "base_motion.amplitude"
"""Paths of the frequency of all periodic excitation, and of the amplitude of a harmonic base motion."""
_PERIODIC = (BaseMotion, HarmonicsBaseMotion)


@runtime_checkable
class Retunes(Protocol):
    """A period map that gives the map for another excitation of its structure with less work than a new map."""

    def retuned(self, field: str, value: float, problem: Callable[[], Problem]) -> PeriodMap | None:
        """The map with another value of one parameter; None if the solver must make the map anew.

        `field` is the path of the parameter, as `lapjoint.Axis` takes it, and `value` its value in its SI unit;
        `problem` gives the problem with this value, and is called only where it is needed.
        """


@dataclass(frozen=True)
class ExcitationChange:
    """How the ``H`` harmonic forces of a problem change with a parameter, per unit of the parameter.

    The motions of stops fixed in space, `Problem.moved_stops`, follow the harmonic forces and count among them.
    """

    frequency: float
    """Derivative of the logarithm of all angular frequencies."""
    sizes: FloatArray
    """Derivatives of the logarithms of the amplitudes, shape ``(H,)``."""


def excitation_change(problem: Problem, field: str) -> ExcitationChange | None:
    """The derivatives of the excitation of a problem by the parameter with the path `field`, see `lapjoint.Axis`.

    None if the parameter is neither `FREQUENCY` nor `AMPLITUDE`, or if there are sampled forces.
    """
    base, forces = problem.base_motion, problem.forces
    if forces.sampled or problem.excitation_frequency is None:
        return None
    of_base = np.array([force.of_base for force in forces.harmonic], dtype=float)
    moved = len(problem.moved_stops)
    if field == FREQUENCY:
        value = base.angular_frequency if isinstance(base, _PERIODIC) else problem.excitation_frequency
        return change_with(FREQUENCY, value, of_base, moved)
    if field == AMPLITUDE and isinstance(base, BaseMotion) and base.amplitude > 0:
        return change_with(AMPLITUDE, base.amplitude, of_base, moved)
    return None


def change_with(field: str, value: float, of_base: FloatArray, moved: int) -> ExcitationChange:
    """How ``H`` harmonic forces change with `FREQUENCY` or `AMPLITUDE`, which has a `value`, in its SI unit.

    `of_base`, (H,), is 1 for each force that the motion of the base causes, which goes with the square of the
    frequency; else 0.  `moved` is the number of waves by which stops fixed in space move: their sizes are amplitudes.
    """
    of_force, of_stops = (2.0, 0.0) if field == FREQUENCY else (1.0, 1.0)
    sizes = np.concatenate([of_force * of_base, np.full(moved, of_stops)])
    return ExcitationChange(1 / value if field == FREQUENCY else 0.0, sizes / value)
