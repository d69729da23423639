r"""Static equilibrium in closed form, by initial parameters (Macaulay, Clebsch), in exact arithmetic.

The beam satisfies EI z'''' = q between the places where anything acts.  With M = EI z'' and V = EI z''', displacement
z, slope s = z', moment and shear pass over a length h of constant EI and load q, N/m, upwards, by

    z + s h + M h^2 / 2 EI + V h^3 / 6 EI + q h^4 / 24 EI,    s + M h / EI + V h^2 / 2 EI + q h^3 / 6 EI,
    M + V h + q h^2 / 2,                                      V + q h.

At a force P upwards V jumps by P, and at a couple C in the sense of a positive slope M jumps by -C.  At the left end of
each beam M = V = 0 before what acts there.  All is then linear in the displacements and the slopes of the left ends, in
the reactions R_i of the springs of supports and links, and in the forces F_j >= 0 of the stops.  Springs and stops read
r z, a displacement or the second beam's less the first one's; they act as P = R_i, or as P = -s_j F_j, s_j = 1 at the
top and between beams and -1 at the bottom, on the beam that they read with +1, and opposite on the other.  The
equations are

    no force and no moment beyond the right end of each beam,    r_i z + R_i / k_i = 0  (of a torsional spring with z'),
    s_j r_j z - gap_j = F_j / k_j where a stop presses, and s_j r_j z <= gap_j where F_j = 0.

An infinite stiffness needs no care: then 1 / k_i = 0.  `analytic.pivoting` says how the stops that press are found.

The numbers of a problem are taken as they are stored, and all arithmetic is rational until the answer is rounded, once:
the errors are those of this rounding, whatever the stiffnesses are, and which stops press is decided without rounding.

Several equilibria of one joint have the same forces and the same bending, as the energy is strictly convex in both.
They differ by rigid motions that neither supports nor pressing stops resist, within the gaps of the other stops; the
rigid motion with the least mean square of z is found by the same pivoting.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

import numpy as np
import numpy.typing as npt

from analytic.pivoting import NoSolution, solve
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.equilibrium import (
    Equilibrium,
    EquilibriumErrors,
    RestingStart,
    breaks_of,
    nothing_holds,
    nothing_resists,
)
from lapjoint.errors import InputError
from lapjoint.problem import AtEquilibrium, FloatArray, Problem
from lapjoint.problem.forces import ConstantForce
from lapjoint.problem.initial import InitialShape
from lapjoint.problem.line import Line
from lapjoint.problem.structure import Structure
from lapjoint.problem.supports_and_stops import PlacedStop

_ROUNDING = float(np.finfo(float).eps) / 2
"""Largest relative error of a rounded number."""
_OF_A_POLYNOMIAL = 16 * _ROUNDING
"""Rounding error of a polynomial of degree 4 with rounded coefficients, relative to the sum of the moduli of its terms:
less than three roundings for each of five terms."""
_KEPT = 64
"""Equilibria kept; each takes some kB."""
Affine = list[Fraction]
"""A quantity as coefficients of the unknowns, and last the constant."""


@dataclass(frozen=True)
class PiecewiseQuartic:
    """z(x) as a polynomial of degree 4 in the distance from the start of each piece; 0 on spaces between beams."""

    nodes: FloatArray
    """Ends of the pieces, m, ascending, shape ``(pieces + 1,)``."""
    coefficients: FloatArray
    """Coefficients, m^(1 - power), of the powers 0 to 4, shape ``(5, pieces)``."""
    empty: npt.NDArray[np.bool_]
    """Whether each piece is a space between beams, shape ``(pieces,)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """The shape or an x-derivative at ``x``, m, ``(...)``, shaped like `x`; see `StaticShape`."""
        at = np.asarray(x, dtype=float)
        piece = np.clip(np.searchsorted(self.nodes, at, side="left") - 1, 0, self.nodes.size - 2)
        piece = np.where(self.empty[piece] & (at == self.nodes[piece + 1]), piece + 1, piece)
        h, found = at - self.nodes[piece], np.zeros_like(at)
        for power in range(4, derivative - 1, -1):
            found = found * h + math.perm(power, derivative) * self.coefficients[power][piece]
        return found

    def error(self, derivative: int) -> float:
        """Largest rounding error of a derivative along the beam, m^(1 - derivative)."""
        return _OF_A_POLYNOMIAL * float(np.max(self._largest(derivative), initial=0.0))

    def error_times(self, EI: FloatArray, derivative: int) -> float:
        """`error` of EI times the derivative, with EI of each piece, N m2."""
        return _OF_A_POLYNOMIAL * float(np.max(EI * self._largest(derivative), initial=0.0))

    def _largest(self, derivative: int) -> FloatArray:
        """The sum of the moduli of the terms at the end of each piece, ``(pieces,)``."""
        h = np.diff(self.nodes)
        terms = [
            math.perm(n, derivative) * np.abs(self.coefficients[n]) * h ** (n - derivative)
            for n in range(derivative, 5)
        ]
        return np.asarray(np.sum(terms, axis=0))


