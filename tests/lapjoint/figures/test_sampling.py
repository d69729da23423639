"""Figures evaluate a motion often enough for the fastest force that drives it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from written_history import OMEGA

from lapjoint import HarmonicsBaseMotion, History
from lapjoint.figures.sampling import LEAST_SAMPLES, times_drawn
from lapjoint.problem import BaseHarmonic


def test_every_period_of_the_fastest_harmonic_has_its_samples(history: History) -> None:
    def gap(*sizes: tuple[int, float]) -> float:
        harmonics = tuple(BaseHarmonic(multiple=n, amplitude=size) for n, size in sizes)
        base = HarmonicsBaseMotion(angular_frequency=OMEGA, harmonics=harmonics)
        motion = replace(history, problem=history.problem.replace(base_motion=base))
        return float(np.diff(times_drawn(motion, 2)).max())

    assert gap((1, 1e-3)) <= 1.02 / LEAST_SAMPLES  # s; the period is a second
    assert gap((1, 1e-3), (7, 1e-4)) <= 1.02 / (7 * LEAST_SAMPLES)
    assert gap((1, 1e-3), (7, 0.0)) > 0.9 / LEAST_SAMPLES
