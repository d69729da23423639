"""The loads of a problem: harmonic ones with their sizes, frequencies and phases, and a constant one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.modes.static_residual import Loads
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import BaseMotion, FloatArray, Problem, SineLoad, StepLoad


@dataclass(frozen=True)
class Harmonics:
    """Frequencies and phases of the harmonic loads."""

    omega: FloatArray
    """Angular frequencies, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases, rad, shape ``(H,)``."""

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
    """The harmonic loads: the base motion first (if any), then the sine loads.

    Parameters
    ----------
    problem : Problem
        What is solved.

    Returns
    -------
    Harmonics
        Frequencies and phases of ``H`` loads.
    """
    parts: list[BaseMotion | SineLoad] = [] if problem.base_motion is None else [problem.base_motion]
    parts += [load for load in problem.point_loads if isinstance(load, SineLoad)]
    return Harmonics(np.array([part.angular_frequency for part in parts]), np.array([part.phase for part in parts]))


def load_sizes(problem: Problem) -> FloatArray:
    """Factors of the unit loads: 1 for the constant one, then the amplitudes of the harmonic ones.

    Parameters
    ----------
    problem : Problem
        What is solved.

    Returns
    -------
    FloatArray, shape (1 + H,)
        Without unit; then N/m for the base motion, N for sine loads.
    """
    base = problem.base_motion
    inertia = [] if base is None else [problem.beam.m * base.amplitude * base.angular_frequency**2]
    return np.array([1.0, *inertia, *(load.force for load in problem.point_loads if isinstance(load, SineLoad))])


def unit_loads(problem: Problem, state: ContactState, nodes: FloatArray) -> Loads:
    """The loads in a contact state, the harmonic ones with unit amplitude.

    Load 0 is constant: the forces k gap of the closed stops, and the step loads.  Loads 1 ... H are those of the
    harmonics, with an amplitude of 1 N/m or 1 N.

    Parameters
    ----------
    problem : Problem
        What is solved.
    state : ContactState
        The stops that are closed.
    nodes : FloatArray, shape (nodes,)
        The nodes of the beam, m, ascending; every load acts at one.

    Returns
    -------
    Loads
        1 + H loads.
    """
    sines = [load for load in problem.point_loads if isinstance(load, SineLoad)]
    uniform = [0.0] + ([] if problem.base_motion is None else [1.0])
    forces = np.zeros((len(uniform) + len(sines), nodes.size))

    def node(x: float) -> int:
        return int(np.argmin(np.abs(nodes - x)))  # nodes are (x / L) L: a rounding from x, on either side

    for i in state.closed:
        stop = problem.stops[i]
        forces[0, node(stop.x)] += stop.sign * stop.stiffness * stop.gap
    for load in problem.point_loads:
        if isinstance(load, StepLoad):
            forces[0, node(load.x)] += load.force
    for row, sine in enumerate(sines, start=len(uniform)):
        forces[row, node(sine.x)] += 1.0
    return Loads(np.array(uniform + [0.0] * len(sines)), forces)
