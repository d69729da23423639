"""A motion with coupled modes by brute force: the modes of the closed stops, with the force law as it is written.

The spring of a closed stop is part of the modes.  What the force law differs by from that spring is an external force
on the modes here, and so is viscous damping beside masses and steps, whose work on each mode is a quadrature along the
beam: no mode is coupled, no oscillator is formed, and the switches come from scipy's event search.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from analytic.march.joint import Joint
from analytic.march.loads import MOVED_STOPS
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import Beam, BeamSegment, FloatArray, Mass, Problem, ViscousDamping

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
    """Energy lost in each damped stop, J, shape ``(P,)``: not what its spring stores at the end."""


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
                "fixed_to": "space" if rng.random() < 0.2 else "base",
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


def random_dragged_joint(rng: np.random.Generator) -> Problem:
    """A cantilever of `random_damped_joint` with masses, steps or both, under viscous damping, which couples its modes.

    The damping of the lowest modes is from light to above critical; every second joint has no damped stop.
    """
    joint, segments, masses = random_damped_joint(rng), (), []
    kind = rng.integers(3)
    if kind != 1:
        cuts = [*np.sort(rng.choice(np.arange(2, 19), int(rng.integers(1, 3)), replace=False)) / 20, 1.0]
        EI, m = 10 ** rng.uniform(-0.5, 0.5, len(cuts)), 10 ** rng.uniform(-0.5, 0.5, len(cuts))
        parts = zip(map(float, cuts), EI.tolist(), m.tolist(), strict=True)
        segments = tuple(BeamSegment(to=to, bending_stiffness=e, mass_per_length=d) for to, e, d in parts)
    if kind != 0:
        for _ in range(int(rng.integers(1, 3))):
            size = float(10 ** rng.uniform(-1.5, 0.5))
            place = 1.0 if rng.random() < 0.5 else float(rng.uniform(0.2, 1))
            masses.append(Mass(x=place, mass=size, rotary_inertia=size * float(rng.uniform(0, 0.02))))
    beam = Beam(length=1.0, segments=segments) if segments else joint.beam
    stops = joint.stops
    if rng.random() < 0.5:
        stops = tuple(stop.model_copy(update={"damping": 0.0, "may_pull": False}) for stop in stops)
    damping = ViscousDamping(coefficient=float(10 ** rng.uniform(-1, 1)))
    return joint.replace(beam=beam, masses=tuple(masses), stops=stops, damping=damping)


class _State:
    """The motion in one contact state: rates of (q, v, impulses, energies), and the functions that end it."""

    def __init__(self, joint: Joint, state: ContactState) -> None:
        stops = joint.problem.stops
        modal = joint.modal(ContactState(state.closed))
        self._joint, self._stops, self.n = joint, stops, modal.size
        self._phi, self._load = modal.at_stops, modal.force * joint.sizes[:, None]
        moved = [False, *(shape == MOVED_STOPS for shape in joint.loaded.positions)]
        seen = np.outer(moved, [stop.in_space for stop in stops])
        self._left_out = (modal.residual_at_stops + seen) * joint.sizes[:, None]
        self._k, self._c = (np.array([getattr(stop, name) for stop in stops]) for name in ("stiffness", "damping"))
        self._sign, self._gap = (np.array([getattr(stop, name) for stop in stops]) for name in ("sign", "gap"))
        self._closed = np.array([i in state for i in range(len(stops))])
        self._acts = self._closed & np.array([i not in state.released for i in range(len(stops))])
        self._natural, self._rate = modal.modes.omega, modal.damping_rate
        x, weights = _quadrature(joint.problem)
        shapes, rest = modal.modes.shapes(x), modal.residual(x) * joint.sizes[:, None]
        damping = joint.problem.damping
        drag = weights * (damping.coefficient if isinstance(damping, ViscousDamping) else 0.0)
        if not joint.problem.masses and len(joint.problem.beam.pieces) == 1:
            drag = 0.0 * drag  # the damping rates of the modes are all of it
        self._drag, self._drag_of_loads = (shapes * drag) @ shapes.T, (rest * drag) @ shapes.T
        self.pulls = np.array([stop.may_pull for stop in stops])
        self.fastest = max([self._natural.max(), *joint.harmonics.omega])
        force = [~i for i, stop in enumerate(stops) if stop.damping > 0 and self._closed[i] and not stop.may_pull]
        self.indices = [*range(len(stops)), *force]
        """What may switch, as `ContactState.toggled` takes it."""

    def _depths(self, t: float, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        theta, omega = self._joint.harmonics.theta(t), self._joint.harmonics.omega
        z = self._phi @ y[: self.n] + self._left_out[0] + np.sin(theta) @ self._left_out[1:]
        rate = self._phi @ y[self.n : 2 * self.n] + (omega * np.cos(theta)) @ self._left_out[1:]
        return self._sign * z - self._gap, self._sign * rate

    def rates(self, t: float, y: FloatArray) -> FloatArray:
        """d/dt of q, v, impulses and energies lost."""
        d, d1 = self._depths(t, y)
        F = np.where(self._acts, self._k * d + self._c * d1, 0.0)
        force = self._load[0] + np.sin(self._joint.harmonics.theta(t)) @ self._load[1:]
        force = force + (self._sign * (np.where(self._closed, self._k * d, 0.0) - F)) @ self._phi
        q, v = y[: self.n], y[self.n : 2 * self.n]
        lost = np.where(self.pulls, F, np.maximum(F, 0.0)) * d1
        omega = self._joint.harmonics.omega
        force = force - (omega * np.cos(self._joint.harmonics.theta(t))) @ self._drag_of_loads[1:] - self._drag @ v
        return np.concatenate([v, force - 2 * self._rate * v - self._natural**2 * q, F, lost])

    def stored(self, t: float, y: FloatArray) -> FloatArray:
        """Energy of the springs that press, J, shape ``(P,)``."""
        return np.where(self._acts, self._k / 2 * self._depths(t, y)[0] ** 2, 0.0)

    def gap_function(self, index: int, t: float, y: FloatArray) -> float:
        """Rises through 0 where a stop, or the force of stop `~index`, switches; m."""
        d, d1 = self._depths(t, y)
        if index >= 0:
            return float(-d[index] if self._closed[index] else d[index])
        value = d[~index] + self._c[~index] / self._k[~index] * d1[~index]
        return float(-value if self._acts[~index] else value)

    def event(self, index: int, level: float) -> Callable[[float, FloatArray], float]:
        """The gap function as an event of scipy, with truncation's `level` in place of 0."""

        def event(t: float, y: FloatArray) -> float:
            return self.gap_function(index, t, y) - level

        event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
        return event


