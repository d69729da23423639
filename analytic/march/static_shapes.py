r"""The joint without contact under unit forces, in closed form, and the energy of its modes.

With N modes of the joint without contact, a force of 1 N at a moves q_i to Phi_i(a) / omega_i^2.  The displacement at b
is the whole series, of which the modes have a part; the rest is in closed form, as that of any other load
(`analytic.modes.static_residual`).  A section point in contact takes these shapes, in its modes, as deviations.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from analytic.march.joint import Joint
from analytic.march.modal_state import loaded_structure, modal_state
from analytic.modes.normal_modes import pool_size
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.problem import FloatArray
from lapjoint.problem.forces import ConstantForce
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.problem import resting


def static_shapes(joint: Joint, state: ContactState, places: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Static shapes of unit forces at `places`, m, ``(p,)``, on the joint without contact, which has no rigid-body
    mode.

    Given are the modal displacements in the ``n`` modes of `state` under each force, kg^1/2 m/N, ``(p, n)``, and the
    compliance, m/N, ``(p, p)``: the displacement at each place, in row i under the force at place i.
    """
    modes = joint.modal(FREE).modes
    shapes = (modes.shapes(places) / modes.omega[:, None] ** 2).T
    if state != FREE:
        shapes = shapes @ joint.passage(FREE, state.pressed).S.T
    return shapes, np.array([_deflection(joint, float(a), places) for a in places])


def _deflection(joint: Joint, a: float, places: FloatArray) -> FloatArray:
    """Static displacement of the joint without contact at places, m, ``(p,)``, under a force of 1 N at `a`."""
    unit = ConstantForce(LoadShape.at(a), 1.0)
    pressed = resting(replace(joint.problem.structure, stops=()), (unit,))
    state = modal_state(loaded_structure(pressed), FREE, pool_size(1))
    return np.asarray((state.force[0] / state.modes.omega**2) @ state.modes.shapes(places) + state.residual(places)[0])


def free_energy(joint: Joint, state: ContactState) -> FloatArray:
    """Matrix A, ``(2 n, 2 n)``, of the energy e . A e / 2, J, that deviations e = (q, v) have on the joint without
    contact.

    The deviations are in the ``n`` modes of `state`.  The joint without contact has no rigid-body mode.
    """
    modal = joint.modal(FREE)
    n = joint.count(state)
    into = np.eye(n) if state == FREE else joint.passage(state.pressed, FREE).S
    bending = into.T @ (modal.modes.omega[:, None] ** 2 * into)
    nothing = np.zeros((n, n))
    matrix, it = np.block([[(bending + bending.T) / 2, nothing], [nothing, np.eye(n)]]), joint.coupled(state)
    return matrix if it is None else np.asarray(it.to.T @ matrix @ it.to)
