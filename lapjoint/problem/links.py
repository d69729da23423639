"""Springs and dampers between two beams at a place: a bolt, a weld or a hinge."""

from __future__ import annotations

import math
from typing import Self

from pydantic import model_validator

from lapjoint.problem.places import Place
from lapjoint.problem.schema import NonNegative, Part, SpringStiffness


class Link(Part):
    """Linear springs and dampers between two beams, always acting; an infinite stiffness joins the beams."""

    between: tuple[Place, Place]
    """The two places, as ``["upper:0.25", "lower:0.05"]``."""
    translational: SpringStiffness = 0.0
    """Translational stiffness between the displacements, N/m, from 0 to inf."""
    torsional: SpringStiffness = 0.0
    """Torsional stiffness between the slopes, N m/rad, from 0 to inf."""
    damping: NonNegative = 0.0
    """Viscous damping between the displacements, beside the translational spring, N s/m."""
    torsional_damping: NonNegative = 0.0
    """Viscous damping between the slopes, beside the torsional spring, N m s/rad."""
    name: str = ""
    """Name shown in figures, and by which ``--set`` and axes find the link; may be empty."""

    @model_validator(mode="after")
    def _dampers_can_move(self) -> Self:
        for damper, spring in (("damping", "translational"), ("torsional_damping", "torsional")):
            if getattr(self, damper) > 0 and math.isinf(getattr(self, spring)):
                value = f"{damper} = {getattr(self, damper):g}"
                raise ValueError(f"{value}: must be 0 beside {spring} = inf, because a rigid joint never moves")
        return self
