"""The mesh: a node at every support, stop and point load, elements of nearly equal length between.

An element of length d has modes near 92 sqrt(EI / m) / d^2: a very short one would cost the low modes their digits, and
the march its speed.  Therefore positions that differ by rounding alone count as one, and a spring, stop or load nearer
to a node than `CLOSE` gets no node of its own.  It acts inside an element, by the element's cubics, which do not bend
within a distance this small of a force as the beam does.  A force F at a distance d from the node bends the beam by F
d^3 / 3 EI less than it should, 3e-13 L^3 / EI at most.  A spring at a distance d stiffens the beam by up to k d^4 / EI
L, or kt d^2 / EI L where it holds a slope.  A spring whose error could be seen is refused at such a position, and so is
a fixed support.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem, Support

SAME = 1e-12
"""Positions nearer than this, in beam lengths, are one: a few thousand rounding errors, more than a sum accumulates."""
CLOSE = 1e-4
"""Shortest element, in beam lengths.

Its modes are 6e4 times as fast as those of an element of the default mesh.  The frequencies of the beam still have nine
digits then; at 1e-5 they had six.
"""
_LOCKED = 1e-7
"""Largest stiffness that a spring inside an element may add by mistake, as a fraction of the beam's stiffness; a mesh
of 40 elements adds more."""

SHORT = 1e-3
"""A stretch between two required nodes up to this length, in beam lengths, is not refined: its error, of fourth order,
is negligible."""


def mesh_nodes(problem: Problem, elements: int, given: tuple[float, ...] | None) -> FloatArray:
    """Node positions of a mesh, m, ascending from 0 to L, about `elements` elements over the whole beam.

    Supports, stops and point loads each get a node, unless there is one nearer than `CLOSE`.  Between two of these
    nodes there is at least one element.  If nodes are given, the required ones are added to them.  An InputError is
    raised if a given node lies outside the beam, or if two of them are nearer than `CLOSE`.  It is also raised if a
    fixed support or a very stiff spring is nearer than `CLOSE` to another part or to an end, without being at the same
    position.
    """
    L = problem.beam.length
    required = _required(problem)
    if given is not None:
        return _with_given(required, given, L)
    pieces = [
        np.linspace(a, b, max(1, round(elements * (b - a) / L)) + 1)[:-1] for a, b in itertools.pairwise(required)
    ]
    return np.concatenate([*pieces, required[-1:]])


def _required(problem: Problem) -> FloatArray:
    """Ends, supports, stops and loads, each position once, none nearer to another than `CLOSE`; ascending, m."""
    L, EI = problem.beam.length, problem.beam.EI
    chosen = {0.0: "the end of the beam", L: "the end of the beam"}
    springs: list[tuple[float, str, float, float]] = []
    others: list[tuple[float, str, float, float]] = []
    for group in ("supports", "stops", "point_loads"):
        for i, part in enumerate(getattr(problem, group)):
            k = part.translational if isinstance(part, Support) else getattr(part, "stiffness", 0.0)
            kt = part.torsional if isinstance(part, Support) else 0.0
            fixed = math.isinf(k) or math.isinf(kt)
            (springs if fixed else others).append((part.x, f"{group}[{i}]", k, kt))
    for x, name, k, kt in [*sorted(springs), *sorted(others)]:
        near = min(chosen, key=lambda node: abs(node - x))
        d = abs(near - x)
        if d >= CLOSE * L:
            chosen[x] = name
        elif d > SAME * L and max(k * d**4, kt * d**2) > _LOCKED * EI * L:
            raise InputError(
                f"{name}.x = {x!r}: is held {d:.3g} m from {chosen[near]} at {near!r} m, too near for finite elements; "
                f"allowed are the same place, or at least {CLOSE * L:g} m"
            )
    return np.array(sorted(chosen))


def _with_given(required: FloatArray, given: tuple[float, ...], L: float) -> FloatArray:
    """The user's nodes together with the required ones; of two nearer than `CLOSE` the required one stays."""
    outside = [x for x in given if not -SAME * L <= x <= (1 + SAME) * L]
    if outside:
        raise InputError(f"nodes: {outside[0]!r} lies outside the beam, 0 to {L:g} m")
    own = np.unique(np.array(given, dtype=float))
    own = own[np.diff(own, prepend=-math.inf) > SAME * L]
    narrow = np.flatnonzero(np.diff(own) < CLOSE * L)
    if narrow.size:
        a, b = float(own[narrow[0]]), float(own[narrow[0] + 1])
        raise InputError(f"nodes: {a!r} and {b!r} m are too near; allowed are nodes at least {CLOSE * L:g} m apart")
    far = np.abs(own[:, None] - required).min(axis=1) >= CLOSE * L
    return np.union1d(required, own[far])


def split_elements(nodes: tuple[float, ...], parts: int) -> tuple[float, ...]:
    """The nodes, m, ascending, with every element cut into equal parts."""
    ends = sorted(set(nodes))
    cut = [np.linspace(a, b, parts + 1)[:-1].tolist() for a, b in itertools.pairwise(ends)]
    return tuple(itertools.chain(*cut, ends[-1:]))


def refined_nodes(problem: Problem, nodes: FloatArray, ratio: float) -> FloatArray:
    """Nodes of a finer mesh with the grading of `nodes`, m, ascending.

    Supports, stops and point loads cut the beam into stretches, whose ends stay.  Each stretch has at least `ratio`
    times as many elements as before, unless it is shorter than `SHORT`.
    """
    parts = (*problem.supports, *problem.stops, *problem.point_loads)
    at = {int(np.abs(nodes - part.x).argmin()) for part in parts}
    pieces = []
    for a, b in itertools.pairwise(sorted({0, *at, nodes.size - 1})):
        short = nodes[b] - nodes[a] < SHORT * nodes[-1]
        count = b - a if short else math.ceil((b - a) * ratio - 1e-9)
        pieces.append(np.interp(np.linspace(a, b, count + 1), np.arange(a, b + 1), nodes[a : b + 1])[:-1])
    return np.concatenate([*pieces, nodes[-1:]])
