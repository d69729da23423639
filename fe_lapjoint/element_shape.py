"""A deflected shape on a mesh: cubics, and what constant loads add within elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class ElementShape:
    """z(x) on a mesh: cubics, and what constant loads add within elements; 0 on spaces between beams."""

    nodes: FloatArray
    """Positions, m, shape ``(e + 1,)``."""
    z: FloatArray
    """Displacements of the nodes, m, shape ``(e + 1,)``."""
    slope: FloatArray
    """Slopes of the nodes, shape ``(e + 1,)``."""
    moment: FloatArray
    """Bending moments at the two ends of each element, N m, without the part of its load, shape ``(2, e)``."""
    shear: FloatArray
    """Shear force at the start of each element, N, shape ``(e,)``."""
    EI: FloatArray
    """Bending stiffness of each element, N m2, shape ``(e,)``; 0 of a space between beams."""
    q: FloatArray
    """Constant load of each element, N/m, shape ``(e,)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """The shape or an x-derivative at ``x``, m, ``(...)``, shaped like `x`; see `StaticShape`."""
        at = np.asarray(x, dtype=float)
        e = np.clip(np.searchsorted(self.nodes, at, side="left") - 1, 0, self.q.size - 1)
        e = np.where((self.EI[e] == 0) & (at == self.nodes[e + 1]), e + 1, e)
        found = self._within(e, at, derivative)
        return np.asarray(np.where(self.EI[e] == 0, 0.0, found))

    def _within(self, e: npt.NDArray[np.intp], at: FloatArray, derivative: int) -> FloatArray:
        """The shape or an x-derivative at positions, m, within elements `e`, ``(...)`` each; of a space no matter
        what."""
        h = (self.nodes[e + 1] - self.nodes[e])[()]
        s, EI, q = (at - self.nodes[e]) / h, np.where(self.EI[e] == 0, 1.0, self.EI[e]), self.q[e]
        if derivative == 0:
            ends = self.z[e] * (1 - s) ** 2 * (1 + 2 * s) + self.z[e + 1] * s**2 * (3 - 2 * s)
            turned = h * (self.slope[e] * s * (1 - s) ** 2 - self.slope[e + 1] * s**2 * (1 - s))
            return np.asarray(ends + turned + q * h**4 / (24 * EI) * (s * (1 - s)) ** 2)
        if derivative == 1:
            ends = (self.z[e + 1] - self.z[e]) / h * 6 * s * (1 - s)
            turned = self.slope[e] * (1 - s) * (1 - 3 * s) + self.slope[e + 1] * s * (3 * s - 2)
            return np.asarray(ends + turned + q * h**3 / (12 * EI) * s * (1 - s) * (1 - 2 * s))
        start, end = self.moment[0, e], self.moment[1, e]
        if derivative == 2:
            return np.asarray((start * (1 - s) + end * s + q * h**2 / 12 * (1 - 6 * s * (1 - s))) / EI)
        return np.asarray((self.shear[e] + q * h * s) / EI)
