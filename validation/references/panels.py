"""Gauss quadrature over panels, by numpy alone."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def gauss_panels(edges: Array, points: int) -> tuple[Array, Array]:
    """Gauss points and weights on panels between edges, in their unit, shape (panels * points,) each."""
    x, w = np.polynomial.legendre.leggauss(points)
    half = np.diff(edges)[:, None] / 2
    return ((edges[:-1, None] + half) + half * x).ravel(), (half * w).ravel()
