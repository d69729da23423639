"""The march from switch to switch (19)-(49): closed form between, certified events, impulses in closed form."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from analytic import kernel
from analytic.state import Passage, StateModel, build_passage, build_state, harmonics_of
from lapjoint.contact import ContactState
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray, Problem
from lapjoint.solution import Contact
from lapjoint.solver import Progress

_FRESH = 1e-9  # s: a stop that switched less than this ago must leave its gap before it can switch again


@dataclass(frozen=True)
class Compiled:
    """One state in the form the kernel takes."""

    model: StateModel
    kind: np.ndarray
    """How each mode moves freely, shape ``(N,)``, int64: OSCILLATING, SPLIT or DRIFTING."""
    stop_harmonic: np.ndarray
    """Complex amplitudes of the forced motion at the stops, residual included, shape ``(P, H)``."""
    stop_constant: FloatArray
    """Constant part of the residual at the stops, shape ``(P,)``."""
    closed: np.ndarray
    """Whether each stop is closed, shape ``(P,)``."""


@dataclass(frozen=True)
class Segment:
    """The motion in one state, from one switch to the next."""

    state: ContactState
    start: float
    end: float
    q: FloatArray
    """Modal displacements at the start, shape ``(N,)``."""
    v: FloatArray
    """Modal velocities at the start, shape ``(N,)``."""
    switched: int
    """The stop that switches at the end, or `kernel.NO_SWITCH`."""
    rate: float
    """h' of that stop at the end, m/s."""


