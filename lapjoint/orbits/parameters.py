"""How a section point's image changes with a number of the problem: a gap, a stiffness, the excitation frequency.

With the excitation frequency the period changes too: by that derivative the period can be an unknown.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, runtime_checkable

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.period_map import PeriodMap
from lapjoint.problem import FloatArray

_STEP = 1e-5
"""Step of the differences over the value: rounding, 1e-16 / 1e-5, and curvature, 1e-10, leave ten digits."""


@runtime_checkable
class FieldDerivatives(Protocol):
    """A period map that knows its derivatives by fields of its problem."""

    def derivative_by(self, field: str, start: SectionPoint, half_periods: int) -> FloatArray:
        """Derivative of the end of a march by a number of the problem, while the start stays where it is.

        Parameters
        ----------
        field : str
            Path of the number, as ``stops.0.gap``.
        start : SectionPoint
            Where the march begins.
        half_periods : int
            Its length, in half periods of the problem's own excitation.

        Returns
        -------
        FloatArray, shape (n,)
            In the coordinates that belong to the end of the march, over the SI unit of the field.
        """


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
        return here.derivative_by(field, start, half_periods)
    end, ends = here.march(start, half_periods).end, []
    for sign in (1, -1):
        beside = period_map_at(value * (1 + sign * _STEP))
        ends.append(here.difference(here.adopted(beside.march(beside.adopted(start), half_periods).end), end))
    return (ends[0] - ends[1]) / (2 * _STEP * value)
