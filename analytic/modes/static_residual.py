r"""The quasi-static response of the modes left out of a state, in closed form.

With N modes, the part of the displacement outside their span has to go somewhere.  The published scheme keeps it
in G(x) of (20), where it is never moved again.  Here it follows its own equilibrium at once:

    z(x, t) = sum_{i <= N} Phi_i q_i(t) + sum_l f_l(t) r_l(x),    r_l = sum_{i > N} Phi_i (Phi_i, p_l) / omega_i^2

for each load p_l (base inertia, point loads, the constant forces k gap of the closed stops).  The sum over the
infinitely many i > N is taken in closed form as a difference,

    r_l = u_l - sum_{i <= N} Phi_i (Phi_i, p_l) / (omega_i^2 + sigma),    EI u_l'''' + m sigma u_l + springs = p_l

where u_l is the deflection of the beam on a weak elastic foundation m sigma.  The foundation makes u_l exist for
beams with rigid-body modes too.  It changes each left-out term by the fraction sigma / omega_i^2, which is below
(2 / (N pi))^4 for the sigma used.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from analytic.modes.beam_functions import BeamFunctions
from analytic.modes.boundary_conditions import BAND, boundary_band, force_row, foundation_waves
from analytic.modes.characteristic_equation import layout_of
from analytic.modes.normal_modes import NormalModes
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem

_FOUNDATION = 1.0  # gamma L of the foundation, without unit: waves as long as the beam are well conditioned


@dataclass(frozen=True)
class Loads:
    """Load shapes: a uniform force per unit length plus concentrated forces at the nodes."""

    uniform: FloatArray
    """Force per unit length, N/m, shape ``(loads,)``."""
    concentrated: FloatArray
    """Forces at the nodes, N, shape ``(loads, nodes)``."""


@dataclass(frozen=True)
class Residual:
    """The shapes r_l as a combination of foundation shapes and modes."""

    foundation: BeamFunctions
    """u_l, shape ``(loads,)``."""
    modes: BeamFunctions
    """The modes that are not left out."""
    weights: FloatArray
    """Modal content of u_l that is taken out, shape ``(loads, modes)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """r_l or an x-derivative at ``x``, m, shape ``(k,)``; gives ``(loads, k)``."""
        return self.foundation(x, derivative) - self.weights @ self.modes(x, derivative)

    def scaled(self, factors: FloatArray) -> Residual:
        """Each shape times the size of its load, shape ``(loads,)``."""
        return Residual(self.foundation.scaled(factors), self.modes, self.weights * factors[:, None])


def residual(problem: Problem, state: ContactState, modes: NormalModes, loads: Loads, modal: FloatArray) -> Residual:
    """The residual shape, m, of each load p_l in a state; `modal`, ``(loads, modes)``, is (Phi_i, p_l), kg^-1/2 N."""
    beam = problem.beam
    sigma = 4 * (_FOUNDATION / beam.length) ** 4 * beam.EI / beam.m
    foundation = _foundation_shapes(problem, state, loads, beam.m * sigma)
    return Residual(foundation, modes.shapes, modal / (modes.omega**2 + sigma))


def _foundation_shapes(problem: Problem, state: ContactState, loads: Loads, stiffness: float) -> BeamFunctions:
    """Deflections under each load of the beam on springs and a foundation of `stiffness`, N/m2."""
    layout, L, EI = layout_of(problem, state.closed), problem.beam.length, problem.beam.EI
    waves, n, spans = foundation_waves(np.array([_FOUNDATION])), loads.uniform.size, layout.spans.size
    band = boundary_band(layout, waves)[0]
    particular = loads.uniform / stiffness  # the same constant on every span: it satisfies continuity
    right_hand = np.zeros((4 * spans, n))
    scale = _FOUNDATION**3
    for node in range(layout.x.size):
        row, k = force_row(layout, node), layout.translational[node]
        if np.isinf(k):
            right_hand[row] = -particular
        else:
            # EI (u'''(+) - u'''(-)) + k u = P, in units of scale (1 + k / scale) EI / L^3
            force = loads.concentrated[:, node] * L**3 / EI
            right_hand[row] = (force - k * particular) / scale / (1 + k / scale)
    amplitudes = solve_banded((BAND, BAND), band, right_hand).T.reshape(n, spans, 4)
    repeated = foundation_waves(np.full(n, _FOUNDATION))
    shapes = repeated.functions(layout.x * L, amplitudes, L)
    constant = np.zeros((n, spans, 2))
    constant[:, :, 0] = particular[:, None]
    return BeamFunctions(shapes.nodes, shapes.mu, shapes.right, shapes.c, constant)
