"""A motion in stretches is the motion as a whole, whatever excites it, and needs no more memory where it is longer."""

from __future__ import annotations

import math
import tracemalloc
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from refining import AnySolver

import analytic
import fe_lapjoint
from analytic import answers
from analytic.march.stretches import StretchSize
from lapjoint import BaseMotion, History, InputError, Problem, paper_joint
from lapjoint.answers import Contact
from lapjoint.problem import PolynomialShape, RandomBaseMotion, RecordBaseMotion, SineLoad, StepLoad
from lapjoint.solver import Streams

ANALYTIC, ELEMENTS = analytic.Solver(n_modes=8), fe_lapjoint.Solver(elements=4)
SOLVERS = {"analytic": ANALYTIC, "fe": ELEMENTS}
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
NOISE = 250 * np.random.default_rng(3).standard_normal(40001)
SINE = BaseMotion(amplitude=0.06, angular_frequency=515.0)
OTHER = SineLoad(x=2.0, force=1e4, angular_frequency=515.0 * np.pi)
LEFT_ALONE = PolynomialShape(displacement=(0.0, 0.0, -2e-2), velocity=(0.0, 0.0, 1.0))
EXCITATIONS = {
    "random": {"base_motion": RandomBaseMotion(psd=((20.0, 80.0), (500.0, 80.0)), seed=5)},
    "record": {"base_motion": RecordBaseMotion(quantity="acceleration", rate=4000.0, values=NOISE)},
    "periodic": {"base_motion": SINE},
    "no period": {"base_motion": SINE, "point_loads": (OTHER,)},
    "steady load": {"base_motion": None, "point_loads": (StepLoad(x=2.0, force=1e5),)},
    "left alone": {"base_motion": None, "initial": LEFT_ALONE},
}
EXACT = ("random", "record", "periodic")
"""Where a stretch ends at an end that the excitation offers.  Elsewhere the end that is made for it is a rounding,
which the contacts after it make larger."""


def driven(name: str) -> Problem:
    return paper_joint().replace(**EXCITATIONS[name])


def joined(parts: list[History]) -> list[Contact]:
    """The contacts of stretches, those that go on over an end as one."""
    whole: list[Contact] = []
    going: dict[int, Contact] = {}
    for one in [contact for part in parts for contact in part.contacts]:
        if one.open_start and one.stop in going:
            first = going.pop(one.stop)
            assert first.end == one.start
            impulse, peak = first.impulse + one.impulse, max(first.peak_force, one.peak_force)
            one = replace(one, start=first.start, impulse=impulse, peak_force=peak, open_start=first.open_start)
        if one.open_end:
            going[one.stop] = one
        else:
            whole.append(one)
    return sorted([*whole, *going.values()], key=lambda contact: (contact.start, contact.stop))


def stretches(solver: AnySolver, name: str) -> tuple[list[History], float]:
    """The stretches of a motion, and how long it is, s; those of the analytic solver are short."""
    if isinstance(solver, fe_lapjoint.Solver):
        end = 40.3 * 2 * math.pi / 515.0 if name == "periodic" else 7.0
        return list(solver.stream(driven(name), end)), end
    size = StretchSize(12, room=5, steps=0.5)
    return list(answers.stream(driven(name), solver.name, solver.mode_counts(driven(name)), 0.4, None, size)), 0.4


