r"""A test, for many marches at once, of whether deviations from a stable orbit are certain to decay.

`lapjoint.orbits.approach` tests whether the deviation e of one march, and all later deviations e_k, meet its
conditions.  With the eigenvectors V of the orbit's derivative, a = V^-1 e, and no multiplier outside the unit circle,

    |D e_k| <= sum_i |D V_i| |a_i|    for all k >= 0,

and likewise for X and X' at the switches.  If these bounds meet the conditions, all e_k do.  This is the last step of a
forecast, at k = 0.  The test succeeds some periods later than the forecast, but needs only one matrix product for many
marches.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.approach import CURVED, LINEAR, RATE, sound
from lapjoint.orbits.newton import Orbit
from lapjoint.orbits.watch import Deviated
from lapjoint.problem import FloatArray

_SOUND_BASIS = 1e-6
"""Largest error of V V^-1 with which the eigenvectors count as a basis.  Without a basis no deviation is trapped."""


@dataclass(frozen=True)
class Trap:
    """A stable orbit, with the test of whether deviations from it decay."""

    orbit: Orbit

    @cached_property
    def _inverse(self) -> ComplexArray | None:
        """V^-1, shape ``(n, n)``; None where the eigenvectors are no basis."""
        vectors = self.orbit.spectrum[1]
        try:
            inverse = np.linalg.inv(vectors)
        except np.linalg.LinAlgError:
            return None
        exact = np.max(np.abs(vectors @ inverse - np.eye(len(vectors))), initial=0.0) <= _SOUND_BASIS
        return np.asarray(inverse) if exact else None

    @cached_property
    def _moduli(self) -> Deviated:
        """|D V|, |X V| and |X' V|, each with a column for each eigenvector."""
        vectors = self.orbit.spectrum[1]
        both = self.orbit.watch.deviated(np.concatenate([vectors.real, vectors.imag], axis=1))
        return Deviated(*(_modulus(part) for part in (both.largest, both.at_switches, both.rates)))

    def holds(self, deviations: FloatArray) -> np.ndarray:
        """Whether marches with deviations, (k, n), are bound for the orbit according to its linearised map, (k,)."""
        held = np.zeros(len(deviations), dtype=np.bool_)
        if self._inverse is None or not len(deviations):
            return held
        amplitudes = np.abs(self._inverse @ deviations.T)
        moduli, switches = self._moduli, self.orbit.watch.switches
        rates = moduli.rates @ amplitudes
        maybe = np.flatnonzero(np.all(rates <= RATE * switches.rate[:, None], axis=0))
        if not maybe.size:
            return held
        amplitudes = np.ascontiguousarray(amplitudes[:, maybe])
        bounds = Deviated(moduli.largest @ amplitudes, moduli.at_switches @ amplitudes, moduli.rates @ amplitudes)
        held[maybe] = sound(self.orbit.watch, bounds, CURVED if switches.time.size else LINEAR)
        return held


def _modulus(both: FloatArray) -> FloatArray:
    """Moduli of complex numbers, whose real and imaginary parts are the first and the second half of the columns."""
    return np.asarray(np.hypot(*np.split(both, 2, axis=1)))
