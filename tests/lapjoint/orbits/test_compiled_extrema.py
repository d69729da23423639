"""Extrema of gap functions: none is overlooked, be it at a corner, and a part without duration has none."""

from __future__ import annotations

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.compiled_extrema import gap_extrema
from lapjoint.orbits.compiled_intervals import Motion, Stops
from lapjoint.problem import FloatArray

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
    stop, time, value, highest = gap_extrema(motion, stops)
    assert stop.tolist() == [0, 0, 0]
    assert np.allclose(time, [0.5 * turn, turn, 1.5 * turn])
    assert np.allclose(value, [-1 - GAP, 1 - GAP, -1 - GAP])
    assert highest.tolist() == [False, True, False]


def drawn(rng: np.random.Generator) -> Motion:
    """A random motion at two places: up to 20 terms over three decades of frequency, damped or not, and a parabola."""
    terms = rng.integers(1, 21)
    frequency = 10 ** rng.uniform(0.0, 3.0, terms)
    damping = 10 ** rng.uniform(-3.0, 0.0, terms) * (rng.random(terms) < 0.8)
    amplitudes = (rng.normal(size=terms) + 1j * rng.normal(size=terms)) * frequency ** -rng.uniform(0.0, 2.5)
    return Motion(
        start=np.zeros(1),
        duration=np.array([10 ** rng.uniform(-2.0, 0.5)]),
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


def course(motion: Motion, place: int, time: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Displacement and velocity of a place at some times."""
    zero, one, two = motion.polynomial[0, place]
    waves = np.exp(np.outer(time, motion.rates[0])) * motion.weights[0, place] * motion.amplitudes[0]
    return (
        zero + time * (one + time * two) + waves.real.sum(axis=1),
        one + 2 * two * time + (waves @ motion.rates[0]).real,
    )


def test_extrema_are_where_a_rate_changes_sign_on_a_grid_that_is_fine_for_every_term() -> None:
    rng, seen = np.random.default_rng(20), 0
    both = Stops(sign=np.ones(2), gap=np.zeros(2), place=np.arange(2), beyond=np.arange(2))
    for _ in range(60):
        motion = drawn(rng)
        stop, time, value, highest = gap_extrema(motion, both)
        swings = motion.duration[0] * np.abs(motion.rates).max()
        grid = np.linspace(0.0, motion.duration[0], 200 + int(10 * swings))
        for place in range(2):
            _, rate = course(motion, place, grid)
            changes = np.flatnonzero(np.sign(rate[:-1]) != np.sign(rate[1:]))
            mine = stop == place
            assert mine.sum() == changes.size
            assert np.all((grid[changes] <= time[mine]) & (time[mine] <= grid[changes + 1]))
            assert np.array_equal(highest[mine], rate[changes] > 0)
            displacement, velocity = course(motion, place, time[mine])
            # times are found to 1e-9 of the way between two points, in which a rate changes by a few of its sizes
            assert np.all(np.abs(velocity) <= 1e-8 * np.abs(rate).max())
            assert np.allclose(value[mine], displacement, rtol=1e-12, atol=1e-12 * np.abs(motion.amplitudes).sum())
            seen += changes.size
    assert seen


def with_jumps(rng: np.random.Generator) -> list[Motion]:
    """Two to five random motions whose displacements and rates do not go on, some of them without duration."""
    parts = [drawn(rng) for _ in range(rng.integers(2, 6))]
    return [part._replace(duration=part.duration * (rng.random() < 0.8)) for part in parts]


def test_a_rate_that_changes_its_sign_between_two_parts_has_an_extremum_where_the_second_begins() -> None:
    rng, at_corners = np.random.default_rng(46), 0
    both = Stops(sign=np.ones(2), gap=np.zeros(2), place=np.arange(2), beyond=np.arange(2))
    for _ in range(20):
        parts = with_jumps(rng)
        motion = joined(parts)
        stop, time, value, highest = gap_extrema(motion, both)
        for place in range(2):
            times, rates, displacements = list[FloatArray](), list[FloatArray](), list[FloatArray]()
            for start, part in zip(motion.start, parts, strict=True):
                if part.duration[0] > 0:
                    fine = 200 + int(10 * part.duration[0] * np.abs(part.rates).max())
                    grid = np.linspace(0.0, part.duration[0], fine)
                    displacement, rate = course(part, place, grid)
                    times.append(start + grid)
                    rates.append(rate)
                    displacements.append(displacement)
            grid, rate, displacement = (np.concatenate(one or [np.zeros(0)]) for one in (times, rates, displacements))
            changes = np.flatnonzero(np.sign(rate[:-1]) != np.sign(rate[1:]))
            mine = stop == place
            assert mine.sum() == changes.size
            assert np.all((grid[changes] <= time[mine]) & (time[mine] <= grid[changes + 1]))
            assert np.array_equal(highest[mine], rate[changes] > 0)
            corner = grid[changes] == grid[changes + 1]
            np.testing.assert_allclose(value[mine][corner], displacement[changes + 1][corner], rtol=1e-12)
            at_corners += int(corner.sum())
    assert at_corners
