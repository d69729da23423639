r"""Periodic motions of the finite element model: shooting with the exact monodromy matrix.

A deviation dy from an orbit travels within a state by the linear flow, and at a switch at time T, where h is the
gap function that vanishes and f- and f+ are the rates before and after,

    dy+ = S dy- + (S f- - f+) dT,    dT = -(dh/dy- dy-) / h'

with S the constant, lossless map between the modes of the two states.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_lapjoint.march import March, Model, Piece, march
from fe_lapjoint.propagator import flow_matrix
from lapjoint.contact import ContactState
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

_STEPS = 10  # of Newton's method; near an orbit the residual squares in each
_NEAR = 1e-2  # relative residual from which on Newton is tried: among coexisting orbits, the one marched to
_FIRST_STRETCH = 12  # periods marched before the first attempt


@dataclass(frozen=True)
class Shot:
    """A start, the motion that follows over some periods, and the distance of its end from the start."""

    state: ContactState
    y: FloatArray
    motion: March
    residual: float
    """Relative to the size of y, velocities over omega; infinite if the contact state has changed."""


@dataclass(frozen=True)
class Orbit:
    """What was found."""

    order: int
    """Excitation periods per period of the motion; 0 if none was found."""
    residual: float
    multipliers: FloatArray
    motion: March


def shoot(model: Model, state: ContactState, y: FloatArray, duration: float, omega: float) -> Shot:
    """March over `duration` and compare the end with the start."""
    motion = march(model, state, y, 0.0, duration)
    if motion.state != state:
        return Shot(state, y, motion, np.inf)
    weight = np.repeat([1.0, 1.0 / omega], y.size // 2)
    size = np.linalg.norm(weight * y) + np.finfo(float).tiny
    return Shot(state, y, motion, float(np.linalg.norm(weight * (motion.y - y)) / size))


def monodromy(model: Model, motion: March) -> FloatArray:
    """d(end) / d(start) of a march by the exact method, shape ``(2 n, 2 n)``."""
    product = np.eye(motion.pieces[0].y.size)
    for piece, following in zip(motion.pieces, (*motion.pieces[1:], None), strict=True):
        product = flow_matrix(model.system(piece.state), piece.end - piece.start) @ product
        if following is not None and piece.switched >= 0:
            product = _jump(model, piece, following) @ product
    return product


def _jump(model: Model, piece: Piece, following: Piece) -> FloatArray:
    old, new = model.system(piece.state), model.system(following.state)
    S = np.kron(np.eye(2), model.transfer(piece.state, following.state))
    at, k = np.array([piece.end]), piece.switched
    y = np.concatenate([piece.coordinates(at, order)[:, 0] for order in (0, 1)])
    row = model.orientation(piece.state)[k] * old.stops[k]
    rate = row @ y[row.size :]
    change = S @ old.rates(piece.end, y) - new.rates(piece.end, following.y)
    return np.asarray(S - np.outer(change / rate, np.concatenate([row, np.zeros(row.size)])))


def newton(
    model: Model, state: ContactState, y: FloatArray, order: int, omega: float, tolerance: float
) -> Orbit | None:
    """A stable orbit of `order` excitation periods near ``y``; None if there is none to be found from here."""
    duration, allowed = order * 2 * np.pi / omega, _NEAR
    for _ in range(_STEPS):
        shot = shoot(model, state, y, duration, omega)
        if shot.residual > allowed:
            return None
        matrix = monodromy(model, shot.motion)
        if shot.residual <= tolerance:
            sizes = np.sort(np.abs(np.linalg.eigvals(matrix)))[::-1]
            return Orbit(order, shot.residual, sizes, shot.motion) if sizes[0] < 1 else None
        allowed = 2 * max(shot.residual, 1e-6)
        y = y + np.linalg.solve(np.eye(y.size) - matrix, shot.motion.y - y)
    return None


def least_period(model: Model, orbit: Orbit, omega: float, tolerance: float) -> Orbit:
    """The orbit over the fewest excitation periods after which it repeats."""
    start = orbit.motion.pieces[0]
    divisors = (n for n in range(1, orbit.order) if orbit.order % n == 0)
    shorter = (newton(model, start.state, start.y, n, omega, tolerance) for n in divisors)
    return next((found for found in shorter if found is not None), orbit)


def find_orbit(
    model: Model,
    state: ContactState,
    y: FloatArray,
    omega: float,
    *,
    tolerance: float,
    max_order: int,
    max_periods: int,
    progress: Progress | None,
) -> Orbit:
    """March from the initial state for longer and longer, and try Newton's method after each stretch."""
    period, marched, stretch = 2 * np.pi / omega, 0, _FIRST_STRETCH
    while True:
        motion = march(model, state, y, 0.0, stretch * period)
        state, y, marched = motion.state, motion.y, marched + stretch
        if progress is not None:
            progress(marched, max_periods)
        for order in range(1, max_order + 1):
            orbit = newton(model, state, y, order, omega, tolerance)
            if orbit is not None:
                return least_period(model, orbit, omega, tolerance)
        if marched >= max_periods:
            last = shoot(model, state, y, max_order * period, omega)
            return Orbit(0, last.residual, np.zeros(0), last.motion)
        stretch = min(2 * stretch, max_periods - marched)
