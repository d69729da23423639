"""A motion that is known exactly, because it is written down and not solved for: that of the fixture `history`."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from lapjoint import FREE, Beam, History, Material, Rectangle
from lapjoint.problem.beam import Section

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


def with_section(history: History, section: Section | None = None) -> History:
    """The motion of a beam with a section, of steel."""
    section = section or Rectangle(breadth=0.05, height=0.02)
    beam = Beam(length=1.0, material=Material(youngs_modulus=2e11, density=7800.0), section=section)
    return replace(history, problem=history.problem.replace(beam=beam))


def at_rest(history: History) -> History:
    """A beam without stops that does not move."""
    problem = history.problem.replace(stops=())
    still = np.zeros(0)
    return History(problem, "", 0.0, 1.0, still, (FREE,), (), lambda x, t, dx=0, dt=0: np.zeros((x.size, t.size)))
