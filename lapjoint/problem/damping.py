"""Damping of the beam: none, a ratio in each mode, or a viscous force along its length."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Discriminator, Field, Tag

from lapjoint.problem.schema import FloatArray, NonNegative, Part

ROUNDED = 1e-14
"""Rate of decay of modes that damping couples, divided by their fastest rate, below which it is rounding: the mode then
is undamped."""


def _one_or_each(value: object) -> str:
    return "each" if isinstance(value, list | tuple) else "one"


class NoDamping(Part):
    """No damping."""

    kind: Literal["none"] = "none"


class ModalDamping(Part):
    """Damping ratios in the modes of the current contact state (the paper's)."""

    kind: Literal["modal"] = "modal"
    ratio: Annotated[
        Annotated[NonNegative, Tag("one")] | Annotated[tuple[NonNegative, ...], Field(min_length=1), Tag("each")],
        Discriminator(_one_or_each),
    ]
    """One ratio for every mode, or one per mode from the lowest; the last then holds for all above."""

    def ratios(self, count: int) -> FloatArray:
        """Damping ratios of the lowest modes.

        Parameters
        ----------
        count : int
            Number of modes.

        Returns
        -------
        FloatArray, shape (count,)
            Ratios of critical damping.
        """
        given = np.atleast_1d(np.asarray(self.ratio, dtype=float))
        return given[np.minimum(np.arange(count), given.size - 1)]


class ViscousDamping(Part):
    """Damping force C z_t per unit length, equation (1) of the paper taken literally."""

    kind: Literal["viscous"] = "viscous"
    coefficient: NonNegative
    """C, N s/m2."""


Damping = Annotated[NoDamping | ModalDamping | ViscousDamping, Field(discriminator="kind")]