def equilibrium(problem: Problem, name: str) -> Equilibrium:
    """The static equilibrium of a problem, by a solver called `name`; an InputError if there is none."""
    found = _equilibrium(problem.structure, problem.forces.constant, breaks_of(problem))
    if isinstance(found, str):
        raise InputError(found)
    supports = len(problem.structure.supports)
    held = np.zeros((2, supports + len(problem.structure.links)))
    for spring, reaction in zip(_springs(problem.structure), found.reactions, strict=True):
        held[int(spring.slope), spring.part] = reaction
    (forces, moments), (link_forces, link_moments) = held[:, :supports], held[:, supports:]
    contacts, shape = np.array(found.contacts, dtype=float), found.shape
    EI = problem.line.EI_at(shape.nodes[1:])
    return Equilibrium(
        problem=problem,
        solver=name,
        state=ContactState(tuple(np.flatnonzero(contacts).tolist())),
        contact_forces=contacts,
        support_forces=forces,
        support_moments=moments,
        link_forces=link_forces,
        link_moments=link_moments,
        shape=shape,
        errors=EquilibriumErrors(
            shape.error(0),
            shape.error(1),
            shape.error_times(EI, 2),
            shape.error_times(EI, 3),
            *(_ROUNDING * np.abs(each) for each in (contacts, forces, moments, link_forces, link_moments)),
        ),
        error_source="rounding of the answer, which was found in exact arithmetic",
        other_equilibria=found.other_equilibria,
    )


def start_of(problem: Problem) -> InitialShape | RestingStart:
    """The initial state of a problem as functions of x: as it is given, or the equilibrium of this solver."""
    if isinstance(problem.initial, AtEquilibrium):
        return RestingStart(equilibrium(problem, "analytic"))
    return problem.start


Reading = tuple[tuple[float, float], ...]
"""Position on the line, m, and factor of each displacement, or slope, of a sum."""


@dataclass(frozen=True)
class _Spring:
    """A spring of a support or link, that holds what it reads of displacements or, if `slope`, of slopes."""

    part: int
    """Index among the supports and then the links."""
    reading: Reading
    slope: bool
    stiffness: float


@dataclass(frozen=True)
class _Found:
    """An equilibrium: forces of the springs and of the stops, the shape, and a sentence if it is not unique."""

    reactions: tuple[float, ...]
    contacts: tuple[float, ...]
    shape: PiecewiseQuartic
    other_equilibria: str


def _springs(structure: Structure) -> list[_Spring]:
    """All springs of the supports and links but those of stiffness 0, and those that hold what others hold."""
    parts: list[tuple[Reading, float, float]] = [
        (((it.x, 1.0),), it.translational, it.torsional) for it in structure.supports
    ]
    parts += [(((it.second, 1.0), (it.first, -1.0)), it.translational, it.torsional) for it in structure.links]
    return [
        _Spring(i, reading, bool(derivative), k)
        for i, (reading, *springs) in enumerate(parts)
        for derivative, k in enumerate(springs)
        if k > 0 and (i, derivative) not in structure.idle
    ]


@lru_cache(maxsize=_KEPT)
def _equilibrium(structure: Structure, loads: tuple[ConstantForce, ...], breaks: tuple[float, ...]) -> _Found | str:
    """The equilibrium, or why there is none; `breaks`, m, are all places where anything acts or changes."""
    springs, stops = _springs(structure), structure.stops
    beams = _Beams(structure, loads, breaks)
    along = beams.with_reactions(springs, stops)
    rows = beams.balances(along)
    ends, n = len(rows), len(springs)
    for i, spring in enumerate(springs):
        row = along.read(spring.reading, int(spring.slope))
        row[ends + i] += _compliance(spring.stiffness)
        rows.append(row)
    for j, stop in enumerate(stops):
        row = [-stop.sign * value for value in along.read(stop.reading)]
        row[ends + n + j] += _compliance(stop.stiffness)
        row[-1] += Fraction(stop.gap)
        rows.append(row)
    solution = solve(rows, ends + n)
    if isinstance(solution, NoSolution):
        return nothing_resists(structure.line, _of_size_one(solution.direction[:ends], structure.line))
    shape = beams.polynomials(along, [*solution.free, *solution.forces])
    other = ""
    pressing = [stop for stop, F in zip(stops, solution.forces, strict=True) if F]
    motions = beams.free_motions(springs, pressing)
    if motions:
        waiting = [stop for stop, F in zip(stops, solution.forces, strict=True) if not F]
        shape = beams.moved(shape, _nearest(beams, shape, motions, waiting))
        touching = [stop for stop in waiting if not beams.depth(shape, stop)]
        other = _other_equilibria(beams, motions, touching)
    coefficients, empty = (
        np.array([[float(c) for c in piece] for piece in shape]).T,
        np.array([not EI for EI in beams.EI]),
    )
    quartic = PiecewiseQuartic(np.array(breaks), coefficients, empty)
    reactions, contacts = ([float(value) for value in part] for part in (solution.free[ends:], solution.forces))
    return _Found(tuple(reactions), tuple(contacts), quartic, other)


