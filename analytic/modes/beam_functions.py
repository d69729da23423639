r"""Functions of x that the beam equation allows, span by span, with exact derivatives and inner products.

On every span a function satisfies f'''' = a f, with one number a for each function and span, and is

    f(x) = Re sum_j c_j exp(mu_j (x - a_j)) + sum_k p_k ((x - x_0) / L)^k,    mu_j^4 = a,

with anchors a_j at the end of the span where the exponential is largest, so that no term exceeds its coefficient.
A mode (12) has mu = i beta, -beta and +beta; a foundation shape (see `analytic.modes.static_residual`) has
mu = gamma (-1 + i) and gamma (1 + i); a rigid-body mode has the polynomial only, and a = 0.  On a span that is short
compared with its waves the four waves nearly cancel.  There a function is a polynomial, the Taylor series about the
left end x_0 of the span, which is exact to rounding.

Inner products are weighted with the mass: integrals of m f g, and M f g + J f' g' at each mass M with the rotary
inertia J.  All are closed form, no grid: boundary terms, as EI a / m is one number for each function along the whole
beam; or, where these numbers of two functions are close, integrals of exponentials, and of polynomials by Gauss points
that are exact for them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray, Line
from lapjoint.problem.masses import Mass

ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

NEAR = 0.02
"""Relative difference of two EI a / m below which functions are multiplied term by term: boundary terms would lose two
digits there."""
_ROUNDING = 8 * float(np.finfo(float).eps)
"""Distance from the end of a beam, divided by the length of the line, that is rounding."""
TERMS = 16
"""Coefficients of a polynomial: four terms of the series of each of the four solutions of f'''' = a f."""


@dataclass(frozen=True, eq=False)
class Inertia:
    """What weights inner products: stiffness and mass per unit length of the beam's pieces, and lumped masses."""

    ends: FloatArray
    """Where each piece ends, m, shape ``(pieces,)``."""
    EI: FloatArray
    """Bending stiffness of each piece, N m2, shape ``(pieces,)``."""
    m: FloatArray
    """Mass per unit length of each piece, kg/m, shape ``(pieces,)``."""
    x: FloatArray
    """Positions of lumped masses, m, ascending, shape ``(K,)``."""
    mass: FloatArray
    """All mass lumped at each position, kg, shape ``(K,)``."""
    rotary: FloatArray
    """All rotary inertia lumped at each position, kg m2, shape ``(K,)``."""

    def on(self, nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
        """EI, N m2, and m, kg/m, of spans whose ends, m, ``(S + 1,)``, include those of the pieces; ``(S,)`` each."""
        middle = (nodes[:-1] + nodes[1:]) / 2
        piece = np.minimum(np.searchsorted(self.ends, middle), self.ends.size - 1)
        return self.EI[piece], self.m[piece]


def inertia_of(beam: Line, masses: Iterable[Mass] = ()) -> Inertia:
    """The weights of inner products of a beam with masses."""
    pieces, lumped = beam.pieces, [it for it in masses if it.mass or it.rotary_inertia]
    places = sorted({it.x for it in lumped})
    here = [[it for it in lumped if it.x == x] for x in places]
    return Inertia(
        ends=np.array([piece.end for piece in pieces]),
        EI=np.array([piece.EI for piece in pieces]),
        m=np.array([piece.inertia for piece in pieces]),
        x=np.array(places),
        mass=np.array([sum(it.mass for it in group) for group in here]),
        rotary=np.array([sum(it.rotary_inertia for it in group) for group in here]),
    )


@dataclass(frozen=True)
class BeamFunctions:
    """A family of ``n`` functions on ``S`` spans, with ``J`` exponentials each."""

    nodes: FloatArray
    """Ends of the spans, m, from 0 to L, shape ``(S + 1,)``."""
    mu: ComplexArray
    """Exponents, 1/m, shape ``(n, S, J)``, also where a function is a polynomial."""
    right: BoolArray
    """Whether each exponential is anchored at the right end of the span, shape ``(J,)``."""
    c: ComplexArray
    """Coefficients, shape ``(n, S, J)``."""
    p: FloatArray
    """Coefficients of the powers of (x - x_0) / L on each span, shape ``(n, S, TERMS)``."""
    at_masses: FloatArray
    """Deflection, and slope, per m, at each position of a lumped mass, shape ``(n, 2, K)``.  A fast mode hardly moves a
    heavy mass: its deflection there has fewer digits in the sum of the waves than here."""
    spaces: tuple[int, ...] = ()
    """The spans that are spaces between two beams, on which the functions are zero."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Values or a derivative at ``x``, m, shape ``(k,)``: ``(n, k)``; at a node those of the span to the left, or
        of the beam beside a space."""
        span = self._spans_at(x)
        anchor = np.where(self.right, self.nodes[span + 1][:, None], self.nodes[span][:, None])  # (k, J)
        mu = self.mu[:, span, :]
        waves = self.c[:, span, :] * np.exp(mu * (x[:, None] - anchor)[None])
        values = np.asarray((waves * mu**derivative).sum(axis=-1).real)
        if self._bent.size:
            values[self._bent] += _horner(self.p[self._bent][:, span], *self._local(x, span), derivative)
        return values

    def _spans_at(self, x: FloatArray) -> IntArray:
        """The span of each position, m, ``(k,)``; at a node that to the left, or that of the beam beside a space."""
        found = np.asarray(np.clip(np.searchsorted(self.nodes, x, side="left") - 1, 0, self.nodes.size - 2))
        for space in self.spaces:
            start, end = self.nodes[space : space + 2]
            here, rounding = found == space, _ROUNDING * self.nodes[-1]
            found = np.where(here & (x >= end - rounding), space + 1, found)
            found = np.where(here & (x <= start + rounding), space - 1, found)
        return found

    def _local(self, x: FloatArray, span: IntArray) -> tuple[FloatArray, float]:
        """(x - x_0) / L of positions, m, in spans, ``(k,)`` each, and L, m."""
        length = float(self.nodes[-1])
        return (x - self.nodes[span]) / length, length

    @cached_property
    def _bent(self) -> IntArray:
        """Indices of the functions that are polynomials on a span."""
        return np.flatnonzero(self.p.any(axis=(1, 2)))

    @cached_property
    def ends(self) -> FloatArray:
        """Derivatives 0 to 3 at both ends of each span, shape ``(n, 4, S, 2)``."""
        x, S = np.stack([self.nodes[:-1], self.nodes[1:]], axis=1), self.nodes.size - 1
        anchor = np.where(self.right[:, None], self.nodes[1:], self.nodes[:-1]).T  # (S, J)
        waves = self.c[:, :, None, :] * np.exp(self.mu[:, :, None, :] * (x[:, :, None] - anchor[:, None, :]))
        powers = self.mu[:, None, :, :] ** np.arange(4)[:, None, None]
        values = np.asarray(np.einsum("nseJ,ndsJ->ndse", waves, powers).real)
        for end in range(2 if self._bent.size else 0):
            local, length = self._local(x[:, end], np.arange(S))
            for d in range(4):
                values[self._bent, d, :, end] += _horner(self.p[self._bent], local, length, d)
        return values

    def scaled(self, factors: FloatArray) -> BeamFunctions:
        """Each function times its factor, shape ``(n,)``."""
        f = factors[:, None, None]
        return BeamFunctions(self.nodes, self.mu, self.right, self.c * f, self.p * f, self.at_masses * f, self.spaces)

    def head(self, count: int) -> BeamFunctions:
        """The first `count` functions of the family."""
        return self.chosen(slice(count))

    def chosen(self, which: IntArray | slice) -> BeamFunctions:
        """The functions with the indices `which`, shape ``(m,)``, or in a slice."""
        c, p, at_masses = self.c[which], self.p[which], self.at_masses[which]
        return BeamFunctions(self.nodes, self.mu[which], self.right, c, p, at_masses, self.spaces)

    def on(self, nodes: FloatArray) -> BeamFunctions:
        """The functions on shorter spans, whose ends, m, shape ``(T + 1,)``, include the present ones."""
        if nodes.size == self.nodes.size:
            return self
        span = np.searchsorted(self.nodes, nodes[:-1], side="right") - 1
        before, after = (
            np.where(self.right, ends[1:, None], ends[:-1, None])[which]
            for ends, which in ((self.nodes, span), (nodes, np.arange(nodes.size - 1)))
        )
        mu = self.mu[:, span]
        moved = np.exp(mu * (after - before))  # inwards, where each exponential is smaller
        p = self.p[:, span]
        if self._bent.size:
            offset, _ = self._local(nodes[:-1], span)
            p[self._bent] = np.einsum("nsk,sjk->nsj", p[self._bent], _shifts(offset))
        spaces = tuple(np.flatnonzero(np.isin(span, self.spaces)).tolist()) if self.spaces else ()
        return BeamFunctions(nodes, mu, self.right, self.c[:, span] * moved, p, self.at_masses, spaces)

    def mixed(self, matrix: FloatArray) -> BeamFunctions:
        """Combinations ``matrix @ functions`` of functions with equal exponents; `matrix` is ``(n, n)``."""
        c, p, at_masses = (np.einsum("ij,jst->ist", matrix, part) for part in (self.c, self.p, self.at_masses))
        return BeamFunctions(self.nodes, self.mu, self.right, c, p, at_masses, self.spaces)


def _horner(p: FloatArray, local: FloatArray, length: float, derivative: int) -> FloatArray:
    """A derivative of polynomials, ``(n, k, TERMS)``, each at its place (x - x_0) / L, ``(k,)``; gives ``(n, k)``."""
    total = np.zeros(p.shape[:2])
    for power in reversed(range(derivative, TERMS)):
        total = total * local + math.perm(power, derivative) * p[:, :, power]
    return total / length**derivative


def _shifts(offset: FloatArray) -> FloatArray:
    """Matrices that write polynomials about places that lie farther right by `offset`, ``(S,)``; ``(S, TERMS,
    TERMS)``."""
    found = np.zeros((offset.size, TERMS, TERMS))
    for j in range(TERMS):
        for k in range(j, TERMS):
            found[:, j, k] = math.comb(k, j) * offset ** (k - j)
    return found


def integrals(f: BeamFunctions) -> FloatArray:
    """Integral of each function over each span, in the unit of the functions times m, shape ``(n, S)``."""
    length = np.diff(f.nodes)
    inwards = np.where(f.right, -1.0, 1.0)  # from the anchor, where an exponential is 1
    mu = np.where(f.mu != 0, f.mu, -inwards)  # a rigid-body mode has no exponentials
    areas = inwards * np.expm1(inwards * mu * length[:, None]) / mu
    total = np.asarray((f.c * areas).sum(axis=2).real)
    for power in range(TERMS if f.p.any() else 0):
        total += f.p[:, :, power] * length * (length / f.nodes[-1]) ** power / (power + 1)
    return total


def gram(f: BeamFunctions, g: BeamFunctions, inertia: Inertia, near: float = NEAR) -> FloatArray:
    """Inner products of ``f_i`` and ``g_j``, weighted with the mass, in kg times the units, ``(n_f, n_g)``.

    Functions whose EI a / m differ by less than `near`, relatively, are multiplied term by term, and so are two
    functions without exponentials.
    """
    nodes = np.union1d(f.nodes, g.nodes)
    f, g = f.on(nodes), g.on(nodes)
    EI, m = inertia.on(nodes)
    a, b = _squared_frequencies(f, EI, m)[:, None], _squared_frequencies(g, EI, m)[None, :]
    without = [~np.asarray(it.c.any(axis=(1, 2))) for it in (f, g)]
    close = np.abs(a - b) <= near * np.maximum(np.abs(a), np.abs(b))
    close |= without[0][:, None] & without[1][None, :]
    total = np.where(close, 0.0, _boundary_terms(f, g, EI) / np.where(close, 1.0, a - b))
    rows, columns = np.nonzero(close)
    total[rows, columns] = _term_by_term(f, rows, g, columns, m)
    for d, lumped in enumerate((inertia.mass, inertia.rotary) if inertia.x.size else ()):
        total += (f.at_masses[:, d] * lumped) @ g.at_masses[:, d].T
    return np.asarray(total)


def squares(f: BeamFunctions, inertia: Inertia) -> FloatArray:
    """Inner products of each ``f_i`` with itself, ``(n,)``: the diagonal of `gram`, without the other products."""
    every = np.arange(f.mu.shape[0])
    total = _term_by_term(f, every, f, every, inertia.on(f.nodes)[1])
    for d, lumped in enumerate((inertia.mass, inertia.rotary) if inertia.x.size else ()):
        total += f.at_masses[:, d] ** 2 @ lumped
    return total


def _squared_frequencies(f: BeamFunctions, EI: FloatArray, m: FloatArray) -> FloatArray:
    """EI a / m of each function, (rad/s)^2, shape ``(n,)``: the square of the frequency of a mode."""
    return np.asarray((f.mu[:, 0, :1] ** 4).real.sum(axis=1) * (EI[0] / m[0]))


def _boundary_terms(f: BeamFunctions, g: BeamFunctions, EI: FloatArray) -> FloatArray:
    """(A - B) times the integral of m f g, where EI f'''' = A m f and EI g'''' = B m g; shape ``(n_f, n_g)``.

    By parts, on every span, it is EI (f''' g - f'' g' + f' g'' - f g''') at the right end minus the value at the left
    end.
    """
    signs = np.array([1.0, -1.0, 1.0, -1.0])[:, None, None] * (EI[:, None] * np.array([-1.0, 1.0]))  # (d, span, end)
    turned = (f.ends[:, ::-1] * signs).reshape(f.ends.shape[0], -1)
    return np.asarray(turned @ g.ends.reshape(g.ends.shape[0], -1).T)


def _term_by_term(f: BeamFunctions, rows: IntArray, g: BeamFunctions, columns: IntArray, m: FloatArray) -> FloatArray:
    """The integral of m f g for pairs of functions, ``(pairs,)``, with m of each span, kg/m, ``(S,)``.

    Where one of a pair is a polynomial, Gauss points are exact for both: waves whose a is close are as long.
    """
    total = np.zeros(rows.size)
    bent_f, bent_g = (np.asarray(it.p.any(axis=2)) for it in (f, g))
    for s in range(m.size):
        bent = bent_f[rows, s] | bent_g[columns, s]
        if not bent.all():
            total[~bent] += m[s] * waves_waves(f, rows[~bent], g, columns[~bent], s)
        if bent.any():
            x, weights = gauss(float(f.nodes[s]), float(f.nodes[s + 1]))
            total[bent] += m[s] * ((f(x)[rows[bent]] * g(x)[columns[bent]]) @ weights)
    return total


def gauss(x0: float, x1: float) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights, m, on a span, exact for products of two polynomials."""
    nodes, weights = np.polynomial.legendre.leggauss(TERMS)
    half = (x1 - x0) / 2
    return x0 + half * (1 + nodes), half * weights


def waves_waves(f: BeamFunctions, rows: IntArray, g: BeamFunctions, columns: IntArray, s: int) -> FloatArray:
    """The integral of the exponentials of pairs on span `s`: Re u Re v = Re (u v + u conj v) / 2, ``(pairs,)``."""
    total = np.zeros(rows.size)
    x0, x1 = f.nodes[s], f.nodes[s + 1]
    for j in range(f.mu.shape[2]):
        for k in range(g.mu.shape[2]):
            a, b = (x1 if f.right[j] else x0), (x1 if g.right[k] else x0)
            mu, nu, u, v = f.mu[rows, s, j], g.mu[columns, s, k], f.c[rows, s, j], g.c[columns, s, k]
            total += 0.5 * (u * v * _exponential_integral(mu, nu, a, b, x0, x1)).real
            total += 0.5 * (u * v.conj() * _exponential_integral(mu, nu.conj(), a, b, x0, x1)).real
    return total


def _exponential_integral(mu: ComplexArray, nu: ComplexArray, a: float, b: float, x0: float, x1: float) -> ComplexArray:
    """Integral of exp(mu (x - a) + nu (x - b)) from x0 to x1, stable where mu + nu vanishes."""
    total, length = mu + nu, x1 - x0
    w = total * (length / 2)
    near = np.abs(w) < 0.05
    ends = np.exp(mu * (x1 - a) + nu * (x1 - b)) - np.exp(mu * (x0 - a) + nu * (x0 - b))
    middle = (x0 + x1) / 2
    w2 = np.where(near, w, 0) ** 2
    sinhc = 1 + w2 / 6 * (1 + w2 / 20 * (1 + w2 / 42 * (1 + w2 / 72)))  # |w| < 0.05: error below 1e-20
    return np.where(
        near, length * np.exp(mu * (middle - a) + nu * (middle - b)) * sinhc, ends / np.where(near, 1, total)
    )