@pytest.mark.parametrize(
    ("solver", "name"),
    [
        *((ANALYTIC, name) for name in EXCITATIONS),
        (ELEMENTS, "left alone"),
        *(pytest.param(ELEMENTS, name, marks=pytest.mark.thorough) for name in ("record", "periodic")),
    ],
)
def test_stretches_come_to_the_motion_as_a_whole(solver: AnySolver, name: str) -> None:
    parts, end = stretches(solver, name)
    whole = solver.simulate(driven(name), end, errors=False)
    assert len(parts) > 1
    assert (parts[0].start, parts[-1].end) == (0.0, end)
    for one, other in pairwise(parts):
        assert one.end == other.start
        assert one.states[-1] == other.states[0]
        for k in one.states[-1].closed:
            assert [it.end for it in one.contacts if it.stop == k and it.open_end] == [one.end]
            assert [it.start for it in other.contacts if it.stop == k and it.open_start] == [one.end]
    exact = name in EXACT and solver is ANALYTIC
    most = len(whole.contacts) if exact else 6 if solver is ANALYTIC else 20  # beyond, chaos may part roundings
    found, expected = joined(parts)[:most], whole.contacts[:most]
    assert len(found) == len(expected) >= 3
    hardest = max(it.peak_force for it in expected)
    for one, other in zip(found, expected, strict=True):
        assert (one.stop, one.open_start) == (other.stop, other.open_start)
        assert one.start == pytest.approx(other.start, rel=1e-9, abs=1e-15)
        assert one.impulse == pytest.approx(other.impulse, rel=1e-7)
        assert one.peak_force == pytest.approx(other.peak_force, abs=1e-9 * hardest)
    until = end if exact else expected[len(expected) // 2 if solver is ELEMENTS else -1].end
    for part in parts:
        if part.start >= until:
            break
        t = np.linspace(part.start, min(part.end, until), 50)
        for dx, dt in ((0, 0), (2, 0), (0, 1), (0, 2)):
            one, other = (it.evaluate([0.4, 1.25, 2.5], t[:-1], dx, dt) for it in (part, whole))
            assert np.max(np.abs(one - other)) < 1e-7 * np.max(np.abs(other))


@solvers
def test_other_orders_of_questions_get_the_same_answers(solver: AnySolver) -> None:
    """A field that keeps what was asked last must not take places, derivatives or times for others."""
    motion = solver.simulate(driven("random"), 0.05, errors=False)
    rng = np.random.default_rng(3)
    asked = [
        (rng.uniform(0, 2.5, 3), rng.uniform(0, 0.05, m), int(dx), int(dt))
        for m, dx, dt in rng.integers([1, 0, 0], [40, 4, 3], (30, 3))
    ]
    asked += [(x, asked[i - 1][1], dx, dt) for i, (x, _, dx, dt) in enumerate(asked)]
    for x, t, dx, dt in rng.permutation(np.array(asked, dtype=object)).tolist():
        fresh = solver.simulate(driven("random"), 0.05, errors=False).evaluate(x, t, dx, dt)
        assert np.array_equal(motion.evaluate(x, t, dx, dt), fresh)


def test_memory_does_not_grow_with_the_duration() -> None:
    # of which a block of noise lasts 2 s, so that what is kept of it is all there after some seconds
    problem = paper_joint().replace(base_motion=RandomBaseMotion(psd=((100.0, 80.0), (500.0, 80.0))))

    def watched(end: float) -> int:
        tracemalloc.start()
        for part in ANALYTIC.stream(problem, end):
            part.displacement([1.25, 2.5], np.linspace(part.start, part.end, 100))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return peak

    watched(1.0)
    peaks = [watched(end) for end in (12.0, 36.0)]
    assert peaks[1] < 1.25 * peaks[0]  # stretches differ a little; the motion is three times as long
    assert peaks[1] < 20e6


def test_a_stretch_of_finite_elements_keeps_few_pieces_however_long_the_motion() -> None:
    motion = ELEMENTS.stream(driven("record"), 10.0)
    assert max(len(stretch.field.pieces) for stretch, _ in zip(motion, range(3), strict=False)) < 5000


@solvers
def test_a_duration_that_cannot_be_is_refused_at_once(solver: AnySolver) -> None:
    assert isinstance(solver, Streams)
    with pytest.raises(InputError, match="must be positive and finite"):
        solver.stream(driven("random"), 0.0)
    with pytest.raises(InputError, match="the record of base_motion ends at"):
        solver.stream(driven("record"), 11.0)


@solvers
def test_progress_is_told_in_seconds_after_each_stretch(solver: AnySolver) -> None:
    told: list[tuple[float, float]] = []
    parts = list(solver.stream(driven("random"), 5.0, progress=lambda done, total: told.append((done, total))))
    assert len(told) > 1
    assert told == [(part.end, 5.0) for part in parts]
