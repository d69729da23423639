"""What holds the beam: springs that always act, and stops that it meets after crossing a gap."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np
from pydantic import model_validator

from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.places import Place
from lapjoint.problem.schema import Finite, FloatArray, NonNegative, Part, Positive, SpringStiffness


class Support(Part):
    """Linear springs between beam and base at one point, always acting; an infinite stiffness fixes."""

    x: NonNegative
    """Position, m, within the beam."""
    translational: SpringStiffness = 0.0
    """Translational stiffness k, N/m, from 0 to inf."""
    torsional: SpringStiffness = 0.0
    """Torsional stiffness kt, N m/rad, from 0 to inf."""


Side = Literal["top", "bottom"]


class Stop(Part):
    """A one-sided spring behind a gap: between a beam and what moves with the base or stands still in space, or between
    two beams."""

    x: Place | None = None
    """Position, m, within the beam (with side, instead of between); of several beams a place, as ``upper:0.3``."""
    side: Side | None = None
    """"top" acts at z > gap, "bottom" at z < -gap (with x)."""
    between: tuple[Place, Place] | None = None
    """Two places of different beams, the upper first, as ``["upper:0.3", "lower:0.1"]``: the stop is closed where the
    second, from below, has come nearer to the first by more than the gap."""
    gap: Finite
    """Gap when the beams are straight, m; below 0 an interference, by which the stop presses straight beams."""
    stiffness: Positive
    """Spring stiffness k, N/m."""
    damping: NonNegative = 0.0
    """Damping c, N s/m: while the beam is beyond the gap by d, the force is k d + c d', or 0 if that would pull."""
    may_pull: bool = False
    """Whether the force k d + c d' may be negative, and pull, while the beam is beyond the gap."""
    fixed_to: Literal["base", "space"] = "base"
    """"base": the stop moves with the base; "space": the stop stands still, and the gap sees z + y (with x)."""
    name: str = ""
    """Name shown in tables; empty: numbered in the order given."""

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        if self.between is not None:
            given = [name for name in ("x", "side") if getattr(self, name) is not None]
            given += ["fixed_to"] if self.fixed_to != "base" else []
            if given:
                raise ValueError(f"{given[0]}: a stop between two beams has none; the beams and gap say all")
        elif self.x is None or self.side is None:
            missing = "x" if self.x is None else "side"
            raise ValueError(f"{missing}: is missing; a stop has x and side, or between if it is between two beams")
        return self

    @property
    def sign(self) -> int:
        """-1 for a bottom stop, else +1: closed where ``sign`` times what the gap sees exceeds the gap."""
        return -1 if self.side == "bottom" else 1

    @property
    def in_space(self) -> bool:
        """Whether the stop is fixed in space, and does not move with the base."""
        return self.fixed_to == "space"


@dataclass(frozen=True)
class PlacedStop:
    """A stop on the line of beams, by what its gap sees: a sum of displacements, and a share of the base's motion."""

    sign: int
    """+1 for a top stop, -1 for a bottom stop: closed where ``sign * seen > gap``."""
    reading: tuple[tuple[float, float], ...]
    """Position on the line, m, and factor of each displacement that the gap sees: one with the factor 1, or the second
    beam's with 1 and the first one's with -1."""
    base_share: float
    """How much of the base's motion y the gap sees: 0 of a stop that moves with the base."""
    gap: float
    """Gap, m; below 0 an interference."""
    stiffness: float
    """Spring stiffness k, N/m."""
    damping: float
    """Damping c, N s/m."""
    may_pull: bool
    """Whether the force may pull."""
    where: str
    """Its place as tables show it."""
    side: str
    """"top", "bottom" or "between"."""

    @property
    def x(self) -> float:
        """Position on the line, m; of a stop between two beams that on the first."""
        return self.reading[-1][0]

    @property
    def met(self) -> float:
        """Position on the line, m, of the beam that comes up to the stop: of two beams the second."""
        return self.reading[0][0]

    @property
    def shape(self) -> LoadShape:
        """Where a force of size 1 of the stop acts, if it pushes upwards on the beam that the gap sees."""
        return LoadShape(points=self.reading)

    def seen(self, shape: Callable[[FloatArray], FloatArray]) -> float:
        """What the gap sees of a displacement.

        Parameters
        ----------
        shape : callable
            Takes positions on the line, m, shape ``(1,)``, and gives the displacement there, m, of the same shape.

        Returns
        -------
        float
            The sum of the displacements times their factors, m.
        """
        return float(sum(factor * shape(np.array([x]))[0] for x, factor in self.reading))

    @property
    def in_space(self) -> bool:
        """Whether the gap sees motion of the base."""
        return self.base_share != 0

    @property
    def still(self) -> bool:
        """Whether the stop moves with the base, as the beam's frame does."""
        return self.side != "between" and not self.in_space

    @property
    def place(self) -> tuple[tuple[tuple[float, float], ...], float]:
        """What the gap sees: one motion opens and closes all stops of a place."""
        return self.reading, self.base_share


def readings(stops: Sequence[PlacedStop]) -> tuple[FloatArray, FloatArray]:
    """The positions that gaps see, m, ascending, ``(n,)``, and what each gap sees of displacements there,
    ``(stops, n)``."""
    x = np.unique(np.array([x for stop in stops for x, _ in stop.reading]))
    factors = np.zeros((len(stops), x.size))
    for k, stop in enumerate(stops):
        for position, factor in stop.reading:
            factors[k, np.searchsorted(x, position)] = factor
    return x, factors


def forces_at_gaps(stops: Sequence[PlacedStop]) -> FloatArray:
    """The force of each stop at a penetration as large as its gap, N, shape ``(stops,)``.

    A force is the stiffness times the difference of displacement and gap, so that rounding of the displacement counts
    with this force, however small the force of the stop is.
    """
    return np.array([stop.stiffness * abs(stop.gap) for stop in stops])
