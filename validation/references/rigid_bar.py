r"""A rigid bar on springs between stops, by numpy and scipy alone: no code of the project takes part.

A beam so stiff that it does not bend has the displacement z(x, t) = N(x) . u(t) with N(x) = (1 - x / L, x / L) and the
displacements u of its ends, or N(x) = x / L where a pin holds its root.  It obeys

    M u'' + C u' + K u = f(t),    M = int m N^T N dx,    K = sum k N^T N + sum kt N'^T N'

over the springs of all supports and of the closed stops, with f from the base's inertia, point loads, gravity, uniform
loads and gaps.  A mass at a point adds mass N^T N and, by its rotary inertia, J N'^T N' to M; the masses per length may
differ from segment to segment.  A stop fixed in space has the gap function sign (z + y) - gap.  Every
contact state has its own K, and under modal damping its own C = M Phi diag(2 zeta_i omega_i) Phi^T M, so that its
modes decouple: between two switches the motion is a sum of decaying sines, the gap functions are sampled closely, and
their roots refined by bisection.

The problem is read from the text of a problem file by `tomllib`, without the reader that is on trial.
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.linalg import eigh
from scipy.optimize import brentq

from validation.references.panels import gauss_panels

Array = npt.NDArray[np.float64]
Closed = frozenset[int]

_SAMPLES = 60
"""Samples of the gap functions in a period of the fastest mode or load: a contact longer than one is not missed."""
_PERIODS = 2  # Such periods that are sampled together
_CLOSE = 1e-15  # Tolerance of a switch, s: that of double precision
_PANELS, _POINTS = 4, 12  # Panels and Gauss points of a contact's quadrature


@dataclass(frozen=True)
class BarContact:
    """A contact of one stop."""

    stop: int
    start: float
    """Start, s."""
    end: float
    """End, s."""
    impulse: float
    """Time integral of the stop's spring force magnitude, N s; positive at the top, negative at the bottom."""
    peak: float
    """Largest spring force magnitude, N."""


@dataclass(frozen=True)
class Flow:
    """The motion between two switches, valid from `start` to `end`."""

    start: float
    end: float
    closed: Closed
    motion: Callable[[Array, int], Array]
    """u(t), shape ``(n, m)``, or its first or second derivative, at times of shape ``(m,)``."""


