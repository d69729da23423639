"""The answers to a question, as processes send them to the page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from lapjoint.campaigns.point import Point
from lapjoint.problem import FloatArray
from lapjoint.summaries.blocks import Block
from validation.case import CaseResult, Table

Part = Literal["curve", "cycle"]
"""The parts of a question, each of which is answered for itself."""


@dataclass(frozen=True)
class Bar:
    """A contact of a stop."""

    stop: int
    """The stop, from 0."""
    start: float
    """Impact, s since the start of the motion."""
    end: float
    """Rebound, s since the start of the motion."""
    impulse: float
    """Time integral of the force, N s."""


@dataclass(frozen=True)
class Cycle:
    """A steady state at one frequency, as a page draws it."""

    solver: str
    """Name of the solver and its numerical options."""
    outcome: str
    """What the search established, a sentence."""
    period: float
    """Period of the excitation, s."""
    place: str
    """The place whose motion is drawn."""
    t: FloatArray
    """Times since the start of the motion, s, ``(m,)``."""
    z: FloatArray
    """Displacement at the place, relative to the base, m, ``(m,)``."""
    v: FloatArray
    """Velocity at the place, relative to the base, m/s, ``(m,)``."""
    forces: FloatArray
    """Force of each stop on the beam, N, positive upwards, ``(stops, m)``."""
    bars: tuple[Bar, ...]
    """The contacts."""
    frame_times: FloatArray
    """Times of the frames since the start of the motion, s, ``(f,)``."""
    x: FloatArray
    """Positions along the line of beams, m, ``(n,)``."""
    frames: FloatArray
    """Displacement in each frame, m, ``(f, n)``."""
    faces: FloatArray
    """Displacement at which the beam touches each stop, in each frame, m, ``(f, stops)``."""
    multipliers: tuple[complex, ...]
    """Floquet multipliers; none if the motion does not repeat."""
    blocks: tuple[Block, ...]
    """What the command line prints of the steady state."""
    tables: tuple[Table, ...]
    """The same as tables of one solver."""


@dataclass(frozen=True)
class CurvePart:
    """Points of the curve, by the indices of their frequencies."""

    points: Mapping[int, Point]


@dataclass(frozen=True)
class CycleFound:
    """The cycle by one of the solvers."""

    solver: str
    """Name of the solver."""
    cycle: Cycle


@dataclass(frozen=True)
class Compared:
    """The comparison of the cycles of both solvers, as ``lapjoint validate`` has it in the case ``steady``."""

    result: CaseResult


@dataclass(frozen=True)
class Failed:
    """A part of the question that has no answer, or none by one of the solvers."""

    message: str


@dataclass(frozen=True)
class Handle:
    """A number of a problem that the sketch of the joint shows, and by which it can be changed there.

    Pairs are those of the wide and the narrow picture, whose units are those of its ``viewBox``.
    """

    path: str
    """The field, as ``--set`` takes it, with numbers for names: ``stops.0.x``."""
    label: str
    """What it is, with its unit: ``P2, gap in m``."""
    value: float
    """The value, m; of a place on one of several beams its position there."""
    beam: str
    """What a place on one of several beams begins with, as ``upper:``; else empty."""
    least: float
    """Smallest value to which it can be moved, m."""
    most: float
    """Largest value to which it can be moved, m."""
    step: float
    """Step of a position, m, and of a gap that is not above 0."""
    is_gap: bool
    """Whether it moves across the beam, and by factors: the sketch shows no gap to scale."""
    centres: tuple[tuple[float, float], tuple[float, float]]
    """Where it is in both pictures, from the left and from the top."""
    reach: tuple[float, float]
    """What a unit of the picture is: of a position to the right, m; of a gap downwards, in gaps as they are drawn."""


@dataclass(frozen=True)
class Drawn:
    """The sketch of a joint."""

    svg: tuple[str, str]
    """The wide and the narrow picture, as SVG whose ink is that of the page."""
    handles: tuple[Handle, ...]
    """What can be moved in it."""


@dataclass(frozen=True)
class Natural:
    """The lowest natural frequencies while all stops are open."""

    angular_frequencies: FloatArray
    """rad/s, ascending, ``(n,)``."""


Answer = CurvePart | Drawn | Natural | CycleFound | Compared | Failed
