"""A motion that is known exactly, because it is written down and not solved for: that of the fixture `history`."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

AMPLITUDE = 3e-3  # m
OMEGA = 2 * math.pi  # rad/s: one period a second
GAP = 1e-3  # m
STIFFNESS = 1e4  # N/m


def swinging(x: NDArray[np.float64], t: NDArray[np.float64], dx: int = 0, dt: int = 0) -> NDArray[np.float64]:
    """z = A x^2 (3 - x) / 2 sin(omega t) on a beam of length 1, and its derivatives, shape ``(n, m)``."""
    shape = (x**2 * (3 - x) / 2, (6 * x - 3 * x**2) / 2, 3 - 3 * x, np.full_like(x, -3.0))[dx]
    wave = (
        np.sin(OMEGA * t),
        OMEGA * np.cos(OMEGA * t),
        -(OMEGA**2) * np.sin(OMEGA * t),
    )[dt]
    return AMPLITUDE * np.outer(shape, wave)
