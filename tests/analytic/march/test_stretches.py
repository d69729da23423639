"""A motion in stretches is the motion as a whole, whatever excites it, and needs no more memory where it is longer."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import analytic
from analytic import answers
from analytic.march.stretches import StretchSize
from lapjoint import BaseMotion, History, InputError, Problem, paper_joint
from lapjoint.answers import Contact
from lapjoint.problem import PolynomialShape, RandomBaseMotion, RecordBaseMotion, SineLoad, StepLoad
from lapjoint.solver import Streams

SOLVER = analytic.Solver(n_modes=8)
RANDOM = RandomBaseMotion(psd=((20.0, 80.0), (500.0, 80.0)), seed=5)
NOISE = 200 * np.random.default_rng(2).standard_normal(2001)
RECORD = RecordBaseMotion(quantity="acceleration", rate=4000.0, values=NOISE)
SINE = BaseMotion(amplitude=0.06, angular_frequency=515.0)
OTHER = SineLoad(x=2.0, force=1e4, angular_frequency=515.0 * np.pi)
LEFT_ALONE = PolynomialShape(displacement=(0.0, 0.0, 4e-3), velocity=(0.0, 0.0, 1.0))
EXCITATIONS = {
    "random": {"base_motion": RANDOM},
    "record": {"base_motion": RECORD},
    "periodic": {"base_motion": SINE},
    "no period": {"base_motion": SINE, "point_loads": (OTHER,)},
    "steady load": {"base_motion": None, "point_loads": (StepLoad(x=2.0, force=1e5),)},
    "left alone": {"base_motion": None, "initial": LEFT_ALONE},
}
END = 0.4


def _problem(name: str) -> Problem:
    return paper_joint().replace(**EXCITATIONS[name])


def _joined(contacts: list[Contact]) -> list[Contact]:
    """Contacts of stretches, those that go on over an end as one."""
    whole: list[Contact] = []
    open_ones: dict[int, int] = {}
    for one in contacts:
        if one.open_start and one.stop in open_ones:
            first = whole[open_ones.pop(one.stop)]
            assert first.end == one.start
            one = replace(
                one,
                start=first.start,
                impulse=first.impulse + one.impulse,
                peak_force=max(first.peak_force, one.peak_force),
                open_start=first.open_start,
            )
            whole[whole.index(first)] = one
        else:
            whole.append(one)
        if one.open_end:
            open_ones[one.stop] = whole.index(one)
    return sorted(whole, key=lambda contact: (contact.start, contact.stop))


def _stretches(problem: Problem, end: float, rows: int) -> list[History]:
    size = StretchSize(rows, room=5, steps=0.5)
    return list(answers.stream(problem, SOLVER.name, SOLVER.mode_counts(problem), end, None, size))


@pytest.mark.parametrize("name", EXCITATIONS)
def test_stretches_come_to_the_motion_as_a_whole(name: str) -> None:
    problem = _problem(name)
    whole = SOLVER.simulate(problem, END, errors=False)
    parts = _stretches(problem, END, 12)
    assert len(parts) > 1
    assert (parts[0].start, parts[-1].end) == (0.0, END)
    for one, other in pairwise(parts):
        assert one.end == other.start
        assert one.states[-1] == other.states[0]
    # where nothing offers an end, one that is made for it is a rounding, which the contacts after it make larger
    exact = name in ("random", "record", "periodic")
    most = len(whole.contacts) if exact else 6
    found, expected = _joined([contact for part in parts for contact in part.contacts])[:most], whole.contacts[:most]
    assert len(found) == len(expected) >= 3
    until = END if exact else expected[-1].end
    hardest = max(it.peak_force for it in expected)
    for one, other in zip(found, expected, strict=True):
        assert (one.stop, one.open_start) == (other.stop, other.open_start)
        assert one.start == pytest.approx(other.start, rel=1e-9, abs=1e-15)
        assert one.impulse == pytest.approx(other.impulse, rel=1e-7)
        assert one.peak_force == pytest.approx(other.peak_force, abs=1e-9 * hardest)
    for part in parts:
        if part.start >= until:
            break
        t = np.linspace(part.start, min(part.end, until), 50)
        for dx, dt in ((0, 0), (2, 0), (0, 1), (0, 2)):
            one, other = (it.evaluate([0.4, 1.25, 2.5], t[:-1], dx, dt) for it in (part, whole))
            assert np.max(np.abs(one - other)) < 1e-7 * np.max(np.abs(other))


def test_a_contact_over_an_end_is_open_in_both() -> None:
    parts = _stretches(_problem("random"), END, 4)
    cut = [(one, other) for one, other in pairwise(parts) if one.states[-1].closed]
    assert cut
    for one, other in cut:
        for k in one.states[-1].closed:
            (before,) = (it for it in one.contacts if it.stop == k and it.open_end)
            (after,) = (it for it in other.contacts if it.stop == k and it.open_start)
            assert before.end == after.start == one.end
            assert min(abs(before.impulse), abs(after.impulse)) > 0


def test_other_orders_of_questions_get_the_same_answers() -> None:
    """The field keeps what was asked last: neither places nor derivatives nor times may be taken for others."""
    problem = _problem("random")
    motion = SOLVER.simulate(problem, 0.05, errors=False)
    rng = np.random.default_rng(3)
    asked = [
        (rng.uniform(0, 2.5, 3), rng.uniform(0, 0.05, m), int(dx), int(dt))
        for m, dx, dt in rng.integers([1, 0, 0], [40, 4, 3], (30, 3))
    ]
    asked += [(x, asked[i - 1][1], dx, dt) for i, (x, _, dx, dt) in enumerate(asked)]
    for x, t, dx, dt in rng.permutation(np.array(asked, dtype=object)).tolist():
        fresh = SOLVER.simulate(problem, 0.05, errors=False).evaluate(x, t, dx, dt)
        assert np.array_equal(motion.evaluate(x, t, dx, dt), fresh)


def test_memory_does_not_grow_with_the_duration() -> None:
    # of which a block of noise lasts 2 s, so that what is kept of it is all there after some seconds
    problem = paper_joint().replace(base_motion=RandomBaseMotion(psd=((100.0, 80.0), (500.0, 80.0))))

    def watched(end: float) -> int:
        tracemalloc.start()
        for part in SOLVER.stream(problem, end):
            part.displacement([1.25, 2.5], np.linspace(part.start, part.end, 100))
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return peak

    watched(1.0)
    peaks = [watched(end) for end in (12.0, 36.0)]
    assert peaks[1] < 1.25 * peaks[0]  # stretches differ a little; the motion is three times as long
    assert peaks[1] < 20e6


def test_a_duration_that_cannot_be_is_refused_at_once() -> None:
    assert isinstance(SOLVER, Streams)
    with pytest.raises(InputError, match="must be positive and finite"):
        SOLVER.stream(_problem("random"), 0.0)
    with pytest.raises(InputError, match="the record of base_motion ends at"):
        SOLVER.stream(_problem("record"), 1.0)


def test_progress_is_told_in_seconds() -> None:
    told: list[tuple[float, float]] = []
    list(SOLVER.stream(_problem("random"), 5.0, progress=lambda done, total: told.append((done, total))))
    assert len(told) > 1
    assert told[-1] == (5.0, 5.0)
    assert [done for done, _ in told] == sorted(done for done, _ in told)
