r"""The boundary and compatibility conditions (13a)-(13h) as a matrix, for any number of spans.

Each span carries the four solutions of f'''' = a f.  The unknowns are their amplitudes; the rows say, node by node,
that deflection and slope are continuous, that ``EI phi'''`` jumps by ``-k phi`` and the moment ``EI phi''`` by
``kt phi'``; at an infinite spring the deflection or the slope vanishes instead.  A mass is a spring that depends on the
frequency (`analytic.modes.characteristic_equation`).

On most spans the four solutions are real waves.  On a span that is short compared with its waves they are the series
K_k = xi^k / k! + a xi^(k+4) / (k+4)! + ..., k = 0 ... 3, in which no digits cancel, times the size that the k-th
derivative has along the whole beam: moments and shears of a slow mode are those of its inertia, (beta L)^4 times all
masses, however much less than its deflection that is.  Each row is divided by its largest entry.  Thus stiff and soft
springs, heavy and light masses, slow and fast modes leave entries of order one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analytic.modes.beam_functions import TERMS, BeamFunctions, ComplexArray
from analytic.modes.characteristic_equation import Layout, Spring
from lapjoint.problem import FloatArray

BAND = 5  # nonzero diagonals on each side of the main one: the rows of a node reach over the two spans beside it
_SHORT = 0.3
"""Wave number times length of a span up to which its solutions are the series.  The first term left out of the series
of a third derivative is 1e-16 of the last one kept; waves lose a factor 1 / 0.3^3 of their digits here, and more on
shorter spans."""


@dataclass(frozen=True)
class Solutions:
    """Four real solutions of f'''' = a f on every span, for ``n`` functions: waves, or series.

    Waves are Re and Im parts of the exponentials that `selection` names.
    """

    fourth: FloatArray
    """a of each function on a span of the mean EI and m, times L^4: (beta L)^4 of modes, shape ``(n,)``."""
    mu: ComplexArray
    """Exponents times L, shape ``(n, S, J)``."""
    right: npt.NDArray[np.bool_]
    """Whether each exponential is anchored at the right end, shape ``(J,)``."""
    selection: ComplexArray
    """Coefficient of each exponential in each of the four waves, shape ``(4, J)``."""
    short: npt.NDArray[np.bool_]
    """Whether the solutions on a span are the series, shape ``(n, S)``."""
    size: FloatArray
    """Factors of the four series, shape ``(n, S, 4)``."""

    def functions(
        self, layout: Layout, amplitudes: FloatArray, length: float, free: bool, forces: FloatArray | None = None
    ) -> BeamFunctions:
        """The functions of x that the amplitudes of the solutions, shape ``(n, S, 4)``, make; of one set of solutions,
        any number of functions.

        `length` is that of the beam, m.  `free` says that no forces act beside those of springs and masses, and
        `forces`, the forces and moments of couplings, ``(n, 2, nodes)``.  The functions have the unit of the
        amplitudes.
        """
        c = np.einsum("nsw,wj->nsj", np.where(self.short[:, :, None], 0.0, amplitudes), self.selection)
        p = np.zeros((*amplitudes.shape[:2], TERMS))
        if self.short.any():
            a, sized = _fourth_powers(self.mu), np.where(self.short[:, :, None], amplitudes * self.size, 0.0)
            for power in range(TERMS):
                k, times = power % 4, power // 4
                p[:, :, power] = sized[:, :, k] * a**times / math.factorial(power)
        mu = np.broadcast_to(self.mu / length, (amplitudes.shape[0], *self.mu.shape[1:]))
        at_masses = self._at_masses(layout, amplitudes, free, forces) / np.array([1.0, length])[:, None]
        return BeamFunctions(layout.x * length, mu, self.right, c, p, at_masses, spaces_of(layout))

    def _at_masses(self, layout: Layout, amplitudes: FloatArray, free: bool, forces: FloatArray | None) -> FloatArray:
        """Deflection, and slope times L, at each node with a mass, shape ``(n, 2, K)``.

        Where the dynamic stiffness of a node outweighs the beam's, the jump of the shear, or of the moment, gives them
        with more digits than a sum of waves that nearly cancel.
        """
        places = np.flatnonzero(layout.mass + layout.rotary)
        found = np.zeros((amplitudes.shape[0], 2, places.size))
        for i, node in enumerate(places.tolist()):
            beside = self.beside(layout, node)
            largest, jump, value = largest_of(*beside), np.zeros((1, 4)), np.zeros((1, 4))
            for side, span, sign in zip(beside, (node - 1, node), (-1.0, 1.0), strict=True):
                if side is not None:
                    value = (side * amplitudes[:, span, None, :]).sum(axis=2)
                    jump = jump + sign * value
            for d, stiffness, sign in zip((0, 1), layout.springs(node, self.fourth), (-1.0, 1.0), strict=True):
                stiff = free & (np.abs(stiffness) * largest[:, d] > largest[:, 3 - d])
                balance = sign * jump[:, 3 - d] if forces is None else sign * jump[:, 3 - d] + forces[:, d, node]
                found[:, d, i] = np.where(stiff, balance / np.where(stiff, stiffness, 1.0), value[:, d])
        return found

    def beside(self, layout: Layout, node: int) -> tuple[FloatArray | None, FloatArray | None]:
        """`at_ends` left and right of a node; None where there is no span."""
        return (
            self.at_ends(layout, node - 1, True) if layout.has_span(node - 1) else None,
            self.at_ends(layout, node, False) if layout.has_span(node) else None,
        )

    def at_ends(self, layout: Layout, span: int, at_right: bool) -> FloatArray:
        """Deflection, slope, moment and EI phi''' of the four solutions at an end of a span, in units of L and EI.

        The shape is ``(n, 4 quantities, 4)``.
        """
        length = float(layout.spans[span])
        distance = np.where(self.right, 0.0 if at_right else -length, length if at_right else 0.0)
        mu = self.mu[:, span]
        wave = np.exp(mu * distance)  # (n, J)
        terms = wave[:, None, :] * mu[:, None, :] ** np.arange(4)[None, :, None]  # (n, d, J)
        values = np.einsum("ndj,wj->ndw", terms, self.selection).real
        short = np.flatnonzero(self.short[:, span])
        if short.size:
            values[short] = _series(_fourth_powers(mu[short]), length if at_right else 0.0)
            values[short] *= self.size[short, span, None, :]
        return np.asarray(values * np.where(np.arange(4) > 1, layout.stiffness[span], 1.0)[:, None])


def spaces_of(layout: Layout) -> tuple[int, ...]:
    """The spans that are spaces between two beams."""
    return tuple(np.flatnonzero(layout.stiffness == 0).tolist())


def _fourth_powers(mu: ComplexArray) -> FloatArray:
    """a = mu^4, which all exponentials share, from exponents ``(..., J)``."""
    return np.asarray((mu[..., 0] ** 4).real)


def _series(a: FloatArray, xi: float) -> FloatArray:
    """Derivatives d from 0 to 3 of K_k, k from 0 to 3, at `xi`, for each a, ``(n,)``; shape ``(n, 4 d, 4 k)``."""
    values = np.zeros((a.size, 4, 4))
    for d in range(4):
        for k in range(4):
            for times in range(TERMS // 4):
                power = 4 * times + k - d
                if power >= 0:
                    values[:, d, k] += a**times * xi**power / math.factorial(power)
    return values


def _solutions(layout: Layout, fourth: FloatArray, mu: ComplexArray, right: list[bool], selection: object) -> Solutions:
    """Solutions with exponents `mu`, times L, ``(n, J)``, on a span of the mean EI and m."""
    own = mu[:, None, :] * layout.wave[:, None]
    short = np.abs(own[:, :, 0]) * layout.spans <= _SHORT
    slope = np.maximum(1.0, np.abs(mu[:, 0]))
    # Masses on a fixed support do not move.
    moving = layout.mass[np.isfinite(layout.translational)].sum() + layout.rotary[np.isfinite(layout.torsional)].sum()
    bending = np.minimum(1.0, np.abs(fourth) * (float(layout.span_masses @ layout.spans) + moving))
    size = np.ones((fourth.size, layout.spans.size, 4))
    size[:, :, 1] = slope[:, None]
    for k in (2, 3):
        size[:, :, k] = (bending * slope**k)[:, None] / np.where(layout.stiffness > 0, layout.stiffness, 1.0)
    return Solutions(fourth, own, np.array(right), np.array(selection, dtype=complex), short, size)


def mode_solutions(layout: Layout, z: FloatArray) -> Solutions:
    """sin, cos and the two decaying exponentials of (12), for wave numbers beta L, shape ``(n,)``."""
    mu = np.stack([1j * z, -z.astype(complex), z.astype(complex)], axis=1)
    return _solutions(layout, z**4, mu, [False, False, True], [[-1j, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


def foundation_solutions(layout: Layout, z: float) -> Solutions:
    """One beam on an elastic foundation, phi'''' + 4 z^4 phi = 0, for a wave number times L."""
    mu = np.array([[-1 + 1j, 1 + 1j]]) * complex(z)
    return _solutions(layout, np.array([-4 * z**4]), mu, [False, True], [[1, 0], [-1j, 0], [0, 1], [0, -1j]])


def boundary_band(layout: Layout, solutions: Solutions) -> tuple[FloatArray, FloatArray]:
    """The matrix [g] of (15) for ``n`` functions, by its diagonals, shape ``(n, 2 BAND + 1, 4 S)``, without unit, and
    the factors of rows at each node, ``(n, 4, nodes)``: of the jump of the deflection, of the force, of the deflection
    where a support is fixed, and of the moment.

    Element (i, j) of the matrix stands in row BAND + i - j and column j.  There are two rows for each end and four for
    each inner node.  At each node the last two rows are the moment and the force balance, each divided by 1 plus the
    scaled stiffness; inner nodes have the continuity of deflection and slope before them.  On a space between two
    beams the four amplitudes are 0, by four rows of their own.
    """
    spans, n = layout.spans.size, solutions.fourth.size
    band, factors = np.zeros((n, 2 * BAND + 1, 4 * spans)), np.ones((n, 4, spans + 1))

    def add(row: int, span: int, values: FloatArray) -> None:
        columns = 4 * span + np.arange(4)
        band[:, BAND + row - columns, columns] += values

    row = 0
    for node in range(spans + 1):
        left, right = solutions.beside(layout, node)
        largest = largest_of(left, right)
        if left is not None and right is not None:
            for d in (0, 1):
                factor = 1 / largest[:, d, None]
                add(row, node - 1, -left[:, d] * factor)
                add(row, node, right[:, d] * factor)
                row += 1
            factors[:, 0, node] = 1 / largest[:, 0]
        kappa, kappa_t = layout.springs(node, solutions.fourth)
        # (13b), (13f), (13h): M(+) - M(-) = kt theta;  (13a), (13e), (13g): V(+) - V(-) = -k phi
        for d, stiffness, sign in ((1, kappa_t, -1.0), (0, kappa, 1.0)):
            jump, hold = _balance_factors(stiffness, largest[:, 3 - d], largest[:, d])
            values = right if right is not None else left
            assert values is not None
            if right is not None:
                add(row, node, jump[:, None] * right[:, 3 - d])
            if left is not None:
                add(row, node - 1, -jump[:, None] * left[:, 3 - d])
            add(row, node if right is not None else node - 1, (sign * hold)[:, None] * values[:, d])
            row += 1
            factors[:, 1 if d == 0 else 3, node] = jump
        factors[:, 2, node] = 1 / largest[:, 0]
        if node < spans and right is None:
            band[:, BAND, 4 * node : 4 * node + 4] = 1.0
            row += 4
    return band, factors


def largest_of(left: FloatArray | None, right: FloatArray | None) -> FloatArray:
    """Largest modulus of each quantity of the solutions left and right of a node, ``(n, 4)``."""
    return np.asarray(np.max([np.abs(side).max(axis=2) for side in (left, right) if side is not None], axis=0))


def whole(band: FloatArray) -> FloatArray:
    """Matrices, ``(n, m, m)``, from their diagonals, ``(n, 2 BAND + 1, m)``, as `boundary_band` gives them."""
    size = band.shape[2]
    matrix = np.zeros((band.shape[0], size, size))
    for offset in range(-BAND, BAND + 1):
        columns = np.arange(max(0, -offset), min(size, size - offset))
        matrix[:, columns + offset, columns] = band[:, BAND + offset, columns]
    return matrix


def _balance_factors(stiffness: Spring, jump: FloatArray, move: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Factors of the jump and of the deflection in a balance whose spring is `stiffness`, ``(n,)`` each.

    `jump` and `move`, ``(n,)``, are the largest values of each.
    """
    if isinstance(stiffness, float) and math.isinf(stiffness):
        return np.zeros_like(jump), 1 / move
    factor = 1 / (jump + np.abs(stiffness) * move)
    return factor, stiffness * factor


def force_row(layout: Layout, node: int) -> int:
    """Row of the force balance of a node in `boundary_band`."""
    return 1 + 4 * node if layout.has_span(node) else 4 * node - 1


def continuity_row(node: int) -> int:
    """Row of the continuity of the deflection at an inner node in `boundary_band`."""
    return 4 * node - 2
