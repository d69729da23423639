"""Characteristic equations of uniform single-span beams, as textbooks give them, and their roots b = beta L.

The equations are from Blevins (1979), Table 8-1, and Rao, Mechanical Vibrations, Figure 8.15.  With K = k L^3 / (EI
b^3) and T = kt L / (EI b), a free beam on a translational spring k and a torsional spring kt at its root obeys

    (1 - cos b cosh b) - T (sin b cosh b + cos b sinh b) - K (sin b cosh b - cos b sinh b) + K T (1 + cos b cosh b) = 0

Every equation is divided by cosh b or a similar factor, so that nothing overflows.  No code of `analytic` is used.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from lapjoint import Support

ROOTS = 5
_FIRST, _STEP = 0.3, 0.01
"""First b and step of the search; the equations of free beams vanish at 0, where the rigid-body modes are."""
_KAPPA, _TAU = 20.0, 3.0  # Springs k L^3 / EI and kt L / EI: neither negligible nor rigid
FIXED = math.inf


@dataclass(frozen=True)
class Textbook:
    """A beam of length and bending stiffness 1, and the equation for its b."""

    supports: tuple[Support, ...]
    equation: Callable[[float], float]
    """Function of b that vanishes at the frequency parameters."""
    rigid: int = 0
    """Number of rigid-body modes."""
    formula: str = ""
    """The equation, for the report."""


def roots(equation: Callable[[float], float], count: int = ROOTS) -> tuple[float, ...]:
    """The lowest positive roots, each to the last bits, between sign changes on a fine grid."""
    grid = np.arange(_FIRST, (count + 1) * math.pi, _STEP)
    signs = np.sign([equation(float(b)) for b in grid])
    changes = np.flatnonzero(signs[:-1] * signs[1:] < 0)[:count]
    return tuple(float(brentq(equation, grid[i], grid[i + 1], xtol=1e-15, rtol=4 * 2.3e-16)) for i in changes)


def _tip_spring(b: float) -> float:
    return b**3 * (1 / math.cosh(b) + math.cos(b)) + _KAPPA * (math.sin(b) - math.cos(b) * math.tanh(b))


def _root_torsion(b: float) -> float:
    return _TAU * (1 / math.cosh(b) + math.cos(b)) - b * (math.sin(b) - math.cos(b) * math.tanh(b))


def _root_springs(b: float) -> float:
    K, T = _KAPPA / b**3, _TAU / b
    cosh, cos, sin, tanh = math.cosh(b), math.cos(b), math.sin(b), math.tanh(b)
    return 1 / cosh - cos - T * (sin + cos * tanh) - K * (sin - cos * tanh) + K * T * (1 / cosh + cos)


def _middle_spring(b: float) -> float:
    h = b / 2
    symmetric = 4 * b**3 * math.cos(h) + _KAPPA * (math.sin(h) - math.cos(h) * math.tanh(h))
    return symmetric * math.sin(h)  # the antisymmetric modes have a node at the spring


def _support(x: float, translational: float, torsional: float) -> Support:
    return Support(x=x, translational=translational, torsional=torsional)


_CLAMP, _PIN = _support(0.0, FIXED, FIXED), _support(0.0, FIXED, 0.0)
_CLAMPED_TIP, _PINNED_TIP, _SLIDING_TIP = (
    _support(1.0, FIXED, FIXED),
    _support(1.0, FIXED, 0.0),
    _support(1.0, 0.0, FIXED),
)
_SLIDING = _support(0.0, 0.0, FIXED)


def _minus(b: float) -> float:
    return math.sin(b) - math.cos(b) * math.tanh(b)


def _plus(b: float) -> float:
    return math.sin(b) + math.cos(b) * math.tanh(b)


def _one(b: float) -> float:
    return math.cos(b) - 1 / math.cosh(b)


BEAMS = {
    "clamped-free": Textbook((_CLAMP,), lambda b: math.cos(b) + 1 / math.cosh(b), 0, "cos b cosh b = -1"),
    "clamped-clamped": Textbook((_CLAMP, _CLAMPED_TIP), _one, 0, "cos b cosh b = 1"),
    "pinned-pinned": Textbook((_PIN, _PINNED_TIP), math.sin, 0, "sin b = 0"),
    "clamped-pinned": Textbook((_CLAMP, _PINNED_TIP), _minus, 0, "tan b = tanh b"),
    "clamped-sliding": Textbook((_CLAMP, _SLIDING_TIP), _plus, 0, "tan b = -tanh b"),
    "free-free": Textbook((), _one, 2, "cos b cosh b = 1"),
    "pinned-free": Textbook((_PIN,), _minus, 1, "tan b = tanh b"),
    "sliding-free": Textbook((_SLIDING,), _plus, 1, "tan b = -tanh b"),
    "sliding-pinned": Textbook((_SLIDING, _PINNED_TIP), math.cos, 0, "cos b = 0"),
    "sliding-sliding": Textbook((_SLIDING, _SLIDING_TIP), math.sin, 1, "sin b = 0"),
    "clamped, spring at the tip": Textbook(
        (_CLAMP, _support(1.0, _KAPPA, 0.0)),
        _tip_spring,
        0,
        f"b^3 (1 + cos b cosh b) + {_KAPPA:g} (sin b cosh b - cos b sinh b) = 0",
    ),
    "pinned with torsional spring, free": Textbook(
        (_support(0.0, FIXED, _TAU),),
        _root_torsion,
        0,
        f"{_TAU:g} (1 + cos b cosh b) = b (sin b cosh b - cos b sinh b)",
    ),
    "both springs at the root, free": Textbook(
        (_support(0.0, _KAPPA, _TAU),), _root_springs, 0, f"see module; kappa = {_KAPPA:g}, tau = {_TAU:g}"
    ),
    "pinned-pinned, spring at mid-span": Textbook(
        (_PIN, _support(0.5, _KAPPA, 0.0), _PINNED_TIP),
        _middle_spring,
        0,
        f"4 b^3 + {_KAPPA:g} (tan b/2 - tanh b/2) = 0, or sin b/2 = 0",
    ),
}
