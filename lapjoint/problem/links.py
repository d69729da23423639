"""Springs between two beams at a place: a bolt, a weld or a hinge."""

from __future__ import annotations

from lapjoint.problem.places import Place
from lapjoint.problem.schema import Part, SpringStiffness


class Link(Part):
    """Linear springs between two beams, always acting; an infinite stiffness joins the beams."""

    between: tuple[Place, Place]
    """The two places, as ``["upper:0.25", "lower:0.05"]``."""
    translational: SpringStiffness = 0.0
    """Translational stiffness between the displacements, N/m, from 0 to inf."""
    torsional: SpringStiffness = 0.0
    """Torsional stiffness between the slopes, N m/rad, from 0 to inf."""
    name: str = ""
    """Name shown in figures, and by which ``--set`` and axes find the link; may be empty."""
