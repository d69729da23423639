"""Joints share nothing that can be written to: in turn or in threads, they give the bits that they give alone."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from alone import assert_the_same_in_threads_that_know_nothing, forget, restless_threads
from refining import AnySolver

import analytic
import fe_lapjoint
from analytic.march import Joint, known_states, march, unit_tables
from analytic.march.initial_state import started
from fe_lapjoint.modes.assembly import unit_element
from fe_lapjoint.modes.eigenmodes import eigenmodes
from lapjoint import ContactState, paper_joint
from lapjoint.orbits import PeriodMap

SOLVERS = {"analytic": analytic.Solver(free_modes=9, contact_modes=7), "fe": fe_lapjoint.Solver(elements=8)}
FREQUENCIES = (181.0, 515.0, 820.0, 1400.0, 2060.0, 2600.0, 3300.0, 4100.0)  # they meet states in different orders
PERIODS = 4
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)


def map_of(solver: AnySolver, omega: float) -> PeriodMap:
    return solver.period_map(paper_joint(angular_frequency=omega))


def steps(solver: AnySolver, omega: float) -> Iterator[bytes]:
    """A motion of `PERIODS` periods, and the bits of each."""
    period_map = map_of(solver, omega)
    point = period_map.initial()
    for _ in range(PERIODS):
        history, passage = period_map.history(point, 1), period_map.march(point, 2)
        point = passage.end
        contacts = np.array([(c.stop, c.start, c.end, c.impulse, c.peak_force) for c in history.contacts])
        numbers = (contacts, history.switch_times, passage.impulses, point.coordinates)
        yield b"".join(part.tobytes() for part in numbers) + str(point.state.closed).encode()


def alone(solver: AnySolver, omega: float) -> list[bytes]:
    forget()
    return list(steps(solver, omega))


@solvers
def test_two_joints_of_one_structure_marched_in_turn(solver: AnySolver) -> None:
    one, other = alone(solver, FREQUENCIES[0]), alone(solver, FREQUENCIES[4])
    forget()
    both = list(zip(steps(solver, FREQUENCIES[0]), steps(solver, FREQUENCIES[4]), strict=True))
    assert [pair[0] for pair in both] == one
    assert [pair[1] for pair in both] == other


@pytest.mark.parametrize(
    "solver",
    [*SOLVERS.values(), pytest.param(analytic.PublishedScheme(), marks=pytest.mark.thorough)],
    ids=[*SOLVERS, "as published"],
)
def test_eight_threads_that_know_nothing(solver: AnySolver | analytic.PublishedScheme) -> None:
    def answer(omega: float) -> tuple[bytes, ...]:
        history = solver.simulate(paper_joint(angular_frequency=omega), 3 * 2 * math.pi / omega, errors=False)
        contacts = np.array([(c.stop, c.start, c.end, c.impulse, c.peak_force) for c in history.contacts])
        z = history.displacement(np.array([1.25, 2.5]), np.linspace(0, history.end, 20))
        return contacts.tobytes(), history.switch_times.tobytes(), z.tobytes()

    assert_the_same_in_threads_that_know_nothing(answer, FREQUENCIES)


def test_threads_may_share_one_period_map_of_finite_elements() -> None:
    """Its states are made as they are met, by whichever thread meets them first."""

    def marched(period_map: PeriodMap) -> bytes:
        return period_map.march(period_map.initial(), 12).end.coordinates.tobytes()

    forget()
    expected = marched(map_of(SOLVERS["fe"], 515.0))
    forget()
    shared = map_of(SOLVERS["fe"], 515.0)
    with restless_threads(8) as threads:
        assert set(threads.map(marched, [shared] * 8)) == {expected}


def test_what_is_kept_cannot_be_written_to() -> None:
    forget()
    joint = Joint(paper_joint(), 5, 5)
    march(joint, started(joint), 0.0, 0.02)
    unit = unit_tables.unit_tables(joint.loaded, joint.counts, known_states.memory_of(joint.loaded, joint.counts).known)
    assert unit.tables.modes.size > 1
    model = fe_lapjoint.Solver(elements=8).period_map(paper_joint()).model
    kept = (*unit.tables, *unit[1:], *unit_element(), *eigenmodes(model.assembly, ContactState((0,))))
    assert not any(part.flags.writeable for part in kept if isinstance(part, np.ndarray))
