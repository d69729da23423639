r"""Static equilibrium in closed form, by initial parameters (Macaulay, Clebsch), in exact arithmetic.

The beam satisfies EI z'''' = q between the places where anything acts.  With M = EI z'' and V = EI z''', displacement
z, slope s = z', moment and shear pass over a length h of constant EI and load q, N/m, upwards, by

    z + s h + M h^2 / 2 EI + V h^3 / 6 EI + q h^4 / 24 EI,    s + M h / EI + V h^2 / 2 EI + q h^3 / 6 EI,
    M + V h + q h^2 / 2,                                      V + q h.

At a force P upwards V jumps by P, and at a couple C in the sense of a positive slope M jumps by -C.  At the root M = V
= 0 before what acts there.  All is then linear in the displacement and the slope of the root, in the reactions R_i of
the springs of the supports, and in the forces F_j >= 0 of the stops, which act as P = -s_j F_j, s_j = 1 at the top and
-1 at the bottom.  The equations are

    no force and no moment beyond the tip,    z(x_i) + R_i / k_i = 0    (of a torsional spring with z'),
    s_j z(x_j) - gap_j = F_j / k_j where a stop presses, and s_j z(x_j) <= gap_j where F_j = 0.

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
from lapjoint.problem.problem import require_one_beam
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
    """z(x) as a polynomial of degree 4 in the distance from the start of each piece."""

    nodes: FloatArray
    """Ends of the pieces, m, ascending, shape ``(pieces + 1,)``."""
    coefficients: FloatArray
    """Coefficients, m^(1 - power), of the powers 0 to 4, shape ``(5, pieces)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """The shape or an x-derivative at ``x``, m, ``(...)``, shaped like `x`; see `StaticShape`."""
        at = np.asarray(x, dtype=float)
        piece = np.clip(np.searchsorted(self.nodes, at, side="left") - 1, 0, self.nodes.size - 2)
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
    require_one_beam(problem, "equilibria are computed")
    found = _equilibrium(problem.structure, problem.forces.constant, breaks_of(problem))
    if isinstance(found, str):
        raise InputError(found)
    zero = [0.0] * len(problem.structure.supports)
    forces, moments = np.array(zero), np.array(zero)
    for spring, reaction in zip(_springs(problem.structure), found.reactions, strict=True):
        (moments if spring.slope else forces)[spring.support] = reaction
    contacts, shape = np.array(found.contacts, dtype=float), found.shape
    EI = problem.line.EI_at(shape.nodes[1:])
    return Equilibrium(
        problem=problem,
        solver=name,
        state=ContactState(tuple(np.flatnonzero(contacts).tolist())),
        contact_forces=contacts,
        support_forces=forces,
        support_moments=moments,
        shape=shape,
        errors=EquilibriumErrors(
            shape.error(0),
            shape.error(1),
            shape.error_times(EI, 2),
            shape.error_times(EI, 3),
            _ROUNDING * np.abs(contacts),
            _ROUNDING * np.abs(forces),
            _ROUNDING * np.abs(moments),
        ),
        error_source="rounding of the answer, which was found in exact arithmetic",
        other_equilibria=found.other_equilibria,
    )


def start_of(problem: Problem) -> InitialShape | RestingStart:
    """The initial state of a problem as functions of x: as it is given, or the equilibrium of this solver."""
    if isinstance(problem.initial, AtEquilibrium):
        return RestingStart(equilibrium(problem, "analytic"))
    return problem.start


@dataclass(frozen=True)
class _Spring:
    """A spring of a support, that holds z or, if `slope`, the slope."""

    support: int
    x: float
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
    """All springs of the supports that are not of stiffness 0."""
    return [
        _Spring(i, support.x, slope, k)
        for i, support in enumerate(structure.supports)
        for slope, k in ((False, support.translational), (True, support.torsional))
        if k > 0
    ]


@lru_cache(maxsize=_KEPT)
def _equilibrium(structure: Structure, loads: tuple[ConstantForce, ...], breaks: tuple[float, ...]) -> _Found | str:
    """The equilibrium, or why there is none; `breaks`, m, are all places where anything acts or changes."""
    springs, stops, L = _springs(structure), structure.stops, Fraction(structure.line.length)
    beam = _Beam(structure, loads, breaks)
    along = beam.with_reactions(springs, stops)
    _, _, M, V = along.beyond_the_tip
    rows = [V, [L * v - m for v, m in zip(V, M, strict=True)]]  # forces, and moments about the root
    n = len(springs)
    for i, spring in enumerate(springs):
        row = list(along.at(spring.x)[1 if spring.slope else 0])
        row[2 + i] += _compliance(spring.stiffness)
        rows.append(row)
    for j, stop in enumerate(stops):
        row = [-stop.sign * value for value in along.at(stop.x)[0]]
        row[2 + n + j] += _compliance(stop.stiffness)
        row[-1] += Fraction(stop.gap)
        rows.append(row)
    solution = solve(rows, 2 + n)
    if isinstance(solution, NoSolution):
        shift, turn = _of_size_one(solution.direction[:2], L)
        return nothing_resists(shift, turn, structure.line.length)
    values = [*solution.free, *solution.forces]
    shape = beam.polynomials(along, values)
    other = ""
    motions = _free_motions(springs, [stop for stop, F in zip(stops, solution.forces, strict=True) if F])
    if motions:
        waiting = [stop for stop, F in zip(stops, solution.forces, strict=True) if not F]
        beam.add(shape, _nearest(shape, beam.nodes, motions, waiting))
        touching = [stop for stop in waiting if not _depth(shape, beam.nodes, stop)]
        other = _other_equilibria(motions, touching, L)
    quartic = PiecewiseQuartic(np.array(breaks), np.array([[float(c) for c in piece] for piece in shape]).T)
    reactions, contacts = ([float(value) for value in part] for part in (solution.free[2:], solution.forces))
    return _Found(tuple(reactions), tuple(contacts), quartic, other)


