"""A motion with coupled modes by brute force: the modes of the closed stops, with the force law as it is written.

The spring of a closed stop is part of the modes.  What the force law differs by from that spring is an external force
on the modes here, and so is viscous damping beside masses and steps, whose work on each mode is a quadrature along the
beam: no mode is coupled, no oscillator is formed, and the switches come from scipy's event search.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from analytic.march import Joint
from analytic.march import march as analytic_march
from analytic.march.field import history_of as analytic_history
from analytic.march.initial_state import initial_coordinates as analytic_coordinates
from analytic.march.initial_state import started
from analytic.march.loads import MOVED_STOPS
from analytic.march.tables import switch_of
from fe_lapjoint.march.field import history_of as mesh_history
from fe_lapjoint.march.initial import initial_coordinates as mesh_coordinates
from fe_lapjoint.march.initial import initial_state
from fe_lapjoint.march.march import march as mesh_march
from fe_lapjoint.march.model import Model
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import Beam, History, PolynomialShape, Problem, StepLoad, Stop, Support
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, ViscousDamping
from tests.helpers.random_joints import damped_cantilever

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


def sampled_joint(seed: int, **options: bool) -> Problem:
    """A joint of `damped_cantilever`, driven by a record or by random motion, beside a step load and often a random
    one; stops in space are as frequent as others."""
    rng = np.random.default_rng([seed, 47])
    joint = damped_cantilever(rng, **options)
    kind, t = (
        str(rng.choice(["displacement", "acceleration", "random"])),
        np.linspace(0.0, 4.0, int(rng.integers(40, 90))),
    )
    lines = [(10 ** rng.uniform(-1.5, -0.7), rng.uniform(2, 12), rng.uniform(0, 6)) for _ in range(3)]
    order = 2 if kind == "acceleration" else 0
    values = sum(a * w**order * np.sin(w * t + phase) for a, w, phase in lines)
    record = {
        "kind": "record",
        "quantity": kind,
        "values": values,
        "times": t,
        "remove": "drift" if order else "nothing",
    }
    psd = {"kind": "random", "psd": [[0.4, float(rng.uniform(0.02, 0.5))], [1.5, 0.5]], "seed": seed}
    loads = [*joint.point_loads]
    if rng.random() < 0.5:
        force = {"kind": "random", "x": 0.6, "psd": [[0.5, 0.01], [1.2, 0.02]], "rate": 7.3, "seed": seed}
        loads.append(force)  # type: ignore[arg-type]
    space = [stop.model_copy(update={"fixed_to": str(rng.choice(["base", "space"]))}) for stop in joint.stops]
    return Problem.model_validate(
        {
            "beam": joint.beam,
            "supports": joint.supports,
            "stops": space,
            "damping": joint.damping,
            "base_motion": psd if kind == "random" else record,
            "point_loads": loads,
            "initial": joint.initial,
        }
    )


def loose_beam(seed: int) -> Problem:
    """A beam on nothing or on a pin, between damped stops, driven by a record and by a random force."""
    rng, t = np.random.default_rng(seed), np.linspace(0.0, 3.0, 60)
    stops = [
        {
            "x": x,
            "side": side,
            "gap": 0.01,
            "stiffness": 100.0,
            "damping": float(rng.uniform(1, 20)),
            "fixed_to": str(rng.choice(["base", "space"])),
        }
        for x in (0.1, 0.9)
        for side in ("top", "bottom")
    ]
    viscous = {"kind": "viscous", "coefficient": 0.4}
    return Problem.model_validate(
        {
            "beam": {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},
            "supports": [] if seed % 2 else [{"x": 0.3, "translational": math.inf}],
            "stops": stops,
            "damping": {"kind": "modal", "ratio": 0.05} if rng.random() < 0.5 else viscous,
            "base_motion": {
                "kind": "record",
                "quantity": "displacement",
                "times": t,
                "values": 0.05 * np.sin(5 * t),
            },
            "point_loads": [{"kind": "random", "x": 0.9, "psd": [[0.5, 0.02], [1.5, 0.02]], "seed": seed, "rate": 9.0}],
        }
    )


def knots_of(problem: Problem) -> FloatArray:
    """Times between which all sampled forces are linear, s, up to 20 s."""
    found = [force.knots_within(0.0, min(force.end, 20.0)) for force in problem.forces.sampled]
    return np.unique(np.concatenate([np.zeros(0), *found]))


def ends_of(knots: FloatArray, t: float) -> FloatArray:
    """The knots, s, between which a time is, s: at a knot, it and the next one; none without knots."""
    before = min(int(np.searchsorted(knots, t * (1 + 1e-14), side="right")) - 1, knots.size - 2)
    return knots[before : before + 2] if knots.size else knots


def loads_at(joint: Joint, t: float, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The loads of a joint that are not constant, and their rates, at a time between two knots `ends`, s."""
    theta, omega, forces = joint.harmonics.theta(t), joint.harmonics.omega, joint.problem.forces
    loads, rates = [*np.sin(theta)], [*omega * np.cos(theta)]
    if forces.sampled:
        for force in forces.sampled:
            one, other = force.at(ends)
            slope = (other - one) / (ends[1] - ends[0])
            loads.append(one + slope * (t - ends[0]))
            rates.append(slope)
    if MOVED_STOPS in joint.loaded.positions[omega.size :]:
        base = joint.problem.base_motion
        assert base is not None
        loads.append(float(base.at(np.array([t]))[0]))
        rates.append(float(base.at(np.array([t]), 1)[0]))
    return np.array(loads), np.array(rates)


