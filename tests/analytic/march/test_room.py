"""Tables of contact states grow with the states and switches that a motion meets, whatever could be met."""

from __future__ import annotations

import pytest

from analytic.march import Joint, march
from analytic.march.initial_state import started
from analytic.march.tables import PER_SLOT, PER_SWITCH, known_switches
from lapjoint import BaseMotion, Beam, ModalDamping, Problem, SolverError, Stop, Support
from lapjoint.machine import memory
from lapjoint.machine.result_cache import bytes_in

MODES, STOPS = 80, 20


def pinned(stops: int) -> Problem:
    """A beam between two pins with stops all along it, above and below, shaken so that it meets several."""
    places = [(i // 2 + 1) / (stops // 2 + 1) for i in range(stops)]
    sides = ("bottom", "top")
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=100.0, mass_per_length=1.0),
        supports=tuple(Support(x=x, translational=float("inf"), torsional=0.0) for x in (0.0, 1.0)),
        stops=tuple(Stop(x=x, side=sides[i % 2], gap=1e-3, stiffness=1e5) for i, x in enumerate(places)),
        damping=ModalDamping(ratio=0.02),
        base_motion=BaseMotion(amplitude=0.05, angular_frequency=100.0),
    )


def bound(states: int, switches: int, stops: int, modes: int) -> float:
    """Bytes of tables with half as many rows to spare, and of four more.

    A switch takes a matrix of modes by modes and two rows.  A state takes 64 tabulated steps, 2 frequencies, twice over
    for terms, as complex numbers; each stop's position, twice over; 20 numbers a mode and 10 a stop besides.
    """
    rows, slots = 1.5 * switches + 4, 1.5 * states + 4
    each = (64 + 2) * 2 * modes * 16 + stops // 2 * 2 * modes * 8 + 20 * modes * 8 + 10 * stops * 8
    return rows * (modes**2 + 2 * modes) * 8 + slots * each


@pytest.fixture(scope="module")
def met() -> Joint:
    """A joint after a motion that met some states."""
    joint = Joint(pinned(STOPS), MODES, MODES)
    march(joint, started(joint), 0.0, 0.008)
    return joint


def test_tables_take_what_the_states_and_switches_met_take(met: Joint) -> None:
    tables, states, switches = met.tables, len(met.states), known_switches(met.tables)
    assert states >= 3
    assert switches <= 2 * states * STOPS
    taken = sum(bytes_in(getattr(tables, name)) for name in (*PER_SLOT, *PER_SWITCH))
    assert taken <= bound(states, switches, STOPS, MODES)
    assert taken < states * STOPS * MODES**2 * 8 / 2  # half of a matrix for every stop of every state


def test_tables_too_large_for_the_machine_end_in_a_sentence(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(memory, "machine_bytes", lambda: 4 * bound(2, 2, STOPS, MODES))
    unknown = ModalDamping(ratio=0.0203)  # no other test has met states with it
    joint = Joint(pinned(STOPS).replace(damping=unknown), MODES, MODES)
    message = r"^the tables of \d+ contact states and \d+ switches, of 80 modes each, take .*: take fewer modes"
    with pytest.raises(SolverError, match=message):
        march(joint, started(joint), 0.0, 0.01)


@pytest.mark.slow
def test_a_hundred_stops_with_320_modes_stay_within_a_few_gigabytes() -> None:
    joint = Joint(pinned(100), 320, 320)
    march(joint, started(joint), 0.0, 0.007)
    states, switches = len(joint.states), known_switches(joint.tables)
    assert states >= 10
    taken = sum(bytes_in(getattr(joint.tables, name)) for name in (*PER_SLOT, *PER_SWITCH))
    assert taken <= bound(states, switches, 100, 320)
    assert taken < states * 100 * 320**2 * 8 / 10
