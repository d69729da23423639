"""Tables that the joints of a structure share: none of them writes to what another borrows."""

from __future__ import annotations

import numpy as np

from analytic.march import Joint, march
from analytic.march.initial_state import started
from analytic.march.known_states import memory_of
from analytic.march.tables import Tables, unit_tables
from lapjoint import paper_joint
from lapjoint.answers.contact_state import ContactState

_MODES = 4


def joint_at(omega: float, ratio: float) -> Joint:
    return Joint(paper_joint(angular_frequency=omega, damping_ratio=ratio), _MODES, _MODES)


def arrays_of(tables: Tables) -> dict[str, np.ndarray]:
    return {name: part for name, part in tables._asdict().items() if isinstance(part, np.ndarray)}


def test_a_joint_that_meets_new_states_leaves_what_it_has_borrowed_as_it_was() -> None:
    ratio = 0.0317  # no other test has met states of this structure
    first = joint_at(300.0, ratio)
    march(first, started(first), 0.0, 0.05)
    unit = unit_tables(first.loaded, first.counts, memory_of(first.loaded, first.counts).known)
    second = joint_at(900.0, ratio)
    assert np.shares_memory(second.tables.turn, unit.tables.turn)
    before = {name: part.copy() for name, part in arrays_of(unit.tables).items()}
    march(second, started(second), 0.0, 0.05)
    known = set(second.states)
    other = next(state for k in range(4) if (state := ContactState((k,))) not in known or k == 3)
    second.connect(second.slot(other), (other.closed[0] + 1) % 4)
    assert not np.shares_memory(second.tables.turn, unit.tables.turn)
    for name, part in arrays_of(unit.tables).items():
        assert np.array_equal(part, before[name]), name


def test_an_undamped_joint_at_resonance_moves_a_mode_of_its_own() -> None:
    plain = joint_at(300.0, 0.0)
    march(plain, started(plain), 0.0, 0.02)
    resonant = float(plain.modal(ContactState(())).modes.omega[0])
    unit = unit_tables(plain.loaded, plain.counts, memory_of(plain.loaded, plain.counts).known)
    before = unit.tables.root.copy()
    assert not np.array_equal(joint_at(resonant, 0.0).tables.root, before)
    assert np.array_equal(unit.tables.root, before)
