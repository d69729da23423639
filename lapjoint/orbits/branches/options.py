"""Numerical options of the continuation of curves."""

from __future__ import annotations

from dataclasses import dataclass, fields

from lapjoint.errors import InputError


@dataclass(frozen=True)
class ContinuationOptions:
    """Numerical options of continuation; arclengths are without unit, see `CurvePoint.scale`."""

    first_step: float = 1e-3
    """Arclength of the first step from a start."""
    largest_step: float = 0.1
    """Largest arclength of a step.  An arclength of 1 is a change by the size of the motion; motions change by a tenth
    of their size between events."""
    smallest_step: float = 1e-9
    """Arclength of a step below which the curve counts as lost: rounding, 1e-12, would decide shorter steps."""
    turning: float = 0.3
    """Angle by which the tangent may turn in a step, rad: Newton's method then takes two or three iterations."""
    newton_tolerance: float = 1e-9
    """Arclength of the Newton step after which a point counts as solved: the remaining error is of the order of its
    square."""
    chord: float = 1e-5
    """Arclength of a Newton step below which the next step uses the same derivative, which leaves an error of 1e-10."""
    newton_iterations: int = 8
    """Largest number of Newton iterations; near the curve three are enough."""
    newton_radius: float = 0.5
    """Largest arclength of a Newton step: a longer one leaves the neighbourhood of the guess."""
    newton_growth: float = 10.0
    """Largest length of a Newton step, divided by the shortest previous step.  If fast modes make the equations
    strongly nonlinear, a step may be four times as long as the previous step, and the next steps are short."""
    difference_step: float = 3e-8
    """Step of the difference quotient by the parameter, divided by the parameter's scale.  Rounding, 1e-16 / 3e-8, and
    curvature leave seven digits of the derivative; the derivative decides only how fast Newton's method converges."""
    section_margin: float = 0.15
    """Least distance in time between the section and an event, divided by the duration of the section's arc; below it,
    the section is moved."""
    grazing_tolerance: float = 1e-11
    """Distance of an extremum from its stop, divided by the stop's gap or the size of the motion, below which the
    extremum counts as touching the stop: the rounding of sums of many terms."""
    max_contacts: int = 200
    """Largest number of switches of a contact sequence.  A branch with more has accumulating contacts, and ends."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not 0 < value < float("inf"):
                raise InputError(f"{field.name} = {value!r}: must be positive and finite")
