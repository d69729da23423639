"""Spectra have the amplitudes of signals whose Fourier series is known."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from written_history import OMEGA, at_rest

from lapjoint import BaseMotion, HarmonicsBaseMotion, History
from lapjoint.figures import plot_spectrum
from lapjoint.figures.spectrum import TOLERANCE, repeating_periods, spectrum
from lapjoint.figures.style import figure_of
from lapjoint.problem import BaseHarmonic, FloatArray

Signal = Callable[[FloatArray], FloatArray]


def signalling(history: History, end: float, signal: Signal, rate: Signal, *, excited: bool = True) -> History:
    """A beam that moves as a whole, z(x, t) = signal(t) from 0 to `end` s, excited once a second."""
    base = BaseMotion(amplitude=1e-3, angular_frequency=OMEGA) if excited else None

    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return np.outer(np.ones_like(x), (signal, rate)[dt](t))

    return replace(history, problem=history.problem.replace(base_motion=base), end=end, field=field)


def sine(history: History, end: float, frequency: float = OMEGA, *, excited: bool = True) -> History:
    return signalling(
        history, end, lambda t: 3e-3 * np.sin(frequency * t), lambda t: 3e-3 * np.cos(frequency * t), excited=excited
    )


@pytest.mark.parametrize("end", [1.0, 3.0, 3.4])
def test_a_sine_has_its_amplitude_at_its_frequency_and_nothing_else(history: History, end: float) -> None:
    axes = plot_spectrum(sine(history, end), harmonics=9)
    hertz, amplitude = (np.asarray(values) for values in axes.lines[0].get_data())
    np.testing.assert_allclose(hertz, np.arange(10), rtol=1e-15)  # excited once a second
    np.testing.assert_allclose(amplitude, [0, 3, *[0] * 8], atol=3e-12)  # mm; rounding of the transform
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("frequency [Hz]", "amplitude of z [mm]")


def test_all_harmonics_of_the_excitation_are_drawn(history: History) -> None:
    base = HarmonicsBaseMotion(angular_frequency=OMEGA, harmonics=(BaseHarmonic(multiple=30, amplitude=1e-3),))
    motion = sine(history, 1.0, 30 * OMEGA)
    motion = replace(motion, problem=motion.problem.replace(base_motion=base))
    hertz, amplitude = (np.asarray(values) for values in plot_spectrum(motion).lines[0].get_data())
    assert hertz[-1] == pytest.approx(60.0)
    assert amplitude[30] == pytest.approx(3.0)


def test_a_rectified_sine_has_the_harmonics_of_its_series(history: History) -> None:
    rectified = signalling(
        history,
        2.0,
        lambda t: np.abs(np.sin(OMEGA * t)),
        lambda t: np.cos(OMEGA * t) * np.sign(np.sin(OMEGA * t + 1e-12)),
    )
    found = spectrum(rectified, 0.5, 10)
    n = np.arange(11)
    exact = np.where(n % 2 == 0, 4 / math.pi / np.abs(n.astype(float) ** 2 - 1 + (n % 2)), 0.0)
    exact[0] /= 2  # |sin| = 2/pi - 4/pi sum over even n of cos(n omega t) / (n^2 - 1)
    # A kink's coefficients fall with n^2, so what is aliased falls fourfold a doubling: the last change is 3 times it.
    np.testing.assert_allclose(found.amplitudes, exact, atol=TOLERANCE)


def test_a_motion_of_two_periods_has_lines_between_the_harmonics(history: History) -> None:
    doubled = signalling(
        history,
        6.0,
        lambda t: np.sin(OMEGA * t) + 0.25 * np.cos(OMEGA * t / 2),
        lambda t: OMEGA * (np.cos(OMEGA * t) - 0.125 * np.sin(OMEGA * t / 2)),
    )
    found = spectrum(doubled, 1.0, 2)
    assert found.periods == 2
    np.testing.assert_allclose(found.angular_frequencies, OMEGA * np.array([0, 0.5, 1, 1.5, 2]), rtol=1e-15)
    np.testing.assert_allclose(found.amplitudes, [0, 0.25, 1, 0, 0], atol=1e-12)


def test_of_a_motion_that_settles_the_last_period_is_taken(history: History) -> None:
    settling = signalling(
        history,
        8.3,
        lambda t: np.sin(OMEGA * t) + np.exp(-3 * t),
        lambda t: OMEGA * np.cos(OMEGA * t) - 3 * np.exp(-3 * t),
    )
    found = spectrum(settling, 1.0, 3)
    assert found.periods == 1
    assert found.mismatch < 1e-8
    np.testing.assert_allclose(found.amplitudes, [0, 1, 0, 0], atol=1e-8)


def test_without_excitation_a_window_is_taken_and_a_line_keeps_its_amplitude(history: History) -> None:
    axes = plot_spectrum(sine(history, 10.0, excited=False), harmonics=2)
    hertz, amplitude = (np.asarray(values) for values in axes.lines[0].get_data())
    assert "Hann window over 10 s" in axes.get_legend().get_title().get_text()
    np.testing.assert_allclose(hertz, 0.1 * np.arange(21), rtol=1e-15)
    exact = np.zeros(21)
    exact[9:12] = 1.5, 3.0, 1.5  # mm: a Hann window halves a line onto its neighbours
    np.testing.assert_allclose(amplitude, exact, atol=1e-11)


def test_a_motion_that_does_not_repeat_is_windowed(history: History) -> None:
    beating = sine(history, 40.0, math.sqrt(2) * OMEGA)
    assert repeating_periods(replace(beating, end=0.5)) == (0, pytest.approx(math.nan, nan_ok=True))
    found = spectrum(replace(beating, end=4.0), 1.0, 3)
    assert found.periods == 0
    peak = int(np.argmax(found.amplitudes))
    assert abs(found.angular_frequencies[peak] - math.sqrt(2) * OMEGA) <= OMEGA / 8  # half a bin
    assert 0.84 * 3e-3 <= found.amplitudes[peak] <= 3e-3  # at worst halfway between bins: 8 / (3 pi) = 0.849


def test_the_mean_does_not_leak_through_the_window(history: History) -> None:
    offset = signalling(
        history,
        5.0,
        lambda t: 1.0 + 1e-3 * np.sin(OMEGA * t),
        lambda t: OMEGA * 1e-3 * np.cos(OMEGA * t),
        excited=False,
    )
    found = spectrum(offset, 1.0, 2)
    assert found.amplitudes[0] == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(found.amplitudes[1:4], 0.0, atol=1e-12)


def test_the_excitation_is_marked_once(history: History) -> None:
    axes = plot_spectrum(sine(history, 1.0), x=0.5)
    plot_spectrum(sine(history, 1.0), axes, label="again")
    marks = [line for line in axes.lines if str(line.get_label()).startswith("excitation")]
    assert [mark.get_xdata()[0] for mark in marks] == [1.0]
    colours = {line.get_color() for line in axes.lines if line.get_label() in ("x = 0.5 m", "again, x = 1 m")}
    assert len(colours) == 2


@pytest.mark.parametrize("omega", [None, OMEGA])
def test_a_beam_at_rest_has_a_line_at_zero_and_says_so(history: History, omega: float | None) -> None:
    base = BaseMotion(amplitude=0.0, angular_frequency=omega) if omega else None
    rest = at_rest(history)
    axes = plot_spectrum(replace(rest, problem=rest.problem.replace(base_motion=base)))
    figure_of(axes).draw_without_rendering()
    assert [text.get_text() for text in axes.texts] == ["at rest"]
    assert axes.get_yscale() == "linear"
    assert set(np.asarray(axes.lines[0].get_ydata())) == {0.0}


def test_the_spectrum_is_of_the_place_that_moves_most(history: History) -> None:
    def pinned(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return np.outer(1e-3 * np.sin(math.pi * x), np.sin(2 * math.pi * t))

    middle = plot_spectrum(replace(history, field=pinned), label="pinned")
    assert "pinned, x = 0.5 m" in {str(line.get_label()) for line in middle.lines}
    assert middle.get_ylim()[1] > 1.0  # mm; the tip does not move but for rounding
    assert "x = 1 m" in {str(line.get_label()) for line in plot_spectrum(history).lines}
