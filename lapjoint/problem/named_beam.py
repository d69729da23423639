"""One of several beams: a beam with a name, its place in drawings, and all that belongs to it alone."""

from __future__ import annotations

from typing import Self

from pydantic import model_validator

from lapjoint.problem.beam import Beam
from lapjoint.problem.masses import Mass
from lapjoint.problem.schema import Finite, NonNegative
from lapjoint.problem.supports_and_stops import Support


class NamedBeam(Beam):
    """One of several beams, which run towards +x; its supports and masses have positions from its own left end."""

    name: str
    """Name, by which places are given, as in ``upper:0.3``."""
    origin: Finite = 0.0
    """Where its left end lies along x, m; a number for drawings and for the eye."""
    offset: Finite = 0.0
    """How far it is drawn above z = 0, m; it changes no answer."""
    supports: tuple[Support, ...] = ()
    """Linear springs between this beam and the base, always acting."""
    masses: tuple[Mass, ...] = ()
    """Masses that this beam carries at points."""
    viscous_damping: NonNegative = 0.0
    """Viscous damping along this beam alone, N s/m2; it adds to the damping of the problem."""
    base_share: Finite = 1.0
    """How much of the base's motion acts along this beam's z: 1 all, -1 mirrored, 0 none."""
    gravity_share: Finite = 1.0
    """How much of gravity acts along this beam's z: 1 all, -1 mirrored, 0 none."""

    @model_validator(mode="after")
    def _has_a_name(self) -> Self:
        if not self.name.strip() or ":" in self.name:
            raise ValueError("name: must be a word without a colon")
        return self
