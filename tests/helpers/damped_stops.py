"""A motion with damped stops by brute force: the modes of the closed stops, with the force law as it is written.

The spring of a closed stop is part of the modes.  What the force law differs by from that spring is an external force
on the modes here: no mode is coupled, no oscillator is formed, and the switches come from scipy's event search.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from analytic.march.joint import Joint
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem

_TURN = 0.3  # most that the fastest mode turns in a step, rad, so that no event is stepped over
_SOON = 1e-9  # s: by which a stop is looked at again that truncation left beyond its switch


@dataclass(frozen=True)
class Witnessed:
    """The motion at its end, and its switches."""

    times: FloatArray
    indices: tuple[int, ...]
    """As `ContactState.toggled` takes them."""
    state: ContactState
    q: FloatArray
    v: FloatArray
    impulses: FloatArray
    """N s, shape ``(P,)``."""
    dissipated: FloatArray
    """Energy lost in each stop, J, shape ``(P,)``."""


def random_damped_joint(rng: np.random.Generator) -> Problem:
    """A cantilever with one to four stops, of which most are damped and some may pull."""
    stops = []
    for _ in range(int(rng.integers(1, 5))):
        k, ratio = float(10 ** rng.uniform(1, 3.5)), 10 ** rng.uniform(-2, 1)
        stops.append(
            {
                "damping": float(ratio * np.sqrt(k)) if rng.random() < 0.8 else 0.0,
                "stiffness": k,
                "x": float(rng.uniform(0.3, 1)),
                "side": str(rng.choice(["top", "bottom"])),
                "gap": float(rng.uniform(0.005, 0.05)),
                "may_pull": bool(rng.random() < 0.3),
            }
        )
    modal = {"kind": "modal", "ratio": float(rng.uniform(0, 0.1))}
    viscous = {"kind": "viscous", "coefficient": float(rng.uniform(0, 1))}
    return Problem.model_validate(
        {
            "beam": {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},
            "supports": [{"x": 0.0, "translational": math.inf, "torsional": math.inf}],
            "stops": stops,
            "damping": modal if rng.random() < 0.5 else viscous,
            "base_motion": {
                "kind": "sine",
                "amplitude": float(10 ** rng.uniform(-1.5, -0.5)),
                "angular_frequency": float(rng.uniform(2, 12)),
            },
            "point_loads": [{"kind": "step", "x": 0.7, "force": float(rng.normal() * 0.05)}],
            "initial": {
                "kind": "polynomial",
                "displacement": [0, 0, float(rng.normal() * 0.02)],
                "velocity": [0, 0, float(rng.normal() * 0.3)],
            },
        }
    )


def witnessed(joint: Joint, state: ContactState, q: FloatArray, v: FloatArray, end: float) -> Witnessed:
    """March displacements `q` and velocities `v` of the modes of `state` from the time 0 to `end`, s."""
    problem, t, P = joint.problem, 0.0, len(joint.problem.stops)
    stops, omega, sizes = problem.stops, joint.harmonics.omega, joint.sizes
    k, c = (np.array([getattr(stop, name) for stop in stops]) for name in ("stiffness", "damping"))
    sign, gap = np.array([stop.sign for stop in stops]), np.array([stop.gap for stop in stops])
    pulls, damped = np.array([stop.may_pull for stop in stops]), c > 0
    totals, times, indices = np.zeros((2, P)), [], []
    while t < end:
        modal = joint.modal(ContactState(state.closed))
        n, phi, load = q.size, modal.at_stops, modal.force * sizes[:, None]
        left_out = modal.residual_at_stops * sizes[:, None]
        closed = np.array([i in state for i in range(P)])
        acts = closed & np.array([i not in state.released for i in range(P)])
        natural, rate = modal.modes.omega, modal.damping_rate

        def depths(t: float, y: FloatArray) -> tuple[FloatArray, FloatArray]:
            theta = joint.harmonics.theta(t)
            z = phi @ y[:n] + left_out[0] + np.sin(theta) @ left_out[1:]
            z1 = phi @ y[n : 2 * n] + (omega * np.cos(theta)) @ left_out[1:]
            return sign * z - gap, sign * z1

        def rates(t: float, y: FloatArray) -> FloatArray:
            d, d1 = depths(t, y)
            F = np.where(acts, k * d + c * d1, 0.0)
            force = load[0] + np.sin(joint.harmonics.theta(t)) @ load[1:]
            force = force + (sign * (np.where(closed, k * d, 0.0) - F)) @ phi
            return np.concatenate(
                [y[n : 2 * n], force - 2 * rate * y[n : 2 * n] - natural**2 * y[:n], F, np.where(acts, F * d1, 0.0)]
            )

        y = np.concatenate([q, v, totals.ravel()])
        functions, toggles, at_once = [], [], []
        for i in range(P):
            for own in (True, False):
                if not own and not (damped[i] and closed[i] and not pulls[i]):
                    continue
                on = closed[i] if own else acts[i]

                def h(t: float, y: FloatArray, i: int = i, own: bool = own, on: bool = on) -> float:
                    d, d1 = depths(t, y)
                    value = d[i] if own else d[i] + c[i] / k[i] * d1[i]
                    return float(-value if on else value)

                level = max(h(t, y), 0.0) * (1 + 1e-9)
                index = i if own else ~i
                if level > 0 and h(t + _SOON, y + _SOON * rates(t, y)) > h(t, y) and indices[-1:] != [index]:
                    at_once.append(index)

                def event(t: float, y: FloatArray, h=h, level: float = level) -> float:  # type: ignore[no-untyped-def]
                    return h(t, y) - level

                event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
                functions.append(event)
                toggles.append(index)
        if at_once:  # few modes left the stop beyond its switch, from which it moves farther
            index = at_once[0]
        else:
            fastest, before = max([natural.max(), *omega]), totals
            found = solve_ivp(
                rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-15, events=functions, max_step=_TURN / fastest
            )
            t, y = float(found.t[-1]), found.y[:, -1]
            q, v, totals = y[:n], y[n : 2 * n], y[2 * n :].reshape(2, P)
            # with few modes a force may pull just after a touch; an impulse takes what a segment comes to, if it presses
            pressed = np.maximum(totals[0] - before[0], 0.0)
            totals[0] = before[0] + np.where(pulls, totals[0] - before[0], pressed)
            hit = [j for j, at in enumerate(found.t_events) if at.size]
            if not hit:
                break
            index = toggles[hit[0]]
        times.append(t)
        indices.append(index)
        after = state.toggled(index)
        if index >= 0:
            passage, theta = (
                joint.passage(ContactState(state.closed), ContactState(after.closed)),
                joint.harmonics.theta(t),
            )
            q = passage.S @ q + passage.residual[0] + np.sin(theta) @ passage.residual[1:]
            v = passage.S @ v + (omega * np.cos(theta)) @ passage.residual[1:]
        state = after
    return Witnessed(np.array(times), tuple(indices), state, q, v, sign * totals[0], totals[1])