@dataclass(frozen=True, eq=False)
class RigidBar:
    """The bar of a problem file."""

    tables: dict[str, Any]
    """The file, as `tomllib` reads it."""

    @staticmethod
    def from_toml(text: str) -> RigidBar:
        """The bar of a problem given as the text of its file."""
        return RigidBar(tomllib.loads(text))

    @cached_property
    def length(self) -> float:
        """Length, m."""
        return float(self.tables["beam"]["length"])

    @cached_property
    def mass_per_length(self) -> float:
        """Mass per length, kg/m."""
        return float(self.tables["beam"]["mass_per_length"])

    @cached_property
    def pinned(self) -> bool:
        """Whether a pin holds the root: the bar can only turn."""
        return any(s["x"] == 0 and math.isinf(s.get("translational", 0.0)) for s in self.tables.get("supports", ()))

    def N(self, x: float | Array) -> Array:
        """Displacement at x, m, per unit of each coordinate, shape (n,) or (places, n)."""
        part = np.asarray(x, dtype=float) / self.length
        return np.stack([part] if self.pinned else [1 - part, part], axis=-1)

    @cached_property
    def slope(self) -> Array:
        """Slope by each coordinate, 1/m, shape ``(n,)``."""
        return np.array([1.0] if self.pinned else [-1.0, 1.0]) / self.length

    def pieces(self, added: bool) -> list[tuple[float, float, float]]:
        """Start, m, end, m, and mass per length, kg/m, of each segment, with contents and, if `added`, added mass."""
        beam, found, start = self.tables["beam"], [], 0.0
        more = beam.get("contents_per_length", 0.0) + (beam.get("added_mass_per_length", 0.0) if added else 0.0)
        for segment in beam.get("segments", [{**beam, "to": self.length}]):
            found.append((start, float(segment["to"]), float(segment["mass_per_length"] + more)))
            start = float(segment["to"])
        return found

    @cached_property
    def masses(self) -> list[dict[str, Any]]:
        """The masses at points."""
        return list(self.tables.get("masses", ()))

    @cached_property
    def M(self) -> Array:
        """Mass matrix, kg."""
        total = np.zeros((self.slope.size, self.slope.size))
        for start, end, m in self.pieces(added=True):
            x, w = gauss_panels(np.array([start, end]), 2)
            total = total + m * (w * self.N(x).T) @ self.N(x)
        for one in self.masses:
            row = self.N(one["x"])
            total = total + one["mass"] * np.outer(row, row)
            total = total + one.get("rotary_inertia", 0.0) * np.outer(self.slope, self.slope)
        return total

    def along(self, start: float, end: float) -> Array:
        """int N dx from `start` to `end`, m, shape (n,), by which a force per unit length is multiplied."""
        return (end - start) * self.N((start + end) / 2)

    def by_inertia(self, added: bool) -> Array:
        """The load, kg, shape (n,), of a unit acceleration on all masses, added ones too if `added`."""
        along = [m * self.along(start, end) for start, end, m in self.pieces(added)]
        return np.asarray(sum(along) + sum((one["mass"] * self.N(one["x"]) for one in self.masses), 0.0 * along[0]))

    @cached_property
    def stops(self) -> list[dict[str, Any]]:
        """The stops, with their sign: +1 at the top, -1 at the bottom."""
        return [{**s, "sign": {"top": 1.0, "bottom": -1.0}[s["side"]]} for s in self.tables.get("stops", ())]

    @cached_property
    def rows(self) -> Array:
        """N at each stop, shape ``(stops, n)``."""
        return np.array([self.N(s["x"]) for s in self.stops]).reshape(-1, self.M.shape[0])

    @cached_property
    def harmonics(self) -> list[tuple[Array, float, float]]:
        """Loads force sin(omega t + phase): N, shape ``(n,)``, rad/s and rad."""
        found = []
        if "base_motion" in self.tables:
            base = self.tables["base_motion"]
            for one in base.get("harmonics", [base]):
                w = float(one.get("multiple", 1) * base["angular_frequency"])
                found.append((one["amplitude"] * w**2 * self.by_inertia(added=True), w, one.get("phase", 0.0)))
        for load in self.tables.get("point_loads", ()):
            for one in load.get("harmonics", [load] if load["kind"] == "sine" else []):
                w = float(one.get("multiple", 1) * load["angular_frequency"])
                found.append((one["force"] * self.N(load["x"]), w, one.get("phase", 0.0)))
        return found

    @cached_property
    def base(self) -> list[tuple[float, float, float]]:
        """The waves of the base's displacement y: m, rad/s and rad."""
        base = self.tables.get("base_motion", {})
        return [
            (one["amplitude"], one.get("multiple", 1) * base["angular_frequency"], one.get("phase", 0.0))
            for one in base.get("harmonics", [base] if base else [])
        ]

    def harmonics_in(self, closed: Closed) -> list[tuple[Array, float, float]]:
        """`harmonics`, and those by which closed stops that are fixed in space drive the bar."""
        moved = [k for k in closed if self.stops[k].get("fixed_to") == "space"]
        push = -sum((self.stops[k]["stiffness"] * self.rows[k] for k in moved), np.zeros(self.slope.size))
        return [*self.harmonics, *((Y * push, w, phase) for Y, w, phase in (self.base if moved else ()))]

    @cached_property
    def damping_is_modal(self) -> bool:
        """Whether modes have damping ratios."""
        return bool(self.tables["damping"]["kind"] == "modal")

    @cached_property
    def period(self) -> float:
        """Excitation period, s, of the lowest frequency in the file, of which all other frequencies are whole
        multiples."""
        parts = [self.tables.get("base_motion", {}), *self.tables.get("point_loads", ())]
        return 2 * math.pi / min(float(part["angular_frequency"]) for part in parts if "angular_frequency" in part)

    def gap_function(self, k: int, u: Array, t: float | Array) -> Array:
        """sign z - gap of stop k, m, or sign (z + y) - gap, positive where it is pressed, at times `t`, s, of the shape
        of `u` (m, (n,) or (n, times)) without n."""
        seen = self.rows[k] @ u + self.seen_of_base(k, t)
        return np.asarray(self.stops[k]["sign"] * seen - self.stops[k]["gap"])

    def seen_of_base(self, k: int, t: float | Array, derivative: int = 0) -> float | Array:
        """The y that stop k sees at times `t`, s, or a derivative of it, m s^-derivative; 0 if it moves with the
        base."""
        if self.stops[k].get("fixed_to") != "space":
            return 0.0
        return sum(
            Y * w**derivative * np.sin(np.multiply(w, t) + phase + derivative * math.pi / 2)
            for Y, w, phase in self.base
        )

    @cached_property
    def _state(self) -> Callable[[Closed], tuple[Array, Array, Array, Array]]:
        @cache
        def state(closed: Closed) -> tuple[Array, Array, Array, Array]:
            """Modes Phi, omega, decay rates, and constant forces of a contact state."""
            K, constant = np.zeros_like(self.M), np.zeros(self.M.shape[0])
            for support in self.tables.get("supports", ()):
                k, kt = support.get("translational", 0.0), support.get("torsional", 0.0)
                if math.isfinite(k):
                    K = K + k * np.outer(self.N(support["x"]), self.N(support["x"]))
                K = K + kt * np.outer(self.slope, self.slope)
            for i in closed:
                stop, row = self.stops[i], self.rows[i]
                K = K + stop["stiffness"] * np.outer(row, row)
                constant = constant + stop["sign"] * stop["stiffness"] * stop["gap"] * row
            for load in self.tables.get("point_loads", ()):
                if load["kind"] == "step":
                    constant = constant + load["force"] * self.N(load["x"])
            if "gravity" in self.tables:
                constant = constant + self.tables["gravity"]["acceleration"] * self.by_inertia(added=False)
            for load in self.tables.get("uniform_loads", ()):
                ends = load.get("from", 0.0), load.get("to", self.length)
                constant = constant + load["force_per_length"] * self.along(*ends)
            squared, modes = eigh(K, self.M)
            omega = np.sqrt(squared)
            return modes, omega, self._decay(omega), constant

        return state

    def _decay(self, omega: Array) -> Array:
        damping = self.tables.get("damping", {"kind": "none"})
        if damping["kind"] == "modal":
            ratios = np.atleast_1d(np.asarray(damping["ratio"], dtype=float))
            return np.asarray(ratios[np.minimum(np.arange(omega.size), ratios.size - 1)] * omega)
        c = float(damping["coefficient"]) if damping["kind"] == "viscous" else 0.0
        return np.full(omega.size, c / (2 * self.mass_per_length))

    def matrices(self, closed: Closed) -> tuple[Array, Array, Array]:
        """C (N s/m) and K (N/m) of a contact state, shape (n, n), and where the bar rests in it without periodic loads
        (m)."""
        modes, omega, decay, constant = self._state(closed)
        C, K = (self.M @ (modes * one) @ modes.T @ self.M for one in (2 * decay, omega**2))
        return C, K, modes @ (modes.T @ constant / omega**2)

    def flow(self, closed: Closed, start: float, u: Array, v: Array) -> Callable[[Array, int], Array]:
        """The motion in one contact state from u (m) and v (m/s), shape (n,), at `start` (s), like `Flow.motion`."""
        modes, omega, decay, constant = self._state(closed)
        rest = modes.T @ constant / omega**2
        waves = [
            (modes.T @ force / (omega**2 - w**2 + 2j * decay * w), w, phase)
            for force, w, phase in self.harmonics_in(closed)
        ]  # q = Im(wave exp(i (w t + phase)))
        q, p = modes.T @ self.M @ u - rest, modes.T @ self.M @ v
        for wave, w, phase in waves:
            now = wave * np.exp(1j * (w * start + phase))
            q, p = q - now.imag, p - (1j * w * now).imag
        root = -decay + 1j * np.sqrt(omega**2 - decay**2)
        free = q - 1j * (p + decay * q) / root.imag  # q(t) = Re(free exp(root t))

        def motion(t: Array, derivative: int = 0) -> Array:
            at = np.atleast_1d(np.asarray(t, dtype=float))
            total = (free * root**derivative)[:, None] * np.exp(np.multiply.outer(root, at - start))
            result = total.real + (rest[:, None] if derivative == 0 else 0.0)
            for wave, w, phase in waves:
                result = result + np.multiply.outer(wave * (1j * w) ** derivative, np.exp(1j * (w * at + phase))).imag
            return np.asarray(modes @ result)

        return motion

    @cached_property
    def initial(self) -> tuple[Array, Array]:
        """u and v at t = 0 of an initial state that is linear in x."""
        given = self.tables.get("initial", {})
        ends = np.array([self.length] if self.pinned else [0.0, self.length])
        u, v = (
            np.polynomial.polynomial.polyval(ends, np.array(given.get(name) or [0.0], dtype=float))
            for name in ("displacement", "velocity")
        )
        return np.asarray(u), np.asarray(v)

    def march(self, duration: float, u: Array | None = None, v: Array | None = None) -> BarMotion:
        """The motion over `duration` s from u (m) and v (m/s), shape (n,), at t = 0, or from the file's initial
        state."""
        if u is None or v is None:
            u, v = self.initial
        closed = frozenset(k for k in range(len(self.stops)) if self._pressed(k, u, v))
        t, just, flows = 0.0, -1, []
        while t < duration:
            motion = self.flow(closed, t, u, v)
            end, just = self._next_switch(motion, closed, t, duration, just)
            flows.append(Flow(t, end, closed, motion))
            now = np.array([end])
            t, u, v = end, motion(now, 0)[:, 0], motion(now, 1)[:, 0]
            closed = closed ^ ({just} if just >= 0 else set())
        return BarMotion(self, tuple(flows), u, v)

    def _pressed(self, k: int, u: Array, v: Array) -> bool:
        beyond, speed = float(self.gap_function(k, u, 0.0)), float(self.rows[k] @ v + self.seen_of_base(k, 0.0, 1))
        return beyond > 0 or (beyond == 0 and self.stops[k]["sign"] * speed > 0)

    def _next_switch(
        self, motion: Callable[[Array, int], Array], closed: Closed, start: float, end: float, just: int
    ) -> tuple[float, int]:
        """When a stop next switches, and which; the end, and -1, if none does.  Stop `just` did so at the start."""
        fastest = max([float(self._state(closed)[1][-1]), *(w for _, w, _ in self.harmonics)])
        a, window = start, 2 * math.pi / fastest * _PERIODS
        while a < end and self.stops:
            b = min(a + window, end)
            t = np.linspace(a, b, _SAMPLES * _PERIODS + 1)
            u, found = motion(t, 0), []
            for k in range(len(self.stops)):
                h = (-1.0 if k in closed else 1.0) * self.gap_function(k, u, t)
                if a == start and k == just:
                    h[0] = -math.inf  # it is zero, and falls
                rises = np.flatnonzero((h[:-1] < 0) & (h[1:] >= 0))
                if rises.size:
                    i = int(rises[0])
                    around = t[i : i + 2]
                    if h[i] == -math.inf:
                        around = self._back_at_once(motion, k, k in closed, around)

                    def gap(s: float, k: int = k) -> float:
                        return float(self.gap_function(k, motion(np.array([s]), 0), s)[0])

                    found.append((float(brentq(gap, *around, xtol=_CLOSE)), k))
            if found:
                return min(found)
            a = b
        return end, -1

    def _back_at_once(self, motion: Callable[[Array, int], Array], k: int, closed: bool, around: Array) -> Array:
        """Two times about the next switch of a stop: it lies between two others, at the first of which it switched."""
        t = np.linspace(around[0], around[1], _SAMPLES)
        h = (-1.0 if closed else 1.0) * self.gap_function(k, motion(t, 0), t)
        first = 1 + int(np.flatnonzero(h[1:] >= 0)[0])
        if first == 1:
            raise ArithmeticError(f"stop {k} switches twice within {t[1] - t[0]:.1e} s")
        return np.asarray(t[first - 1 : first + 1])

    def moment(self, x: float, t: float, flow: Flow) -> float:
        """Bending moment EI z'' at x (m) and t (s), N m, by the balance of all forces beyond x; `flow` is that of t.

        The bar is uniform, without masses at points, and under base motion and point loads alone."""
        now = np.array([t])
        u, v, a = (flow.motion(now, derivative)[:, 0] for derivative in range(3))
        modes, _, decay, _ = self._state(flow.closed)
        inertia = self.mass_per_length * (a + modes @ (2 * decay * (modes.T @ self.M @ v)))  # damping with it
        places, weights = np.polynomial.legendre.leggauss(_POINTS)
        half = (self.length - x) / 2
        s = x + half * (1 + places)
        total = -float(half * weights * (s - x) @ (self.N(s) @ inertia))
        if "base_motion" in self.tables:
            base = self.tables["base_motion"]
            for one in base.get("harmonics", [base]):
                w = one.get("multiple", 1) * base["angular_frequency"]
                force = self.mass_per_length * one["amplitude"] * w**2 * math.sin(w * t + one.get("phase", 0.0))
                total += force * 2 * half**2
        for load in self.tables.get("point_loads", ()):
            for one in load.get("harmonics", [load]) if load["x"] > x else []:
                w = one.get("multiple", 1) * load.get("angular_frequency", 0.0)
                wave = 1 if load["kind"] == "step" else math.sin(w * t + one.get("phase", 0.0))
                total += one["force"] * wave * (load["x"] - x)
        for k, stop in enumerate(self.stops):
            if stop["x"] > x and k in flow.closed:
                total -= stop["sign"] * stop["stiffness"] * float(self.gap_function(k, u, t)) * (stop["x"] - x)
        for support in self.tables.get("supports", ()):
            if support["x"] > x:
                total -= support.get("translational", 0.0) * float(self.N(support["x"]) @ u) * (support["x"] - x)
                total -= support.get("torsional", 0.0) * float(self.slope @ u)
        return total


