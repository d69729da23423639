"""Loads along the beam that are constant from t = 0 on: gravity, and uniform loads."""

from __future__ import annotations

from typing import Self

from pydantic import ConfigDict, Field, model_validator

from lapjoint.problem.schema import Finite, NonNegative, Part, Positive


class Gravity(Part):
    """Gravity along z: it acts on the beam, its contents and its masses."""

    acceleration: Finite
    """Acceleration of free fall, m/s2, positive upwards: -9.81 where z points up."""


class UniformLoad(Part):
    """A constant force per unit length along a part of the beam."""

    model_config = ConfigDict(populate_by_name=True)

    beam: str = ""
    """Name of the beam on which it acts, if there are several."""
    start: NonNegative = Field(default=0.0, alias="from")
    """Where the load begins on the beam, m; its left end, if not given."""
    to: Positive | None = None
    """Where the load ends, m; the beam's right end, if not given."""
    force_per_length: Finite
    """Force per unit length, N/m, positive upwards."""

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if self.to is not None and self.to <= self.start:
            raise ValueError(f"to = {self.to:g}: must be more than from = {self.start:g}")
        return self
