r"""Viscous damping that couples the modes: along beams whose inertia is not in proportion to it, and in links.

A force -C z_t per unit length, and dampers c between two deflections or slopes, act on mode i by

    -sum_j D_ij q_j' - sum_l d_li f_l'(t),    D_ij = integral of C Phi_i Phi_j + sum over dampers of c R(Phi_i) R(Phi_j)
                                              d_li = integral of C Phi_i r_l   + sum over dampers of c R(Phi_i) R(r_l)

where R is the difference that a damper sees.  The shapes r_l that the modes leave out move with the loads f_l, see
`analytic.modes.static_residual`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
    modal, structure = modal_state(loaded, state, count), loaded.problem.structure
    shapes, foundation, pieces = modal.modes.shapes, modal.residual.foundation, structure.coupling_drag
    D = overlaps(shapes, shapes, pieces)
    left_out = overlaps(foundation.solutions, shapes, pieces) + overlaps(foundation.constants, shapes, pieces)
    for it in structure.dampers:
        ends = np.array([it.first, it.second])
        moved, rest = (np.diff(of(ends, it.derivative))[:, 0] for of in (shapes, foundation))
        D += it.damping * np.outer(moved, moved)
        left_out += it.damping * np.outer(rest, moved)
    return Drag((D + D.T) / 2, left_out)
