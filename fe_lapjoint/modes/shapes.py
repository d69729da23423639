"""Mode shapes of the mesh as functions of position."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fe_lapjoint.modes.assembly import Assembly
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class ElementShapes:
    """Shapes given by vectors over the ``n`` free degrees of freedom; see `lapjoint.answers.ModeShapes`."""

    assembly: Assembly
    vectors: FloatArray
    """One mode a column, shape ``(n, modes)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Shapes or an x-derivative (0 to 3) at ``x``, m, shape ``(k,)``; gives ``(modes, k)``."""
        return np.asarray((self.assembly.shapes(np.asarray(x, dtype=float), derivative) @ self.vectors).T)
