"""Masses that the beam carries at points."""

from __future__ import annotations

from lapjoint.problem.schema import NonNegative, Part


class Mass(Part):
    """A rigid mass at a point of the beam; base motion and gravity act on it."""

    x: NonNegative
    """Position, m, within the beam."""
    mass: NonNegative
    """Mass, kg."""
    rotary_inertia: NonNegative = 0.0
    """Moment of inertia about the axis of bending through the point, kg m2; it resists changes of the slope."""
    name: str = ""
    """Name shown in figures, and by which ``--set`` and axes find the mass; may be empty."""
