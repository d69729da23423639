r"""The semi-discrete beam in one contact state, in the coordinates of its own finite element modes.

    M u'' + C u' + K u = f0 + sum_h fh sin(Omega_h t + phase_h)

with the springs of the closed stops in K and their k gap in f0.  The modes of one mesh span all of its degrees of
freedom, so nothing is lost between states: q_new = Phi_new^T M Phi_old q_old exactly.  Under modal damping every
mode of the state has its ratio; under viscous damping C = (C / m) M.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.linalg import cholesky, eigh, solve_triangular

from fe_lapjoint.assembly import Assembly
from lapjoint.contact import ContactState
from lapjoint.problem import FloatArray, ModalDamping, SineLoad, StepLoad, ViscousDamping

ComplexArray = npt.NDArray[np.complex128]
_SOFT = 1e-3  # of EI / m L^4: a lowest omega^2 below needs a shift to be solved for safely


@dataclass(frozen=True, eq=False)
class System:
    """One contact state with ``n`` modes, ``P`` stops and ``H`` harmonic loads."""

    state: ContactState
    omega: FloatArray
    """Natural angular frequencies, rad/s, shape ``(n,)``."""
    vectors: FloatArray
    """Mass-normalised modes as columns over the free degrees of freedom, shape ``(n, n)``."""
    decay: FloatArray
    """zeta omega of each mode, 1/s, shape ``(n,)``."""
    constant: FloatArray
    """Modal force of the closed stops' gaps and of the step loads, shape ``(n,)``."""
    harmonic: FloatArray
    """Modal amplitudes of the harmonic loads, shape ``(n, H)``."""
    driven: FloatArray
    """Their angular frequencies, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Their phases, rad, shape ``(H,)``."""
    stops: FloatArray
    """Rows that read z at the stops, shape ``(P, n)``."""

    @cached_property
    def oscillating(self) -> npt.NDArray[np.bool_]:
        """Modes damped well below critical, shape ``(n,)``."""
        return np.asarray(self.omega > self.decay * (1 + 1e-6))

    @cached_property
    def roots(self) -> ComplexArray:
        """-a + i sqrt(omega^2 - a^2) of the oscillating modes."""
        a, omega = self.decay[self.oscillating], self.omega[self.oscillating]
        return np.asarray(-a + 1j * np.sqrt(omega**2 - a**2))

    @cached_property
    def equilibrium(self) -> FloatArray:
        """Modal displacements under the constant forces; 0 for rigid-body modes, shape ``(n,)``."""
        rigid = self.omega == 0
        return np.where(rigid, 0.0, self.constant / np.where(rigid, 1.0, self.omega) ** 2)

    def rates(self, t: float, y: FloatArray) -> FloatArray:
        """d(q, q')/dt for ``y`` = (q, q') of shape ``(2 n,)``."""
        q, v = np.split(y, 2)
        force = self.constant + self.harmonic @ np.sin(self.driven * t + self.phase)
        return np.concatenate([v, force - 2 * self.decay * v - self.omega**2 * q])

    def jacobian(self, t: float, y: FloatArray) -> FloatArray:
        """Derivative of `rates` by y, shape ``(2 n, 2 n)``."""
        n = self.omega.size
        return np.block(
            [
                [np.zeros((n, n)), np.eye(n)],
                [-np.diag(self.omega**2), -2 * np.diag(self.decay)],
            ]
        )


def eigenmodes(assembly: Assembly, state: ContactState) -> tuple[FloatArray, FloatArray]:
    """All frequencies, ascending, and mass-normalised vectors of the mesh in a contact state.

    Two dense solutions are joined, because each is poor where the other is good: the inverted problem
    M v = mu (K + sigma M) v keeps the digits of the low modes, K v = omega^2 M v those of the high ones.  sigma is
    zero unless the beam can nearly move as a rigid body.  The joined basis is orthonormalised, so that a change of
    state loses nothing, and the frequencies are Rayleigh quotients.  Rigid-body modes are counted, not detected.
    """
    M, springs = assembly.mass, assembly.springs(state)
    vectors = _orthonormal(_joined(assembly, M, assembly.stiffness(state)), M)
    square = np.sum((assembly.curvature @ vectors) ** 2, axis=0) + springs @ vectors**2
    order = np.argsort(square, kind="stable")
    omega = np.sqrt(square[order])
    omega[: assembly.rigid_modes(state)] = 0.0
    return omega, np.ascontiguousarray(vectors[:, order])


def _joined(assembly: Assembly, M: FloatArray, K: FloatArray) -> FloatArray:
    """Low modes of the inverted problem beside high modes of the direct one, shape ``(n, n)``."""
    beam = assembly.problem.beam
    unit = beam.EI / (beam.m * beam.length**4)  # 1/s^2
    square, direct = eigh(K, M)
    sigma = 0.0 if square[0] > _SOFT * unit else unit
    c = 1 / np.sqrt(np.diag(K + sigma * M))
    low = c[:, None] * eigh(M * np.outer(c, c), (K + sigma * M) * np.outer(c, c))[1][:, ::-1]
    middle = np.sqrt(max(square[0] + sigma, unit) * max(square[-1], unit))
    split = int(np.count_nonzero(square < middle))
    return np.concatenate((low[:, :split], direct[:, split:]), axis=1)


def _orthonormal(V: FloatArray, M: FloatArray) -> FloatArray:
    """Gram-Schmidt in the mass inner product, first column first, by Cholesky factors, twice for full precision."""
    V = V / np.sqrt(np.sum(V * (M @ V), axis=0))
    for _ in range(2):
        V = solve_triangular(cholesky(V.T @ M @ V), V.T, trans="T").T
    return V


def build_system(assembly: Assembly, state: ContactState) -> System:
    """The modal form of a contact state on a mesh."""
    problem = assembly.problem
    omega, vectors = eigenmodes(assembly, state)
    sines = [load for load in problem.point_loads if isinstance(load, SineLoad)]
    steps = [load for load in problem.point_loads if isinstance(load, StepLoad)]
    base = problem.base_motion
    f0 = np.zeros(omega.size)
    for k in state.closed:
        stop = problem.stops[k]
        f0 += stop.sign * stop.stiffness * stop.gap * assembly.unit_force(stop.x)
    for step in steps:
        f0 += step.force * assembly.unit_force(step.x)
    columns = [load.force * assembly.unit_force(load.x) for load in sines]
    driven, phase = ([load.angular_frequency for load in sines], [load.phase for load in sines])
    if base is not None:
        acceleration = base.amplitude * base.angular_frequency**2
        columns.append(problem.beam.m * acceleration * assembly.uniform_load)
        driven.append(base.angular_frequency)
        phase.append(base.phase)
    rows = [assembly.unit_force(stop.x) for stop in problem.stops]
    return System(
        state=state,
        omega=omega,
        vectors=vectors,
        decay=_decay(assembly, omega),
        constant=vectors.T @ f0,
        harmonic=vectors.T @ np.array(columns).reshape(len(columns), omega.size).T,
        driven=np.array(driven),
        phase=np.array(phase),
        stops=np.array(rows).reshape(len(rows), omega.size) @ vectors,
    )


def _decay(assembly: Assembly, omega: FloatArray) -> FloatArray:
    damping = assembly.problem.damping
    if isinstance(damping, ModalDamping):
        return damping.ratios(omega.size) * omega
    coefficient = damping.coefficient if isinstance(damping, ViscousDamping) else 0.0
    return np.full(omega.size, coefficient / (2 * assembly.problem.beam.m))
