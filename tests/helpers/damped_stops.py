"""A motion with damped stops by brute force: the modes of the closed stops, with the force law as it is written.

The spring of a closed stop is part of the modes.  What the force law differs by from that spring is an external force
on the modes here: no mode is coupled, no oscillator is formed, and the switches come from scipy's event search.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from analytic.march.joint import Joint
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray

_STEP = 0.05  # longest step, as a fraction of the time in which the fastest mode turns by 1 rad times 2 pi


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
        functions, toggles = [], []
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

                def event(t: float, y: FloatArray, h=h, level: float = level) -> float:  # type: ignore[no-untyped-def]
                    return h(t, y) - level

                event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
                functions.append(event)
                toggles.append(i if own else ~i)
        fastest = max([natural.max(), *omega])
        found = solve_ivp(
            rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-15, events=functions, max_step=_STEP * 6 / fastest
        )
        t, y = float(found.t[-1]), found.y[:, -1]
        q, v, before, totals = y[:n], y[n : 2 * n], totals, y[2 * n :].reshape(2, P)
        # just after a touch, few modes may give a force that pulls; impulses take what a segment comes to, if it presses
        totals[0] = before[0] + np.where(pulls, totals[0] - before[0], np.maximum(totals[0] - before[0], 0.0))
        hit = [j for j, at in enumerate(found.t_events) if at.size]
        if not hit:
            break
        index = toggles[hit[0]]
        times.append(t)
        indices.append(index)
        after = state.toggled(index)
        if index >= 0:
            passage, theta = joint.passage(ContactState(state.closed), ContactState(after.closed)), joint.harmonics.theta(t)
            q = passage.S @ q + passage.residual[0] + np.sin(theta) @ passage.residual[1:]
            v = passage.S @ v + (omega * np.cos(theta)) @ passage.residual[1:]
        state = after
    return Witnessed(np.array(times), tuple(indices), state, q, v, sign * totals[0], totals[1])