@dataclass(frozen=True, eq=False)
class BarMotion:
    """A motion of the bar, from t = 0."""

    bar: RigidBar
    flows: tuple[Flow, ...]
    u: Array
    """Displacements at the end, m."""
    v: Array
    """Velocities at the end, m/s."""

    @property
    def y(self) -> Array:
        """(u, v) at the end."""
        return np.concatenate([self.u, self.v])

    def evaluate(self, x: float, t: Array, derivative: int = 0) -> Array:
        """z(x, t), m, or its time derivative, m s^-derivative, at `t`, s, shape (m,)."""
        result = np.empty(t.size)
        for flow in self.flows:
            here = (t >= flow.start) & (t <= flow.end)
            result[here] = self.bar.N(x) @ flow.motion(t[here], derivative)
        return result

    @cached_property
    def contacts(self) -> tuple[BarContact, ...]:
        """All contacts, by start; the ends of the motion cut the contacts that last beyond them."""
        found = [c for k in range(len(self.bar.stops)) for c in self._contacts_of(k)]
        return tuple(sorted(found, key=lambda contact: contact.start))

    @property
    def closings(self) -> int:
        """How often a stop closes."""
        return sum(bool(flow.closed - before.closed) for before, flow in pairwise(self.flows))

    def impulses(self) -> Array:
        """Impulse of each stop, N s, shape ``(stops,)``."""
        return np.array([sum(c.impulse for c in self.contacts if c.stop == k) for k in range(len(self.bar.stops))])

    def _contacts_of(self, k: int) -> list[BarContact]:
        found: list[list[Flow]] = []
        for before, flow in zip((None, *self.flows), self.flows, strict=False):
            if k in flow.closed:
                if before is not None and k in before.closed:
                    found[-1].append(flow)
                else:
                    found.append([flow])
        return [self._contact(k, flows) for flows in found]

    def _contact(self, k: int, flows: list[Flow]) -> BarContact:
        stop, area, deepest = self.bar.stops[k], 0.0, 0.0
        for flow in flows:
            t, w = gauss_panels(np.linspace(flow.start, flow.end, _PANELS + 1), _POINTS)
            area += float(self.bar.gap_function(k, flow.motion(t, 0), t) @ w)
            deepest = max(deepest, self._deepest(k, flow))
        force = stop["stiffness"] * area * stop["sign"]
        return BarContact(k, flows[0].start, flows[-1].end, force, stop["stiffness"] * deepest)

    def _deepest(self, k: int, flow: Flow) -> float:
        """Largest sign z - gap in a flow, m: at its ends, or where the stop's speed vanishes."""

        def speed(s: float) -> float:
            return float(self.bar.rows[k] @ flow.motion(np.array([s]), 1)[:, 0] + self.bar.seen_of_base(k, s, 1))

        t = np.linspace(flow.start, flow.end, _PANELS * _POINTS)
        v = self.bar.rows[k] @ flow.motion(t, 1) + self.bar.seen_of_base(k, t, 1)
        turns = [brentq(speed, t[i], t[i + 1], xtol=_CLOSE) for i in np.flatnonzero(v[:-1] * v[1:] < 0)]
        at = np.array([flow.start, flow.end, *turns])
        return float(self.bar.gap_function(k, flow.motion(at, 0), at).max())

    def moment(self, x: float, t: float) -> float:
        """Bending moment EI z'' at x, m, and t, s, in N m."""
        return self.bar.moment(x, t, next(flow for flow in self.flows if flow.start <= t <= flow.end))
