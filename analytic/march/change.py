r"""How a march changes with a number p of the problem, while its start stays where it is: one more deviation.

Within a state the motion is a free one and a forced one, and only the forced one depends on p by itself.  So what a
deviation w = d(q, v)/dp has beyond the forced motion's own change travels as any deviation does, see
`analytic.march.tangent`.  With the answer to the harmonics Im sum_h A_h exp(i (Omega_h t + phi_h)) that change is

    Im sum_h (dA_h + i t A_h dOmega_h) exp(i theta_h) + d(static answer).

At a switch the gap function and the passage depend on p, too, and at the end of the march its duration does:

    dT = -(grad h . w + dh/dp) / h',    w_new = J (w + f_old dT) + (b - f_new) dT + d(passage)/dp.
"""

from __future__ import annotations

from typing import NamedTuple

from analytic.march.oscillator import SPLIT
from analytic.march.tables import IntArray, Tables
from analytic.march.tangent import Switching, beyond_modes, write_rates
from analytic.modes.beam_functions import ComplexArray
from lapjoint.by_reference import by_reference
from lapjoint.compiled_arrays import bool_zeros, complex_zeros, zeros
from lapjoint.compiling import njit_inner
from lapjoint.problem import FloatArray


@by_reference
class Change(NamedTuple):
    """Derivatives of the logarithms of frequencies and sizes of a joint's ``H`` harmonics, over the number's unit."""

    omega: float
    """Of all angular frequencies."""
    size: FloatArray
    """Of the size of each, shape ``(H,)``."""


@njit_inner()
def changes_of_answers(tables: Tables, change: Change, slots: IntArray) -> ComplexArray:
    """How the answers of modes to the harmonics change, in the states of a march.

    Parameters
    ----------
    tables, change : Tables, Change
        The states of the joint, and how its harmonics change.
    slots : ndarray, shape (M,)
        The states that are wanted, in any sequence.

    Returns
    -------
    ComplexArray, shape (S, H, N)
        Derivatives of `Tables.harmonic`, over the unit of the number; of other states zeros.
    """
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
    t: float,
    theta: ComplexArray,
    factor: float,
    now: FloatArray,
) -> None:
    """Add the forced motion's own change, times a factor, to the last of some deviations, in place.

    Parameters
    ----------
    tables, change : Tables, Change
        The states of the joint, and how its harmonics change.
    changes : ComplexArray, shape (S, H, N)
        `changes_of_answers`.
    slot : int
        The state.
    t : float
        When, s from the start of the march.
    theta : ComplexArray, shape (H,)
        exp(i theta_h), without unit, then.
    factor : float
        Without unit.
    now : FloatArray, shape (2 N, m)
        Deviations (dq, dv), kg^1/2 m and kg^1/2 m/s, as columns; the last one is over the unit of the number.
    """
    n, last = tables.modes[slot], now.shape[1] - 1
    for h in range(theta.size):
        omega = tables.omega[h]
        rise = change.omega * omega
        for i in range(n):
            wave = tables.harmonic[slot, h, i] * theta[h]
            q = changes[slot, h, i] * theta[h] + wave * complex(0.0, t * rise)
            now[i, last] += factor * q.imag
            now[n + i, last] += factor * (omega * q.real + rise * wave.real)


