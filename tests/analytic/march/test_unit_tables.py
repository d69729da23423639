"""Tables of joints with damped stops, scaled from unit loads, against the equations of motion in the modes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from analytic.march import Joint, march
from analytic.march.coupled import is_coupled
from analytic.march.drag import drag_of
from analytic.march.initial_state import started
from analytic.march.known_states import memory_of
from analytic.march.tables import switch_of
from analytic.modes.beam_functions import ComplexArray
from lapjoint import BaseMotion, NoDamping, Problem
from lapjoint.answers.contact_state import FREE, ContactState
from tests.helpers.damped_stops import loose_beam, sampled_joint
from tests.helpers.random_joints import damped_cantilever, dragged_cantilever

MODES = 6
JOINTS = [damped_cantilever(np.random.default_rng(seed)) for seed in range(6)]
JOINTS += [dragged_cantilever(np.random.default_rng(seed)) for seed in range(4)]


def marched(problem: Problem) -> Joint:
    """A joint after a motion that met some states."""
    joint = Joint(problem, MODES, MODES)
    march(joint, started(joint), 0.0, 2.0)
    return joint


def response(joint: Joint, state: ContactState, h: int) -> ComplexArray:
    """Complex amplitudes of z and of z + (c / k) z' at the stops, m, ``(2, P)``: the modes' linear system, solved."""
    modal, stops, s = joint.modal(state), joint.problem.structure.stops, 1j * joint.harmonics.omega[h]
    left_out, size = joint.left_out(state)[1 + h], joint.sizes[1 + h]
    force = (modal.force[1 + h] * size).astype(complex)
    system = np.diag(modal.modes.omega**2 + 2 * s * modal.damping_rate + s**2)
    if joint.problem.structure.couples:
        drag = drag_of(joint.loaded, state.pressed, MODES)
        system, force = system + s * drag.D, force - s * drag.left_out[1 + h] * size
    for k in state.closed:
        gain = -stops[k].stiffness if k in state.released else s * stops[k].damping
        system = system + gain * np.outer(modal.at_stops[k], modal.at_stops[k])
        force -= gain * left_out[k] * modal.at_stops[k]
    z = modal.at_stops @ np.linalg.solve(system, force) + left_out
    delay = np.array([stop.damping / stop.stiffness for stop in stops])
    return np.array([z, z * (1 + s * delay)])


def cases() -> Iterator[tuple[Joint, ContactState, int]]:
    """The joints, the states that they met, and the slots of these."""
    for problem in JOINTS:
        joint = marched(problem)
        yield from ((joint, state, slot) for slot, state in enumerate(joint.states))


def test_the_forced_motion_at_the_stops_solves_the_equations_of_the_modes() -> None:
    worst = 0.0
    for joint, state, slot in cases():
        damped = np.flatnonzero([stop.damping > 0 for stop in joint.problem.structure.stops])
        for h in range(joint.harmonics.omega.size):
            gaps, forces = response(joint, state, h)
            seen = np.concatenate([gaps, forces[damped]]) if is_coupled(joint.problem, state) else gaps
            found = joint.tables.forced[slot, joint.tables.position[: seen.size], h]
            worst = max(worst, float(np.abs(found - seen).max() / np.abs(gaps).max()))
    assert worst < 1e-12


def test_switches_keep_displacements_and_velocities_of_the_modes() -> None:
    rng, worst, switches = np.random.default_rng(0), 0.0, 0
    for joint, old, slot in cases():
        tables = joint.tables
        for row in np.flatnonzero(tables.passage[slot] >= 0).tolist():
            new, at, t = old.toggled(switch_of(tables, row)), int(tables.passage[slot, row]), float(rng.uniform(0, 9))
            switches += 1
            waves = np.exp(1j * joint.harmonics.theta(t))
            P, V = rng.normal(size=(2, MODES))
            there = tables.whole[at].reshape(2 * MODES, 2 * MODES) @ np.concatenate([P, V])
            load = tables.whole_load[at].reshape(-1, 2 * MODES)
            there += load[0].real + (waves @ load[1:]).imag
            q, v = joint.in_modes(old, P, V, t)
            if new.closed != old.closed:
                passage = joint.passage(old.pressed, new.pressed)
                q = passage.S @ q + passage.residual[0] + waves.imag @ passage.residual[1:]
                v = passage.S @ v + (joint.harmonics.omega * waves.real) @ passage.residual[1:]
            expected = np.concatenate(joint.from_modes(new, q, v, t))
            worst = max(worst, float(np.abs(there - expected).max() / np.abs(expected).max()))
    assert switches > len(JOINTS)
    assert worst < 1e-12


def resonant() -> Problem:
    """A joint without damping in the beam, driven at its first frequency."""
    joint = JOINTS[0].replace(damping=NoDamping())
    omega = Joint(joint, 1, 1).modal(FREE).modes.omega[0]
    return joint.replace(base_motion=BaseMotion(amplitude=0.02, angular_frequency=float(omega)))


@pytest.mark.parametrize("problem", [*JOINTS[:3], JOINTS[-1], sampled_joint(0), loose_beam(0), resonant()])
def test_states_known_beforehand_change_no_bit(problem: Problem) -> None:
    memory_of.cache_clear()
    ends = []
    for _ in range(2):
        joint = Joint(problem, MODES, MODES)
        known = len(joint.known.states)
        motion = march(joint, started(joint), 0.0, 1.0)
        ends.append([part.tobytes() for part in (*motion.log[1:], motion.end.q, motion.end.v, motion.penetration)])
    assert known == len(joint.states) > 1
    assert ends[0] == ends[1]
