"""How a section point's image changes with a number of the problem: a gap, a stiffness, the excitation frequency.

With the excitation frequency the period changes too: by that derivative the period can be an unknown.  A solver may
know the derivative by some numbers in closed form; by others it comes from differences of marches.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.period_map import Linearised, PeriodMap
from lapjoint.problem import BaseMotion, FloatArray, Problem
from lapjoint.problem.excitation import HarmonicsBaseMotion

FREQUENCY, AMPLITUDE = "base_motion.angular_frequency", "base_motion.amplitude"
"""Paths of the frequency of all periodic excitation, and of the amplitude of a harmonic base motion."""
_STEP = 1e-5
"""Step of the differences over the value: rounding, 1e-16 / 1e-5, and curvature, 1e-10, leave ten digits."""


@runtime_checkable
class FieldDerivatives(Protocol):
    """A period map that knows its derivatives by some numbers of its problem."""

    def linearised_by(self, field: str, start: SectionPoint, half_periods: int) -> Linearised | None:
        """March on and carry all deviations along, and the change by a number, while the start stays where it is.

        Parameters
        ----------
        field : str
            Path of the number, as `lapjoint.Axis` takes it: `FREQUENCY` is that of all periodic excitation.
        start : SectionPoint
            Where the march begins.
        half_periods : int
            Its length, in half periods of the problem's own excitation.

        Returns
        -------
        Linearised, or None
            With `Linearised.by_number` and, in all segments, `Segment.change`; None if the map does not know the
            derivative by this number.

        Raises
        ------
        SolverError
            If the march cannot go on.
        """


@runtime_checkable
class Retunes(Protocol):
    """A period map that gives that of the same structure with another excitation, for less work than a new one."""

    def retuned(self, field: str, value: float, problem: Callable[[], Problem]) -> PeriodMap | None:
        """The map of a problem that differs by one number.

        Parameters
        ----------
        field : str
            Path of the number, as `lapjoint.Axis` takes it.
        value : float
            Its value, in its SI unit; there is such a problem.
        problem : callable
            Gives the problem; called only where it is asked for.

        Returns
        -------
        PeriodMap, or None
            The same as the solver gives with this resolution; None if the map does not know it by this number.
        """


@dataclass(frozen=True)
class ExcitationChange:
    """How the ``H`` harmonic forces of a problem change with a number, over the number's unit."""

    frequency: float
    """Derivative of the logarithm of all angular frequencies."""
    sizes: FloatArray
    """Derivatives of the logarithms of the amplitudes, shape ``(H,)``."""


def excitation_change(problem: Problem, field: str) -> ExcitationChange | None:
    """How the excitation of a problem changes with a number.

    Parameters
    ----------
    problem : Problem
        Its excitation has a period.
    field : str
        Path of the number, as `FieldDerivatives.linearised_by` takes it.

    Returns
    -------
    ExcitationChange, or None
        None if the number is not the frequency of all excitation, or the amplitude of a harmonic base motion, or
        if there are sampled forces.
    """
    base, forces = problem.base_motion, problem.forces
    if forces.sampled or problem.excitation_frequency is None:
        return None
    of_base = np.array([force.x is None for force in forces.harmonic], dtype=float)
    if field == FREQUENCY:
        value = base.angular_frequency if isinstance(base, _PERIODIC) else problem.excitation_frequency
        return change_with(FREQUENCY, value, of_base)
    if field == AMPLITUDE and isinstance(base, BaseMotion) and base.amplitude > 0:
        return change_with(AMPLITUDE, base.amplitude, of_base)
    return None


def change_with(field: str, value: float, of_base: FloatArray) -> ExcitationChange:
    """How harmonic forces change with the frequency of all of them, or with the amplitude of the base.

    Parameters
    ----------
    field : str
        `FREQUENCY` or `AMPLITUDE`.
    value : float
        Its value, in its SI unit.
    of_base : FloatArray, shape (H,)
        1 for each force that is due to the base, whose acceleration goes with the square of the frequency; else 0.

    Returns
    -------
    ExcitationChange
        Of these ``H`` forces.
    """
    sizes = 2 * of_base if field == FREQUENCY else of_base
    return ExcitationChange(frequency_change(field, value), sizes / value)


def frequency_change(field: str, value: float) -> float:
    """How the frequency of all excitation changes with a number.

    Parameters
    ----------
    field : str
        Path of the number.
    value : float
        Its value, in its SI unit.

    Returns
    -------
    float
        Derivative of the logarithm of the frequency, over the unit of the number: 0 if that is not `FREQUENCY`.
    """
    return 1 / value if field == FREQUENCY else 0.0


_PERIODIC = (BaseMotion, HarmonicsBaseMotion)


def derivative_by_field(
    period_map_at: Callable[[float], PeriodMap], field: str, value: float, start: SectionPoint, half_periods: int
) -> FloatArray:
    """Derivative of the end of a march by a number of the problem, while the start stays where it is.

    Parameters
    ----------
    period_map_at : callable
        Takes a value of the field, and returns the period map of the problem with it.
    field : str
        Path of the number, as ``base_motion.angular_frequency``.
    value : float
        Its value, not 0; SI units.
    start : SectionPoint
        Where the march begins.
    half_periods : int
        Its length, in half periods of the problem's own excitation.

    Returns
    -------
    FloatArray, shape (n,)
        In the coordinates that belong to the end of the march at `value`, over the SI unit of the field.  The solver
        gives it where it can; else it comes from central differences.
    """
    here = period_map_at(value)
    if isinstance(here, FieldDerivatives):
        known = here.linearised_by(field, start, half_periods)
        if known is not None and known.by_number is not None and known.end.state == start.state:
            return known.by_number
    end, ends = here.march(start, half_periods).end, []
    for sign in (1, -1):
        beside = period_map_at(value * (1 + sign * _STEP))
        ends.append(here.difference(here.adopted(beside.march(beside.adopted(start), half_periods).end), end))
    return (ends[0] - ends[1]) / (2 * _STEP * value)
