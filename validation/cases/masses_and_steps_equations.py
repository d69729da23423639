"""Characteristic equations of beams with masses and steps, and their roots b = beta L.

A cantilever of length, stiffness and mass 1 with a mass mu and a rotary inertia J at its tip obeys, with c, s, C, S for
cos b, sin b, cosh b, sinh b (Blevins 1979, Karnovsky and Lebed 2001, for J = 0),

    (1 + c C) - mu b (s C - c S) - J b^3 (s C + c S) + mu J b^4 (1 - c C) = 0

A mass in the middle of a pinned beam moves in the even modes, 4 cos h = mu b (sin h - cos h tanh h) with h = b / 2; the
odd ones have a node there.  A pinned beam whose stiffness and mass both grow by a factor r at the middle, as they do
with its breadth, has one wave number along the whole, so that with t = tan h, T = tanh h

    4 r (t + T)^2 = (1 + r)^2 (t - T)^2

A cantilever with a step of any kind is met by four conditions on A (cos - cosh) + B (sin - sinh) from the root and C
(cos + cosh) + D (sin + sinh) from the tip.  Every equation is divided by cosh b or the like, so that nothing overflows.
Nothing here comes from `analytic`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lapjoint import Beam, Problem, Support
from lapjoint.problem import BeamSegment, Mass

_LIGHT, _HEAVY, _TURNING = 0.5, 20.0, 0.3
"""Masses over the beam's, and rotary inertia over the beam's mass times L^2: neither negligible nor immovable."""
_BROADER, _THINNER = 3.0, 0.5  # factors of the breadth, and of the diameter, from the middle on
FIXED = math.inf
_CLAMP, _PIN = Support(x=0.0, translational=FIXED, torsional=FIXED), Support(x=0.0, translational=FIXED)
_PINNED_TIP = Support(x=1.0, translational=FIXED)


@dataclass(frozen=True)
class Carrying:
    """A beam of length 1, whose first piece has stiffness and mass per length 1, and the equation for its b."""

    problem: Problem
    equation: Callable[[float], float]
    """Function of b that vanishes at the frequency parameters."""
    formula: str
    """The equation, for the report."""


def tip_mass(mu: float, J: float = 0.0) -> Callable[[float], float]:
    """The equation of a cantilever with a mass and a rotary inertia at its tip."""

    def equation(b: float) -> float:
        one, c, s, S = 1 / math.cosh(b), math.cos(b), math.sin(b), math.tanh(b)
        turning = J * b**3 * (-(s + c * S) + mu * b * (one - c))
        return one + c - mu * b * (s - c * S) + turning

    return equation


def _middle_mass(b: float) -> float:
    h = b / 2
    even = 4 * math.cos(h) - _LIGHT * b * (math.sin(h) - math.cos(h) * math.tanh(h))
    return even * math.sin(h)  # the odd modes have a node at the mass


def broader(ratio: float) -> Callable[[float], float]:
    """The equation of a pinned beam whose stiffness and mass are `ratio` times as large from the middle on."""

    def equation(b: float) -> float:
        s, c = math.sin(b / 2), math.cos(b / 2) * math.tanh(b / 2)
        return 4 * ratio * (s + c) ** 2 - (1 + ratio) ** 2 * (s - c) ** 2

    return equation


def stepped_cantilever(EI: float, m: float) -> Callable[[float], float]:
    """The equation of a cantilever with this stiffness and mass per length from the middle on."""
    waves = (m / EI) ** 0.25

    def equation(b: float) -> float:
        near, far = b / 2, b * waves / 2
        c, s, C, S = math.cos(near), math.sin(near), math.cosh(near), math.sinh(near)
        d, r, D, R = math.cos(far), math.sin(far), math.cosh(far), math.sinh(far)
        conditions = [
            [c - C, s - S, -(d + D), -(r + R)],
            [-s - S, c - C, waves * (-r + R), waves * (d + D)],
            [-c - C, -s - S, -EI * waves**2 * (-d + D), -EI * waves**2 * (-r + R)],
            [s - S, -c - C, EI * waves**3 * (r + R), EI * waves**3 * (-d + D)],
        ]
        size = np.array([C, C, D, D])
        return float(np.linalg.det(np.array(conditions) / size)) * math.cosh(near) * math.cosh(far)

    return equation


def _uniform(*supports: Support, masses: tuple[Mass, ...]) -> Problem:
    beam = Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0)
    return Problem(beam=beam, supports=supports, masses=masses)


def _stepped(*supports: Support, EI: float, m: float) -> Problem:
    segments = (
        BeamSegment(to=0.5, bending_stiffness=1.0, mass_per_length=1.0),
        BeamSegment(to=1.0, bending_stiffness=EI, mass_per_length=m),
    )
    return Problem(beam=Beam(length=1.0, segments=segments), supports=supports)


CARRYING = {
    "cantilever, light mass at the tip": Carrying(
        _uniform(_CLAMP, masses=(Mass(x=1.0, mass=_LIGHT),)),
        tip_mass(_LIGHT),
        f"1 + cos b cosh b = {_LIGHT:g} b (sin b cosh b - cos b sinh b)",
    ),
    "cantilever, heavy mass at the tip": Carrying(
        _uniform(_CLAMP, masses=(Mass(x=1.0, mass=_HEAVY),)),
        tip_mass(_HEAVY),
        f"1 + cos b cosh b = {_HEAVY:g} b (sin b cosh b - cos b sinh b)",
    ),
    "cantilever, turning mass at the tip": Carrying(
        _uniform(_CLAMP, masses=(Mass(x=1.0, mass=_LIGHT, rotary_inertia=_TURNING),)),
        tip_mass(_LIGHT, _TURNING),
        f"see module; mu = {_LIGHT:g}, J = {_TURNING:g}",
    ),
    "pinned-pinned, mass at mid-span": Carrying(
        _uniform(_PIN, _PINNED_TIP, masses=(Mass(x=0.5, mass=_LIGHT),)),
        _middle_mass,
        f"4 = {_LIGHT:g} b (tan b/2 - tanh b/2), or sin b/2 = 0",
    ),
    "pinned-pinned, broader from mid-span on": Carrying(
        _stepped(_PIN, _PINNED_TIP, EI=_BROADER, m=_BROADER),
        broader(_BROADER),
        f"see module; r = {_BROADER:g}",
    ),
    "cantilever, thinner from the middle on": Carrying(
        _stepped(_CLAMP, EI=_THINNER**4, m=_THINNER**2),
        stepped_cantilever(_THINNER**4, _THINNER**2),
        f"see module; the diameter is {_THINNER:g} times as large",
    ),
}