def _compliance(stiffness: float) -> Fraction:
    """1 / k, exactly; 0 of a fixed support."""
    return Fraction(0) if math.isinf(stiffness) else 1 / Fraction(stiffness)


class _Along:
    """z, z', M and V at each node, before what acts there, as affine functions of the unknowns; and beyond the tip."""

    def __init__(self, nodes: Sequence[float], before: Sequence[list[Affine]], after: Sequence[list[Affine]]) -> None:
        self._index = {x: i for i, x in enumerate(nodes)}
        self._before, self.after = before, after

    def at(self, x: float) -> list[Affine]:
        """z, z', M and V just before a position, m, which is a node."""
        return self._before[self._index[x]]

    @property
    def beyond_the_tip(self) -> list[Affine]:
        """z, z', M and V beyond all that acts at the tip."""
        return self.after[-1]


class _Beam:
    """The beam under its loads between the nodes `breaks`, m, in rational numbers."""

    def __init__(self, structure: Structure, loads: tuple[ConstantForce, ...], breaks: tuple[float, ...]) -> None:
        self.nodes, spans = breaks, list(pairwise(breaks))
        pieces = structure.line.pieces
        self.EI = [Fraction(next(it.EI for it in pieces if it.start <= a and b <= it.end)) for a, b in spans]
        self.q, self.P = [Fraction(0) for _ in spans], {x: Fraction(0) for x in breaks}
        for load in loads:
            for start, end, force in load.shape.pieces:
                for i, (a, b) in enumerate(spans):
                    if start <= a and b <= end:
                        self.q[i] += Fraction(force) * Fraction(load.force)
            for x, force in load.shape.points:
                self.P[x] += Fraction(force) * Fraction(load.force)

    def with_reactions(self, springs: list[_Spring], stops: tuple[PlacedStop, ...]) -> _Along:
        """All quantities along the beam as affine functions of z and z' at the root, R_i and F_j."""
        n, size = len(springs), 2 + len(springs) + len(stops) + 1
        unit = [[Fraction(int(i == j)) for j in range(size)] for i in range(size)]
        z, s, M, V = unit[0], unit[1], [Fraction(0)] * size, [Fraction(0)] * size
        before, after = [], []
        for i, x in enumerate(self.nodes):
            before.append([z, s, M, V])
            V = _plus(V, (self.P[x], unit[-1]))
            for j, spring in enumerate(springs):
                if spring.x == x and spring.slope:
                    M = _plus(M, (Fraction(-1), unit[2 + j]))
                elif spring.x == x:
                    V = _plus(V, (Fraction(1), unit[2 + j]))
            for j, stop in enumerate(stops):
                if stop.x == x:
                    V = _plus(V, (Fraction(-stop.sign), unit[2 + n + j]))
            after.append([z, s, M, V])
            if i < len(self.EI):
                h, EI, q = Fraction(self.nodes[i + 1]) - Fraction(x), self.EI[i], self.q[i]
                load = unit[-1]
                z = _plus(z, (h, s), (h**2 / 2 / EI, M), (h**3 / 6 / EI, V), (q * h**4 / 24 / EI, load))
                s = _plus(s, (h / EI, M), (h**2 / 2 / EI, V), (q * h**3 / 6 / EI, load))
                M = _plus(M, (h, V), (q * h**2 / 2, load))
                V = _plus(V, (q * h, load))
        return _Along(self.nodes, before, after)

    def polynomials(self, along: _Along, values: Sequence[Fraction]) -> list[list[Fraction]]:
        """The five coefficients of z on each span, in the distance from its start, for values of the unknowns."""
        found = []
        for i, EI in enumerate(self.EI):
            z, s, M, V = (_value(quantity, values) for quantity in along.after[i])
            found.append([z, s, M / 2 / EI, V / 6 / EI, self.q[i] / 24 / EI])
        return found

    def add(self, shape: list[list[Fraction]], motion: tuple[Fraction, Fraction]) -> None:
        """Add a rigid motion, of the root and of the slope, to a shape."""
        for x, piece in zip(self.nodes[:-1], shape, strict=True):
            piece[0] += motion[0] + motion[1] * Fraction(x)
            piece[1] += motion[1]


