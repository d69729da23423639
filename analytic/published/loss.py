"""How much of a motion each switch of the published scheme fails to carry over, which measures its truncation.

Let A be the contact state before a switch, and B the state after it, with the modes Phi_i.  The displacement z splits
into sum Phi_i (Phi_i, z), which moves on, and R, which stands still.  The part of the velocity outside the span of the
modes is lost.  In the inner product (f, g) = integral of m f g and in the energy of state B,

    a(f, g) = integral of EI f'' g'' + support springs + sum over the closed stops of B of k f(x_s) g(x_s),

both parts of the displacement are orthogonal, a(Phi_i, R) = omega_i^2 (Phi_i, R) = 0, so their elastic energies add up.
All inner products have closed forms: for a mode Phi_j of state A, a_A(Phi_j, g) = omega_j^2 (Phi_j, g).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.tables import IntArray
from analytic.published.field import PublishedField
from analytic.published.joint import PublishedJoint
from analytic.published.march import PublishedMarch
from lapjoint.answers import History
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class FrozenPart:
    """The losses at each switch, each of shape ``(switches,)``."""

    time: FloatArray
    """Time of the switch, s."""
    displacement: FloatArray
    """Norm of the frozen shape R after the switch, divided by the norm of the whole displacement."""
    displacement_added: FloatArray
    """Norm of the change of R at this switch, divided by the norm of the whole displacement."""
    energy: FloatArray
    """Elastic energy a(R, R) / 2 of the frozen shape, divided by the elastic energy of the whole displacement."""
    kinetic: FloatArray
    """Kinetic energy that the next modes do not span, lost at the switch, divided by the kinetic energy before."""
    kinetic_lost: FloatArray
    """Kinetic energy lost since the start, J."""


def frozen_part(history: History) -> FrozenPart:
    """The fractions of displacement and energy that the frozen shape holds, for each switch of a motion by
    `PublishedScheme`.

    `TypeError` is raised if another solver made the history.
    """
    if not isinstance(history.field, PublishedField):
        raise TypeError(f"frozen_part takes a history of analytic.PublishedScheme, not of {history.solver}")
    motion = history.field.motion
    joint, log = motion.joint, motion.log
    assert isinstance(joint, PublishedJoint)
    met = len(joint.states)
    products = _products(joint)
    rest, whole = _flat(motion.rest[:, :met]), _flat(_whole(motion)[:, :met])
    after, change = rest[1:], np.diff(rest, axis=0)
    size = _norms(whole[1:], products)
    before, behind = 0.5 * (log.v_end[:-1] ** 2).sum(axis=1), 0.5 * (log.v[1:] ** 2).sum(axis=1)
    return FrozenPart(
        time=log.start[1:].copy(),
        displacement=_norms(after, products) / size,
        displacement_added=_norms(change, products) / size,
        energy=_energies(joint, log.slot[1:], after) / _energies(joint, log.slot[1:], whole[1:]),
        kinetic=(before - behind) / before,
        kinetic_lost=np.cumsum(before - behind),
    )


def _whole(motion: PublishedMarch) -> FloatArray:
    """Coefficients of the whole displacement at the start of each segment, shape ``(M, S, N)``."""
    whole, log = motion.rest.copy(), motion.log
    whole[np.arange(log.slot.size), log.slot] += log.q
    return whole


def _flat(coefficients: FloatArray) -> FloatArray:
    """Coefficients ``(M, S, N)`` in the shape ``(M, S N)``."""
    return coefficients.reshape(coefficients.shape[0], -1)


def _products(joint: PublishedJoint) -> FloatArray:
    """(Phi_i, Phi_j) of all modes of all states, shape ``(S N, S N)``."""
    met, size = len(joint.states), max(joint.counts)
    return np.asarray(joint.cross[:met, :met].transpose(0, 2, 1, 3).reshape(met * size, met * size))


def _norms(coefficients: FloatArray, products: FloatArray) -> FloatArray:
    """sqrt((f, f)), kg^1/2 m, shape ``(M,)``."""
    squares = np.einsum("mi,ij,mj->m", coefficients, products, coefficients)
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)))


def _energies(joint: PublishedJoint, slots: IntArray, coefficients: FloatArray) -> FloatArray:
    """a(f, f) / 2 in the states of `slots`, J, shape ``(M,)``."""
    states, size = len(joint.states), max(joint.counts)
    omega, stops = np.zeros((states, size)), np.zeros((states, size, joint.stops))
    for slot, modal in enumerate(map(joint.modal, joint.states)):
        omega[slot, : modal.size], stops[slot, : modal.size] = modal.modes.omega, modal.at_stops.T
    closed = joint.tables.closed[:states] * np.array([stop.stiffness for stop in joint.problem.structure.stops])
    at_stops = stops.reshape(states * size, -1)
    springs = (stops * closed[:, None, :]).reshape(states * size, -1) @ at_stops.T
    bending = omega.reshape(-1, 1) ** 2 * _products(joint) - springs
    values = coefficients @ at_stops
    stored = np.einsum("mi,ij,mj->m", coefficients, bending, coefficients)
    return np.asarray(0.5 * (stored + (closed[slots] * values**2).sum(axis=1)))
