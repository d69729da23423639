"""How far the beam is beyond the gaps of a joint with damped stops, from the coordinates of its motion."""

from __future__ import annotations

from analytic.march.tables import Tables
from analytic.march.terms import set_phases
from lapjoint.compiled.arrays import complex_zeros, zeros
from lapjoint.compiled.compiling import njit_called
from lapjoint.problem import FloatArray


@njit_called()
def depths(tables: Tables, slot: int, t: float, q: FloatArray, v: FloatArray) -> FloatArray:
    """Sign z - gap of each row of the tables, m, ``(P,)``, at the time `t`, s, where no load is sampled.

    `q`, kg^1/2 m, and `v`, kg^1/2 m/s, ``(N,)``, are the coordinates in the state of `slot`.  The row of a force has
    the force over the stiffness, in coupled states alone.
    """
    theta, found = complex_zeros(tables.omega.size), zeros(tables.sign.size)
    set_phases(tables, t, theta)
    for row in range(found.size):
        u = tables.position[row]
        z, by = tables.constant[slot, u], tables.gradient[slot, u]
        for i in range(tables.modes[slot]):
            x, y = q[i], v[i]
            for h in range(theta.size):
                wave = tables.harmonic[slot, h, i] * theta[h]
                x -= wave.imag
                y -= tables.omega[h] * wave.real
            z += by[0, i] * x + by[1, i] * y
        for h in range(theta.size):
            z += (tables.forced[slot, u, h] * theta[h]).imag
        found[row] = tables.sign[row] * z - tables.gap[row]
    return found