def _quadrature(problem: Problem) -> tuple[FloatArray, FloatArray]:
    """Gauss points along the beam and their weights, m, on panels that no mass, stop, load or step divides."""
    parts = [it.x for it in (*problem.masses, *problem.stops, *problem.point_loads)]
    edges = np.unique([*np.linspace(0, problem.beam.length, 17), *parts, *(it.end for it in problem.beam.pieces)])
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = np.diff(edges)[:, None] / 2
    return (edges[:-1, None] + half * (1 + nodes)).ravel(), (half * weights).ravel()


def witnessed(joint: Joint, state: ContactState, q: FloatArray, v: FloatArray, end: float) -> Witnessed:
    """March displacements `q` and velocities `v` of the modes of `state` from the time 0 to `end`, s."""
    t, P, times, indices = 0.0, len(joint.problem.stops), [], []
    totals = np.zeros((2, P))
    while t < end:
        now, y = _State(joint, state), np.concatenate([q, v, totals.ravel()])
        soon = t + _SOON, y + _SOON * _State(joint, state).rates(t, y)
        level = {index: max(now.gap_function(index, t, y), 0.0) for index in now.indices}
        # few modes may leave a stop beyond its switch, from which it moves farther
        beyond = [i for i in now.indices if 0 < level[i] < now.gap_function(i, *soon) and indices[-1:] != [i]]
        if beyond:
            index = beyond[0]
        else:
            events = [now.event(index, level[index] * (1 + 1e-9)) for index in now.indices]
            options = {"rtol": 1e-12, "atol": 1e-15, "max_step": _TURN / now.fastest}
            found = solve_ivp(now.rates, (t, end), y, method="DOP853", events=events, **options)
            t, y, before = float(found.t[-1]), found.y[:, -1], totals
            q, v, totals = y[: now.n], y[now.n : 2 * now.n], y[2 * now.n :].reshape(2, P)
            # with few modes a force may pull just after a touch: an impulse takes what a segment comes to if it presses
            pressed = np.maximum(totals[0] - before[0], 0.0)
            totals[0] = before[0] + np.where(now.pulls, totals[0] - before[0], pressed)
            hit = [index for index, at in zip(now.indices, found.t_events, strict=True) if at.size]
            if not hit:
                break
            index = hit[0]
        times.append(t)
        indices.append(index)
        after = state.toggled(index)
        if index >= 0:
            theta, omega = joint.harmonics.theta(t), joint.harmonics.omega
            passage = joint.passage(ContactState(state.closed), ContactState(after.closed))
            q = passage.S @ q + passage.residual[0] + np.sin(theta) @ passage.residual[1:]
            v = passage.S @ v + (omega * np.cos(theta)) @ passage.residual[1:]
        state = after
    sign = np.array([stop.sign for stop in joint.problem.stops])
    totals[1] -= _State(joint, state).stored(t, np.concatenate([q, v]))
    return Witnessed(np.array(times), tuple(indices), state, q, v, sign * totals[0], totals[1])
