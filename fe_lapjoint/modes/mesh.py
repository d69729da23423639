"""The mesh: a node at every support, stop and point load, elements of nearly equal length between.

An element of length d has modes near 92 sqrt(EI / m) / d^2: a very short one would cost the low modes their digits,
and the march its speed.  So positions that only rounding parts are one, and a spring, stop or load nearer to a node
than `CLOSE` gets none of its own: it acts inside an element, by the element's cubics.  These cannot follow what a force
does within that distance.  A force F at a distance d from the node bends the beam by F d^3 / 3 EI less than it should,
3e-13 L^3 / EI at most.  A spring that stiffens a length d too much stiffens the beam by up to k d^4 / EI L, or
kt d^2 / EI L where it holds a slope; where that could be seen, and for fixed supports, the position is refused.
"""

from __future__ import annotations

import itertools
import math

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem, Support

SAME = 1e-12
"""Of the length: positions nearer than this are one; a few thousand rounding errors, more than any sum gathers."""
CLOSE = 1e-4
"""Of the length: the shortest element.  Its modes are 1e4 times as fast as those of the default mesh.  The frequencies
of the beam still have nine digits then; at 1e-5 they had six."""
_LOCKED = 1e-7
"""Of the stiffness of the beam: what a spring inside an element may add by mistake, less than 40 elements do."""

SHORT = 1e-3
"""Of the length of the beam: in a shorter stretch between two nodes that must be, the error, of the fourth power of the
length of the elements, does not count."""


def mesh_nodes(problem: Problem, elements: int, given: tuple[float, ...] | None) -> FloatArray:
    """Node positions of a mesh, ascending from 0 to L.

    Parameters
    ----------
    problem : Problem
        Its supports, stops and point loads each get a node, unless there is one nearer than `CLOSE`.
    elements : int
        About how many elements the whole beam gets; every stretch between required nodes gets at least one.
    given : tuple of float or None
        Nodes of a graded mesh, m; required nodes that are missing are added.

    Returns
    -------
    FloatArray, shape (nodes,)
        m.

    Raises
    ------
    InputError
        If a given node lies outside the beam, or two of them nearer than `CLOSE`; if a fixed support or a very stiff
        spring lies nearer than that to another part or to an end, but not at the same place.
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
    """Ends, supports, stops and loads, each place once, none nearer to another than `CLOSE`; ascending, m."""
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
    """Nodes of the user's own with those that are required; of two nearer than `CLOSE` the required one stays."""
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
    """The nodes with every element between two of them cut into equal parts.

    Parameters
    ----------
    nodes : tuple of float
        Node positions, m, in any order.
    parts : int
        Into how many parts.

    Returns
    -------
    tuple of float
        Node positions, m, ascending.
    """
    ends = sorted(set(nodes))
    cut = [np.linspace(a, b, parts + 1)[:-1].tolist() for a, b in itertools.pairwise(ends)]
    return tuple(itertools.chain(*cut, ends[-1:]))


def refined_nodes(problem: Problem, nodes: FloatArray, ratio: float) -> FloatArray:
    """The nodes of a finer mesh of the same grading.

    Parameters
    ----------
    problem : Problem
        Its supports, stops and point loads cut the beam into stretches.
    nodes : FloatArray, shape (nodes,)
        Nodes of a mesh of the problem, m, ascending.
    ratio : float
        How many times as many elements each stretch gets at least, unless it is shorter than `SHORT`.

    Returns
    -------
    FloatArray, shape (finer nodes,)
        m, ascending; the nodes at the ends of the stretches stay where they are.
    """
    parts = (*problem.supports, *problem.stops, *problem.point_loads)
    at = {int(np.abs(nodes - part.x).argmin()) for part in parts}
    pieces = []
    for a, b in itertools.pairwise(sorted({0, *at, nodes.size - 1})):
        short = nodes[b] - nodes[a] < SHORT * nodes[-1]
        count = b - a if short else math.ceil((b - a) * ratio - 1e-9)
        pieces.append(np.interp(np.linspace(a, b, count + 1), np.arange(a, b + 1), nodes[a : b + 1])[:-1])
    return np.concatenate([*pieces, nodes[-1:]])