def _plus(one: Affine, *others: tuple[Fraction, Affine]) -> Affine:
    """The sum of a quantity and of multiples of others."""
    total = list(one)
    for factor, other in others:
        if factor:
            for i, value in enumerate(other):
                if value:
                    total[i] += factor * value
    return total


def _value(quantity: Affine, values: Sequence[Fraction]) -> Fraction:
    """A quantity for values of the unknowns."""
    return sum((a * v for a, v in zip(quantity, values, strict=False) if a and v), quantity[-1])


Motion = tuple[Fraction, Fraction]
"""A rigid motion: displacement of the root, m, and slope."""


def _free_motions(springs: list[_Spring], pressing: list[PlacedStop]) -> list[Motion]:
    """A basis of the rigid motions that neither the springs nor the pressing stops resist: 0 to 2 of them."""
    zero, one = Fraction(0), Fraction(1)
    held = [(zero, one) if spring.slope else (one, Fraction(spring.x)) for spring in springs]
    held += [(one, Fraction(stop.x)) for stop in pressing]
    if not held:
        return [(one, zero), (zero, one)]
    a, b = held[0]
    if any(a * d != b * c for c, d in held):
        return []
    return [(b, -a) if a else (one, zero)]


def _moved(motion: Motion, stop: PlacedStop) -> Fraction:
    """How far a rigid motion takes the beam towards a stop."""
    return stop.sign * (motion[0] + motion[1] * Fraction(stop.x))


def _depth(shape: list[list[Fraction]], nodes: Sequence[float], stop: PlacedStop) -> Fraction:
    """How far the beam is beyond a stop's gap, exactly."""
    i = min(nodes.index(stop.x), len(shape) - 1)
    h = Fraction(stop.x) - Fraction(nodes[i])
    z = sum((c * h**n for n, c in enumerate(shape[i])), Fraction(0))
    return stop.sign * z - Fraction(stop.gap)


def _other_equilibria(motions: list[Motion], touching: list[PlacedStop], L: Fraction) -> str:
    """The sentence that rigid motions among `motions` do not change the equilibrium; empty if stops allow none.

    Motions that touching stops allow form a cone; unless it is 0 or everything, it has an edge, about a stop.
    """
    rays = list(motions)
    if len(motions) == 2:
        rays += [(Fraction(stop.x), Fraction(-1)) for stop in touching]
    rays += [(-a, -b) for a, b in rays]
    allowed = [ray for ray in rays if all(_moved(ray, stop) <= 0 for stop in touching)]
    if not allowed:
        return ""
    (a, b), first = allowed[0], _of_size_one(allowed[0], L)
    others = any(a * d != b * c for c, d in allowed)
    return nothing_holds(*first, float(L), any(a * c + b * d < 0 for c, d in allowed), others)


def _of_size_one(motion: Sequence[Fraction], L: Fraction) -> tuple[float, float]:
    """A rigid motion divided by its largest displacement at the ends, in numbers that floats hold."""
    shift, turn = motion
    most = max(abs(shift), abs(shift + turn * L))
    return float(shift / most), float(turn / most)


def _nearest(
    shape: list[list[Fraction]], nodes: Sequence[float], motions: list[Motion], waiting: list[PlacedStop]
) -> Motion:
    """The rigid motion among `motions` that the gaps allow, and after which the mean square of z is least.

    With amounts r of the motions and multipliers F_j, half of the derivative of the integral of z^2 by r_k, plus the
    sum of F_j times the way of motion k towards stop j, is 0.
    """
    d = len(motions)
    rows: list[list[Fraction]] = []
    for motion in motions:
        products = [_product([[a, b]], (nodes[0], nodes[-1]), motion) for a, b in motions]
        rows.append([*products, *(_moved(motion, stop) for stop in waiting), _product(shape, nodes, motion)])
    for stop in waiting:
        none = [Fraction(0)] * len(waiting)
        rows.append([*(-_moved(motion, stop) for motion in motions), *none, -_depth(shape, nodes, stop)])
    found = solve(rows, d)
    assert not isinstance(found, NoSolution)
    return (
        sum((r * motion[0] for r, motion in zip(found.free, motions, strict=True)), Fraction(0)),
        sum((r * motion[1] for r, motion in zip(found.free, motions, strict=True)), Fraction(0)),
    )


def _product(shape: list[list[Fraction]], nodes: Sequence[float], motion: Motion) -> Fraction:
    """The integral along the beam of a shape times a rigid motion."""
    total = Fraction(0)
    for (a, b), piece in zip(pairwise(nodes), shape, strict=True):
        h, start = Fraction(b) - Fraction(a), motion[0] + motion[1] * Fraction(a)
        total += sum(
            (c * (start * h ** (n + 1) / (n + 1) + motion[1] * h ** (n + 2) / (n + 2)) for n, c in enumerate(piece)),
            Fraction(0),
        )
    return total
