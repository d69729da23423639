r"""Switches that crowd, so that a march would take minutes: which stop makes them, the cause, and the remedy.

**A stop that is too stiff for the mesh** makes one node of it bounce.  A stop of stiffness k acts on the mesh at its
position x: after an impulse there, the deflection of the mesh without contact, with its modes phi_i, begins as

    z(t) = sum phi_i(x)^2 sin(omega_i t) / omega_i,   z'(0) = sum phi_i^2 = 1 / m_x,   -z'''(0) = sum phi_i^2 omega_i^2,

a mass m_x that gives way to the rest of the mesh with the frequency omega_x, omega_x^2 = sum phi_i^2 omega_i^2 / sum
phi_i^2.  Against the stop it bounces with sqrt(k / m_x).  If the bounce is faster than omega_x, the mass leaves the
stop again and again before the rest of the mesh has followed: where the beam is pressed and little damped, thousands of
contacts take the place of one.  A beam has no such mass.  On a mesh r times as fine m_x is r times smaller and omega_x
r^2 times larger, so the ratio of the two frequencies falls with r^1.5.

**Modal damping** damps the modes of the present contact state, so its force jumps at each switch.  Where it drives the
stop's gap function up in both states, the motion slides along the gap, in contacts that grow shorter and shorter.  This
sliding belongs to the problem, not to the mesh; it takes large ratios, or fast modes that a stiff stop has thrown.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from fe_lapjoint.march.model import Model
from lapjoint.answers.contact_state import FREE
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray, ModalDamping

MOST_SWITCHES = 3000
"""Most switches of a stop in one window where one of the two causes holds; these many take some ten seconds of
computing.  A vibrating beam of 40 elements that is thrown against a stop too stiff for it makes up to two thousand."""


def bounce_ratio(model: Model) -> FloatArray:
    """sqrt(k / m_x) / omega_x of each stop, ``(P,)``: up to 1 the mesh follows its contacts; 0 on a fixed node."""
    system = model.system(FREE)
    squares = system.stops**2
    inverse_mass, stiffness = squares.sum(axis=1), squares @ system.omega**2
    return np.asarray(np.sqrt(model.stiffness / np.where(stiffness > 0, stiffness, np.inf)) * inverse_mass)


@dataclass
class Crowd:
    """Counts of the switches of each stop within one window."""

    model: Model
    window: float
    """Length of the window, s."""
    _ratio: FloatArray | None = None
    _start: float = -math.inf
    _switches: dict[int, int] = field(default_factory=dict)

    def add(self, stop: int, t: float) -> None:
        """Count a switch of a stop at time `t`, s; a SolverError if there are too many, for a known cause."""
        if t - self._start > self.window:
            self._start, self._switches = t, {}
        number = self._switches[stop] = self._switches.get(stop, 0) + 1
        if number <= MOST_SWITCHES:
            return
        if self._ratio is None:
            self._ratio = bounce_ratio(self.model)
        cause = self._cause(stop, float(self._ratio[stop]))
        if cause:
            name = self.model.problem.stop_names[stop]
            when = f"between t = {self._start:.6g} and {t:.6g} s"
            raise SolverError(f"{name}: more than {MOST_SWITCHES} switches {when}: {cause}")

    def _cause(self, stop: int, ratio: float) -> str:
        """The cause of a stop's crowded switches, and what to change; empty if neither cause holds."""
        stiffness, damping = float(self.model.stiffness[stop]), self.model.problem.damping
        if ratio > 1:
            return (
                f"its stiffness of {stiffness:.3g} N/m makes one node of the mesh bounce {ratio:.2g} times as fast as "
                f"the rest can follow; take {math.ceil(ratio ** (2 / 3) * 10) / 10:g} times as many elements, or a "
                f"stiffness of at most {stiffness / ratio**2:.3g} N/m"
            )
        if isinstance(damping, ModalDamping):
            return (
                "the force of modal damping jumps where the stop opens or closes, and holds the beam at the gap; take "
                "a smaller damping ratio, or viscous damping"
            )
        return ""
