"""What holds the beam: springs that always act, and stops that it meets after crossing a gap."""

from __future__ import annotations

from typing import Literal

from lapjoint.problem.schema import Finite, NonNegative, Part, Positive, SpringStiffness


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
    """A one-sided spring that the beam meets after crossing a gap."""

    x: NonNegative
    """Position, m, within the beam."""
    side: Side
    """"top" acts at z > gap, "bottom" at z < -gap."""
    gap: Finite
    """Gap when the beam is straight, m; below 0 an interference, by which the stop presses the straight beam."""
    stiffness: Positive
    """Spring stiffness k, N/m."""
    damping: NonNegative = 0.0
    """Damping c, N s/m: while the beam is beyond the gap by d, the force is k d + c d', or 0 if that would pull."""
    may_pull: bool = False
    """Whether the force k d + c d' may be negative, and pull, while the beam is beyond the gap."""
    fixed_to: Literal["base", "space"] = "base"
    """"base": the stop moves with the base; "space": the stop stands still, and the gap sees z + y."""
    name: str = ""
    """Name shown in tables; empty: numbered in the order given."""

    @property
    def sign(self) -> int:
        """+1 for a top stop, -1 for a bottom stop: closed where ``sign * z > gap``, with z + y for a stop in space."""
        return 1 if self.side == "top" else -1

    @property
    def in_space(self) -> bool:
        """Whether the stop is fixed in space, and does not move with the base."""
        return self.fixed_to == "space"

    @property
    def place(self) -> tuple[float, bool]:
        """Position, m, and whether the stop is fixed in space: one displacement opens and closes all stops of a
        place."""
        return self.x, self.in_space