class _State:
    """The motion in one contact state: rates of (q, v, impulses, energies), and the functions that end it."""

    def __init__(self, joint: Joint, state: ContactState, start: float) -> None:
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
        if not joint.problem.structure.masses and len(joint.problem.line.pieces) == 1:
            drag = 0.0 * drag  # the damping rates of the modes are all of it
        self._drag, self._drag_of_loads = (shapes * drag) @ shapes.T, (rest * drag) @ shapes.T
        self.pulls = np.array([stop.may_pull for stop in stops])
        self.fastest = max([self._natural.max(), *joint.harmonics.omega])
        self._ends = ends_of(knots_of(joint.problem), start)
        force = [~i for i, stop in enumerate(stops) if stop.damping > 0 and self._closed[i] and not stop.may_pull]
        self.indices = [*range(len(stops)), *force]
        """What may switch, as `ContactState.toggled` takes it."""

    def _depths(self, t: float, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        loads, rates = loads_at(self._joint, t, self._ends)
        z = self._phi @ y[: self.n] + self._left_out[0] + loads @ self._left_out[1:]
        rate = self._phi @ y[self.n : 2 * self.n] + rates @ self._left_out[1:]
        return self._sign * z - self._gap, self._sign * rate

    def rates(self, t: float, y: FloatArray) -> FloatArray:
        """d/dt of q, v, impulses and energies lost."""
        d, d1 = self._depths(t, y)
        F = np.where(self._acts, self._k * d + self._c * d1, 0.0)
        loads, rates = loads_at(self._joint, t, self._ends)
        force = self._load[0] + loads @ self._load[1:]
        force = force + (self._sign * (np.where(self._closed, self._k * d, 0.0) - F)) @ self._phi
        q, v = y[: self.n], y[self.n : 2 * self.n]
        force = force - rates @ self._drag_of_loads[1:] - self._drag @ v
        return np.concatenate([v, force - 2 * self._rate * v - self._natural**2 * q, F, F * d1])

    def gap_function(self, index: int, t: float, y: FloatArray) -> float:
        """Rises through 0 where a stop, or the force of stop `~index`, switches; m."""
        d, d1 = self._depths(t, y)
        if index >= 0:
            return float(-d[index] if self._closed[index] else d[index])
        value = d[~index] + self._c[~index] / self._k[~index] * d1[~index]
        return float(-value if self._acts[~index] else value)

    def first_beyond(self, found: Any, levels: dict[int, float]) -> float:
        """The first time, s, by which a gap function has passed its level and scipy has not seen it: its function
        returns below before the step ends, or another event cuts the step.  Infinite if there is none.

        Peaks within a step are those of a parabola.
        """
        a, b = found.t[:-1], found.t[1:]
        grid = np.concatenate([a, (a + b) / 2, b])
        states, times = found.sol(grid).T, []
        for index, seen in zip(self.indices, found.t_events, strict=True):
            pairs = zip(grid.tolist(), states, strict=True)
            f, g, h = np.array([self.gap_function(index, t, y) for t, y in pairs]).reshape(3, -1) - levels[index]
            if seen.size:
                h[-1] = 0.0
            slope, bend = (h - f) / 2, f - 2 * g + h  # by half steps, at the middle
            with np.errstate(divide="ignore", invalid="ignore"):
                at = np.where(np.abs(slope) < -bend, -slope / bend, np.sign(slope))
            peak = (f < 0) & (g + at * slope + at**2 * bend / 2 > 0)
            times += ((a + b) / 2 + at * (b - a) / 2)[peak].tolist()
        return min(times, default=math.inf)

    def event(self, index: int, level: float) -> Callable[[float, FloatArray], float]:
        """The gap function as an event of scipy, with truncation's `level` in place of 0."""

        def event(t: float, y: FloatArray) -> float:
            return self.gap_function(index, t, y) - level

        event.terminal, event.direction = True, 1.0  # type: ignore[attr-defined]
        return event


def _quadrature(problem: Problem) -> tuple[FloatArray, FloatArray]:
    """Gauss points along the beam and their weights, m, on panels that no mass, stop, load or step divides."""
    parts = [it.x for it in (*problem.structure.masses, *problem.structure.stops, *problem.point_loads)]
    edges = np.unique([*np.linspace(0, problem.line.length, 17), *parts, *(it.end for it in problem.line.pieces)])
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = np.diff(edges)[:, None] / 2
    return (edges[:-1, None] + half * (1 + nodes)).ravel(), (half * weights).ravel()


def witnessed(joint: Joint, state: ContactState, q: FloatArray, v: FloatArray, end: float) -> Witnessed:
    """March displacements `q` and velocities `v` of the modes of `state` from the time 0 to `end`, s."""
    t, P, times, indices, began = 0.0, len(joint.problem.stops), [], [], True
    knots = knots_of(joint.problem)
    totals = np.zeros((2, P))
    while t < end:
        now, y = _State(joint, state, t), np.concatenate([q, v, totals.ravel()])
        soon = t + _SOON, y + _SOON * now.rates(t, y)
        if began:  # the levels are those at which the state was entered
            before = totals
            level = {index: max(now.gap_function(index, t, y), 0.0) for index in now.indices}
        until = min([end, *knots[knots > t * (1 + 1e-14)][:1]])
        jumped = [i for i in now.indices if not began and i < 0 and now.gap_function(i, t, y) > level[i] * (1 + 1e-9)]
        # few modes may leave a stop beyond its switch, from which it moves farther
        beyond = [i for i in now.indices if 0 < level[i] < now.gap_function(i, *soon) and indices[-1:] != [i]]
        if jumped or (began and beyond):
            index = (jumped or beyond)[0]
        else:
            events = [now.event(index, level[index] * (1 + 1e-9)) for index in now.indices]
            options = {"rtol": 1e-12, "atol": 1e-15, "max_step": _TURN / now.fastest}
            found, options = None, {**options, "method": "DOP853", "dense_output": True}
            while found is None or until <= found.t[-1]:
                found = solve_ivp(now.rates, (t, until), y, events=events, **options)
                until = now.first_beyond(found, level)
            t, y = float(found.t[-1]), found.y[:, -1]
            q, v, totals = y[: now.n], y[now.n : 2 * now.n], y[2 * now.n :].reshape(2, P)
            hit = [index for index, at in zip(now.indices, found.t_events, strict=True) if at.size]
            began = bool(hit)
            if hit or t >= end:
                # with few modes a force may pull just after a touch: an impulse takes a state's sum if it presses
                pressed = np.maximum(totals[0] - before[0], 0.0)
                totals[0] = before[0] + np.where(now.pulls, totals[0] - before[0], pressed)
            if not hit:
                continue
            index = hit[0]
        times.append(t)
        indices.append(index)
        after = state.toggled(index)
        if index >= 0:
            loads, rates = loads_at(joint, t, ends_of(knots, t))
            passage = joint.passage(ContactState(state.closed), ContactState(after.closed))
            q = passage.S @ q + passage.residual[0] + loads @ passage.residual[1:]
            v = passage.S @ v + rates @ passage.residual[1:]
        state, began = after, True
    sign = np.array([stop.sign for stop in joint.problem.stops])
    return Witnessed(np.array(times), tuple(indices), state, q, v, sign * totals[0], totals[1])


Draw = Callable[..., Problem]
"""Draws a random cantilever, with `halves` one whose parts are at its middle and its tip."""


@dataclass(frozen=True)
class Marched:
    """A march of a solver from the initial state in the coordinates of a witness, and what the witness says of it."""

    times: FloatArray
    indices: tuple[int, ...]
    state: ContactState
    q: FloatArray
    v: FloatArray
    history: History
    witness: Witnessed


def by_modes(seed: int, end: float, draw: Draw = damped_cantilever) -> Marched:
    """A random cantilever on three to six modes, by the analytic solver."""
    rng = np.random.default_rng(seed)
    problem, n = draw(rng), int(rng.integers(3, 7))
    joint = Joint(problem, n, n)
    start = started(joint)
    motion = analytic_march(joint, start, 0.0, end, depth=True)
    log = motion.log
    q, v = joint.in_modes(motion.end.state, motion.end.q, motion.end.v, log.end[-1])
    switched = log.stop >= 0
    indices = tuple(switch_of(joint.tables, row) for row in log.stop[switched].tolist())
    first = analytic_coordinates(problem, joint.modal(start.state).modes)
    witness, history = witnessed(joint, start.state, *first, end), analytic_history("", joint, log)
    return Marched(log.end[switched], indices, motion.end.state, q, v, history, witness)


def by_elements(seed: int, end: float, draw: Draw = damped_cantilever) -> Marched:
    """A random cantilever of two elements, by the FE solver; its stops are at their ends."""
    model = model_of(draw(np.random.default_rng(seed), halves=True), 2)
    state, P, mesh = initial_state(model), len(model.problem.stops), MeshForWitness(model)
    y = mesh_coordinates(model.assembly, model.system(state))
    motion = mesh_march(model, state, y, 0.0, end)
    switched = [piece for piece in motion.pieces if piece.switched >= 0]
    indices = tuple(it.switched if it.switched < P else ~model.damped[it.switched - P] for it in switched)
    witness = witnessed(mesh, state, *mesh.in_modes(state, y), end)  # type: ignore[arg-type]
    times, (q, v) = np.array([it.end for it in switched]), mesh.in_modes(motion.state, motion.y)
    return Marched(times, indices, motion.state, q, v, mesh_history("", model, [motion], end), witness)


def model_of(problem: Problem, elements: int) -> Model:
    """A problem on a mesh, by the exact method."""
    return Model(problem, Assembly(problem, mesh_nodes(problem, elements, None)), "exact", 1e-9, 1e-12)


class MeshForWitness:
    """All modes of a mesh with the springs of the closed stops; no mode is left out."""

    def __init__(self, model: Model) -> None:
        system, forces = model.undamped(ContactState()), model.problem.forces
        self.model, self.problem = model, model.problem
        self.harmonics = SimpleNamespace(omega=system.driven, theta=lambda t: system.driven * t + system.phase)
        moved = [] if forces.seen is None else [MOVED_STOPS]
        self.loaded = SimpleNamespace(positions=[None] * (system.driven.size + len(forces.sampled)) + moved)
        self.sizes = np.ones(1 + len(self.loaded.positions))

    def modal(self, state: ContactState) -> SimpleNamespace:
        """The modes of a set of closed stops, and the loads on them."""
        system, n, loads = self.model.undamped(state), self.model.assembly.free.size, self.sizes.size
        still = loads - 1 - system.driven.size
        n_stops = len(self.problem.stops)
        springs = [stop.stiffness * (stop.in_space and k in state) for k, stop in enumerate(self.problem.stops)]
        of_samples = [system.vectors.T @ self.model.assembly.load(it.shape) for it in self.problem.forces.sampled]
        moved = [-np.array(springs) @ system.stops] * (still - len(of_samples))
        return SimpleNamespace(
            size=n,
            at_stops=system.stops,
            force=np.stack([system.constant, *system.harmonic.T, *of_samples, *moved]),
            residual_at_stops=np.concatenate(
                [np.zeros((1, n_stops)), system.seen[system.place_of].T, np.zeros((still, n_stops))]
            ),
            modes=SimpleNamespace(
                omega=system.omega, shapes=lambda x: system.vectors.T @ self.model.assembly.shapes(x, 0).T
            ),
            residual=lambda x: np.zeros((loads, x.size)),
            damping_rate=system.damping_rate * (not self.model.drags),
        )

    def passage(self, old: ContactState, new: ContactState) -> SimpleNamespace:
        """The map between the modes of two sets of closed stops."""
        n = self.model.assembly.free.size
        return SimpleNamespace(S=self.model.transfer(old, new), residual=np.zeros((self.sizes.size, n)))

    def in_modes(self, state: ContactState, y: FloatArray) -> FloatArray:
        """(q, q') in the modes of all closed stops, from those of the springs that act, shape ``(2, n)``."""
        return np.asarray(y.reshape(2, -1) @ self.model.transfer(state, ContactState(state.closed)).T)


def pinned_bar(
    damping: float, may_pull: bool = False, *, EI: float = 1e12, force: float = -10.0, stiffness: float = 100.0
) -> Problem:
    """A bar on a pin whose tip moves as 1 kg under 10 m/s2, with a stop 2 m below: SDND108 of Code_Aster."""
    stop = Stop(x=1.0, side="bottom", gap=2.0, stiffness=stiffness, damping=damping, may_pull=may_pull)
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=EI, mass_per_length=3.0),
        supports=(Support(x=0.0, translational=math.inf),),
        stops=(stop,),
        point_loads=(StepLoad(x=1.0, force=force),) if force else (),
        initial=PolynomialShape(velocity=(0.0, -1.0)),
    )
