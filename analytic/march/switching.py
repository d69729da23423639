"""The two rules by which a motion goes from one contact state to the next.

The present solver projects the whole displacement, residual shapes included, on the modes of the next state.  The
published scheme, see `analytic.published`, carries on only the part in the span of the modes.  The rest of the
displacement, R = z - sum Phi_i q_i, stands still until the next switch.  R is kept as coefficients over the modes of
every state met, so its values at the stops are dot products.  These are summed in an order of the states that does not
depend on which state was met first, perhaps by another motion: a motion that never settles shows the last bit.

The march takes a `Frozen` for the published rule, and None for the present rule; numba compiles it once for each.
"""

from __future__ import annotations

from typing import NamedTuple

from analytic.march.tables import IntArray, Tables
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_inner
from lapjoint.problem import FloatArray


@by_reference
class Frozen(NamedTuple):
    """The frozen shape of the published rule, beside the tables: ``S`` slots, ``N`` modes."""

    rest: FloatArray
    """Coefficients of R over the modes of all states, kg^1/2 m, shape ``(S, N)``; changed in place."""
    cross: FloatArray
    """S_ij of (43) from the modes of each state (second axis) to the modes of each state (first axis), without unit,
    shape ``(S, S, N, N)``."""
    order: IntArray
    """The slots in the order in which to sum over states, shape ``(states met,)``."""


@njit_inner()
def switch(tables: Tables, slot: int, stop: int, theta: ComplexArray, q: FloatArray, v: FloatArray) -> None:
    """Carry displacement (36) and velocity (41) over to the state after `stop` has switched, in place.

    `slot` is the state before, and the tables know the switch.  `q`, kg^1/2 m, and `v`, kg^1/2 m/s, ``(N,)``, are
    replaced.  `theta`, ``(H,)``, is exp(i theta_h) at the switch.
    """
    target = tables.next_slot[slot, stop]
    n_old, n_new = tables.modes[slot], tables.modes[target]
    row = tables.passage[slot, stop]
    if tables.owner is not None:
        _switch_coupled(tables, row, n_old, n_new, theta, q, v)
        return
    S, onto = tables.carry[row], tables.carry_residual[row]
    q_old, v_old = q.copy(), v.copy()
    q[:] = 0.0
    v[:] = 0.0
    for i in range(n_new):
        x, y = onto[0, i], 0.0
        for j in range(n_old):
            x += S[i, j] * q_old[j]
            y += S[i, j] * v_old[j]
        for h in range(theta.size):
            x += onto[1 + h, i] * theta[h].imag
            y += onto[1 + h, i] * tables.omega[h] * theta[h].real
        q[i], v[i] = x, y


@njit_inner()
def _switch_coupled(
    tables: Tables, row: int, n_old: int, n_new: int, theta: ComplexArray, q: FloatArray, v: FloatArray
) -> None:
    """`switch` of a joint with damped stops, in whose states q and v may be coupled; `row` is that of the switch."""
    q_old, v_old, load, whole = q.copy(), v.copy(), tables.whole_load[row], tables.whole[row]
    q[:] = 0.0
    v[:] = 0.0
    for i in range(n_new):
        x, y = load[0, 0, i].real, load[0, 1, i].real
        for j in range(n_old):
            x += whole[0, i, 0, j] * q_old[j] + whole[0, i, 1, j] * v_old[j]
            y += whole[1, i, 0, j] * q_old[j] + whole[1, i, 1, j] * v_old[j]
        for h in range(theta.size):
            x += (load[1 + h, 0, i] * theta[h]).imag
            y += (load[1 + h, 1, i] * theta[h]).imag
        q[i], v[i] = x, y


@njit_inner()
def switch_frozen(tables: Tables, frozen: Frozen, slot: int, target: int, q: FloatArray, v: FloatArray) -> None:
    """Carry displacement (36), of which R keeps the rest, and velocity (44) over from `slot` to `target`, in place.

    `q`, kg^1/2 m, and `v`, kg^1/2 m/s, ``(N,)``, are replaced, and `frozen.rest` is changed.
    """
    n_old, n_new, rest = tables.modes[slot], tables.modes[target], frozen.rest
    v_old = v.copy()
    for j in range(n_old):
        rest[slot, j] += q[j]
    q[:] = 0.0
    v[:] = 0.0
    for i in range(n_new):
        x, y = 0.0, 0.0
        for other in frozen.order:
            for j in range(tables.modes[other]):
                x += frozen.cross[target, other, i, j] * rest[other, j]
        for j in range(n_old):
            y += frozen.cross[target, slot, i, j] * v_old[j]
        q[i], v[i] = x, y
    for i in range(n_new):
        rest[target, i] -= q[i]


@njit_inner()
def freeze(tables: Tables, frozen: Frozen, slot: int) -> None:
    """Write the values of R at the stops to `tables.constant[slot]`, the part of z that moves with no mode."""
    for u in range(tables.constant.shape[1]):
        z = 0.0
        for other in frozen.order:
            for j in range(tables.modes[other]):
                z += tables.weight[other, u, j] * frozen.rest[other, j]
        tables.constant[slot, u] = z
