"""Joints share nothing that can be written to: in turn or in threads, they give the bits that they give alone."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from alone import assert_the_same_in_threads_that_know_nothing, forget

from analytic.march import Coordinates, Joint, known_states, march, tables
from analytic.march.initial_state import started
from lapjoint import Problem, paper_joint
from lapjoint.solver import make_solver

FREQUENCIES = (181.0, 515.0, 820.0, 1400.0, 2060.0, 2600.0, 3300.0, 4100.0)  # they meet states in different orders
PARTS = 12


def problem(omega: float) -> Problem:
    return paper_joint(angular_frequency=omega)


def steps(omega: float) -> Iterator[bytes]:
    """A motion in `PARTS` parts of a third of a period each, and the bits of each."""
    joint = Joint(problem(omega), 9, 7)
    now, span = started(joint), 2 * math.pi / omega / 3
    for i in range(PARTS):
        motion = march(joint, now, i * span, (i + 1) * span, depth=True)
        now = motion.end
        log = (motion.log.start, motion.log.q[:, :7], motion.log.area, motion.log.deepest, motion.penetration)
        yield b"".join(part.tobytes() for part in (*log, now.y)) + str(now.state.closed).encode()


def alone(omega: float) -> list[bytes]:
    forget()
    return list(steps(omega))


def test_two_joints_of_one_structure_marched_in_turn() -> None:
    one, other = alone(FREQUENCIES[0]), alone(FREQUENCIES[4])
    forget()
    both = list(zip(steps(FREQUENCIES[0]), steps(FREQUENCIES[4]), strict=True))
    assert [pair[0] for pair in both] == one
    assert [pair[1] for pair in both] == other


def test_states_known_from_other_motions_change_no_bit() -> None:
    """The memory of a structure only grows, and decides only what is filled in beforehand."""
    one = alone(FREQUENCIES[0])
    memory = known_states.memory_of(Joint(problem(FREQUENCIES[0]), 9, 7).loaded, (9, 7))
    before = memory.known
    for omega in FREQUENCIES[1:]:
        list(steps(omega))
    assert set(before.states) < set(memory.known.states)
    assert set(before.switches) < set(memory.known.switches)
    assert list(memory.known.states) == sorted(memory.known.states)
    assert list(steps(FREQUENCIES[0])) == one
    memory.known = before  # as if another thread had replaced it: what is lost is only met again
    assert list(steps(FREQUENCIES[0])) == one


@pytest.mark.parametrize("solver", ["analytic", pytest.param("analytic-published", marks=pytest.mark.thorough)])
def test_eight_threads_that_know_nothing(solver: str) -> None:
    def answer(omega: float) -> tuple[bytes, ...]:
        history = make_solver(solver).simulate(problem(omega), 3 * 2 * math.pi / omega, errors=False)
        contacts = np.array([(c.stop, c.start, c.end, c.impulse, c.peak_force) for c in history.contacts])
        z = history.displacement(np.array([1.25, 2.5]), np.linspace(0, history.end, 20))
        return contacts.tobytes(), history.switch_times.tobytes(), z.tobytes()

    assert_the_same_in_threads_that_know_nothing(answer, FREQUENCIES)


def test_what_is_kept_cannot_be_written_to() -> None:
    forget()
    joint = Joint(problem(515.0), 5, 5)
    march(joint, Coordinates(*vars(started(joint)).values()), 0.0, 0.02)
    unit = tables.unit_tables(joint.loaded, joint.counts, known_states.memory_of(joint.loaded, joint.counts).known)
    assert unit.tables.modes.size > 1
    for part in (*unit.tables, *unit[1:]):
        assert not isinstance(part, np.ndarray) or not part.flags.writeable
