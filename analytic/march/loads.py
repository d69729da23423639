"""The loads of a problem: harmonic ones with their sizes, frequencies and phases, and a constant one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.modes.static_residual import Loads
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem

Positions = tuple[float | None, ...]
"""Where each load that is not constant acts: a position, m, or None for one that is uniform along the beam."""


@dataclass(frozen=True)
class Harmonics:
    """Frequencies and phases of the harmonic loads."""

    omega: FloatArray
    """Angular frequencies, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases, rad, shape ``(H,)``."""

    @staticmethod
    def of_unit_frequency(count: int) -> Harmonics:
        """Some harmonics of 1 rad/s and without phase, which stand for harmonics given later."""
        return Harmonics(np.ones(count), np.zeros(count))

    def theta(self, t: float) -> FloatArray:
        """Phase angles, rad, at the time `t`, s, shape ``(H,)``."""
        return self.omega * t + self.phase


def harmonics_of(problem: Problem) -> Harmonics:
    """The harmonic loads of a problem, in the order of its forces."""
    forces = problem.forces.harmonic
    return Harmonics(np.array([force.angular_frequency for force in forces]), np.array([it.phase for it in forces]))


def load_sizes(problem: Problem) -> FloatArray:
    """Factors of the unit loads, shape ``(1 + H + R,)``: 1 for the constant load, the amplitudes of the harmonics, then
    1.

    Amplitudes are in N/m for uniform loads and in N for loads at points; the samples of sampled loads have a unit
    themselves.
    """
    forces = problem.forces
    return np.array([1.0, *(force.amplitude for force in forces.harmonic), *(1.0 for _ in forces.sampled)])


def unit_loads(problem: Problem, positions: Positions, state: ContactState, nodes: FloatArray) -> Loads:
    """The loads in a contact state, those that are not constant of a size of 1 N/m or 1 N.

    Load 0 is constant: the forces k gap of the closed stops, and the constant forces of `problem`.  The others,
    harmonic or sampled, act at `positions`.  `nodes`, m, ascending, are those of the beam; every load acts at a node.
    """
    forces = np.zeros((1 + len(positions), nodes.size))

    def node(x: float) -> int:
        return int(np.argmin(np.abs(nodes - x)))  # nodes are (x / L) L: a rounding from x, on either side

    for i in state.closed:
        stop = problem.stops[i]
        forces[0, node(stop.x)] += stop.sign * stop.stiffness * stop.gap
    for load in problem.forces.constant:
        forces[0, node(load.x)] += load.force
    for row, x in enumerate(positions, start=1):
        if x is not None:
            forces[row, node(x)] += 1.0
    return Loads(np.array([0.0, *(float(x is None) for x in positions)]), forces)
