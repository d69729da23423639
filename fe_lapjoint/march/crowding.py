r"""Switches that crowd: a stop so stiff that its contacts are bounces of one node of the mesh.

A stop of stiffness k acts on what the mesh has at its position x: after an impulse there, the deflection of the mesh
without contact, with its modes phi_i, begins as

    z(t) = sum phi_i(x)^2 sin(omega_i t) / omega_i,   z'(0) = sum phi_i^2 = 1 / m_x,   -z'''(0) = sum phi_i^2 omega_i^2,

a mass m_x that gives way to the rest of the mesh with the frequency omega_x, omega_x^2 = sum phi_i^2 omega_i^2 / sum
phi_i^2.  Against the stop it bounces with sqrt(k / m_x).  If that is the faster one, the mass leaves the stop again and
again before the rest of the mesh has followed: where the beam is pressed and little damped, thousands of contacts take
the place of one.  A beam has no such mass.  On a mesh r times as fine m_x is r times smaller and omega_x r^2 times
larger, so the ratio of the two frequencies falls with r^1.5.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from fe_lapjoint.march.model import Model
from lapjoint.answers.contact_state import FREE
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray

MOST_BOUNCES = 3000
"""Most switches, in the time of one window, of a stop whose contacts the mesh does not follow: some ten seconds of
computing.  Where a vibrating beam is thrown against such a stop, 40 elements make up to two thousand."""


def bounce_ratio(model: Model) -> FloatArray:
    """How much faster a node bounces against each stop than the mesh without contact follows it.

    Parameters
    ----------
    model : Model
        The problem on a mesh.

    Returns
    -------
    FloatArray, shape (P,)
        sqrt(k / m_x) / omega_x, without unit; up to 1 the mesh follows the contacts; 0 on a fixed node.
    """
    system = model.system(FREE)
    squares = system.stops**2
    inverse_mass, stiffness = squares.sum(axis=1), squares @ system.omega**2
    return np.asarray(np.sqrt(model.stiffness / np.where(stiffness > 0, stiffness, np.inf)) * inverse_mass)


@dataclass
class Crowd:
    """The switches, in the time of one window, of stops whose contacts the mesh does not follow."""

    model: Model
    window: float
    """s."""
    _ratio: FloatArray | None = None
    _start: float = -math.inf
    _switches: dict[int, int] = field(default_factory=dict)

    def add(self, stop: int, t: float) -> None:
        """Count a switch.

        Parameters
        ----------
        stop : int
            Which stop switches.
        t : float
            When, s.

        Raises
        ------
        SolverError
            If they are too many, and the mesh does not follow the contacts of this stop.
        """
        if t - self._start > self.window:
            self._start, self._switches = t, {}
        number = self._switches[stop] = self._switches.get(stop, 0) + 1
        if number <= MOST_BOUNCES:
            return
        if self._ratio is None:
            self._ratio = bounce_ratio(self.model)
        ratio = float(self._ratio[stop])
        if ratio > 1:
            raise SolverError(self._message(stop, t, ratio))

    def _message(self, stop: int, t: float, ratio: float) -> str:
        """What crowds where, and what to change."""
        stiffness = float(self.model.stiffness[stop])
        return (
            f"{self.model.problem.stop_names[stop]}: more than {MOST_BOUNCES} switches between t = {self._start:.6g} "
            f"and {t:.6g} s: its stiffness of {stiffness:.3g} N/m makes one node of the mesh bounce {ratio:.2g} times "
            f"as fast as the rest can follow; take {math.ceil(ratio ** (2 / 3) * 10) / 10:g} times as many elements, "
            f"or a stiffness of at most {stiffness / ratio**2:.3g} N/m"
        )
