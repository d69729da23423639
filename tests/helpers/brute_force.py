"""A march in tiny steps by matrix exponentials, which knows nothing of closed forms, bounds or searches.

The motion of a contact state, with what drives it as further unknowns, is z' = M z; each step multiplies by exp(M dt).
A stop switches where the cubic through a gap function and its rate at both ends of a step passes through 0.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.linalg import expm

from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.model import Model
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray

STEPS = 60  # at least, in the shortest period or time constant, and in the time between two knots
_POINTS = np.linspace(0.0, 1.0, 9)[1:-1]  # of a step, at which its cubic is looked at, too


def switches(model: Model, end: float, most: int) -> list[tuple[int, float]]:
    """The first switches under sampled forces until `end`, s, at most `most`: the stop and its time, s, of each."""
    ramps = model.problem.forces.ramps
    assert ramps is not None
    state, found = initial_state(model), []
    y, t = initial_coordinates(model.assembly, model.system(state)), 0.0
    while t < end and len(found) < most:
        until = min(ramps.until(t), end)
        y, t, stop = _to_a_knot(model, state, y, t, until)
        if stop >= 0:
            found.append((stop, t))
            y = (y.reshape(2, -1) @ model.transfer(state, state.toggled(stop)).T).ravel()
            state = state.toggled(stop)
    return found


def _to_a_knot(
    model: Model, state: ContactState, y: FloatArray, t: float, until: float
) -> tuple[FloatArray, float, int]:
    """March up to a knot or a switch: (q, q') then, the time, and the stop, -1 for none."""
    system = model.system(state)
    M, z = _matrix(model, state, y, t)
    fastest = float(np.max(np.hypot(system.omega, system.damping_rate)))
    steps = max(STEPS, math.ceil((until - t) * fastest * STEPS / (2 * math.pi)))
    dt, n = (until - t) / steps, system.omega.size
    move, rows = expm(M * dt), np.zeros((2, model.sign.size, z.size))
    rows[0, :, :n] = rows[1, :, n : 2 * n] = model.orientation(state)[:, None] * system.stops
    offset = np.array([model.offset(state), np.zeros(model.sign.size)])
    path = np.empty((steps + 1, z.size))
    path[0] = z
    for i in range(steps):
        path[i + 1] = move @ path[i]
    h, rate = rows @ path.T - offset[:, :, None]
    u = _POINTS[:, None, None]
    between = _cubic(u, h[:, :-1], h[:, 1:], rate[:, :-1] * dt, rate[:, 1:] * dt)
    between = np.concatenate([h[None, :, :-1], between, h[None, :, 1:]])
    rising = ((between[:-1] < 0) & (between[1:] >= 0)).any(axis=0)  # (P, steps)
    if not rising.any():
        return path[-1, : 2 * n], until, -1
    i = int(np.flatnonzero(rising.any(axis=0))[0])
    part, k = min(
        (_root(between[:, k, i], h[k, i : i + 2], rate[k, i : i + 2] * dt), k) for k in np.flatnonzero(rising[:, i])
    )
    return (expm(M * part * dt) @ path[i])[: 2 * n], t + (i + part) * dt, int(k)


def _cubic(u: FloatArray, left: FloatArray, right: FloatArray, rate: FloatArray, rate_end: FloatArray) -> FloatArray:
    """The cubic through values and rates, for each step, at both ends of a step."""
    value = left * (1 + 2 * u) * (1 - u) ** 2 + right * u**2 * (3 - 2 * u)
    return np.asarray(value + u * (1 - u) * (rate * (1 - u) - rate_end * u))


def _root(between: FloatArray, h: FloatArray, rate: FloatArray) -> float:
    """Where a cubic first rises through 0, in parts of the step."""
    i = int(np.flatnonzero((between[:-1] < 0) & (between[1:] >= 0))[0])
    lo, hi = np.array(i / (between.size - 1)), np.array((i + 1) / (between.size - 1))
    for _ in range(50):
        middle = (lo + hi) / 2
        lo, hi = (middle, hi) if _cubic(middle, h[0], h[1], rate[0], rate[1]) < 0 else (lo, middle)
    return float(hi)


def _matrix(model: Model, state: ContactState, y: FloatArray, t: float) -> tuple[FloatArray, FloatArray]:
    """M, and z at a time: (q, q'), 1, the sampled forces, their rates, and sine and cosine of each load."""
    system, ramps = model.system(state), model.problem.forces.ramps
    assert ramps is not None
    assert system.ramps is not None
    n, R, H = system.omega.size, len(ramps.forces), system.driven.size
    force, slope = (part[0] for part in ramps.at(np.array([t])))
    angle = system.driven * t + system.phase
    one, f, g, sine, cosine = np.cumsum([2 * n, 1, R, R, H])
    M = np.zeros((cosine + H, cosine + H))
    M[: 2 * n, : 2 * n] = system.jacobian(t, y)
    M[n : 2 * n, one] = system.constant
    M[n : 2 * n, f:g] = system.ramps.shares
    M[n : 2 * n, sine:cosine] = system.harmonic
    M[f:g, g:sine] = np.eye(R)
    M[sine:cosine, cosine:] = np.diag(system.driven)
    M[cosine:, sine:cosine] = -np.diag(system.driven)
    return M, np.concatenate([y, [1.0], force, slope, np.sin(angle), np.cos(angle)])
