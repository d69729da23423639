r"""Functions of x that the beam equation allows, span by span, with exact derivatives and inner products.

On every span a function is

    f(x) = Re sum_j c_j exp(mu_j (x - a_j)) + p0 + p1 x

with anchors a_j at the end of the span where the exponential is largest, so that no term exceeds its coefficient.
A mode (12) has mu = i beta, -beta and +beta; a foundation shape (see `analytic.modes.static_residual`) has
mu = gamma (-1 + i) and gamma (1 + i); a rigid-body mode has the polynomial only.  All inner products are closed
form, no quadrature, no grid: boundary terms, as all exponentials of a function have one mu^4; or, where the mu^4 of two
functions are close, integrals of exponentials.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray

ComplexArray = npt.NDArray[np.complex128]
IntArray = npt.NDArray[np.int64]

NEAR = 0.02
"""Relative difference of two mu^4 below which functions are multiplied term by term: boundary terms would lose two
digits there."""


@dataclass(frozen=True)
class BeamFunctions:
    """A family of ``n`` functions on ``S`` spans, with ``J`` exponentials each."""

    nodes: FloatArray
    """Ends of the spans, m, shape ``(S + 1,)``."""
    mu: ComplexArray
    """Exponents, 1/m, shape ``(n, J)``."""
    right: npt.NDArray[np.bool_]
    """Whether each exponential is anchored at the right end of the span, shape ``(J,)``."""
    c: ComplexArray
    """Coefficients, shape ``(n, S, J)``."""
    p: FloatArray
    """p0 and p1 of each span, shape ``(n, S, 2)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Values or a derivative at ``x``, m, shape ``(k,)``: ``(n, k)``; at a node those of the span to the left."""
        span = np.clip(np.searchsorted(self.nodes, x, side="left") - 1, 0, self.nodes.size - 2)
        anchor = np.where(self.right, self.nodes[span + 1][:, None], self.nodes[span][:, None])  # (k, J)
        waves = self.c[:, span, :] * np.exp(self.mu[:, None, :] * (x[:, None] - anchor)[None])
        values = (waves * self.mu[:, None, :] ** derivative).sum(axis=-1).real
        if derivative == 0:
            values = values + self.p[:, span, 0] + self.p[:, span, 1] * x
        elif derivative == 1:
            values = values + self.p[:, span, 1]
        return np.asarray(values)

    def scaled(self, factors: FloatArray) -> BeamFunctions:
        """Each function times its factor, shape ``(n,)``."""
        f = factors[:, None, None]
        return BeamFunctions(self.nodes, self.mu, self.right, self.c * f, self.p * f)

    def head(self, count: int) -> BeamFunctions:
        """The first `count` functions of the family."""
        return self.chosen(slice(count))

    def chosen(self, which: IntArray | slice) -> BeamFunctions:
        """The functions with the indices `which`, shape ``(m,)``, or in a slice."""
        return BeamFunctions(self.nodes, self.mu[which], self.right, self.c[which], self.p[which])

    def on(self, nodes: FloatArray) -> BeamFunctions:
        """The functions on shorter spans, whose ends, m, shape ``(T + 1,)``, include the present ones."""
        if nodes.size == self.nodes.size:
            return self
        span = np.searchsorted(self.nodes, nodes[:-1], side="right") - 1
        before, after = (
            np.where(self.right, ends[1:, None], ends[:-1, None])[which]
            for ends, which in ((self.nodes, span), (nodes, np.arange(nodes.size - 1)))
        )
        moved = np.exp(self.mu[:, None, :] * (after - before))  # inwards, where each exponential is smaller
        return BeamFunctions(nodes, self.mu, self.right, self.c[:, span] * moved, self.p[:, span])

    def mixed(self, matrix: FloatArray) -> BeamFunctions:
        """Combinations ``matrix @ functions`` of functions with equal exponents; `matrix` is ``(n, n)``."""
        return BeamFunctions(
            self.nodes,
            self.mu,
            self.right,
            np.einsum("ij,jst->ist", matrix, self.c),
            np.einsum("ij,jst->ist", matrix, self.p),
        )


def integral(f: BeamFunctions) -> FloatArray:
    """Integral of each function over the beam, in the unit of the functions times m, shape ``(n,)``."""
    one = BeamFunctions(
        f.nodes,
        np.zeros((1, 0), dtype=complex),
        np.zeros(0, dtype=bool),
        np.zeros((1, f.nodes.size - 1, 0), dtype=complex),
        np.tile([1.0, 0.0], (1, f.nodes.size - 1, 1)),
    )
    return gram(f, one)[:, 0]


def gram(f: BeamFunctions, g: BeamFunctions, near: float = NEAR) -> FloatArray:
    """Integrals of ``f_i g_j`` over the beam, in the product of the units times m, shape ``(n_f, n_g)``.

    Functions whose mu^4 differ by less than `near`, relatively, are multiplied term by term.
    """
    nodes = np.union1d(f.nodes, g.nodes)
    f, g = f.on(nodes), g.on(nodes)
    a, b = _fourth_powers(f)[:, None], _fourth_powers(g)[None, :]
    close = np.abs(a - b) <= near * np.maximum(np.abs(a), np.abs(b))
    total = np.where(close, 0.0, _boundary_terms(f, g) / np.where(close, 1.0, a - b))
    rows, columns = np.nonzero(close)
    total[rows, columns] = _waves_waves(f, rows, g, columns)
    for s in range(f.nodes.size - 1):
        _add_polynomials(total, f, g, s)
    return total


def squares(f: BeamFunctions) -> FloatArray:
    """Integrals of ``f_i^2`` over the beam, shape ``(n,)``: the diagonal of `gram`, without the other products."""
    every = np.arange(f.mu.shape[0])
    total = _waves_waves(f, every, f, every)
    for i in np.flatnonzero(f.p.any(axis=(1, 2))):
        one = f.chosen(np.array([i]))
        total[i] = gram(one, one)[0, 0]
    return total


def _fourth_powers(f: BeamFunctions) -> FloatArray:
    """mu^4 of each function, 1/m4, which all its exponentials share, shape ``(n,)``."""
    return np.asarray((f.mu[:, :1] ** 4).real.sum(axis=1))


def _boundary_terms(f: BeamFunctions, g: BeamFunctions) -> FloatArray:
    """(a - b) times the integral of f g, exponentials alone, where f'''' = a f and g'''' = b g; shape ``(n_f, n_g)``.

    By parts, on every span, it is f''' g - f'' g' + f' g'' - f g''' at the right end minus the value at the left end.
    """
    ends_f, ends_g = _waves_at_ends(f), _waves_at_ends(g)
    signs = np.array([1.0, -1.0, 1.0, -1.0])[:, None, None] * np.array([-1.0, 1.0])  # (d, span, end)
    turned = (ends_f[:, ::-1] * signs).reshape(ends_f.shape[0], -1)
    return np.asarray(turned @ ends_g.reshape(ends_g.shape[0], -1).T)


def _waves_at_ends(f: BeamFunctions) -> FloatArray:
    """Derivatives 0 to 3 of the exponentials at both ends of each span, shape ``(n, 4, S, 2)``."""
    x = np.stack([f.nodes[:-1], f.nodes[1:]], axis=1)
    anchor = np.where(f.right[:, None], f.nodes[1:], f.nodes[:-1]).T  # (S, J)
    waves = f.c[:, :, None, :] * np.exp(f.mu[:, None, None, :] * (x[:, :, None] - anchor[:, None, :]))
    powers = f.mu[:, None, :] ** np.arange(4)[:, None]
    return np.asarray(np.einsum("nseJ,ndJ->ndse", waves, powers).real)


def _waves_waves(f: BeamFunctions, rows: IntArray, g: BeamFunctions, columns: IntArray) -> FloatArray:
    """The integral of the exponentials of pairs of functions: Re u Re v = Re (u v + u conj v) / 2, ``(pairs,)``."""
    total = np.zeros(rows.size)
    for s in range(f.nodes.size - 1):
        x0, x1 = f.nodes[s], f.nodes[s + 1]
        for j in range(f.mu.shape[1]):
            for k in range(g.mu.shape[1]):
                a, b = (x1 if f.right[j] else x0), (x1 if g.right[k] else x0)
                mu, nu, u, v = f.mu[rows, j], g.mu[columns, k], f.c[rows, s, j], g.c[columns, s, k]
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


def _add_polynomials(total: FloatArray, f: BeamFunctions, g: BeamFunctions, s: int) -> None:
    """Add the integrals with the polynomials on span `s`, which few functions have, to `total`, ``(n_f, n_g)``."""
    in_f, in_g = np.flatnonzero(f.p[:, s].any(axis=1)), np.flatnonzero(g.p[:, s].any(axis=1))
    if in_g.size:
        total[:, in_g] += _waves_polynomials(f, g.chosen(in_g), s)
    if in_f.size:
        total[in_f] += _waves_polynomials(g, f.chosen(in_f), s).T
    if in_f.size and in_g.size:
        total[np.ix_(in_f, in_g)] += _polynomials(f.chosen(in_f), g.chosen(in_g), s)


def _waves_polynomials(f: BeamFunctions, g: BeamFunctions, s: int) -> FloatArray:
    """The integrals of the exponentials of `f` times the polynomials of `g`, on span `s`."""
    total = np.zeros((f.mu.shape[0], g.mu.shape[0]))
    x0, x1 = f.nodes[s], f.nodes[s + 1]
    p0, p1 = g.p[None, :, s, 0], g.p[None, :, s, 1]
    for j in range(f.mu.shape[1]):
        waves = f.mu[:, j] != 0  # a rigid-body mode has none
        mu, anchor = f.mu[waves, j, None], x1 if f.right[j] else x0

        def antiderivative(x: float, mu: ComplexArray = mu, anchor: float = anchor) -> ComplexArray:
            wave: ComplexArray = np.exp(mu * (x - anchor)) * ((p0 + p1 * x) / mu - p1 / mu**2)
            return wave

        total[waves] += (f.c[waves, s, j, None] * (antiderivative(x1) - antiderivative(x0))).real
    return total


def _polynomials(f: BeamFunctions, g: BeamFunctions, s: int) -> FloatArray:
    """The integrals of the polynomials of `f` times those of `g`, on span `s`."""
    x0, x1 = f.nodes[s], f.nodes[s + 1]
    f0, f1, g0, g1 = f.p[:, s, 0, None], f.p[:, s, 1, None], g.p[None, :, s, 0], g.p[None, :, s, 1]
    length, square, cube = x1 - x0, (x1**2 - x0**2) / 2, (x1**3 - x0**3) / 3
    return np.asarray(f0 * g0 * length + (f0 * g1 + f1 * g0) * square + f1 * g1 * cube)
