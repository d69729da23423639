"""Where a motion by the published scheme starts: at the initial state, or at a section with its frozen shape.

A section's coordinates are q and v, padded to the largest number of modes, and after q one block for each state in
which the frozen shape has coefficients: the stops that are closed in it, as the bits of a number, then the
coefficients.
"""

from __future__ import annotations

import numpy as np

from analytic import published_kernel
from analytic.published_kernel import Carried
from analytic.published_march import PublishedJoint
from analytic.start import TOUCHING, initial_coordinates, initial_state
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.problem import FloatArray


def started(joint: PublishedJoint, start: SectionPoint | None) -> tuple[int, Carried]:
    """Slot and coordinates at the initial state, or at a section of a joint with the same numbers of modes.

    An initial shape is carried over like the deflected shape at a switch to the modes of the first state; what they
    cannot hold of it is left out, as there are no modes that it could be a sum of.
    """
    if start is not None:
        return _resumed(joint, start)
    state = initial_state(joint.problem)
    return joint.begin(state, *initial_coordinates(joint.problem, joint.model(state).modes))


def packed(joint: PublishedJoint, slot: int, carried: Carried) -> SectionPoint:
    """The section of a motion."""
    blocks = [carried.q]
    for other in joint.frozen_tables.order:
        coefficients = carried.rest[other]
        if coefficients.any():
            bits = float(sum(1 << stop for stop in joint.state_in(other).closed))
            blocks.append(np.concatenate([[bits], coefficients]))
    q = np.concatenate(blocks)
    v = np.concatenate([carried.v, np.zeros(q.size - carried.v.size)])
    return SectionPoint(joint.state_in(slot), np.stack([q, v]))


def _resumed(joint: PublishedJoint, section: SectionPoint) -> tuple[int, Carried]:
    size = joint.cross.shape[2] or max(joint.tables.weight.shape[2] // 2, 1)
    q, v = section.coordinates
    blocks = [(_state_of(int(block[0])), block[1:]) for block in q[size:].reshape(-1, size + 1)]
    slots = [joint.slot(state) for state, _ in blocks]
    slot, carried = joint.begin(section.state, q[:size], v[:size])
    for other, (_, coefficients) in zip(slots, blocks, strict=True):
        carried.rest[other] = coefficients
    return _switched(joint, section.state, slot, carried)


def _state_of(bits: int) -> ContactState:
    return ContactState(tuple(stop for stop in range(bits.bit_length()) if bits >> stop & 1))


def _switched(joint: PublishedJoint, state: ContactState, slot: int, carried: Carried) -> tuple[int, Carried]:
    """Close and open stops whose gaps are others than when the section was taken."""
    z = _at_stops(joint, slot, carried)
    closed = []
    for k, stop in enumerate(joint.problem.stops):
        least = stop.gap * (1 - TOUCHING) if k in state else stop.gap
        if stop.sign * z[k] > least:
            closed.append(k)
    if tuple(closed) == state.closed:
        return slot, carried
    target = joint.slot(ContactState(tuple(closed)))
    joint.refresh()
    carried = joint.grown(carried)
    published_kernel.switch(joint.frozen_tables, joint.cross, slot, target, carried)
    return target, carried


def _at_stops(joint: PublishedJoint, slot: int, carried: Carried) -> FloatArray:
    """Displacement at the stops, m, shape ``(P,)``."""
    tables, size = joint.frozen_tables, carried.q.size
    whole = carried.rest.copy()
    whole[slot] += carried.q
    values = np.zeros(tables.weight.shape[1])
    for other in tables.order:  # as in `analytic.published_kernel.freeze`
        values += tables.weight[other, :, :size] @ whole[other]
    return np.asarray(values[tables.position])
