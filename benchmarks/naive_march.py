"""A march as one would write it first: sample all modes often enough, look for sign changes, bisect.

It uses the same modal model as `analytic`, so only the way of marching differs: every mode is sampled 20 times per
period of the fastest one, with exponentials at each sample, and a crossing between two samples is bisected.  Contacts
shorter than the sampling, and grazes, are missed.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit

from analytic.march.switching import switch
from analytic.march.terms import start_terms, state_from_terms

SAMPLES = 20
"""Samples per period of the fastest mode."""


@njit(cache=True)
def _gap(tables: Any, slot: int, k: int, t0: float, s: float, term: Any, poly: Any) -> float:
    u, closed = tables.position[k], tables.closed[slot, k]
    z = tables.constant[slot, u]
    for i in range(tables.terms[slot]):
        z += tables.weight[slot, u, i] * (term[i] * np.exp(tables.root[slot, i] * s)).real
    for i in range(tables.modes[slot]):
        z += tables.weight[slot, u, i] * (poly[i, 0] + s * (poly[i, 1] + s * poly[i, 2]))
    for h in range(tables.omega.size):
        angle = tables.omega[h] * (t0 + s) + tables.phase[h]
        z += (tables.forced[slot, u, h] * complex(math.cos(angle), math.sin(angle))).imag
    orientation = -tables.sign[k] if closed else tables.sign[k]
    return orientation * z + (tables.gap[k] if closed else -tables.gap[k])


@njit(cache=True)
def naive_march(tables: Any, slot: int, t: float, end: float, q: Any, v: Any) -> tuple[int, float, int]:
    """March from `t` to `end`; returns the slot, the time and the number of switches."""
    stops, switches = tables.sign.size, 0
    term, poly = np.zeros(2 * q.size, dtype=np.complex128), np.zeros((q.size, 3))
    last = -1
    while True:
        theta = np.exp(1j * (tables.omega * t + tables.phase))
        start_terms(tables, slot, theta, q, v, term, poly)
        step = 2 * math.pi / np.abs(tables.root[slot]).max() / SAMPLES
        s, which = 0.0, -1
        while which < 0 and t + s < end:
            after = min(s + step, end - t)
            for k in range(stops):
                if _gap(tables, slot, k, t, after, term, poly) > 0 and not (k == last and s == 0.0):
                    which = k
            if which < 0:
                s = after
        if which < 0:
            return slot, end, switches
        lo, hi = s, min(s + step, end - t)
        for _ in range(50):
            middle = 0.5 * (lo + hi)
            if _gap(tables, slot, which, t, middle, term, poly) > 0:
                hi = middle
            else:
                lo = middle
        for i in range(tables.terms[slot]):
            term[i] *= np.exp(tables.root[slot, i] * lo)
        theta *= np.exp(1j * tables.omega * lo)
        state_from_terms(tables, slot, theta, lo, term, poly, q, v)
        t += lo
        target = tables.next_slot[slot, which]
        if target < 0:
            return slot, t, -1
        switch(tables, slot, which, theta, q, v)
        slot = target
        last = which
        switches += 1