@njit_inner()
def add_switch_change(
    tables: Tables,
    change: Change,
    old: int,
    k: int,
    t: float,
    theta: ComplexArray,
    rate: float,
    work: Switching,
    now: FloatArray,
) -> None:
    """Add what a switch and its passage change by themselves to the last of some deviations after it, in place.

    Parameters
    ----------
    tables, change : Tables, Change
        The states of the joint, and how its harmonics change.
    old, k : int
        The state before, and the stop that switches.
    t : float
        When, s from the start of the march.
    theta : ComplexArray, shape (H,)
        exp(i theta_h), without unit, then.
    rate : float
        With which h', m/s.
    work : Switching
        With what `analytic.march.tangent.saltation` has written; its `delay` is added to.
    now : ndarray, shape (2 N_new, m)
        Deviations (dq, dv) just after the switch, likewise.
    """
    last, n_new = now.shape[1] - 1, tables.modes[tables.next_slot[old, k]]
    onto, jump = tables.carry_residual[tables.passage[old, k]], work.jump
    delay = -_own_change(tables, change, old, k, t, theta) / rate
    work.delay[last] += delay
    for j in range(n_new):
        x, y = jump[j] * delay, jump[n_new + j] * delay
        for h in range(theta.size):
            omega, sine, cosine, size = tables.omega[h], theta[h].imag, theta[h].real, change.size[h]
            turned = omega * change.omega * t
            x += onto[1 + h, j] * (cosine * turned + size * sine)
            y += onto[1 + h, j] * omega * ((change.omega + size) * cosine - sine * turned)
        now[j, last] += x
        now[n_new + j, last] += y


@njit_inner()
def _own_change(tables: Tables, change: Change, slot: int, k: int, t: float, theta: ComplexArray) -> float:
    """How much a stop's gap function changes by what is no mode's, m over the number's unit."""
    u, z = tables.position[k], 0.0
    for h in range(theta.size):
        turned = complex(change.size[h], t * change.omega * tables.omega[h])
        z += (beyond_modes(tables, slot, u, h) * theta[h] * turned).imag
    own: float = -tables.sign[k] * z if tables.closed[slot, k] else tables.sign[k] * z
    return own


@njit_inner()
def own_changes(tables: Tables, change: Change, slot: int, t: float, theta: ComplexArray) -> FloatArray:
    """How much gap functions change by themselves, while the motion stays where it is.

    Parameters
    ----------
    tables, change : Tables, Change
        The states of the joint, and how its harmonics change.
    slot : int
        The state.
    t : float
        When, s from the start of the march.
    theta : ComplexArray, shape (H,)
        exp(i theta_h), without unit, then.

    Returns
    -------
    FloatArray, shape (P,)
        Derivatives, m over the unit of the number.
    """
    own = zeros(tables.sign.size)
    for k in range(own.size):
        own[k] = _own_change(tables, change, slot, k, t, theta)
    return own


@njit_inner()
def add_end_change(
    tables: Tables, slot: int, theta: ComplexArray, later: float, q: FloatArray, v: FloatArray, now: FloatArray
) -> None:
    """Add what the march goes on at its end, whose time depends on the number, to the last deviation, in place.

    Parameters
    ----------
    tables : Tables
        The states of the joint.
    slot : int
        The state at the end.
    theta : ComplexArray, shape (H,)
        exp(i theta_h), without unit, then.
    later : float
        Derivative of that time by the number, s over its unit.
    q, v : ndarray, shape (N,)
        The motion there, kg^1/2 m and kg^1/2 m/s.
    now : ndarray, shape (2 N, m)
        Deviations (dq, dv) there.
    """
    rates = zeros(2 * tables.modes[slot])
    write_rates(tables, slot, theta, q, v, rates)
    for i in range(rates.size):
        now[i, now.shape[1] - 1] += later * rates[i]


@njit_inner()
def forced_change(tables: Tables, change: Change, changes: ComplexArray, slot: int, u: int, h: int) -> complex:
    """Derivative of the complex amplitude of the forced motion at a position of stops, by a harmonic.

    Parameters
    ----------
    tables, change : Tables, Change
        The states of the joint, and how its harmonics change.
    changes : ComplexArray, shape (S, H, N)
        `changes_of_answers`.
    slot, u, h : int
        The state, the position, and the harmonic.

    Returns
    -------
    complex
        m over the number's unit.
    """
    total: complex = tables.forced[slot, u, h] * change.size[h]
    for i in range(tables.modes[slot]):
        own = changes[slot, h, i] - tables.harmonic[slot, h, i] * change.size[h]
        total += tables.weight[slot, u, i] * own
    return total