def _compliance(stiffness: float) -> Fraction:
    """1 / k, exactly; 0 of a fixed support."""
    return Fraction(0) if math.isinf(stiffness) else 1 / Fraction(stiffness)


class _Along:
    """z, z', M and V at each node, before what acts there and after it, as affine functions of the unknowns."""

    def __init__(self, nodes: Sequence[float], before: Sequence[list[Affine]], after: Sequence[list[Affine]]) -> None:
        self._index = {x: i for i, x in enumerate(nodes)}
        self._before, self.after = before, after

    def read(self, reading: Reading, derivative: int = 0) -> Affine:
        """A sum of displacements, or of slopes, at nodes."""
        return _sum(*((Fraction(factor), self._before[self._index[x]][derivative]) for x, factor in reading))

    def beyond(self, x: float) -> list[Affine]:
        """z, z', M and V beyond all that acts at a position, m, which is a node."""
        return self.after[self._index[x]]


Row = list[Fraction]
Polynomials = list[list[Fraction]]
"""The coefficients of a shape on each span, in the distance from its start; none on spaces between beams."""
Motion = list[Fraction]
"""A rigid motion: of each beam the displacement of its left end, m, and its slope."""


class _Beams:
    """The beams under their loads between the nodes `breaks`, m, in rational numbers."""

    def __init__(self, structure: Structure, loads: tuple[ConstantForce, ...], breaks: tuple[float, ...]) -> None:
        self.line, self.nodes, spans = structure.line, breaks, list(pairwise(breaks))
        pieces, none = self.line.pieces, Fraction(0)
        self.EI = [next((Fraction(it.EI) for it in pieces if it.start <= a and b <= it.end), none) for a, b in spans]
        """Bending stiffness of each span, N m2; 0 of a space between beams."""
        self.beam_of = [self.line.beam_at((a + b) / 2) for a, b in spans]
        self.q, self.P = [none for _ in spans], dict.fromkeys(breaks, none)
        for load in loads:
            for start, end, force in load.shape.pieces:
                for i, (a, b) in enumerate(spans):
                    if start <= a and b <= end:
                        self.q[i] += Fraction(force) * Fraction(load.force)
            for x, force in load.shape.points:
                self.P[x] += Fraction(force) * Fraction(load.force)

    def with_reactions(self, springs: list[_Spring], stops: tuple[PlacedStop, ...]) -> _Along:
        """All quantities along the beams as affine functions of z and z' at the left ends, R_i and F_j."""
        ends, starts = 2 * len(self.line.beams), {x: i for i, x in enumerate(self.line.starts)}
        size = ends + len(springs) + len(stops) + 1
        unit = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
        acting: dict[float, list[tuple[bool, Fraction, Affine]]] = {x: [] for x in self.nodes}
        for spring, force in zip(springs, unit[ends:], strict=False):
            for x, factor in spring.reading:
                acting[x].append((spring.slope, Fraction(factor), force))
        for stop, force in zip(stops, unit[ends + len(springs) :], strict=False):
            for x, factor in stop.reading:
                acting[x].append((False, -stop.sign * Fraction(factor), force))
        z, s, M, V = ([Fraction(0)] * size for _ in range(4))
        before, after, load = [], [], unit[-1]
        for i, x in enumerate(self.nodes):
            if x in starts:
                z, s, M, V = unit[2 * starts[x]], unit[2 * starts[x] + 1], [Fraction(0)] * size, [Fraction(0)] * size
            before.append([z, s, M, V])
            V = _sum((Fraction(1), V), (self.P[x], load), *((f, F) for couple, f, F in acting[x] if not couple))
            M = _sum((Fraction(1), M), *((-f, F) for couple, f, F in acting[x] if couple))
            after.append([z, s, M, V])
            if i < len(self.EI) and self.EI[i]:
                one, h, EI, q = Fraction(1), Fraction(self.nodes[i + 1]) - Fraction(x), self.EI[i], self.q[i]
                z = _sum((one, z), (h, s), (h**2 / 2 / EI, M), (h**3 / 6 / EI, V), (q * h**4 / 24 / EI, load))
                s = _sum((one, s), (h / EI, M), (h**2 / 2 / EI, V), (q * h**3 / 6 / EI, load))
                M = _sum((one, M), (h, V), (q * h**2 / 2, load))
                V = _sum((one, V), (q * h, load))
        return _Along(self.nodes, before, after)

    def balances(self, along: _Along) -> list[Affine]:
        """Of each beam all forces, and all moments about its left end, which must be 0."""
        rows = []
        for start, end in zip(self.line.starts, self.line.ends, strict=True):
            _, _, M, V = along.beyond(end)
            rows += [V, _sum((Fraction(end) - Fraction(start), V), (Fraction(-1), M))]
        return rows

    def polynomials(self, along: _Along, values: Sequence[Fraction]) -> Polynomials:
        """z on each span for values of the unknowns; five coefficients, 0 on spaces."""
        found = []
        for i, EI in enumerate(self.EI):
            z, s, M, V = (_value(quantity, values) for quantity in along.after[i])
            found.append([z, s, M / 2 / EI, V / 6 / EI, self.q[i] / 24 / EI] if EI else [Fraction(0)] * 5)
        return found

    def rigid(self, motion: Motion) -> Polynomials:
        """A rigid motion as a shape."""
        return [
            [motion[2 * b] + motion[2 * b + 1] * (Fraction(x) - Fraction(self.line.starts[b])), motion[2 * b + 1]]
            if EI
            else [Fraction(0)] * 2
            for x, b, EI in zip(self.nodes, self.beam_of, self.EI, strict=False)
        ]

    def moved(self, shape: Polynomials, motion: Motion) -> Polynomials:
        """A shape with a rigid motion added."""
        both = zip(shape, self.rigid(motion), strict=True)
        return [[piece[0] + more[0], piece[1] + more[1], *piece[2:]] for piece, more in both]

    def depth(self, shape: Polynomials, stop: PlacedStop) -> Fraction:
        """How far what a stop's gap sees is beyond the gap, exactly."""
        z = Fraction(0)
        for x, factor in stop.reading:
            i = self.nodes.index(x)
            i -= i == len(self.EI) or not self.EI[i]  # at the right end of a beam, the span to the left
            h = Fraction(x) - Fraction(self.nodes[i])
            z += Fraction(factor) * sum((c * h**n for n, c in enumerate(shape[i])), Fraction(0))
        return stop.sign * z - Fraction(stop.gap)

    def product(self, one: Polynomials, other: Polynomials) -> Fraction:
        """The integral along the beams of the product of two shapes."""
        return sum(
            (
                c * d * (Fraction(b) - Fraction(a)) ** (m + n + 1) / (m + n + 1)
                for (a, b), first, second in zip(pairwise(self.nodes), one, other, strict=True)
                for m, c in enumerate(first)
                for n, d in enumerate(second)
                if c and d
            ),
            Fraction(0),
        )

    def read_of_motions(self, reading: Reading, slope: bool = False) -> Motion:
        """What a sum of displacements, or of slopes, is of a rigid motion of size 1 of each beam's end and slope."""
        row = [Fraction(0)] * 2 * len(self.line.beams)
        for x, factor in reading:
            b = self.line.beam_at(x)
            row[2 * b + 1] += Fraction(factor) * (1 if slope else Fraction(x) - Fraction(self.line.starts[b]))
            row[2 * b] += 0 if slope else Fraction(factor)
        return row

    def way(self, motion: Motion, stop: PlacedStop) -> Fraction:
        """How far a rigid motion goes towards a stop."""
        return stop.sign * _dot(self.read_of_motions(stop.reading), motion)

    def free_motions(self, springs: list[_Spring], pressing: list[PlacedStop]) -> list[Motion]:
        """A basis of the rigid motions that neither springs nor pressing stops resist: 0 to 2 a beam."""
        size, free = 2 * len(self.line.beams), []
        held = [self.read_of_motions(spring.reading, spring.slope) for spring in springs]
        held += [self.read_of_motions(stop.reading) for stop in pressing]
        columns: list[int] = []  # one of each reduced row, which has 1 there where the other rows have 0
        for column in range(size):
            row = next((row for row in held[len(columns) :] if row[column]), None)
            if row is None:
                free.append(column)
                continue
            held.remove(row)
            held.insert(len(columns), [value / row[column] for value in row])
            row = held[len(columns)]
            held = [other if other is row else _sum((Fraction(1), other), (-other[column], row)) for other in held]
            columns.append(column)
        found = []
        for column in free:
            motion = [Fraction(int(i == column)) for i in range(size)]
            for row, pivot in zip(held, columns, strict=False):
                motion[pivot] = -row[column]
            found.append(motion)
        return found


