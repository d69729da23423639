"""The times that are shown: as many as the motion needs, and its switches always."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from lapjoint import HarmonicsBaseMotion, History
from lapjoint.problem import BaseHarmonic, FloatArray
from lapjoint.scene.frame_times import chosen_times


def test_equidistant_frames_hold_every_switch(history: History) -> None:
    times = chosen_times([history], frames=11)
    assert times.tolist() == sorted({*np.linspace(0, 1, 11).tolist(), *history.switch_times.tolist()})


def test_given_times_hold_the_switches_between_them(history: History) -> None:
    times = chosen_times([history], times=[0.5, 0.0])
    assert times.tolist() == sorted({0.0, 0.5, *history.switch_times[:2].tolist()})


@pytest.mark.parametrize("tolerance", [0.01, 1e-4])
def test_straight_lines_between_frames_are_as_good_as_asked_for(history: History, tolerance: float) -> None:
    times = chosen_times([history], tolerance=tolerance)
    assert set(history.switch_times) <= set(times)
    t = np.linspace(0.0, 1.0, 5001)
    for exact, at_frames in (
        (history.displacement(1.0, t)[0], history.displacement(1.0, times)[0]),
        (history.velocity(1.0, t)[0], history.velocity(1.0, times)[0]),
    ):
        error = np.abs(np.interp(t, times, at_frames) - exact).max() / np.abs(exact).max()
        assert error <= tolerance


def test_a_finer_tolerance_takes_the_frames_a_sine_needs(history: History) -> None:
    # The error of a chord of sin(2 pi t) is (2 pi h)^2 / 8, and intervals are halved.
    needed = 2 * math.pi / math.sqrt(8 * 1e-4)
    assert needed < chosen_times([history], tolerance=1e-4).size < 2.5 * needed


@pytest.mark.parametrize(("seconds", "multiple"), [(160, 1), (8, 20), (1, 160)])
def test_a_motion_that_all_first_looks_miss_is_shown(history: History, seconds: int, multiple: int) -> None:
    """Once 32 intervals of a history, and four times inside each, saw sin(2 pi t) at multiples of its period alone."""
    omega = 2 * math.pi * multiple
    base = HarmonicsBaseMotion(
        angular_frequency=2 * math.pi, harmonics=(BaseHarmonic(multiple=multiple, amplitude=1.0),)
    )

    def field(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        return np.outer(np.ones_like(x), omega**dt * np.sin(omega * t + dt * math.pi / 2))

    still = {"switch_times": np.zeros(0), "states": history.states[:1], "contacts": ()}
    problem = history.problem.replace(stops=(), base_motion=base)
    motion = replace(history, **still, problem=problem, end=float(seconds), field=field)
    times, t = chosen_times([motion], tolerance=0.01), np.linspace(0.0, seconds, 20_011)
    error = np.abs(np.interp(t, times, np.sin(omega * times)) - np.sin(omega * t)).max()
    assert error <= 0.01


def test_two_motions_are_shown_at_the_switches_of_both(history: History) -> None:
    other = replace(history, switch_times=history.switch_times + 1e-3, end=0.9)
    times = chosen_times([history, other], frames=3)
    assert times[-1] == 0.9
    assert {t for t in (*history.switch_times, *other.switch_times) if t <= 0.9} <= set(times)
