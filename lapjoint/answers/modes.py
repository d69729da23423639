"""Natural frequencies and mode shapes of one contact state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.shown import Shown
from lapjoint.problem import FloatArray


class ModeShapes(Protocol):
    """Mass-normalised mode shapes as a function of position."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Mode shapes, or a derivative of them in x.

        Where a spring makes the third derivative jump, the value is the limit from the left (from the right at x = 0).

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Positions, m, from 0 to L.
        derivative : int
            Order of the x-derivative, 0 to 3.

        Returns
        -------
        FloatArray, shape (modes, n)
            kg^-1/2 m^-derivative.
        """


@dataclass(frozen=True, repr=False)
class Modes(Shown):
    """Natural frequencies and mass-normalised mode shapes (16)-(17) of one contact state."""

    state: ContactState
    angular_frequencies: FloatArray
    """Natural angular frequencies, rad/s, ascending, shape ``(modes,)``; 0 for a rigid-body mode."""
    shapes: ModeShapes
    """Mode shapes, kg^-1/2; their sign is arbitrary, so compare them by MAC (modal assurance criterion) or up to
    sign."""