def _sum(*parts: tuple[Fraction, Affine]) -> Affine:
    """A sum of quantities, each with its factor."""
    total = [Fraction(0)] * len(parts[0][1])
    for factor, other in parts:
        if factor:
            for i, value in enumerate(other):
                if value:
                    total[i] += factor * value
    return total


def _dot(one: Sequence[Fraction], other: Sequence[Fraction]) -> Fraction:
    """The sum of the products of two rows."""
    return sum((a * b for a, b in zip(one, other, strict=True) if a and b), Fraction(0))


def _value(quantity: Affine, values: Sequence[Fraction]) -> Fraction:
    """A quantity for values of the unknowns."""
    return _dot(quantity[:-1], values) + quantity[-1]


def _least(Q: list[Row], c: Row, ways: list[Row], room: Row) -> Row:
    """The a, ``(d,)``, with a Q a / 2 + c a least among those that go no farther along each way than there is room.

    With multipliers F_j, Q a + c plus the sum of F_j times way j is 0.
    """
    columns = [list(column) for column in zip(*ways, strict=True)] or [[] for _ in c]
    rows = [[*row, *column, constant] for row, column, constant in zip(Q, columns, c, strict=True)]
    none = [Fraction(0)] * len(ways)
    rows += [[*(-part for part in way), *none, left] for way, left in zip(ways, room, strict=True)]
    found = solve(rows, len(c))
    assert not isinstance(found, NoSolution)
    return list(found.free)


