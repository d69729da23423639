"""The deepest penetration of each closed stop within a state: a certified maximum, not the largest of samples.

With the penetration d = -h, its derivatives d' and d'' now and the bound |d'''| <= B that holds from now on, see
`analytic.march.segment`, two steps are safe.  While

    d + d' tau + d'' tau^2 / 2 + B tau^3 / 6

is below the deepest found so far, nothing deeper is passed.  And while d' + d'' tau - B tau^2 / 2 is positive, d rises:
the deepest is at the end of the step, where it is looked at next.  The longer of the two is taken.  On a rise the
second one converges to the root of d' from below; past it the first one goes on to where another maximum could be.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.march.gap_function import Rigid, add_rigid, add_terms, at_positions
from analytic.march.step_bound import first_root_of_bound
from analytic.march.tables import Tables
from analytic.march.terms import turn_exactly
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import zeros
from lapjoint.compiled.compiling import njit_inner
from lapjoint.problem import FloatArray

_SHARP = 1e-12  # of the deepest penetration so far, without unit: by so little a maximum may be missed
_SHORTEST = 1e-4  # rad: of the fastest mode's turn, the least step; the penetration changes by 5e-9 of that mode's part
_TINY = 1e-300  # keeps a bound of 0 from being divided by


@njit_inner()
def deepest_of(
    tables: Tables,
    slot: int,
    k: int,
    duration: float,
    theta0: ComplexArray,
    term0: ComplexArray,
    drift: FloatArray,
    rigid: Rigid | None,
    so_far: float,
    goes_on: bool,
) -> float:
    """The deepest penetration of one closed stop while one closed form holds, or before.

    Parameters
    ----------
    tables : Tables
        The states of the joint.
    slot : int
        The state.
    k : int
        The stop.
    duration : float
        How long the closed form holds, s.
    theta0 : ComplexArray, shape (H,)
        exp(i theta_h) at its start, without unit.
    term0 : ComplexArray, shape (T,)
        The c_t, kg^1/2 m, at its start.
    drift : FloatArray, shape (U, 3)
        The coefficients of 1, s, s^2 of z, m over powers of s.
    rigid : Rigid or None
        What rigid-body modes add to it under forces that are linear in time.
    so_far : float
        The deepest before, m.
    goes_on : bool
        Whether another closed form follows, of which the start is looked at: then the end of this one need not be.

    Returns
    -------
    float
        m; 0 where the stop was not pressed.
    """
    u, sign, terms = tables.position[k], tables.sign[k], tables.terms[slot]
    root, weight, forced = tables.root[slot], tables.weight[slot, u], tables.forced[slot]
    fastest = tables.fastest[slot]
    for omega in tables.omega:
        fastest = max(fastest, omega)
    least, out = _SHORTEST / (fastest + _TINY), zeros((forced.shape[0], 4))
    deepest, s, theta, term = so_far, 0.0, theta0, term0
    while True:
        at_positions(forced, tables.omega, s, theta, drift, out)
        if rigid is not None:
            add_rigid(rigid, s, out)
        z, z1, z2, b3 = add_terms(weight, term, root, np.int64(0), terms)
        d, d1, d2 = sign * (out[u, 0] + z) - tables.gap[k], sign * (out[u, 1] + z1), sign * (out[u, 2] + z2)
        b3 += out[u, 3] + _TINY
        deepest = max(deepest, float(d))
        left = duration - s
        if left <= 0:
            return deepest
        tau = first_root_of_bound(d - deepest * (1 + _SHARP) - _TINY, d1, d2, b3, left)
        if tau >= left and d1 <= 0:
            return deepest
        if d1 > 0:
            # the positive root of d1 + d2 x - b3 x^2 / 2, without cancellation
            split = math.sqrt(d2 * d2 + 2 * b3 * d1)
            tau = max(tau, (d2 + split) / b3 if d2 > 0 else 2 * d1 / (split - d2))
        if tau >= left and goes_on:
            return deepest
        if s == 0:
            theta, term = theta0.copy(), term0.copy()
        tau = min(max(tau, least), left)
        s = duration if tau == left else s + tau
        turn_exactly(root, tables.omega, terms, tau, term, theta)
