"""Integrals of products of beam functions along pieces of the beams, without the weight of mass, in closed form.

A viscous force C z_t per unit length takes them: it does not act on lumped masses, and is the same where the mass per
length changes, so that modes, which are orthogonal with the mass, are not orthogonal here.  Boundary terms over the
difference of two squared frequencies, as in `analytic.modes.beam_functions.gram`, hold for the beam as a whole with its
mass; here each span has its own f'''' = a f and g'''' = b g, and

    (a - b) integral of f g = [f''' g - f'' g' + f' g'' - f g''']    from the left end of the span to the right.

Two sums of exponentials are integrated exponential by exponential, which is as exact for a = b; two polynomials, and a
polynomial and waves that are as long, by Gauss points; and a polynomial and shorter waves by these boundary terms.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytic.modes.beam_functions import NEAR, BeamFunctions, gauss, waves_waves
from lapjoint.problem import FloatArray


def overlaps(f: BeamFunctions, g: BeamFunctions, pieces: Sequence[tuple[float, float, float]]) -> FloatArray:
    """Integrals of C f_i g_j, m times the units of all, ``(n_f, n_g)``; `pieces` are the start and end, m, of those
    along which C is not 0, and C; nodes of f or g are at their ends."""
    nodes = np.union1d(f.nodes, g.nodes)
    f, g = f.on(nodes), g.on(nodes)
    total = np.zeros((f.p.shape[0], g.p.shape[0]))
    bent_f, bent_g = (np.asarray(it.p.any(axis=2)) for it in (f, g))
    for s, C in enumerate(_along(nodes, pieces)):
        if not C:
            continue
        a, b = _fourth_powers(f, s)[:, None], _fourth_powers(g, s)[None, :]
        close = np.abs(a - b) <= NEAR * np.maximum(np.abs(a), np.abs(b))
        one, other = bent_f[:, s, None], bent_g[None, :, s]
        waves = ~one & ~other
        if waves.any():
            rows, columns = np.nonzero(waves)
            total[rows, columns] += C * waves_waves(f, rows, g, columns, s)
        pointed = (one & other) | (~waves & close)
        if pointed.any():
            x, weights = gauss(float(nodes[s]), float(nodes[s + 1]))
            total += C * np.where(pointed, (f(x) * weights) @ g(x).T, 0.0)
        ended = ~waves & ~pointed
        if ended.any():
            total += C * np.where(ended, _between_ends(f, g, s) / np.where(ended, a - b, 1.0), 0.0)
    return total


def _along(nodes: FloatArray, pieces: Sequence[tuple[float, float, float]]) -> list[float]:
    """C on each span between nodes, m, ``(S + 1,)``."""
    middle = (nodes[:-1] + nodes[1:]) / 2
    return [sum(C for start, end, C in pieces if start < x < end) for x in middle.tolist()]


def _fourth_powers(f: BeamFunctions, s: int) -> FloatArray:
    """The number a of f'''' = a f on span `s`, 1/m4, ``(n,)``; 0 of functions without exponentials."""
    return np.asarray((f.mu[:, s, :1] ** 4).real.sum(axis=1))


def _between_ends(f: BeamFunctions, g: BeamFunctions, s: int) -> FloatArray:
    """(a - b) times the integral of f g over span `s`, from its ends, ``(n_f, n_g)``."""
    total = np.zeros((f.p.shape[0], g.p.shape[0]))
    for d, sign in enumerate((1.0, -1.0, 1.0, -1.0)):
        total += sign * (f.ends[:, 3 - d, s] * [-1.0, 1.0]) @ g.ends[:, d, s].T
    return total