def _combined(amounts: Row, motions: list[Motion]) -> Motion:
    """A sum of motions, each with its amount."""
    return _sum(*zip(amounts, motions, strict=True))


def _nearest(beams: _Beams, shape: Polynomials, motions: list[Motion], waiting: list[PlacedStop]) -> Motion:
    """The rigid motion among `motions` that the gaps allow, and after which the mean square of z is least."""
    rigid = [beams.rigid(motion) for motion in motions]
    amounts = _least(
        [[beams.product(one, other) for other in rigid] for one in rigid],
        [beams.product(shape, one) for one in rigid],
        [[beams.way(motion, stop) for motion in motions] for stop in waiting],
        [-beams.depth(shape, stop) for stop in waiting],
    )
    return _combined(amounts, motions)


def _other_equilibria(beams: _Beams, motions: list[Motion], touching: list[PlacedStop]) -> str:
    """The sentence that rigid motions among `motions` do not change the equilibrium; empty if stops allow none.

    The motions that touching stops allow form a cone.  Those of them that lie nearest to each of `motions`, and to its
    opposite, are all 0 if the cone is 0, and all multiples of one motion if the cone is a ray or a line.
    """
    ways = [[beams.way(motion, stop) for motion in motions] for stop in touching]
    unit = [[Fraction(int(i == k)) for i in range(len(motions))] for k in range(len(motions))]
    sides = [[sign * part for part in one] for one in unit for sign in (-1, 1)]
    rays = [ray for side in sides if any(ray := _least(unit, side, ways, [Fraction(0)] * len(ways)))]
    if not rays:
        return ""
    ray, both_ways = rays[0], all(_dot(way, rays[0]) == 0 for way in ways)
    others = any(_dot(ray, it) ** 2 != _dot(ray, ray) * _dot(it, it) for it in rays)
    motion = _of_size_one(_combined(ray, motions), beams.line)
    return nothing_holds(beams.line, motion, both_ways, others)


def _of_size_one(motion: Sequence[Fraction], line: Line) -> list[float]:
    """A rigid motion divided by its largest displacement at the ends of beams, in numbers that floats hold."""
    lengths = (Fraction(end) - Fraction(start) for start, end in zip(line.starts, line.ends, strict=True))
    beams = zip(motion[::2], motion[1::2], lengths, strict=True)
    most = max(max(abs(shift), abs(shift + turn * L)) for shift, turn, L in beams)
    return [float(part / most) for part in motion]
