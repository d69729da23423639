"""Joints share nothing that can be written to: in turn or in threads, they give the bits that they give alone."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from alone import assert_the_same_in_threads_that_know_nothing, forget, restless_threads

import fe_lapjoint
from fe_lapjoint.modes.assembly import unit_element
from fe_lapjoint.modes.eigenmodes import eigenmodes
from lapjoint import ContactState, Problem, paper_joint

SOLVER = fe_lapjoint.Solver(elements=8)
FREQUENCIES = (181.0, 515.0, 820.0, 1400.0, 2060.0, 2600.0, 3300.0, 4100.0)  # they meet states in different orders
PARTS = 4


def problem(omega: float) -> Problem:
    return paper_joint(angular_frequency=omega)


def steps(omega: float) -> Iterator[bytes]:
    """A motion in `PARTS` periods, and the bits of each."""
    period_map = SOLVER.period_map(problem(omega))
    point = period_map.initial()
    for _ in range(PARTS):
        history = period_map.history(point, 1)
        passage = period_map.march(point, 2)
        point = passage.end
        contacts = np.array([(c.stop, c.start, c.end, c.impulse, c.peak_force) for c in history.contacts])
        numbers = (contacts, history.switch_times, passage.impulses, point.coordinates)
        yield b"".join(part.tobytes() for part in numbers) + str(point.state.closed).encode()


def alone(omega: float) -> list[bytes]:
    forget()
    return list(steps(omega))


def test_two_joints_of_one_family_marched_in_turn() -> None:
    one, other = alone(FREQUENCIES[0]), alone(FREQUENCIES[4])
    forget()
    both = list(zip(steps(FREQUENCIES[0]), steps(FREQUENCIES[4]), strict=True))
    assert [pair[0] for pair in both] == one
    assert [pair[1] for pair in both] == other


def test_eight_threads_that_know_nothing() -> None:
    def answer(omega: float) -> tuple[bytes, ...]:
        history = SOLVER.simulate(problem(omega), 3 * 2 * math.pi / omega, errors=False)
        z = history.displacement(np.array([1.25, 2.5]), np.linspace(0, history.end, 20))
        return *steps(omega), z.tobytes()

    assert_the_same_in_threads_that_know_nothing(answer, FREQUENCIES)


def test_threads_may_share_one_period_map() -> None:
    """Its states are made as they are met, by whichever thread meets them first."""

    def marched(period_map: fe_lapjoint.period_map.PeriodMap) -> bytes:
        return period_map.march(period_map.initial(), 12).end.coordinates.tobytes()

    forget()
    expected = marched(SOLVER.period_map(problem(515.0)))
    forget()
    shared = SOLVER.period_map(problem(515.0))
    with restless_threads(8) as threads:
        assert set(threads.map(marched, [shared] * 8)) == {expected}


def test_what_is_kept_cannot_be_written_to() -> None:
    period_map = SOLVER.period_map(problem(515.0))
    kept = (*unit_element(), *eigenmodes(period_map.model.assembly, ContactState((0,))))
    for part in kept:
        with pytest.raises(ValueError, match="read-only"):
            part[0] = 1.0
