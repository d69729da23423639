"""All that may be tuned in the continuation of curves."""

from __future__ import annotations

from dataclasses import dataclass, fields

from lapjoint.errors import InputError


@dataclass(frozen=True)
class ContinuationOptions:
    """Numerical options of continuation; arclengths are without unit, see `CurvePoint.scale`."""

    first_step: float = 1e-3
    """Arclength of the first step from a start."""
    largest_step: float = 0.1
    """Largest arclength of a step, a tenth of the size of the motion: motions change that much between events."""
    smallest_step: float = 1e-9
    """Arclength of a step below which the curve counts as lost: steps of the size of rounding, 1e-12, lead nowhere."""
    turning: float = 0.3
    """Angle by which the tangent may turn in a step, rad: Newton's method then takes two or three iterations."""
    newton_tolerance: float = 1e-9
    """Arclength of Newton's last step: the error left is of the size of its square."""
    chord: float = 1e-5
    """Arclength of a Newton step below which the derivative is kept for the next step, which leaves 1e-10."""
    newton_iterations: int = 8
    """Largest number of Newton's iterations, of which three suffice near the curve."""
    newton_radius: float = 0.5
    """Largest arclength of a Newton step: a longer one leaves the neighbourhood of the guess."""
    newton_growth: float = 10.0
    """Largest length of a Newton step over the shortest before: where fast modes bend the way to a solution, a step may
    be four times as long as the step before, and the next ones are short."""
    difference_step: float = 3e-8
    """Step of the difference by the parameter, over the parameter's scale: rounding, 1e-16 / 3e-8, and curvature leave
    seven digits of the derivative, which decides the speed of Newton's method alone."""
    section_margin: float = 0.15
    """Least share of the section's arc on either side of the section; below, the section is moved."""
    grazing_tolerance: float = 1e-11
    """Distance of an extremum from its stop, over the stop's gap or the size of the motion, that counts as rounding of
    sums of many terms."""
    max_contacts: int = 200
    """Largest number of switches of a contact sequence: a branch that exceeds the number accumulates contacts, and
    ends."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not 0 < value < float("inf"):
                raise InputError(f"{field.name} = {value!r}: must be positive and finite")
