"""The drawn power spectral density is that of the motion: of sines in closed form, and of a linear beam under noise."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import analytic
from lapjoint import Beam, InputError, Problem, Support, ViscousDamping
from lapjoint.answers import History
from lapjoint.figures import plot_psd
from lapjoint.figures.density import power_density
from lapjoint.problem import FloatArray, RandomBaseMotion
from validation.references.shaken_cantilever import ShakenCantilever


def _moving(history: History, end: float, *sines: tuple[float, float]) -> History:
    """A beam that moves as a whole by 1 m and sines of amplitudes, m, and frequencies, Hz."""

    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        z = 1.0 + np.sum([a * np.sin(2 * math.pi * f * t) for a, f in sines], axis=0)
        return np.outer(np.ones_like(x), z)

    return replace(history, end=end, field=field)


def test_the_integral_over_a_line_is_its_mean_square(history: History) -> None:
    found = power_density(_moving(history, 16.0, (2e-3, 5.0), (1e-3, 40.0)), 0.5, 15)
    step = found.frequencies[1] - found.frequencies[0]
    assert step == pytest.approx(1 / found.segment) == pytest.approx(0.5)
    for amplitude, frequency in ((2e-3, 5.0), (1e-3, 40.0)):
        near = np.abs(found.frequencies - frequency) < 5 * step
        assert np.sum(found.density[near]) * step == pytest.approx(amplitude**2 / 2, rel=1e-6)
    assert np.sum(found.density) * step == pytest.approx(2.5e-6, rel=1e-5)  # and nothing elsewhere; no mean


def test_the_sampling_is_made_denser_until_nothing_is_folded_back(history: History) -> None:
    found = power_density(_moving(history, 4.0, (1e-3, 3.0), (1e-3, 1111.0)), 0.5, 7)
    assert found.frequencies[np.argsort(found.density)[-2:]] == pytest.approx([3.0, 1111.0], abs=1.0)


@pytest.mark.parametrize("segments", [1, 15, 40])
def test_the_interval_is_that_of_averages_of_white_noise(segments: int) -> None:
    """The witness: Welch densities of many white noises, without a beam."""
    from scipy.signal import welch

    rng, each = np.random.default_rng(1), 64
    noise = rng.standard_normal((400, each * (segments + 1) // 2))
    _, density = welch(noise, 1.0, "hann", each, each // 2)
    inner = density[:, 4:-4] / 2.0  # the density of white noise of variance 1 is 2, one-sided, per Hz
    low, high = _interval(segments)
    covered = np.mean((low * inner <= 1) & (high * inner >= 1))
    assert covered == pytest.approx(0.95, abs=0.015)  # binomial error 0.002; the rest is the chi-square's approximation


def _interval(segments: int) -> tuple[float, float]:
    still = History.__new__(History)
    return power_density(_Ramp(still), 0.0, segments).interval  # type: ignore[arg-type]


class _Ramp:
    """What a density asks of a motion."""

    start, end = 0.0, 1.0

    def __init__(self, _: object) -> None:
        pass

    def displacement(self, x: float, t: FloatArray) -> FloatArray:
        return np.sin(20 * t)[np.newaxis]


def test_a_beam_under_noise_has_the_density_of_its_frequency_response() -> None:
    beam = Beam(length=1.0, bending_stiffness=20.0, mass_per_length=1.0)
    shaken = Problem(
        beam=beam,
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        damping=ViscousDamping(coefficient=2.0),
        base_motion=RandomBaseMotion(psd=[[1.0, 1.0], [10.0, 1.0]], seed=3),
    )
    history = analytic.Solver(n_modes=3).simulate(shaken, 64.0, errors=False)
    found = power_density(replace(history, start=8.0), 1.0, 27, 10.0)  # after its start from rest
    exact = np.abs(ShakenCantilever(1.0, 20.0, 1.0, 2.0).answer(found.frequencies, 1.0, 0)) ** 2
    inside = (found.frequencies > 1.5) & (found.frequencies < 9.0)  # a window's width from the edges of the band
    low, high = (end * found.density for end in found.interval)
    covered = (low <= exact) & (exact <= high)
    assert np.mean(covered[inside]) > 0.85  # 0.95 of some 30, of which neighbours are correlated


def test_it_is_drawn_with_its_interval_and_says_how_it_was_made(history: History) -> None:
    axes = plot_psd(_moving(history, 16.0, (2e-3, 5.0)), x=0.5)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("frequency [Hz]", "density of z [m²/Hz]")
    assert "Welch, 15 segments of 2 s, 95 % interval" in axes.get_legend().get_title().get_text()
    assert axes.get_yscale() == "log"
    assert len(axes.collections) == 1


def test_what_cannot_be_drawn_is_refused(history: History) -> None:
    for wrong, message in (({"segments": 0}, "segments = 0: must be 1"), ({"highest": -1.0}, "highest = -1: must be")):
        with pytest.raises(InputError, match=message):
            plot_psd(history, **wrong)
    with pytest.raises(InputError, match="a density needs a duration"):
        plot_psd(replace(history, end=history.start), x=0.5)
