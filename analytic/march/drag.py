r"""Viscous damping that couples the modes, because the joint has masses or a mass per length that changes.

A force -C z_t per unit length acts on mode i by

    -(Phi_i, C z_t) = -sum_j D_ij q_j' - sum_l d_li f_l'(t),    D_ij = C integral of Phi_i Phi_j,
                                                                d_li = C integral of Phi_i r_l,

because the shapes r_l that the modes leave out move with the loads f_l, see `analytic.modes.static_residual`.
"""

from __future__ import annotations

from dataclasses import dataclass

from analytic.march.modal_state import LoadedStructure, modal_state
from analytic.modes.normal_modes import pool_size
from analytic.modes.overlaps import overlaps
from lapjoint.answers.contact_state import ContactState
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray

_STATES = 256  # contact states kept, as in `analytic.march.modal_state`; 20 kB each


@dataclass(frozen=True, eq=False)
class Drag:
    """The viscous force on ``N`` modes of a contact state under loads of unit size."""

    D: FloatArray
    """Damping matrix, 1/s, shape ``(N, N)``."""
    left_out: FloatArray
    """d of the left-out shapes, kg^1/2 m/s for each unit of load, shape ``(1 + H + R, N)``."""


def drag_of(loaded: LoadedStructure, state: ContactState, count: int) -> Drag:
    """The viscous force on `count` modes of a state."""
    whole = _drag(loaded, state, pool_size(count))
    D, weights = whole.D[:count, :count], modal_state(loaded, state, count).residual.weights
    return Drag(D, whole.left_out[:, :count] - weights @ D)


@cached(_STATES)
def _drag(loaded: LoadedStructure, state: ContactState, count: int) -> Drag:
    """The viscous force on the modes, and in place of `Drag.left_out` that of the foundation shapes."""
    modal, C = modal_state(loaded, state, count), loaded.problem.structure.coupling_drag
    shapes, foundation = modal.modes.shapes, modal.residual.foundation
    D = C * overlaps(shapes, shapes)
    return Drag((D + D.T) / 2, C * (overlaps(foundation.solutions, shapes) + overlaps(foundation.constants, shapes)))
