"""The S-N line of a material: how many cycles of a stress range it endures.

The line is straight in logarithms, with one slope or, beyond a knee, a second one:

    N(S) = reference_cycles (reference_range / S)^slope.

By Miner's rule a cycle of the range S does the damage 1 / N(S), and a damage of 1 is the end of the life.
"""

from __future__ import annotations

from typing import Annotated, Self

import numpy as np
from pydantic import Field, model_validator

from lapjoint.problem.schema import AtLeastOne, FloatArray, Part, Positive

Slope = Annotated[AtLeastOne, Field(le=50)]
"""A slope; real ones are 3 to 15, and powers above 50 overflow."""


class SNLine(Part):
    """An S-N line of stress ranges, which are twice the amplitudes, with one slope or two."""

    slope: Slope
    """Slope m, 1: ten times the stress range does 10^m times the damage."""
    reference_range: Positive
    """A stress range on the line, Pa, where the slope is m."""
    reference_cycles: Positive
    """Number of cycles of the reference range that the material endures."""
    knee_cycles: Positive | None = None
    """Number of cycles beyond which the second slope holds (with second_slope)."""
    second_slope: AtLeastOne | None = None
    """Slope beyond the knee, not less than the first; inf if smaller ranges do no damage."""

    @model_validator(mode="after")
    def _knee_is_whole(self) -> Self:
        if (self.knee_cycles is None) != (self.second_slope is None):
            raise ValueError("give both knee_cycles and second_slope, or neither")
        if self.second_slope is not None and self.second_slope < self.slope:
            raise ValueError(
                f"second_slope = {self.second_slope:g}: must not be less than slope = {self.slope:g}; the line is "
                "flatter beyond the knee"
            )
        return self

    @property
    def knee_range(self) -> float:
        """Stress range at the knee, Pa; 0 without a knee."""
        if self.knee_cycles is None:
            return 0.0
        return float(self.reference_range * (self.reference_cycles / self.knee_cycles) ** (1 / self.slope))

    def damage(self, ranges: FloatArray) -> FloatArray:
        """The damage that a cycle does.

        Parameters
        ----------
        ranges : FloatArray, shape (...)
            Stress ranges, Pa, not negative.

        Returns
        -------
        FloatArray, shape (...)
            1 / N of each range.
        """
        above = (ranges / self.reference_range) ** self.slope / self.reference_cycles
        if self.knee_cycles is None or self.second_slope is None:
            return np.asarray(above)
        below = (np.minimum(ranges / self.knee_range, 1.0)) ** self.second_slope / self.knee_cycles
        return np.where(ranges >= self.knee_range, above, below)

    def range_at(self, damage: FloatArray) -> FloatArray:
        """The range of which one cycle does a damage: the inverse of `damage`.

        Parameters
        ----------
        damage : FloatArray, shape (...)
            Damages of one cycle, not negative.

        Returns
        -------
        FloatArray, shape (...)
            Stress ranges, Pa.
        """
        found = self.reference_range * (damage * self.reference_cycles) ** (1 / self.slope)
        if self.knee_cycles is None or self.second_slope is None:
            return np.asarray(found)
        below = self.knee_range * (damage * self.knee_cycles) ** (1 / self.second_slope)
        return np.where(damage * self.knee_cycles >= 1, found, np.where(damage > 0, below, 0.0))
