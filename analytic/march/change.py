"""The change of the forced motion of a joint with a parameter of its excitation, at fixed phases.

With the answer to the harmonics Im sum_h A_h exp(i theta_h) the displacements change by Im sum_h dA_h exp(i theta_h).
The velocities have the factors Omega_h besides; where the parameter changes the frequencies, these factors change too.
"""

from __future__ import annotations

from typing import NamedTuple

from analytic.march.oscillator import SPLIT
from analytic.march.tables import IntArray, Tables
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import bool_zeros, complex_zeros
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_inner
from lapjoint.problem import FloatArray


@by_reference
class Change(NamedTuple):
    """Derivatives of the logarithms of frequencies and sizes of a joint's ``H`` harmonics, per unit of a parameter."""

    omega: float
    """Derivative of the logarithm of all angular frequencies."""
    size: FloatArray
    """Derivative of the logarithm of the size of each harmonic, shape ``(H,)``."""


@njit_inner()
def changes_of_answers(tables: Tables, change: Change, slots: IntArray) -> ComplexArray:
    """Derivatives of `Tables.harmonic` by the parameter, ``(S, H, N)``, 0 in states not among `slots`, ``(M,)``."""
    changes, done = complex_zeros(tables.harmonic.shape), bool_zeros(tables.modes.size)
    for slot in slots:
        if done[slot]:
            continue
        done[slot] = True
        n = tables.modes[slot]
        for h in range(tables.omega.size):
            omega, extra = tables.omega[h], n
            for i in range(n):
                root = tables.root[slot, i]
                damping, stiffness = -2 * root.real, root.real**2 + root.imag**2
                if tables.kind[slot, i] == SPLIT:
                    other = tables.root[slot, extra].real
                    damping, stiffness = -root.real - other, root.real * other
                    extra += 1
                slope = complex(change.size[h], 0.0)
                if change.omega != 0.0:
                    turned = omega * change.omega * complex(2 * omega, -damping)
                    slope += turned / complex(stiffness - omega * omega, damping * omega)
                changes[slot, h, i] = tables.harmonic[slot, h, i] * slope
    return changes


@njit_inner()
def add_forced_change(
    tables: Tables,
    change: Change,
    changes: ComplexArray,
    slot: int,
    theta: ComplexArray,
    factor: float,
    now: FloatArray,
) -> None:
    """Add the change of the forced motion, times `factor`, to the deviation `now`, ``(2 N,)``, in place.

    `changes`, ``(S, H, N)``, are `changes_of_answers`, and `theta`, ``(H,)``, is exp(i theta_h).  The deviation (dq,
    dv) is in kg^1/2 m and kg^1/2 m/s per unit of the parameter.
    """
    n = tables.modes[slot]
    for h in range(theta.size):
        omega = tables.omega[h]
        rise = change.omega * omega
        for i in range(n):
            q, wave = changes[slot, h, i] * theta[h], tables.harmonic[slot, h, i] * theta[h]
            now[i] += factor * q.imag
            now[n + i] += factor * (omega * q.real + rise * wave.real)


@njit_inner()
def forced_change(tables: Tables, change: Change, changes: ComplexArray, slot: int, u: int, h: int) -> complex:
    """Derivative by the parameter of the forced motion's complex amplitude, m, at position `u` for harmonic `h`.

    `changes`, ``(S, H, N)``, are `changes_of_answers`.
    """
    total: complex = tables.forced[slot, u, h] * change.size[h]
    for i in range(tables.modes[slot]):
        own = changes[slot, h, i] - tables.harmonic[slot, h, i] * change.size[h]
        total += tables.weight[slot, u, i] * own
    return total
