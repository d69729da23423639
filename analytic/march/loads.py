"""The loads of a problem: harmonic ones with their sizes, frequencies and phases, and a constant one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.modes.static_residual import Loads
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem

Places = tuple[float | None, ...]
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
        """Some harmonics of 1 rad/s and without phase, in whose place others will be.

        Parameters
        ----------
        count : int
            How many, ``H``.

        Returns
        -------
        Harmonics
            ``H`` harmonics.
        """
        return Harmonics(np.ones(count), np.zeros(count))

    def theta(self, t: float) -> FloatArray:
        """Phase angles at a time.

        Parameters
        ----------
        t : float
            The time, s.

        Returns
        -------
        FloatArray, shape (H,)
            rad.
        """
        return self.omega * t + self.phase


def harmonics_of(problem: Problem) -> Harmonics:
    """The harmonic loads of a problem, in the order of its forces.

    Parameters
    ----------
    problem : Problem
        What is solved.

    Returns
    -------
    Harmonics
        Frequencies and phases of ``H`` loads.
    """
    forces = problem.forces.harmonic
    return Harmonics(np.array([force.angular_frequency for force in forces]), np.array([it.phase for it in forces]))


def load_sizes(problem: Problem) -> FloatArray:
    """Factors of the unit loads: 1 for the constant one, the amplitudes of the harmonic ones, 1 for the sampled ones.

    Parameters
    ----------
    problem : Problem
        What is solved.

    Returns
    -------
    FloatArray, shape (1 + H + R,)
        Without unit; then N/m for uniform loads, N for loads at points; then without unit, as samples have one.
    """
    forces = problem.forces
    return np.array([1.0, *(force.amplitude for force in forces.harmonic), *(1.0 for _ in forces.sampled)])


def unit_loads(problem: Problem, places: Places, state: ContactState, nodes: FloatArray) -> Loads:
    """The loads in a contact state, those that are not constant of unit size.

    Load 0 is constant: the forces k gap of the closed stops, and the constant forces.  The others, harmonic or sampled,
    have a size of 1 N/m or 1 N.

    Parameters
    ----------
    problem : Problem
        The problem with its constant forces; others that it has are not looked at.
    places : tuple of float or None
        Where each of the others acts, m, or None for a uniform one.
    state : ContactState
        The stops that are closed.
    nodes : FloatArray, shape (nodes,)
        The nodes of the beam, m, ascending; every load acts at one.

    Returns
    -------
    Loads
        1 + H loads, or 1 + H + R with ``R`` sampled ones.
    """
    forces = np.zeros((1 + len(places), nodes.size))

    def node(x: float) -> int:
        return int(np.argmin(np.abs(nodes - x)))  # nodes are (x / L) L: a rounding from x, on either side

    for i in state.closed:
        stop = problem.stops[i]
        forces[0, node(stop.x)] += stop.sign * stop.stiffness * stop.gap
    for load in problem.forces.constant:
        forces[0, node(load.x)] += load.force
    for row, x in enumerate(places, start=1):
        if x is not None:
            forces[row, node(x)] += 1.0
    return Loads(np.array([0.0, *(float(x is None) for x in places)]), forces)
