r"""Natural frequencies: a characteristic function that neither overflows nor cancels, and a count of its roots.

The paper sets the determinant of its boundary matrix [g] to zero (15).  That determinant overflows with the
hyperbolic terms and loses its digits when supports are soft.  Here the same condition is carried along the
beam by the minors of two solutions.  Write, for the two independent solutions u, v of

.. math:: \phi'''' - \beta^4 \phi = 0                                                                     (8)

that satisfy the conditions at x = 0, with :math:`M = \phi''` and :math:`Q = -\phi'''`,

    A = [phi, theta],  B = [phi, M],  C = -[phi, Q] = [theta, M],  D = -[theta, Q],  F = -[M, Q]

where ``[a, b] = a_u b_v - a_v b_u``.  Along a span they obey

    A' = B,   B' = 2 C,   C' = D,   D' = F - beta^4 A,   F' = -beta^4 B

so that ``A'''' + 4 beta^4 A = 2 (F + beta^4 A)``, whose right-hand side is constant: closed form.  A translational
spring kappa = k L^3 / EI and a torsional spring kappa_t = kt L / EI add

    B += kappa_t A,   D += kappa A,   F += kappa B + kappa_t D + kappa kappa_t A

(13a)-(13h).  At beta = 0 every term is positive, so nothing cancels however soft a spring is; an infinite spring
is the leading coefficient.  A beam that begins free has (A, B, C, D, F) = (1, 0, 0, 0, 0) before the springs at
x = 0, and the frequencies are the roots of F after the springs at x = L.  Only their signs matter: where each
fixed support takes the five some digits further towards underflow, they are divided by the largest.

A mass M with the rotary inertia J is a pair of springs that depends on the frequency,

    kappa - (beta L)^4 M / (m L),   kappa_t - (beta L)^4 J / (m L^3).

Where the beam has steps, EI and m are its means.  Span s has the wave number b_s beta, b_s^4 = (m_s / EI_s) / (m / EI),
and the moments M = (EI_s / EI) phi''.  On each span the minors are carried in units of its own EI_s: at a step from
EI_s to EI_t, B, C and D are multiplied by EI_s / EI_t, and F by the square of it.

The count.  sign F = (-1)^J, where J is the number of frequencies below the trial value.  Releasing one constraint
raises J by 0 or 1 (Rayleigh), also where a mass is released with it, and the two signs tell which.  Starting from the
beam that is clamped at every node, whose J is a sum over clamped-clamped spans in closed form, and releasing one
constraint after another, J follows with certainty: the Wittrick-Williams algorithm with signs in place of a
factorisation.  Nodes are released from the root to the tip; what lies beyond the next, clamped node gives F the same
factor before and after, so each release costs one span.

Lengths are divided by L here, so that z = beta L is the unknown.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.optimize import elementwise

from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray, Problem

IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

_ERROR = 1e-12  # largest relative error of a root, some thousand rounding errors
_ONE_PLACE = 8 * float(np.finfo(float).eps)
"""Distance of positions, divided by the length of the beam, that is rounding: 0.6 L and 24 L / 40 are one place."""
_SMALL = 1e-100  # size below which minors are scaled up: 200 decades are left above the least double
_SERIES_BELOW = 1.0  # z length below which two differences that cancel are summed as series; 8 terms give 1e-20


@dataclass(frozen=True)
class Coupling:
    """A spring between two nodes of different beams, made dimensionless as those of a node are."""

    first: int
    """Node of one beam."""
    second: int
    """Node of another beam."""
    derivative: int
    """0 of a spring between the displacements, 1 of one between the slopes."""
    stiffness: float
    """k L^3 / EI, or kt L / EI, above 0, possibly infinite."""


@dataclass(frozen=True)
class Layout:
    """Nodes of the beam with what acts at them, and the spans between them, made dimensionless with L, EI and m."""

    x: FloatArray
    """Node positions divided by L, from 0 to 1, shape ``(nodes,)``."""
    translational: FloatArray
    """k L^3 / EI at each node, possibly infinite, shape ``(nodes,)``."""
    torsional: FloatArray
    """kt L / EI at each node, possibly infinite, shape ``(nodes,)``."""
    mass: FloatArray
    """M / (m L) of the masses at each node, shape ``(nodes,)``."""
    rotary: FloatArray
    """J / (m L^3) of the rotary inertias at each node, shape ``(nodes,)``."""
    stiffness: FloatArray
    """EI of each span divided by EI, shape ``(nodes - 1,)``."""
    wave: FloatArray
    """Wave number b of each span divided by beta, shape ``(nodes - 1,)``; see the module's head.  A space between two
    beams is a span whose stiffness and wave number are 0."""
    couplings: tuple[Coupling, ...] = ()
    """Springs between two nodes of different beams, none of them redundant."""

    @cached_property
    def beams(self) -> tuple[tuple[int, int], ...]:
        """First and last node of each beam, from left to right."""
        spaces = np.flatnonzero(self.stiffness == 0).tolist()
        return tuple(zip([0, *(s + 1 for s in spaces)], [*spaces, self.x.size - 1], strict=True))

    @property
    def several(self) -> bool:
        """Whether there are several beams."""
        return len(self.beams) > 1

    def has_span(self, span: int) -> bool:
        """Whether a span, -1 ... ``nodes - 1``, is part of a beam: not beyond an end, and no space."""
        return 0 <= span < self.stiffness.size and self.stiffness[span] != 0

    @property
    def spans(self) -> FloatArray:
        """Span lengths divided by L, shape ``(nodes - 1,)``."""
        return np.diff(self.x)

    @property
    def span_masses(self) -> FloatArray:
        """Mass per unit length of each span divided by m, shape ``(nodes - 1,)``."""
        return np.asarray(self.stiffness * self.wave**4)

    def springs(self, node: int, fourth: FloatArray) -> tuple[Spring, Spring]:
        """Dynamic stiffnesses of a node, divided by EI / L^3 and by EI / L: force per deflection, and moment per slope.

        `fourth` is (beta L)^4, ``(n,)``.  A node without a mass gives numbers, one with a mass arrays, ``(n,)``.
        """
        return (
            _spring(float(self.translational[node]), float(self.mass[node]), fourth),
            _spring(float(self.torsional[node]), float(self.rotary[node]), fourth),
        )

    def rigid_modes(self) -> int:
        """Number of rigid-body modes that the springs allow: 0, 1 or 2."""
        rows = [(1.0, x) for x, k in zip(self.x, self.translational, strict=True) if k > 0]
        rows += [(0.0, 1.0) for k in self.torsional if k > 0]
        if not rows:
            return 2
        if any(row[0] == 0 for row in rows) and any(row[0] == 1 for row in rows):
            return 0
        return 1 if len({row[1] for row in rows}) == 1 or rows[0][0] == 0 else 0


def _spring(stiffness: float, mass: float, fourth: FloatArray) -> Spring:
    """Dynamic stiffness of a spring with a mass."""
    return stiffness - fourth * mass if mass and not math.isinf(stiffness) else stiffness


def node_positions(problem: Problem, closed: tuple[int, ...]) -> FloatArray:
    """Positions, m, ascending, of the ends of the beam's pieces, of the edges of loads, and of all that acts on the
    beam; open stops do not.  Positions that differ by rounding are one."""
    structure = problem.structure
    at = [support.x for support in structure.supports] + [mass.x for mass in structure.masses]
    at += [x for link in structure.links for x in (link.first, link.second)]
    at += [x for i in closed for x, _ in structure.stops[i].reading]
    at += [x for load in problem.forces.every for x in load.shape.edges]
    at += [x for piece in problem.line.pieces for x in (piece.start, piece.end)]
    x = np.unique(np.array(at))
    apart = np.append(np.diff(x) > _ONE_PLACE * problem.line.length, True)
    return np.asarray(np.append(0.0, x[apart][x[apart] > _ONE_PLACE * problem.line.length]))


def layout_of(problem: Problem, closed: tuple[int, ...] = ()) -> Layout:
    """The beam with its supports and its `closed` stops as springs."""
    beam, x = problem.line, node_positions(problem, closed)
    translational, torsional = np.zeros(x.size), np.zeros(x.size)

    def at(position: float) -> int:
        return int(np.argmin(np.abs(x - position)))

    for support in problem.structure.supports:
        node = at(support.x)
        translational[node] += support.translational
        torsional[node] += support.torsional
    for stop in (problem.structure.stops[i] for i in closed):
        if len(stop.reading) == 1:
            translational[at(stop.x)] += stop.stiffness
    mass, rotary = np.zeros(x.size), np.zeros(x.size)
    for lumped in problem.structure.masses:
        node = at(lumped.x)
        mass[node] += lumped.mass
        rotary[node] += lumped.rotary_inertia
    L, middle = beam.length, (x[:-1] + x[1:]) / 2
    stiffness, span_mass = beam.EI_at(middle) / beam.EI, beam.inertia_at(middle) / beam.m
    springs = [
        Coupling(at(link.first), at(link.second), d, k)
        for link in problem.structure.links
        for d, k in ((0, link.translational * (L**3 / beam.EI)), (1, link.torsional * (L / beam.EI)))
    ]
    for stop in (problem.structure.stops[i] for i in closed):
        if len(stop.reading) == 2:
            (second, _), (first, _) = stop.reading
            springs.append(Coupling(at(first), at(second), 0, stop.stiffness * (L**3 / beam.EI)))
    return Layout(
        x=x / L,
        translational=translational * (L**3 / beam.EI),
        torsional=torsional * (L / beam.EI),
        mass=mass / (beam.m * L),
        rotary=rotary / (beam.m * L) / L**2,
        stiffness=stiffness,
        wave=(span_mass / np.where(stiffness > 0, stiffness, 1.0)) ** 0.25,
        couplings=_independent(springs, translational, torsional),
    )


def _independent(springs: Iterable[Coupling], *supports: FloatArray) -> tuple[Coupling, ...]:
    """Springs without those of no stiffness, those side by side as one, and no infinite spring where two nodes are held
    together already, by fixed supports or by other infinite springs; `supports` are the translational and the torsional
    stiffnesses at each node, ``(nodes,)``."""
    found: dict[tuple[int, int, int], float] = {}
    for it in springs:
        key = (min(it.first, it.second), max(it.first, it.second), it.derivative)
        found[key] = found.get(key, 0.0) + it.stiffness
    # What moves as one has one number; fixed supports hold all their nodes to the base.
    body = [np.where(np.isinf(support), -1, np.arange(support.size)) for support in supports]
    kept = []
    for (first, second, derivative), stiffness in found.items():
        own = body[derivative]
        if stiffness > 0 and own[first] != own[second]:
            kept.append(Coupling(first, second, derivative, stiffness))
            if math.isinf(stiffness):
                low, high = sorted((int(own[first]), int(own[second])))
                own[own == high] = low
    return tuple(kept)


def characteristic(layout: Layout, z: FloatArray) -> FloatArray:
    """The characteristic function F times a positive factor, without unit, at trial values beta L > 0, ``(n,)``."""
    minors, fourth = _free_end(z), z**4
    for node in range(layout.x.size):
        minors = _into_span(layout, node, minors)
        minors = _through_springs(minors, *_own_springs(layout, node, fourth))
        if node < layout.spans.size:
            minors = _through_span(minors, *_span(layout, node, z))
    return minors[4]


Minors = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""A, B, C, D and F at a position, each of shape ``(n,)``."""
SpanFunctions = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Factors with which minors go over a span, each of shape ``(n,)``; see `_span_functions`."""
Spring = float | FloatArray
"""A dynamic stiffness: one number, or an array with one for each trial value, ``(n,)``."""


def _free_end(z: FloatArray) -> Minors:
    """The minors of a beam that begins free."""
    zero = np.zeros_like(z)
    return np.ones_like(z), zero, zero, zero, zero


def _own_springs(layout: Layout, node: int, fourth: FloatArray) -> tuple[Spring, Spring]:
    """`Layout.springs` in units of the EI of the span to the right of a node, or of the last span."""
    kappa, kappa_t = layout.springs(node, fourth)
    own = float(layout.stiffness[min(node, layout.spans.size - 1)])
    return kappa / own, kappa_t / own


def _into_span(layout: Layout, node: int, minors: Minors) -> Minors:
    """The minors left of a node in units of the EI of the span to the right."""
    if not 0 < node < layout.spans.size or layout.stiffness[node - 1] == layout.stiffness[node]:
        return minors
    A, B, C, D, F = minors
    r = float(layout.stiffness[node - 1] / layout.stiffness[node])
    return A, B * r, C * r, D * r, F * r**2


def _span(layout: Layout, node: int, z: FloatArray) -> tuple[FloatArray, SpanFunctions]:
    """The wave numbers times L, and the functions, ``(n,)`` each, of the span to the right of a node."""
    own = z * float(layout.wave[node])
    return own, _span_functions(own, float(layout.spans[node]))


def _fixed(spring: Spring) -> bool:
    """Whether a spring is infinite."""
    return isinstance(spring, float) and math.isinf(spring)


def _acts(spring: Spring) -> bool:
    """Whether there is a spring or a mass at all."""
    return not isinstance(spring, float) or spring != 0


def _through_springs(minors: Minors, kappa: Spring, kappa_t: Spring) -> Minors:
    """The minors to the right of a node from the minors to the left."""
    A, B, C, D, F = minors
    zero = np.zeros_like(A)
    # Dividing by 1 + |stiffness| keeps the numbers of order one, and gives the infinite spring as the limit.
    if _fixed(kappa_t):
        A, B, C, D, F = zero, A, zero, zero, D
    elif _acts(kappa_t):
        s = 1 / (1 + np.abs(kappa_t))
        A, B, C, D, F = A * s, B * s + (kappa_t * s) * A, C * s, D * s, F * s + (kappa_t * s) * D
    if _fixed(kappa):
        # A root of the part up to here, to the last bit, has the same signs beyond as a trial value just beside it.
        A, B, C, D, F = zero, zero, zero, A, np.where((A == 0) & (B == 0), np.finfo(float).eps, B)
    elif _acts(kappa):
        s = 1 / (1 + np.abs(kappa))
        A, B, C, D, F = A * s, B * s, C * s, D * s + (kappa * s) * A, F * s + (kappa * s) * B
    return A, B, C, D, F


def _through_span(minors: Minors, z: FloatArray, span: SpanFunctions) -> Minors:
    """The minors at the right end of a span, whose wave number times L is `z`, from the minors at its left end; where
    all are small they are divided by the largest.

    A fixed support scales the minors down by about (z length)^3: without the division, they underflow on many spans.
    """
    A, B, C, D, F = minors
    b4 = z**4
    half, g0, g1, g2, g3, g4 = span
    after = (
        _at_next_node(minors, span),
        -2 * b4 * g3 * A + g0 * B + 2 * (g1 * C + g2 * D + g3 * F),
        -b4 * (g2 * A + 2 * g3 * B) + g0 * C + g1 * D + g2 * F,
        -b4 * (g1 * A + 2 * g2 * B + 4 * g3 * C) + g0 * D + g1 * F,
        b4 * (2 * b4 * g4 * A - g1 * B - 2 * (g2 * C + g3 * D)) + half * F,
    )
    largest = np.abs(after).max(axis=0)
    if largest.min() > _SMALL:
        return after
    A, B, C, D, F = np.array(after) / np.where(largest > _SMALL, 1.0, largest)
    return A, B, C, D, F


def _at_next_node(minors: Minors, span: SpanFunctions) -> FloatArray:
    """The minor A at the right end of a span from the minors at its left end."""
    A, B, C, D, F = minors
    half, _, g1, g2, g3, g4 = span
    return half * A + g1 * B + 2 * (g2 * C + g3 * D + g4 * F)


def _span_functions(z: FloatArray, length: float) -> SpanFunctions:
    """(1 + cos cosh) / 2 and g0 ... g4, each divided by exp(z length); `length` is divided by L.

    g0 ... g3 solve g'''' = -4 z^4 g with one unit derivative at 0; g4 answers a unit right-hand side.
    """
    s = z * length
    decay = np.exp(-s)
    ch, sh = (1 + decay**2) / 2, -np.expm1(-2 * s) / 2
    cos, sin = np.cos(s), np.sin(s)
    difference = np.where(s < _SERIES_BELOW, decay * s**3 * _series(s, _SIN_COSH_LESS), sin * ch - cos * sh)
    return (
        (decay + ch * cos) / 2,
        ch * cos,
        (sin * ch + cos * sh) / (2 * z),
        sin * sh / (2 * z**2),
        difference / (4 * z**3),
        _one_minus_cos_cosh(s) / (4 * z**4),
    )


def _one_minus_cos_cosh(s: FloatArray) -> FloatArray:
    """(1 - cos s cosh s) / exp(s), without cancellation for small s: -sum_{n>0} (-4)^n s^(4n) / (4n)! over exp(s)."""
    decay = np.exp(-s)
    return np.where(s < _SERIES_BELOW, -decay * _series(s, _ONE_MINUS_COS_COSH), decay - (1 + decay**2) / 2 * np.cos(s))


def _series(s: FloatArray, coefficients: list[float]) -> FloatArray:
    """sum_n a_n (-4 s^4)^n for s below `_SERIES_BELOW`; a finite, meaningless value for larger s."""
    x = -4 * np.minimum(s, _SERIES_BELOW) ** 4
    total = np.zeros_like(s)
    for coefficient in reversed(coefficients):
        total = total * x + coefficient
    return total


_ONE_MINUS_COS_COSH = [0.0, *(1 / math.factorial(4 * n) for n in range(1, 8))]
_SIN_COSH_LESS = [4 / math.factorial(4 * n + 3) for n in range(8)]
"""sin s cosh s - cos s sinh s = s^3 sum_n a_n (-4 s^4)^n."""


def count_below(layout: Layout, z: FloatArray) -> IntArray:
    """Number of natural frequencies, rigid-body modes included, below each trial value beta L > 0, shape ``(n,)``.

    The number is right unless a trial value is a frequency itself to within a few rounding errors.
    """
    count, fourth = np.zeros(z.shape, dtype=int), z**4
    for own, length in zip(layout.wave, layout.spans, strict=True):
        count = count + _clamped_span_count(z * own * length)
    minors = _free_end(z)
    for node in range(layout.x.size):
        # Left of the node all springs act, right of it every node is clamped: that part of F is the same in all three.
        minors = _into_span(layout, node, minors)
        own, span = _span(layout, node, z) if node < layout.spans.size else (z, None)
        kappa, kappa_t = _own_springs(layout, node, fourth)
        positive = _clamped_after(minors, np.inf, np.inf, span)
        for translational in (np.inf, kappa):
            now_positive = _clamped_after(minors, translational, kappa_t, span)
            count = count + (now_positive != positive)
            positive = now_positive
        if span is not None:
            minors = _through_span(_through_springs(minors, kappa, kappa_t), own, span)
    return np.asarray(count)


def _clamped_after(minors: Minors, kappa: Spring, kappa_t: Spring, span: SpanFunctions | None) -> BoolArray:
    """Whether F is positive with these springs at a node and the next node clamped, or no next node; ``(n,)``."""
    after = _through_springs(minors, kappa, kappa_t)
    return np.asarray((after[4] if span is None else _at_next_node(after, span)) >= 0)


def _clamped_span_sign(s: FloatArray) -> FloatArray:
    """Sign of the clamped-clamped characteristic 1 - cos s cosh s."""
    return np.where(_one_minus_cos_cosh(s) >= 0, 1.0, -1.0)


def _clamped_span_count(s: FloatArray) -> IntArray:
    """Clamped-clamped frequencies below s: one in each interval (n pi, (n + 1) pi), n > 0."""
    n = np.floor(s / math.pi).astype(int)
    expected = np.where(n % 2 == 0, 1.0, -1.0)
    # At n pi the first n - 1 roots are passed; the sign tells whether the n-th is too.
    return np.where(n == 0, 0, n - 1 + (_clamped_span_sign(s) == expected))


def frequencies(layout: Layout, count: int) -> FloatArray:
    """The `count` lowest natural frequencies as roots beta L, shape ``(count,)``, ascending, 0 for rigid-body modes.

    Every root is bracketed by the count of roots, so none can be missed, and near-degenerate pairs come out as two.
    The relative error is a few rounding errors: the count just below and just above each root confirms it, or
    `SolverError` is raised.
    """
    rigid = min(layout.rigid_modes(), count)
    index = np.arange(rigid, count)  # number of roots below each root
    lo = np.full(index.size, 1e-6)
    while index.size and count_below(layout, lo[:1])[0] > rigid:
        lo *= 1e-3
    # A clamped span has at least z b length / pi - 2 frequencies below z, and releasing its ends takes none away.
    waves = float(layout.wave @ layout.spans)
    hi = np.full(index.size, math.pi * (count + 2 * layout.spans.size + 1) / waves)
    lo, hi = _isolate(layout, index, lo, hi)
    alone = np.append(lo[1:] >= hi[:-1], True) & np.append(True, lo[1:] >= hi[:-1])
    f_lo, f_hi = characteristic(layout, lo), characteristic(layout, hi)
    alone &= f_lo * f_hi < 0
    roots = (lo + hi) / 2
    if alone.any():
        found = elementwise.find_root(
            lambda z: characteristic(layout, z), (lo[alone], hi[alone]), tolerances={"xrtol": 4e-16, "xatol": 0.0}
        )
        roots[alone] = found.x
    if not alone.all():
        few = ~alone
        narrow = _bisect(layout, index[few], lo[few], hi[few], steps=80)
        roots[few] = (narrow[0] + narrow[1]) / 2
    beside = np.concatenate([roots * (1 - _ERROR), roots * (1 + _ERROR)])
    below, above = count_below(layout, beside).reshape(2, -1)
    wrong = np.flatnonzero((below > index) | (above <= index))
    if wrong.size:
        raise SolverError(f"the count of frequencies below beta L = {roots[wrong[0]]:.6g} does not bear that root out")
    return np.concatenate([np.zeros(rigid), roots])


def _isolate(layout: Layout, index: IntArray, lo: FloatArray, hi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Intervals that hold one root each, if 48 bisections are enough for that."""
    for _ in range(12):
        if np.all(lo[1:] >= hi[:-1]) and np.all(hi < 1.5 * lo):
            break
        lo, hi = _bisect(layout, index, lo, hi, steps=4)
    return lo, hi


def _bisect(
    layout: Layout, index: IntArray, lo: FloatArray, hi: FloatArray, steps: int
) -> tuple[FloatArray, FloatArray]:
    """Halve the intervals, in z, around the roots with the numbers `index`, by the count, up to `steps` times."""
    for _ in range(steps):
        middle = np.where(hi > 2 * lo, np.sqrt(lo * hi), (lo + hi) / 2)
        if np.all((middle <= lo) | (middle >= hi)):
            break
        above = count_below(layout, middle) > index
        lo, hi = np.where(above, lo, middle), np.where(above, middle, hi)
    return lo, hi
