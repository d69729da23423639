"""Quantities of a motion at a place: the displacement and its derivatives, with names and units."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass

import numpy as np

from lapjoint.answers.history import History
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class Quantity:
    """A derivative of the displacement, times a constant, with or without the motion of the base."""

    name: str
    units: str
    text: str
    dx: int
    """Order of the x-derivative."""
    dt: int
    """Order of the t-derivative."""
    absolute: bool = False
    """Whether the motion of the base is added."""

    def factor(self, problem: Problem, x: FloatArray) -> FloatArray:
        """The factor of the derivative at places `x`, m, (n,), in `units` divided by the derivative's: shape (n, 1)."""
        beam = problem.line
        if self.dx < 2:
            return np.ones((x.size, 1))
        factor = beam.EI_at(x)
        if self.name == "stress":
            factor = -beam.stress_per_moment_at(x) * factor
        return factor[:, None]

    def of(self, history: History, x: FloatArray, t: FloatArray) -> FloatArray:
        """The quantity at places `x`, m, (n,), and times `t`, s, (m,): shape (n, m), in `units`."""
        values = self.factor(history.problem, x) * history.evaluate(x, t, self.dx, self.dt)
        if not self.absolute:
            return values
        return values + np.outer(history.problem.structure.base_shares(x), history.base(t, self.dt))


_ALL = (
    Quantity("displacement", "m", "displacement relative to the base", 0, 0),
    Quantity("velocity", "m s-1", "velocity relative to the base", 0, 1),
    Quantity("acceleration", "m s-2", "acceleration relative to the base", 0, 2),
    Quantity("absolute_displacement", "m", "displacement, that of the base added", 0, 0, True),
    Quantity("absolute_velocity", "m s-1", "velocity, that of the base added", 0, 1, True),
    Quantity("absolute_acceleration", "m s-2", "acceleration, that of the base added", 0, 2, True),
    Quantity("moment", "N m", "bending moment, EI z_xx", 2, 0),
    Quantity("shear", "N", "shear force, EI z_xxx; where it jumps, the value to the left", 3, 0),
    Quantity(
        "stress",
        "Pa",
        "bending stress at the top of the section, tension positive; at a step the larger of both sides",
        2,
        0,
    ),
)
QUANTITIES = {quantity.name: quantity for quantity in _ALL}
"""The quantities by their names, in the order of lists."""


def checked_quantities(problem: Problem, names: Iterable[str], allowed: Collection[str]) -> list[str]:
    """Names of quantities, each once, if all are allowed and the problem has them."""
    chosen = list(dict.fromkeys(names))
    unknown = [name for name in chosen if name not in allowed]
    if unknown or not chosen:
        what = f"quantity {unknown[0]!r}: is unknown" if unknown else "quantity: none is named"
        raise InputError(f"{what}; allowed: {', '.join(allowed)}")
    if "stress" in chosen:
        problem.line.require_sections("quantity 'stress'")
    return chosen
