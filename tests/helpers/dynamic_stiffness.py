"""Counts of natural frequencies by the dynamic stiffness matrix, in as many digits as mpmath is set to."""

from __future__ import annotations

import math

import mpmath as mp

from analytic.modes.characteristic_equation import Layout

REACH = 4  # unknowns of two neighbouring nodes: the matrix is 0 farther from its diagonal


def dynamic_stiffness_count(layout: Layout, z: mp.mpf) -> int:
    """Frequencies below z by the Wittrick-Williams algorithm on the dynamic stiffness matrix.

    Independent of the minors: members are assembled from the textbook stiffness functions, and the sign count of
    an LDL^T factorisation is added to the clamped-clamped roots of the members.
    """
    x = [mp.mpf(float(value)) for value in layout.x]
    n = 2 * len(x)
    K = mp.zeros(n, n)
    total = 0
    for e in range(len(x) - 1):
        length = x[e + 1] - x[e]
        s = z * length
        c, sn, ch, sh = mp.cos(s), mp.sin(s), mp.cosh(s), mp.sinh(s)
        d = 1 - c * ch
        entries = {
            (0, 0): (z**3, sn * ch + c * sh), (0, 1): (z**2, sn * sh), (0, 2): (z**3, -(sn + sh)),
            (0, 3): (z**2, ch - c), (1, 1): (z, sn * ch - c * sh), (1, 2): (z**2, -(ch - c)),
            (1, 3): (z, sh - sn), (2, 2): (z**3, sn * ch + c * sh), (2, 3): (z**2, -sn * sh),
            (3, 3): (z, sn * ch - c * sh),
        }  # fmt: skip
        for (i, j), (power, value) in entries.items():
            K[2 * e + i, 2 * e + j] += power * value / d
            if i != j:
                K[2 * e + j, 2 * e + i] += power * value / d
        k = int(mp.floor(s / mp.pi))
        total += 0 if k == 0 else k - 1 + int((d > 0) == (k % 2 == 0))
    kept = []
    for node in range(len(x)):
        for offset, spring in ((0, layout.translational[node]), (1, layout.torsional[node])):
            if not math.isinf(spring):
                K[2 * node + offset, 2 * node + offset] += mp.mpf(float(spring))
                kept.append(2 * node + offset)
    return total + negative_pivots(K, kept)


def negative_pivots(K: mp.matrix, kept: list[int]) -> int:
    """Negative pivots of the factorisation of the rows and columns `kept` of a matrix of bandwidth `REACH`."""
    size, negative = len(kept), 0
    a = {(p, j): K[kept[p], kept[j]] for p in range(size) for j in range(max(0, p - REACH), min(size, p + REACH))}
    for p in range(size):
        pivot = a[p, p]
        negative += pivot < 0
        near = range(p + 1, min(size, p + REACH))
        for i in near:
            factor = a[i, p] / pivot
            for j in near:
                a[i, j] -= factor * a[p, j]
    return negative
