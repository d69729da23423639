"""Extrema of gap functions: none is overlooked, be it at a corner, and a part without duration has none."""

from __future__ import annotations

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.compiled_extrema import gap_extrema
from lapjoint.orbits.compiled_intervals import Motion, Stops
from lapjoint.problem import FloatArray


def drawn(rng: np.random.Generator) -> Motion:
    """A random motion at two places: up to 20 terms over three decades of frequency, damped or not, and a parabola."""
    terms = rng.integers(1, 21)
    frequency = 10 ** rng.uniform(0.0, 3.0, terms)
    damping = 10 ** rng.uniform(-3.0, 0.0, terms) * (rng.random(terms) < 0.8)
    amplitudes = (rng.normal(size=terms) + 1j * rng.normal(size=terms)) * frequency ** -rng.uniform(0.0, 2.5)
    return Motion(
        start=np.zeros(1),
        duration=np.array([10 ** rng.uniform(-2.0, 0.5) * (rng.random() < 0.8)]),
        rates=(frequency * (1j - damping))[None],
        weights=rng.normal(size=(1, 2, terms)).astype(complex),
        amplitudes=amplitudes[None].astype(complex),
        polynomial=rng.normal(size=(1, 2, 3)) * (rng.random() < 0.5),
        orientation=np.ones((1, 2)),
    )


def joined(parts: list[Motion]) -> Motion:
    """Motions one after the other, each of which goes on anew where the one before ends."""
    terms = max(part.rates.shape[1] for part in parts)

    def padded(values: ComplexArray) -> ComplexArray:
        return np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, terms - values.shape[-1])])

    durations = np.concatenate([part.duration for part in parts])
    return Motion(
        start=np.append(0.0, np.cumsum(durations)[:-1]),
        duration=durations,
        rates=np.concatenate([padded(part.rates) for part in parts]),
        weights=np.concatenate([padded(part.weights) for part in parts]),
        amplitudes=np.concatenate([padded(part.amplitudes) for part in parts]),
        polynomial=np.concatenate([part.polynomial for part in parts]),
        orientation=np.concatenate([part.orientation for part in parts]),
    )


def course(motion: Motion, part: int, place: int, time: FloatArray) -> FloatArray:
    """Displacement and velocity of a place at some times from the start of a part, shape (2, m)."""
    zero, one, two = motion.polynomial[part, place]
    waves = np.exp(np.outer(time, motion.rates[part])) * motion.weights[part, place] * motion.amplitudes[part]
    return np.array(
        [
            zero + time * (one + time * two) + waves.real.sum(axis=1),
            one + 2 * two * time + (waves @ motion.rates[part]).real,
        ]
    )


def on_a_grid(motion: Motion, place: int) -> tuple[FloatArray, FloatArray]:
    """Times that are close enough for every term, and displacement and velocity there, shape (2, m)."""
    times, courses = [np.zeros(0)], [np.zeros((2, 0))]
    for i in np.flatnonzero(motion.duration > 0):
        fine = 200 + int(10 * motion.duration[i] * np.abs(motion.rates[i]).max())
        since = np.linspace(0.0, motion.duration[i], fine)
        times.append(motion.start[i] + since)
        courses.append(course(motion, i, place, since))
    return np.concatenate(times), np.concatenate(courses, axis=1)


def test_extrema_are_where_a_rate_changes_sign_on_a_fine_grid_within_parts_and_between_them() -> None:
    """Of one to five random parts whose displacements and rates do not go on, some of them without duration."""
    rng, smooth, corners = np.random.default_rng(46), 0, 0
    for _ in range(80):
        motion = joined([drawn(rng) for _ in range(rng.integers(1, 6))])
        stops = Stops(rng.choice([-1.0, 1.0], 2), rng.uniform(0.0, 1.0, 2), *[np.arange(2)] * 3)
        stop, time, value, highest = gap_extrema(motion, stops)
        for k in range(2):
            grid, (displacement, rate) = on_a_grid(motion, k)
            changes = np.flatnonzero(np.sign(rate[:-1]) != np.sign(rate[1:]))
            mine = stop == k
            assert mine.sum() == changes.size
            assert np.all((grid[changes] <= time[mine]) & (time[mine] <= grid[changes + 1]))
            assert np.array_equal(highest[mine], stops.sign[k] * rate[changes] > 0)
            size = np.abs(motion.amplitudes).sum()
            for i, t, z in zip(changes, time[mine], stops.sign[k] * (value[mine] + stops.gap[k]), strict=True):
                if grid[i] == grid[i + 1]:
                    corners += 1
                    np.testing.assert_allclose(z, displacement[i + 1], rtol=1e-12, atol=1e-12 * size)
                else:
                    smooth += 1
                    part = int(np.searchsorted(motion.start, grid[i], side="right")) - 1
                    (here,), (slope,) = course(motion, part, k, np.array([t - motion.start[part]]))
                    # times are found to 1e-9 of the way between two points, in which a rate changes by few of its sizes
                    assert abs(slope) <= 1e-8 * np.abs(rate).max()
                    np.testing.assert_allclose(z, here, rtol=1e-12, atol=1e-12 * size)
    assert min(smooth, corners) > 100