@dataclass
class Joint:
    """A problem with numbers of modes; states and passages are built when first needed, and kept."""

    problem: Problem
    counts: dict[ContactState, int]
    default_count: int
    _states: dict[ContactState, Compiled] = field(default_factory=dict)
    _passages: dict[tuple[ContactState, ContactState], Passage] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.harmonics = harmonics_of(self.problem)
        self.sign = np.array([stop.sign for stop in self.problem.stops], dtype=float)
        self.gap = np.array([stop.gap for stop in self.problem.stops], dtype=float)
        self.stiffness = np.array([stop.stiffness for stop in self.problem.stops], dtype=float)

    def state(self, state: ContactState) -> Compiled:
        """One contact state."""
        if state not in self._states:
            model = build_state(self.problem, state, self.counts.get(state, self.default_count))
            self._states[state] = _compiled(model, len(self.problem.stops))
        return self._states[state]

    def passage(self, old: ContactState, new: ContactState) -> Passage:
        """The map from one state to another."""
        if (old, new) not in self._passages:
            self._passages[old, new] = build_passage(self.problem, self.state(old).model, self.state(new).model)
        return self._passages[old, new]

    def carry(
        self, old: ContactState, new: ContactState, t: float, q: FloatArray, v: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Displacement (36) and velocity (41) in the coordinates of the next state."""
        passage, theta = self.passage(old, new), self.harmonics.theta(t)
        q_new = passage.S @ q + passage.residual[0] + np.sin(theta) @ passage.residual[1:]
        v_new = passage.S @ v + (self.harmonics.omega * np.cos(theta)) @ passage.residual[1:]
        return q_new, v_new


def _compiled(model: StateModel, stops: int) -> Compiled:
    oscillating = model.roots[:, 0].imag > 0
    drifting = (model.roots == 0).all(axis=1)
    kind = np.where(oscillating, kernel.OSCILLATING, np.where(drifting, kernel.DRIFTING, kernel.SPLIT))
    return Compiled(
        model=model,
        kind=kind.astype(np.int64),
        stop_harmonic=np.ascontiguousarray(model.at_stops @ model.harmonic.T + model.residual_at_stops[1:].T),
        stop_constant=np.ascontiguousarray(model.residual_at_stops[0]),
        closed=np.array([k in model.state for k in range(stops)], dtype=np.bool_),
    )


@dataclass(frozen=True)
class Follow:
    """One state followed from given modal coordinates to its first switch."""

    segment: Segment
    q: FloatArray
    v: FloatArray
    penetration: FloatArray
    """Time integral of the penetration of each closed stop, m s, shape ``(P,)``."""
    deepest: FloatArray
    """Deepest penetration of each closed stop, m, shape ``(P,)``."""


def follow(
    joint: Joint, state: ContactState, t: float, q: FloatArray, v: FloatArray, end: float, fresh: np.ndarray
) -> Follow:
    """Follow `state` from time `t` to its first switch, or to `end`."""
    it = joint.state(state)
    model, theta, omega = it.model, joint.harmonics.theta(t), joint.harmonics.omega
    c, poly = kernel.amplitudes(q, v, theta, omega, it.kind, model.roots, model.static, model.harmonic)
    exponents, coefficients, polynomials = kernel.gap_functions(
        c,
        poly,
        theta,
        omega,
        it.kind,
        model.roots,
        model.at_stops,
        it.stop_harmonic,
        it.stop_constant,
        joint.sign,
        joint.gap,
        it.closed,
    )
    s, which, deepest, _ = kernel.first_switch(exponents, coefficients, polynomials, it.closed, fresh, end - t)
    if which == kernel.STUCK:
        raise SolverError(f"the march makes no progress at t = {t + s:.12g} s in state {state.closed}")
    q_end, v_end = kernel.state_at(s, c, poly, theta, omega, it.kind, model.roots, model.harmonic)
    rate = 0.0
    if which >= 0:
        rate = kernel._evaluate(s, which, exponents, coefficients, polynomials)[1]
    integral = -kernel.gap_integrals(s, exponents, coefficients, polynomials)
    segment = Segment(state, t, end if which < 0 else t + s, q, v, which, rate)
    deepest = np.where(it.closed, deepest, 0.0)
    return Follow(segment, q_end, v_end, np.where(it.closed, np.maximum(integral, 0.0), 0.0), deepest)


@dataclass(frozen=True)
class March:
    """A motion as segments and contacts, and the modal coordinates at its end."""

    segments: tuple[Segment, ...]
    contacts: tuple[Contact, ...]
    state: ContactState
    q: FloatArray
    v: FloatArray


@dataclass
class _OpenContact:
    start: float
    open_start: bool
    penetration: float = 0.0
    deepest: float = 0.0


def march(
    joint: Joint,
    state: ContactState,
    start: float,
    q: FloatArray,
    v: FloatArray,
    end: float,
    *,
    progress: Progress | None = None,
    max_switches: int = 1_000_000,
) -> March:
    """March from `start` to `end`.

    Raises
    ------
    SolverError
        If more than `max_switches` switches occur.
    """
    stops = len(joint.problem.stops)
    segments: list[Segment] = []
    contacts: list[Contact] = []
    going = {k: _OpenContact(start, open_start=True) for k in state.closed}
    last_switch = np.full(stops, -np.inf)
    last_switch[:] = start  # at the start a stop that just touches counts as fresh
    t = start
    while True:
        step = follow(joint, state, t, q, v, end, (t - last_switch) < _FRESH)
        segments.append(step.segment)
        for k, contact in going.items():
            contact.penetration += float(step.penetration[k])
            contact.deepest = max(contact.deepest, float(step.deepest[k]))
        q, v, t, which = step.q, step.v, step.segment.end, step.segment.switched
        if which < 0:
            break
        if len(segments) > max_switches:
            raise SolverError(f"more than {max_switches} switches before t = {t:.6g} s")
        if which in state:
            contacts.append(_finished(joint, which, going.pop(which), t, open_end=False))
        else:
            going[which] = _OpenContact(t, open_start=False)
        following = state.toggled(which)
        q, v = joint.carry(state, following, t, q, v)
        state = following
        last_switch[which] = t
        if progress is not None and len(segments) % 64 == 0:
            progress(t - start, end - start)
    contacts += [_finished(joint, k, contact, end, open_end=True) for k, contact in going.items()]
    contacts.sort(key=lambda contact: (contact.start, contact.stop))
    return March(tuple(segments), tuple(contacts), state, q, v)


def _finished(joint: Joint, k: int, contact: _OpenContact, end: float, *, open_end: bool) -> Contact:
    stiffness = float(joint.stiffness[k])
    return Contact(
        stop=k,
        start=contact.start,
        end=end,
        impulse=float(joint.sign[k]) * stiffness * contact.penetration,
        peak_force=stiffness * contact.deepest,
        open_start=contact.open_start,
        open_end=open_end,
    )
