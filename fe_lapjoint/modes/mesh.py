"""The mesh: a node at every support, stop, mass, step and load, and elements between.

Elements are of nearly equal length along a uniform beam.  A beam with steps bends in shorter waves where it is softer
or heavier: its elements are shorter there, in proportion to the wave length (EI / m)^(1/4).  Of several beams each
has the mesh that it has alone, and the space between two of them is one element, without stiffness and mass.

An element of length d has modes near 92 sqrt(EI / m) / d^2: a very short one would cost the low modes their digits, and
the march its speed.  Therefore positions that differ by rounding alone count as one, and a spring, stop or load nearer
to a node than `CLOSE` gets no node of its own.  It acts inside an element, by the element's cubics, which do not bend
within a distance this small of a force as the beam does.  A force F at a distance d from the node bends the beam by F
d^3 / 3 EI less than it should, 3e-13 L^3 / EI at most, and a couple C turns it by about C d / EI less.  Frequencies are
too high by up to kt d / 2 EI of themselves where a torsional spring kt does so, and by k d^3 / 6 EI where a spring k
acts beside a pin, as the torsional spring k d^2.  A spring whose error could be seen is refused at such a position, and
so are fixed supports, masses and steps.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Line, Problem
from lapjoint.problem.placing import masses_of, supports_of, uniform_load_shape

SAME = 1e-12
"""Positions nearer than this, in lengths of the line of beams, are one: a few thousand rounding errors, more than a sum
accumulates."""
CLOSE = 1e-4
"""Shortest element, in lengths of its beam.

