r"""The boundary and compatibility conditions (13a)-(13h) as a matrix, for any number of spans.

Each span carries four real waves.  The unknowns are their amplitudes; the rows say, node by node, that deflection
and slope are continuous, that the shear jumps by ``k phi`` and the moment by ``kt phi'``; at an infinite spring
the deflection or the slope vanishes instead.  Rows and columns are scaled so that stiff and soft springs, low and
high modes leave entries of order one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from analytic.modes.beam_functions import BeamFunctions, ComplexArray
from analytic.modes.characteristic_equation import Layout
from lapjoint.problem import FloatArray

BAND = 5  # nonzero diagonals on each side of the main one: the rows of a node reach over the two spans beside it


@dataclass(frozen=True)
class Waves:
    """Four real waves on every span: Re and Im parts of the exponentials selected by `real` and `imaginary`."""

    mu: ComplexArray
    """Exponents times L, shape ``(n, J)``."""
    scale: FloatArray
    """Positive wave number, times L, that scales derivatives, shape ``(n,)``."""
    right: npt.NDArray[np.bool_]
    """Whether each exponential is anchored at the right end, shape ``(J,)``."""
    selection: ComplexArray
    """Coefficient of each exponential in each of the four waves, shape ``(4, J)``."""

    def functions(self, nodes: FloatArray, amplitudes: FloatArray, length: float) -> BeamFunctions:
        """The ``n`` functions of x that the amplitudes of the waves, shape ``(n, S, 4)``, make.

        `nodes`, shape ``(S + 1,)``, are the ends of the spans, and `length` is that of the beam, m.  The functions have
        the unit of the amplitudes.
        """
        n, spans = amplitudes.shape[:2]
        c = np.einsum("nsw,wj->nsj", amplitudes, self.selection)
        return BeamFunctions(nodes, self.mu / length, self.right, c, np.zeros((n, spans, 2)))


def mode_waves(z: FloatArray) -> Waves:
    """sin, cos and the two decaying exponentials of (12), for wave numbers beta L, shape ``(n,)``."""
    mu = np.stack([1j * z, -z.astype(complex), z.astype(complex)], axis=1)
    selection = np.array([[-1j, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=complex)
    return Waves(mu, z, np.array([False, False, True]), selection)


def foundation_waves(z: FloatArray) -> Waves:
    """The waves of a beam on an elastic foundation, phi'''' + 4 z^4 phi = 0, for wave numbers times L, ``(n,)``."""
    mu = np.stack([z * (-1 + 1j), z * (1 + 1j)], axis=1)
    selection = np.array([[1, 0], [-1j, 0], [0, 1], [0, -1j]], dtype=complex)
    return Waves(mu, z, np.array([False, True]), selection)


def _end_values(waves: Waves, length: float, at_right: bool) -> FloatArray:
    """Derivatives of order d from 0 to 3, divided by scale^d, of the four waves at an end of a span: shape ``(n, 4
    derivatives, 4)``."""
    distance = np.where(waves.right, 0.0 if at_right else -length, length if at_right else 0.0)
    wave = np.exp(waves.mu * distance)  # (n, J)
    relative = waves.mu / waves.scale[:, None]
    d = np.arange(4)
    terms = wave[:, None, :] * relative[:, None, :] ** d[None, :, None]  # (n, d, J)
    return np.asarray(np.einsum("ndj,wj->ndw", terms, waves.selection).real)


def boundary_band(layout: Layout, waves: Waves) -> FloatArray:
    """The matrix [g] of (15) for ``n`` wave numbers, by its diagonals, shape ``(n, 2 BAND + 1, 4 S)``, without unit.

    Element (i, j) of the matrix stands in row BAND + i - j and column j.  There are two rows for each end and four for
    each inner node.  At each node the last two rows are the moment and the force balance, each divided by 1 plus the
    scaled stiffness; inner nodes have the continuity of deflection and slope before them.
    """
    spans, n = layout.spans.size, waves.scale.size
    band = np.zeros((n, 2 * BAND + 1, 4 * spans))

    def add(row: int, span: int, values: FloatArray) -> None:
        columns = 4 * span + np.arange(4)
        band[:, BAND + row - columns, columns] += values

    row = 0
    for node in range(spans + 1):
        left = _end_values(waves, layout.spans[node - 1], True) if node > 0 else None
        right = _end_values(waves, layout.spans[node], False) if node < spans else None
        if left is not None and right is not None:
            for d in (0, 1):
                add(row, node - 1, -left[:, d])
                add(row, node, right[:, d])
                row += 1
        # (13b), (13f), (13h): M(+) - M(-) = kt theta;  (13a), (13e), (13g): V(+) - V(-) = -k phi
        for d, stiffness, sign in ((1, layout.torsional[node], -1.0), (0, layout.translational[node], 1.0)):
            jump, hold = _balance_weights(stiffness, waves.scale ** (3 - 2 * d), sign)
            values = right if right is not None else left
            assert values is not None
            if right is not None:
                add(row, node, jump[:, None] * right[:, 3 - d])
            if left is not None:
                add(row, node - 1, -jump[:, None] * left[:, 3 - d])
            add(row, node if right is not None else node - 1, hold[:, None] * values[:, d])
            row += 1
    return band


def whole(band: FloatArray) -> FloatArray:
    """Matrices, ``(n, m, m)``, from their diagonals, ``(n, 2 BAND + 1, m)``, as `boundary_band` gives them."""
    size = band.shape[2]
    matrix = np.zeros((band.shape[0], size, size))
    for offset in range(-BAND, BAND + 1):
        columns = np.arange(max(0, -offset), min(size, size - offset))
        matrix[:, columns + offset, columns] = band[:, BAND + offset, columns]
    return matrix


def _balance_weights(stiffness: float, scale: FloatArray, sign: float) -> tuple[FloatArray, FloatArray]:
    """Factors of the jump and of the spring in a balance whose spring is `stiffness`, each of shape ``(n,)``."""
    if np.isinf(stiffness):
        return np.zeros_like(scale), np.ones_like(scale)
    relative = stiffness / scale
    return 1 / (1 + relative), sign * relative / (1 + relative)


def force_row(layout: Layout, node: int) -> int:
    """Row of the force balance of a node in `boundary_band`."""
    last = 1 + 4 * node
    return last if node < layout.spans.size else 4 * layout.spans.size - 1
