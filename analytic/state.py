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

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from analytic.modes import ExactModes, exact_modes
from analytic.residual import Loads, Residual, residual
from analytic.shapes import gram, integral
from lapjoint.contact import ContactState
from lapjoint.problem import BaseMotion, FloatArray, ModalDamping, Problem, SineLoad, StepLoad, ViscousDamping

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


def _loads_of(problem: Problem, state: ContactState, nodes: FloatArray) -> Loads:
    """Load 0 is constant; loads 1 ... H are the amplitudes of the harmonics."""
    base = problem.base_motion
    sines = [load for load in problem.point_loads if isinstance(load, SineLoad)]
    uniform = [0.0] + ([] if base is None else [problem.beam.m * base.amplitude * base.angular_frequency**2])
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
        forces[row, node(sine.x)] += sine.force
    return Loads(np.array(uniform + [0.0] * len(sines)), forces)


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


def damping_rates(problem: Problem, omega: FloatArray) -> FloatArray:
    """zeta_i omega_i of each mode, 1/s (34)."""
    damping = problem.damping
    if isinstance(damping, ModalDamping):
        return damping.ratios(omega.size) * omega
    rate = damping.coefficient / (2 * problem.beam.m) if isinstance(damping, ViscousDamping) else 0.0
    return np.full(omega.size, rate)


def build_state(problem: Problem, state: ContactState, count: int) -> StateModel:
    """The modal form of `problem` in `state` with `count` modes."""
    modes = exact_modes(problem, state, count)
    harmonics = harmonics_of(problem)
    loads = _loads_of(problem, state, modes.shapes.nodes)
    at_nodes = modes.shapes(modes.shapes.nodes)
    modal = loads.concentrated @ at_nodes.T + loads.uniform[:, None] * integral(modes.shapes)  # (27)
    shapes = residual(problem, state, modes, loads, modal)
    x_stops = np.array([stop.x for stop in problem.stops])
    decay = damping_rates(problem, modes.omega)
    omega = _away_from_resonance(modes.omega, decay, harmonics.omega)
    roots = _roots(omega, decay)
    denominator = omega**2 - harmonics.omega[:, None] ** 2 + 2j * decay * harmonics.omega[:, None]
    return StateModel(
        state=state,
        modes=modes,
        decay=decay,
        F0=modal[0],
        Fh=modal[1:],
        residual=shapes,
        at_stops=modes.shapes(x_stops).T,
        residual_at_stops=shapes(x_stops),
        roots=roots,
        static=_static_answer(modal[0], omega, decay),
        harmonic=modal[1:] / denominator,  # (28), (29) with the off-diagonal entries C* omega
    )


def _away_from_resonance(omega: FloatArray, decay: FloatArray, driven: FloatArray) -> FloatArray:
    """Move an undamped frequency that a load meets exactly by 1e-7 of itself; the secular growth stays."""
    result = omega.copy()
    for value in driven:
        hit = (decay < _SEPARATE * omega) & (np.abs(omega - value) < _SEPARATE * omega)
        result[hit] = value * (1 + _SEPARATE)
    return result


def _roots(omega: FloatArray, decay: FloatArray) -> np.ndarray:
    """Roots of the damped oscillator; a critically damped pair is kept 1e-7 apart (under the root: 1e-14)."""
    square = decay**2 - omega**2
    square = np.where((omega > 0) & (np.abs(square) < (_SEPARATE * omega) ** 2), -((_SEPARATE * omega) ** 2), square)
    split = np.sqrt(square.astype(complex))
    first = -decay + split
    # For strong damping the slow root is omega^2 over the fast one: no cancellation.
    slow = np.where(square > 0, -(omega**2) / np.where(decay + split.real == 0, 1, decay + split.real), first)
    return np.stack([slow, -decay - split], axis=1)


def _static_answer(F0: FloatArray, omega: FloatArray, decay: FloatArray) -> FloatArray:
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


@lru_cache(maxsize=256)
def _overlap(new: ExactModes, old: ExactModes) -> FloatArray:
    """Integrals of Phi_i_new Phi_j_old, shape ``(N_new, N_old)``; kept: they do not depend on the excitation."""
    return gram(new.shapes, old.shapes)


def build_passage(problem: Problem, old: StateModel, new: StateModel) -> Passage:
    """The map from `old` to `new` by closed-form inner products (43)."""
    m = problem.beam.m
    S = m * _overlap(new.modes, old.modes)
    onto = m * gram(old.residual.foundation, new.modes.shapes) - old.residual.weights @ S.T
    return Passage(S, onto)