Its modes are 6e4 times as fast as those of an element of the default mesh.  The frequencies of the beam still have nine
digits then; at 1e-5 they had six.
"""
_LOCKED = 1e-6
"""Largest relative error of frequencies by a spring inside an element; the third mode of 40 elements has as much."""

SHORT = 1e-3
"""A stretch between two required nodes up to this length, in lengths of its beam, is not refined: its error, of fourth
order, is negligible."""


def mesh_nodes(problem: Problem, elements: int, given: tuple[float, ...] | None) -> FloatArray:
    """Node positions of a mesh, m, ascending from 0 to L, about `elements` elements over each whole beam.

    Supports, stops, links, masses, steps and loads each get a node, unless there is one nearer than `CLOSE`.
    Between two of these nodes there is at least one element.  If nodes are given, the required ones are added to them;
    on a space between beams there are none.
    An InputError is raised if a given node lies outside the beam, or if two of them are nearer than `CLOSE`.  It is
    also raised if a fixed support, a rigid link, a stiff spring, a mass or a step is nearer than `CLOSE` to another
    part or to an end, without being at the same position.
    """
    line = problem.line
    required = _required(problem)
    if given is not None:
        return _with_given(line, required, given)
    waves = _waves(line, (required[:-1] + required[1:]) / 2)
    pieces = []
    for (a, b), wave in zip(itertools.pairwise(required), waves.tolist(), strict=True):
        L = _length_at(line, a, b)
        count = min(round(elements * (b - a) / L * wave), math.floor((b - a) / (CLOSE * L))) if L else 1
        pieces.append(np.linspace(a, b, max(1, count) + 1)[:-1])
    return np.concatenate([*pieces, required[-1:]])


def _length_at(line: Line, a: float, b: float) -> float:
    """The length, m, of the beam between two neighbouring nodes; 0 on a space between beams."""
    i = line.beam_at((a + b) / 2)
    return line.beams[i].length if line.starts[i] <= a and b <= line.ends[i] else 0.0


def _waves(line: Line, x: FloatArray) -> FloatArray:
    """Waves per length at positions, m, ``(k,)``, divided by their mean along the beam there; 1 without steps."""
    found = np.ones(x.size)
    for i, (start, end) in enumerate(zip(line.starts, line.ends, strict=True)):
        steps = [step for step, _ in _steps(line) if start < step < end]
        here = (x > start) & (x < end)
        edges = np.array([start, *steps, end])
        middle = (edges[:-1] + edges[1:]) / 2
        density, own = ((line.inertia_at(at) / line.EI_at(at)) ** 0.25 for at in (x[here], middle))
        if steps:
            found[here] = density / (np.diff(edges) @ own) * line.beams[i].length
    return found


def _steps(line: Line) -> list[tuple[float, str]]:
    """Positions, m, where stiffness or inertia changes along a beam, and the fields that state them."""
    found = []
    for j, (start, beam) in enumerate(zip(line.starts, line.beams, strict=True)):
        path = f"beams[{j}]" if line.several else "beam"
        for i, (one, other) in enumerate(itertools.pairwise(beam.pieces)):
            if (one.EI, one.inertia) != (other.EI, other.inertia):
                found.append((start + one.end, f"{path}.segments[{i}].to"))
    return found


class _Place(NamedTuple):
    """A part of a problem that wants a node, and what it resists there; infinite if it must have the node."""

    x: float
    """Position, m."""
    name: str
    """Path of the field that states the position."""
    k: float = 0.0
    """Stiffness against displacement, N/m."""
    kt: float = 0.0
    """Stiffness against turning, N m."""


def _places(problem: Problem) -> Iterator[_Place]:
    """Steps, supports, stops, masses and loads."""
    for x, name in _steps(problem.line):
        yield _Place(x, name, math.inf)
    for path, support in supports_of(problem, problem.line):
        yield _Place(support.x, f"{path}.x", support.translational, support.torsional)
    for i, stop in enumerate(problem.structure.stops):
        for x, _ in stop.reading:
            yield _Place(x, f"stops[{i}].{'between' if stop.side == 'between' else 'x'}", stop.stiffness)
    for i, link in enumerate(problem.structure.links):
        for x in (link.first, link.second):
            yield _Place(x, f"links[{i}].between", link.translational, link.torsional)
    for path, mass in masses_of(problem, problem.line):
        yield _Place(mass.x, f"{path}.x", math.inf if mass.mass or mass.rotary_inertia else 0.0)
    for i, load in enumerate(problem.point_loads):
        yield _Place(problem.line.at(load.x), f"point_loads[{i}].x")
    for i, along in enumerate(problem.uniform_loads):
        ((start, end, _),) = uniform_load_shape(along, problem.line).pieces
        yield _Place(start, f"uniform_loads[{i}].from")
        yield _Place(end, f"uniform_loads[{i}].to")


def _required(problem: Problem) -> FloatArray:
    """Ends and places of parts, each position once, none nearer to another than `CLOSE`; ascending, m."""
    line = problem.line
    chosen = dict.fromkeys((*line.starts, *line.ends), "the end of the beam")
    for x, name, k, kt in sorted(_places(problem), key=lambda it: (not math.isinf(it.k + it.kt), it.x, it.name)):
        near, i = min(chosen, key=lambda node: abs(node - x)), line.beam_at(x)
        d, L = abs(near - x), line.beams[i].length
        if d >= CLOSE * L:
            chosen[x] = name.rpartition(".")[0]
        elif d > SAME * line.length and _locked(k, kt, d) > _LOCKED * float(line.EI_at(np.array([near, x])).min()):
            here, there = (line.place(it, 12) if line.several else repr(it) for it in (x, near))
            raise InputError(
                f"{name} = {here}: lies {d:.3g} m from {chosen[near]} at {there} m, too near for finite elements; "
                f"allowed are the same place, or at least {CLOSE * L:g} m"
            )
    return np.array(sorted(chosen))


def _locked(k: float, kt: float, d: float) -> float:
    """The relative error of frequencies times EI, N m2, by springs, N/m and N m, that act at a distance d, m, from a
    node."""
    return kt * d / 2 + k * d**3 / 6


def _with_given(line: Line, required: FloatArray, given: tuple[float, ...]) -> FloatArray:
    """The user's nodes together with the required ones; of two nearer than `CLOSE` the required one stays."""
    L = line.length
    outside = [x for x in given if not -SAME * L <= x <= (1 + SAME) * L]
    if outside:
        raise InputError(f"nodes: {outside[0]!r} lies outside the beam, 0 to {L:g} m")
    own = np.unique(np.array(given, dtype=float))
    for start, end in line.spaces:
        own = own[(own <= start) | (own >= end)]
    own = own[np.diff(own, prepend=-math.inf) > SAME * L]
    close = np.array([CLOSE * line.beams[line.beam_at(x)].length for x in own.tolist()])
    narrow = np.flatnonzero(np.diff(own) < close[1:])
    if narrow.size:
        a, b, least = float(own[narrow[0]]), float(own[narrow[0] + 1]), float(close[narrow[0] + 1])
        raise InputError(f"nodes: {a!r} and {b!r} m are too near; allowed are nodes at least {least:g} m apart")
    far = np.abs(own[:, None] - required).min(axis=1) >= close
    return np.union1d(required, own[far])


def split_elements(nodes: tuple[float, ...], parts: int) -> tuple[float, ...]:
    """The nodes, m, ascending, with every element cut into equal parts."""
    ends = sorted(set(nodes))
    cut = [np.linspace(a, b, parts + 1)[:-1].tolist() for a, b in itertools.pairwise(ends)]
    return tuple(itertools.chain(*cut, ends[-1:]))


def refined_nodes(problem: Problem, nodes: FloatArray, ratio: float) -> FloatArray:
    """Nodes of a finer mesh with the grading of `nodes`, m, ascending.

    Supports, stops, links, masses, steps, loads and the ends of beams cut the line into stretches, whose ends stay.
    Each stretch has at least `ratio` times as many elements as before, unless it is shorter than `SHORT`, or a space
    between beams.
    """
    line = problem.line
    ends = [*line.starts, *line.ends, *(place.x for place in _places(problem))]
    at, pieces = {int(np.abs(nodes - x).argmin()) for x in ends}, []
    for a, b in itertools.pairwise(sorted(at)):
        short = nodes[b] - nodes[a] < SHORT * _length_at(line, nodes[a], nodes[b])
        kept = short or not _length_at(line, nodes[a], nodes[b])
        count = b - a if kept else math.ceil((b - a) * ratio - 1e-9)
        pieces.append(np.interp(np.linspace(a, b, count + 1), np.arange(a, b + 1), nodes[a : b + 1])[:-1])
    return np.concatenate([*pieces, nodes[-1:]])
