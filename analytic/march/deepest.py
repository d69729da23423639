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

from analytic.march.gap_function import Rigid, add_rigid, add_terms, add_twisted, at_position
from analytic.march.step_bound import first_root_of_bound
from analytic.march.tables import Tables
from analytic.march.terms import turn_exactly
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import zeros
from lapjoint.compiled.compiling import njit_inner
from lapjoint.problem import FloatArray

_SHARP = 1e-12  # largest error of the maximum, relative to the deepest penetration so far
_SHORTEST = 1e-4  # rad: least turn of the fastest mode in a step; 5e-9 of that mode's part of the penetration
_TINY = 1e-300  # m or 1/s: keeps divisions by a bound of 0 finite


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
    """The deepest penetration of stop `k`, m, while one closed form holds, or `so_far`, m, if that is more.

    The closed form lasts `duration`, s, from phases `theta0`, ``(H,)``, and terms `term0`, kg^1/2 m, ``(T,)``.
    `drift`, ``(U, 3)``, holds the coefficients of 1, s, s^2 of z, m over powers of s; `rigid` is what rigid-body modes
    add under forces that are linear in time.  `goes_on` says that another closed form follows: its start is looked at,
    and the end of this one need not be.
    """
    u, sign, terms = tables.position[k], tables.sign[k], tables.terms[slot]
    root, weight, forced = tables.root[slot], tables.weight[slot, u], tables.forced[slot]
    cube, fastest = tables.cube[slot], tables.fastest[slot]
    for omega in tables.omega:
        fastest = max(fastest, omega)
    least, out = _SHORTEST / (fastest + _TINY), zeros((forced.shape[0], 4))
    deepest, s, theta, term = so_far, 0.0, theta0, term0
    while True:
        at_position(u, forced, tables.omega, s, theta, drift, out)
        if rigid is not None:
            add_rigid(rigid, u, s, out)
        if tables.owner is not None:
            z, z1, z2, b3, _ = add_twisted(weight, tables.twist[slot, u], term, root, cube, np.int64(0), terms)
        else:
            z, z1, z2, b3, _ = add_terms(weight, term, root, cube, np.int64(0), terms)
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
