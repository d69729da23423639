r"""The quasi-static response of the modes left out of a state, in closed form.

With N modes, the part of the displacement outside their span has to go somewhere.  The published scheme keeps it
in G(x) of (20), where it is never moved again.  Here it follows its own equilibrium at once:

    z(x, t) = sum_{i <= N} Phi_i q_i(t) + sum_l f_l(t) r_l(x),    r_l = sum_{i > N} Phi_i (Phi_i, p_l) / omega_i^2

for each load p_l (base inertia, point loads, the constant forces k gap of the closed stops).  The sum over the
infinitely many i > N is taken in closed form as a difference,

    r_l = u_l - sum_{i <= N} Phi_i (Phi_i, p_l) / (omega_i^2 + sigma),    (K + sigma M) u_l = p_l

where K is the stiffness of beam and springs, and M all their mass: u_l is the deflection of the beam on a weak elastic
foundation m sigma, with a further spring sigma M at each mass M, and sigma J where it has a rotary inertia J.  The
foundation makes u_l exist for beams with rigid-body modes too.  It changes each left-out term by the fraction sigma /
omega_i^2, which is below (2 / (N pi))^4 for the sigma used, on a uniform beam.  On a span with the load p_l per unit
length, u_l is the constant p_l / (sigma m), and a solution of the beam equation on the foundation without load.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import solve_banded

from analytic.modes.beam_functions import TERMS, BeamFunctions, Inertia, gram, integrals
from analytic.modes.boundary_conditions import (
    BAND,
    Solutions,
    boundary_band,
    continuity_row,
    force_row,
    foundation_solutions,
    spaces_of,
)
from analytic.modes.characteristic_equation import Layout, layout_of
from analytic.modes.coupled_beams import CoupledBeams
from analytic.modes.normal_modes import NormalModes
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem

_FOUNDATION = 1.0  # gamma L of the foundation, without unit: waves as long as the beam are well conditioned


@dataclass(frozen=True)
class Loads:
    """Load shapes: a force per unit length that is constant on each span, plus concentrated forces at the nodes."""

    distributed: FloatArray
    """Force per unit length, N/m, shape ``(loads, spans)``."""
    concentrated: FloatArray
    """Forces at the nodes, N, shape ``(loads, nodes)``."""

    def modal(self, modes: BeamFunctions) -> FloatArray:
        """(Phi_i, p_l) (27), the unit of the loads over kg^1/2, ``(loads, modes)``."""
        return np.asarray(self.concentrated @ modes(modes.nodes).T + self.distributed @ integrals(modes).T)


@dataclass(frozen=True)
class Foundation:
    """The shapes u_l: solutions of the beam equation without load, and a constant on each span."""

    solutions: BeamFunctions
    """Shape ``(loads,)``."""
    constants: BeamFunctions
    """Shape ``(loads,)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """u_l or an x-derivative at ``x``, m, shape ``(k,)``; gives ``(loads, k)``."""
        return self.solutions(x, derivative) + self.constants(x, derivative)

    def scaled(self, factors: FloatArray) -> Foundation:
        """Each shape times the size of its load, shape ``(loads,)``."""
        return Foundation(self.solutions.scaled(factors), self.constants.scaled(factors))

    def products(self, modes: BeamFunctions, inertia: Inertia) -> FloatArray:
        """Inner products with modes, kg^1/2 m for each unit of load, ``(loads, modes)``."""
        return gram(self.solutions, modes, inertia) + gram(self.constants, modes, inertia)


@dataclass(frozen=True)
class Residual:
    """The shapes r_l as a combination of foundation shapes and modes."""

    foundation: Foundation
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
    beam = problem.line
    longest = max(it.length for it in beam.beams)
    sigma = 4 * (_FOUNDATION / longest) ** 4 * beam.EI / beam.m
    foundation = _foundation_shapes(problem, state, loads, sigma)
    return Residual(foundation, modes.shapes, modal / (modes.omega**2 + sigma))


def _foundation_shapes(problem: Problem, state: ContactState, loads: Loads, sigma: float) -> Foundation:
    """Deflections under each load of the beam on springs, with a further stiffness of `sigma`, 1/s2, times its mass."""
    layout, L, EI = layout_of(problem, state.closed), problem.line.length, problem.line.EI
    longest = max(it.length for it in problem.line.beams)
    solutions = foundation_solutions(layout, _FOUNDATION * (L / longest))
    n, spans = loads.distributed.shape[0], layout.spans.size
    band, (factors,) = boundary_band(layout, solutions)
    mass = np.where(layout.span_masses > 0, layout.span_masses, 1.0)
    constant = loads.distributed / (sigma * problem.line.m * mass)
    right_hand = np.zeros((4 * spans, n))
    for node in range(layout.x.size):
        row, own = force_row(layout, node), constant[:, node if layout.has_span(node) else node - 1]
        if layout.has_span(node - 1) and layout.has_span(node):
            right_hand[continuity_row(node)] = (constant[:, node - 1] - own) * factors[0, node]
        kappa, _ = layout.springs(node, solutions.fourth)
        if np.isinf(kappa).all():
            right_hand[row] = -own * factors[2, node]
        else:
            # EI (u'''(+) - u'''(-)) + (k + sigma M) u = P, in units of EI / L^3
            right_hand[row] = (loads.concentrated[:, node] * L**3 / EI - kappa * own) * factors[1, node]
    if layout.several:
        amplitudes = _coupled(layout, solutions, constant, right_hand).reshape(n, spans, 4)
    else:
        amplitudes = solve_banded((BAND, BAND), band[0], right_hand).T.reshape(n, spans, 4)
    return Foundation(solutions.functions(layout, amplitudes, L, free=False), _constants(layout, constant, L))


def _coupled(layout: Layout, solutions: Solutions, constant: FloatArray, right_hand: FloatArray) -> FloatArray:
    """Amplitudes of several beams, ``(n, 4 S)``, with their couplings, whose motions have the part `constant`,
    ``(n, S)``, beside the solutions; `right_hand`, ``(4 S, n)``, is that of the beams alone."""
    (matrix,), _, (balances,) = CoupledBeams(layout).bordered(solutions)
    waves, n = right_hand.shape
    every = np.concatenate([right_hand, np.zeros((len(layout.couplings), n))])
    for i, it in enumerate(layout.couplings):
        if it.derivative == 0:
            first, second = (node if layout.has_span(node) else node - 1 for node in (it.first, it.second))
            every[waves + i] = -balances[i] * (constant[:, second] - constant[:, first])
    found = np.linalg.solve(matrix, every)
    left = every - matrix.astype(np.longdouble) @ found
    found += np.linalg.solve(matrix, left.astype(float))  # takes out what elimination loses beside stiff springs
    return np.asarray(found[:waves].T)


def _constants(layout: Layout, values: FloatArray, length: float) -> BeamFunctions:
    """Functions that are constant on each span, ``(n, S)``."""
    n, spans = values.shape
    p = np.zeros((n, spans, TERMS))
    p[:, :, 0] = values
    none, places = np.zeros((n, spans, 0), dtype=complex), np.flatnonzero(layout.mass + layout.rotary)
    at_masses = np.zeros((n, 2, places.size))
    beside = [node if layout.has_span(node) else node - 1 for node in places.tolist()]
    at_masses[:, 0] = values[:, np.array(beside, dtype=int)]  # right of a node, where there is a span
    return BeamFunctions(layout.x * length, none, np.zeros(0, dtype=bool), none, p, at_masses, spaces_of(layout))
