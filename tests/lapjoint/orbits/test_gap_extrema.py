"""Extrema of gap functions: those of a motion of which a part has no duration."""

from __future__ import annotations

import numpy as np

from lapjoint.orbits.branches.compiled_extrema import gap_extrema
from lapjoint.orbits.compiled_intervals import Motion, Stops

OMEGA, GAP = 2.0, 0.3  # rad/s, m


def test_a_part_of_a_motion_that_has_no_duration_has_no_extrema() -> None:
    # Re exp(i omega t) over a period and a half, after a part that ends where it begins: two stops switch together.
    turn = 2 * np.pi / OMEGA
    motion = Motion(
        start=np.array([0.0, 0.0]),
        duration=np.array([0.0, 1.6 * turn]),
        rates=np.full((2, 1), 1j * OMEGA),
        weights=np.ones((2, 1, 1), dtype=complex),
        amplitudes=np.ones((2, 1), dtype=complex),
        polynomial=np.zeros((2, 1, 3)),
        orientation=np.ones((2, 1)),
    )
    stops = Stops(sign=np.array([1.0]), gap=np.array([GAP]), place=np.array([0]), beyond=np.array([0]))
    stop, time, value, highest = gap_extrema(motion, stops, turn / 20)
    assert stop.tolist() == [0, 0, 0]
    assert np.allclose(time, [0.5 * turn, turn, 1.5 * turn])
    assert np.allclose(value, [-1 - GAP, 1 - GAP, -1 - GAP])
    assert highest.tolist() == [False, True, False]
