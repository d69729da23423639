"""Natural frequencies and mode shapes of one contact state."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray


class ModeShapes(Protocol):
    """Mass-normalised mode shapes as a function of position."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Shapes or their x-derivative (0 to 3) at ``x``, shape ``(n,)``; returns ``(modes, n)``.

        Where a spring makes the third derivative jump, the value is the one to the left (to the right at x = 0).
        """


@dataclass(frozen=True)
class Modes:
    """Natural frequencies and mass-normalised mode shapes (16)-(17) of one contact state."""

    state: ContactState
    angular_frequencies: FloatArray
    """Natural angular frequencies, rad/s, ascending, shape ``(modes,)``; 0 for a rigid-body mode."""
    shapes: ModeShapes
    """Mode shapes, kg^-1/2; their sign is arbitrary, so compare them with MAC or up to sign."""
