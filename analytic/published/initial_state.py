"""Where a motion by the published scheme starts: at the initial state, or at a section point with its frozen shape.

The coordinates of a section point are q and v, padded to the largest number of modes, and after q one block for each
state in which the frozen shape has coefficients: the stops that are closed in it, as the bits of a number, then the
coefficients.
"""

from __future__ import annotations

import numpy as np

from analytic.march.initial_state import TOUCHING, initial_coordinates
from analytic.march.motion import SLOT
from analytic.march.switching import switch_frozen
from analytic.march.touching import by_displacement_and_velocity
from analytic.published.joint import FrozenMotion, PublishedJoint
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.problem import FloatArray


def started(joint: PublishedJoint, start: SectionPoint | None) -> FrozenMotion:
    """The motion at the time 0, from the initial state, or from a section point of a joint with as many modes.

    An initial shape is carried over like the deflected shape at a switch to the modes of the first state.  The part of
    it outside their span is left out, as there are no other modes to write it with.
    """
    if start is not None:
        return _resumed(joint, start)
    state = ContactState(tuple(by_displacement_and_velocity(joint.problem)[0]))
    return joint.begin(state, *initial_coordinates(joint.problem, joint.modal(state).modes))


def packed(joint: PublishedJoint, motion: FrozenMotion) -> SectionPoint:
    """The section point of a motion, with its frozen shape."""
    blocks = [motion.moving.q]
    for other in joint.order[joint.order < motion.rest.shape[0]]:
        coefficients = motion.rest[other]
        if coefficients.any():
            bits = float(sum(1 << stop for stop in joint.state_in(other).closed))
            blocks.append(np.concatenate([[bits], coefficients]))
    q = np.concatenate(blocks)
    v = np.concatenate([motion.moving.v, np.zeros(q.size - motion.moving.v.size)])
    return SectionPoint(joint.state_in(motion.slot), np.stack([q, v]))


def _resumed(joint: PublishedJoint, point: SectionPoint) -> FrozenMotion:
    """The motion at a section point."""
    size = max(joint.counts)
    q, v = point.coordinates
    blocks = [(_state_of(int(block[0])), block[1:]) for block in q[size:].reshape(-1, size + 1)]
    slots = [joint.slot(state) for state, _ in blocks]
    motion = joint.begin(point.state, q[:size], v[:size])
    for other, (_, coefficients) in zip(slots, blocks, strict=True):
        motion.rest[other] = coefficients
    return _switched(joint, point.state, motion)


def _state_of(bits: int) -> ContactState:
    """The contact state whose stops are the bits of a number."""
    return ContactState(tuple(stop for stop in range(bits.bit_length()) if bits >> stop & 1))


def _switched(joint: PublishedJoint, state: ContactState, motion: FrozenMotion) -> FrozenMotion:
    """Close and open stops whose gaps have changed since the section point was taken."""
    z = _at_stops(joint, motion)
    closed = []
    for k, stop in enumerate(joint.problem.structure.stops):
        least = stop.gap - TOUCHING * abs(stop.gap) if k in state else stop.gap
        if stop.sign * z[k] > least:
            closed.append(k)
    if tuple(closed) != state.closed:
        target, moving = joint.slot(ContactState(tuple(closed))), motion.moving
        switch_frozen(joint.tables, joint.frozen(motion), motion.slot, target, moving.q, moving.v)
        moving.counts[SLOT] = target
    return motion


def _at_stops(joint: PublishedJoint, motion: FrozenMotion) -> FloatArray:
    """Displacement at the stops, m, shape ``(P,)``."""
    tables, q = joint.tables, motion.moving.q
    whole = motion.rest.copy()
    whole[motion.slot] += q
    values = np.zeros(tables.weight.shape[1])
    for other in joint.order[joint.order < whole.shape[0]]:  # as in `analytic.march.switching.freeze`
        values += tables.weight[other, :, : q.size] @ whole[other]
    return np.asarray(values[tables.position])
