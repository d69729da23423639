"""No peak of a penetration is too narrow to be found."""

from __future__ import annotations

import numpy as np
import pytest

from fe_lapjoint.march.peaks import deepest
from lapjoint.problem import FloatArray


class Spike:
    """Minus a penetration that is 1 nearly everywhere, and 1 + height within a width of a place."""

    def __init__(self, place: float, width: float, height: float) -> None:
        self.place, self.width, self.height = place, width, height

    def __call__(self, t: FloatArray) -> FloatArray:
        return -(1 + self.height * np.exp(-(((t - self.place) / self.width) ** 2)))[None, :]

    def at(self, k: int, t: float) -> tuple[float, float]:
        raise NotImplementedError

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        return np.full((1, t.size), min(self.height, self.height * 2 / self.width**2 * width**2 / 8))

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        return np.asarray((side * ends).max(axis=0) + self.from_chord(t, width)[k])

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        raise NotImplementedError


@pytest.mark.parametrize("place", [0.0, 0.123456789, 0.5, 0.987654321, 1.0])
def test_no_peak_is_too_narrow_to_be_found(place: float) -> None:
    assert deepest(Spike(place, 1e-3, 0.7), 0, 0.0, 1.0, 0.0) == pytest.approx(1.7, rel=1e-11)
