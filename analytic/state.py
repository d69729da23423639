r"""Everything the march needs to know of one contact state, and of the passage between two.

In a state with modes Phi_i, i <= N, and the loads p_l of `analytic.residual`, equation (26) reads

    q_i'' + 2 zeta_i omega_i q_i' + omega_i^2 q_i = F0_i + sum_h Fh_i sin(theta_h(t))

with theta_h = Omega_h t + phase_h, in coordinates q_i = (Phi_i, z) of the whole displacement, where F0 holds
the forces k gap of the closed stops and the step loads.  The paper's eta_i of (20) is q_i(t) - q_i(T), measured
from the deflected shape G at the last switch; both give the same motion within the span of the modes, and (40)
holds by construction.

At a switch displacement and velocity are carried over (36), (41) by closed-form inner products (43)-(44):

    q_new = S q_old + S0 + sum_h Sh sin(theta_h),    S_ij = integral of m Phi_i_new Phi_j_old
    v_new = S v_old + sum_h Sh Omega_h cos(theta_h)

where S0 and Sh carry the residual shapes of the old state.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from analytic.modes import ExactModes, exact_modes, pool_size
from analytic.residual import Loads, Residual, residual
from analytic.shapes import gram, integral
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import (
    AtRest,
    BaseMotion,
    FloatArray,
    ModalDamping,
    Problem,
    SineLoad,
    StepLoad,
    ViscousDamping,
)

OSCILLATING, SPLIT, DRIFTING = 0, 1, 2  # complex pair of roots; two real ones; free rigid body
_SEPARATE = 1e-7  # relative distance kept between coincident poles; the motion changes by its square


@dataclass(frozen=True)
class Harmonics:
    """Frequencies and phases of the harmonic loads."""

    omega: FloatArray
    """Angular frequencies, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases, rad, shape ``(H,)``."""

    def theta(self, t: float) -> FloatArray:
        """Phase angles at time `t`, shape ``(H,)``."""
        return self.omega * t + self.phase


def harmonics_of(problem: Problem) -> Harmonics:
    """The base motion first (if any), then the sine loads."""
    parts: list[BaseMotion | SineLoad] = [] if problem.base_motion is None else [problem.base_motion]
    parts += [load for load in problem.point_loads if isinstance(load, SineLoad)]
    return Harmonics(np.array([part.angular_frequency for part in parts]), np.array([part.phase for part in parts]))


def load_sizes(problem: Problem) -> FloatArray:
    """Factors of the unit loads: 1 for the constant one, then the amplitudes of the harmonics, ``(1 + H,)``."""
    base = problem.base_motion
    inertia = [] if base is None else [problem.beam.m * base.amplitude * base.angular_frequency**2]
    return np.array([1.0, *inertia, *(load.force for load in problem.point_loads if isinstance(load, SineLoad))])


def _unit_loads(problem: Problem, state: ContactState, nodes: FloatArray) -> Loads:
    """Load 0 is constant; loads 1 ... H are those of the harmonics with an amplitude of 1 N/m or 1 N."""
    sines = [load for load in problem.point_loads if isinstance(load, SineLoad)]
    uniform = [0.0] + ([] if problem.base_motion is None else [1.0])
    forces = np.zeros((len(uniform) + len(sines), nodes.size))

    def node(x: float) -> int:
        return int(np.searchsorted(nodes, x))

    for i in state.closed:
        stop = problem.stops[i]
        forces[0, node(stop.x)] += stop.sign * stop.stiffness * stop.gap
    for load in problem.point_loads:
        if isinstance(load, StepLoad):
            forces[0, node(load.x)] += load.force
    for row, sine in enumerate(sines, start=len(uniform)):
        forces[row, node(sine.x)] += 1.0
    return Loads(np.array(uniform + [0.0] * len(sines)), forces)


@dataclass(frozen=True)
class UnitState:
    """What a contact state holds apart from the size and the frequency of the excitation."""

    modes: ExactModes
    decay: FloatArray
    """Half the damping rate, zeta_i omega_i, 1/s, shape ``(N,)``."""
    modal: FloatArray
    """(Phi_i, p_l) of the unit loads, shape ``(1 + H, N)``."""
    residual: Residual
    at_stops: FloatArray
    """Modes at the stops, shape ``(P, N)``."""
    foundation_at_stops: FloatArray
    """The foundation shapes of `residual` at the stops, shape ``(1 + H, P)``."""

    @property
    def size(self) -> int:
        """Number of modes N."""
        return self.decay.size

    @property
    def residual_at_stops(self) -> FloatArray:
        """Residual shapes at the stops, shape ``(1 + H, P)``."""
        return np.asarray(self.foundation_at_stops - self.residual.weights @ self.at_stops.T)

    def head(self, count: int) -> UnitState:
        """The same state with its lowest `count` modes."""
        modes, left = self.modes.head(count), self.residual.weights[:, :count]
        return UnitState(
            modes,
            self.decay[:count],
            self.modal[:, :count],
            Residual(self.residual.foundation, modes.shapes, left),
            self.at_stops[:, :count],
            self.foundation_at_stops,
        )


@dataclass(frozen=True, eq=False)
class Family:
    """All problems that differ in the size and the frequency of the excitation only: their states are kept."""

    problem: Problem
    _states: dict[tuple[ContactState, int], UnitState] = field(default_factory=dict)
    _passages: dict[tuple[ContactState, int, ContactState, int], Passage] = field(default_factory=dict)

    def state(self, state: ContactState, count: int) -> UnitState:
        """A contact state with `count` modes."""
        return self._pool(state, pool_size(count)).head(count)

    def passage(self, old: ContactState, n_old: int, new: ContactState, n_new: int) -> Passage:
        """The map between two states, for unit loads (43)."""
        before, m = self._pool(old, pool_size(n_old)), self.problem.beam.m
        key = (old, before.size, new, pool_size(n_new))
        if key not in self._passages:
            after = self._pool(new, pool_size(n_new)).modes.shapes
            products = m * gram(after, before.modes.shapes), m * gram(before.residual.foundation, after)
            self._passages[key] = Passage(*products)
        S = self._passages[key].S[:n_new, :n_old]
        onto = self._passages[key].residual[:, :n_new] - before.residual.weights[:, :n_old] @ S.T
        return Passage(S, onto)

    def _pool(self, state: ContactState, size: int) -> UnitState:
        if (state, size) not in self._states:
            self._states[state, size] = _unit_state(self.problem, state, size)
        return self._states[state, size]


def family_of(problem: Problem) -> Family:
    """The family of a problem; the last ones are kept."""
    sines = tuple(
        load.model_copy(update={"force": 1.0, "angular_frequency": 1.0, "phase": 0.0})
        if isinstance(load, SineLoad)
        else load
        for load in problem.point_loads
    )
    base = None if problem.base_motion is None else BaseMotion(amplitude=1.0, angular_frequency=1.0)
    unit = {"title": "", "base_motion": base, "point_loads": sines, "initial": AtRest()}
    return _family(problem.model_copy(update=unit))


@lru_cache(maxsize=16)
def _family(problem: Problem) -> Family:
    return Family(problem)


def _unit_state(problem: Problem, state: ContactState, count: int) -> UnitState:
    modes = exact_modes(problem, state, count)
    loads = _unit_loads(problem, state, modes.shapes.nodes)
    at_nodes = modes.shapes(modes.shapes.nodes)
    modal = loads.concentrated @ at_nodes.T + loads.uniform[:, None] * integral(modes.shapes)  # (27)
    shapes = residual(problem, state, modes, loads, modal)
    x_stops = np.array([stop.x for stop in problem.stops])
    return UnitState(
        modes=modes,
        decay=damping_rates(problem, modes.omega),
        modal=modal,
        residual=shapes,
        at_stops=modes.shapes(x_stops).T,
        foundation_at_stops=shapes.foundation(x_stops),
    )


@dataclass(frozen=True)
class StateModel:
    """One contact state in modal form, with ``N`` modes, ``P`` stops and ``H`` harmonics."""

    state: ContactState
    modes: ExactModes
    decay: FloatArray
    """Half the damping rate, zeta_i omega_i, 1/s, shape ``(N,)``."""
    F0: FloatArray
    """Constant modal force, shape ``(N,)``."""
    Fh: FloatArray
    """Modal force amplitudes of the harmonics, shape ``(H, N)``."""
    residual: Residual
    at_stops: FloatArray
    """Modes at the stops, shape ``(P, N)``."""
    residual_at_stops: FloatArray
    """Residual shapes at the stops, constant load first, shape ``(1 + H, P)``."""
    roots: np.ndarray
    """The two roots lambda of lambda^2 + 2 zeta omega lambda + omega^2, shape ``(N, 2)``, complex."""
    static: FloatArray
    """Coefficients of 1, t, t^2 of the answer to F0, shape ``(N, 3)``."""
    harmonic: np.ndarray
    """Complex amplitudes P with q_i = Im(P exp(i theta)), shape ``(H, N)``."""

    @property
    def size(self) -> int:
        """Number of modes N."""
        return self.decay.size

    @property
    def kind(self) -> np.ndarray:
        """How each mode moves freely, shape ``(N,)``; see `kinds_of`."""
        return kinds_of(self.modes.omega, self.decay)


def damping_rates(problem: Problem, omega: FloatArray) -> FloatArray:
    """zeta_i omega_i of each mode, 1/s (34)."""
    damping = problem.damping
    if isinstance(damping, ModalDamping):
        return damping.ratios(omega.size) * omega
    rate = damping.coefficient / (2 * problem.beam.m) if isinstance(damping, ViscousDamping) else 0.0
    return np.full(omega.size, rate)


def build_state(problem: Problem, family: Family, state: ContactState, count: int) -> StateModel:
    """The modal form of `problem`, of the given family, in `state` with `count` modes."""
    unit, sizes, driven = family.state(state, count), load_sizes(problem), harmonics_of(problem).omega
    modal = unit.modal * sizes[:, None]
    omega = away_from_resonance(unit.modes.omega, unit.decay, driven)
    return StateModel(
        state=state,
        modes=unit.modes,
        decay=unit.decay,
        F0=modal[0],
        Fh=modal[1:],
        residual=unit.residual.scaled(sizes),
        at_stops=unit.at_stops,
        residual_at_stops=unit.residual_at_stops * sizes[:, None],
        roots=roots_of(omega, unit.decay),
        static=static_answer(modal[0], omega, unit.decay),
        harmonic=forced_answer(modal[1:], omega, unit.decay, driven),
    )


def forced_answer(force: FloatArray, omega: FloatArray, decay: FloatArray, driven: FloatArray) -> np.ndarray:
    """Complex amplitudes of the answer to the harmonics (28), (29), with the off-diagonal entries C* omega of (29).

    ``force`` is ``(..., H, N)``, ``omega`` and ``decay`` are ``(..., N)``, ``driven`` is ``(H,)``.
    """
    Omega = driven[:, None]
    return np.asarray(force / (omega[..., None, :] ** 2 - Omega**2 + 2j * decay[..., None, :] * Omega))


def away_from_resonance(omega: FloatArray, decay: FloatArray, driven: FloatArray) -> FloatArray:
    """Move an undamped frequency that a load meets exactly by 1e-7 of itself; the secular growth stays."""
    result = omega.copy()
    for value in driven:
        hit = (decay < _SEPARATE * omega) & (np.abs(omega - value) < _SEPARATE * omega)
        result[hit] = value * (1 + _SEPARATE)
    return result


def roots_of(omega: FloatArray, decay: FloatArray) -> np.ndarray:
    """Roots of the damped oscillator; a critically damped pair is kept 1e-7 apart (under the root: 1e-14)."""
    square = decay**2 - omega**2
    square = np.where((omega > 0) & (np.abs(square) < (_SEPARATE * omega) ** 2), -((_SEPARATE * omega) ** 2), square)
    split = np.sqrt(square.astype(complex))
    first = -decay + split
    # For strong damping the slow root is omega^2 over the fast one: no cancellation.
    slow = np.where(square > 0, -(omega**2) / np.where(decay + split.real == 0, 1, decay + split.real), first)
    return np.stack([slow, -decay - split], axis=1)


def kinds_of(omega: FloatArray, decay: FloatArray) -> np.ndarray:
    """OSCILLATING, SPLIT or DRIFTING for each mode, int64."""
    roots = roots_of(omega, decay)
    drifting = (roots == 0).all(axis=1)
    return np.where(roots[:, 0].imag > 0, OSCILLATING, np.where(drifting, DRIFTING, SPLIT))


def static_answer(F0: FloatArray, omega: FloatArray, decay: FloatArray) -> FloatArray:
    """Particular solution for a constant force (31); a rigid-body mode drifts, F0 t/(2 decay), or F0 t^2/2."""
    answer = np.zeros((F0.size, 3))
    rigid = omega == 0
    answer[~rigid, 0] = F0[~rigid] / omega[~rigid] ** 2
    dragged = rigid & (decay > 0)
    answer[dragged, 1] = F0[dragged] / (2 * decay[dragged])
    free = rigid & (decay == 0)
    answer[free, 2] = F0[free] / 2
    return answer


@dataclass(frozen=True)
class Passage:
    """The map from one state to the next at a switch."""

    S: FloatArray
    """Shape ``(N_new, N_old)``."""
    residual: FloatArray
    """S0 first, then Sh, shape ``(1 + H, N_new)``."""


def build_passage(problem: Problem, family: Family, old: StateModel, new: StateModel) -> Passage:
    """The map from `old` to `new` by closed-form inner products (43)."""
    unit = family.passage(old.state, old.size, new.state, new.size)
    return Passage(unit.S, unit.residual * load_sizes(problem)[:, None])
