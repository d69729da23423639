"""The mesh: a node at every support, stop and point load, elements of nearly equal length between."""

from __future__ import annotations

import itertools

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem


def mesh_nodes(problem: Problem, elements: int, given: tuple[float, ...] | None) -> FloatArray:
    """Node positions of a mesh, ascending from 0 to L.

    Parameters
    ----------
    problem : Problem
        Its supports, stops and point loads each get a node.
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
        If a given node lies outside the beam.
    """
    L = problem.beam.length
    parts = (*problem.supports, *problem.stops, *problem.point_loads)
    required = np.unique(np.array([0.0, L, *(part.x for part in parts)]))
    if given is not None:
        outside = [x for x in given if not 0 <= x <= L]
        if outside:
            raise InputError(f"nodes: {outside[0]!r} lies outside the beam, 0 to {L:g} m")
        return np.union1d(required, np.array(given, dtype=float))
    pieces = [
        np.linspace(a, b, max(1, round(elements * (b - a) / L)) + 1)[:-1] for a, b in itertools.pairwise(required)
    ]
    return np.concatenate([*pieces, required[-1:]])


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
