"""What is drawn, frame by frame: numbers and words only, so that drawing can happen in a process of its own."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from lapjoint.problem import FloatArray
from lapjoint.scene.section_mesh import IntArray


@dataclass(frozen=True)
class Skin:
    """A beam, coloured by a value: its solid's surface, or a tube about its axis."""

    cells: IntArray
    """Hexahedra ``(cells, 8)`` of a solid, or lines ``(cells, 2)`` of an axis."""
    points: FloatArray
    """Where the points are, m, ``(frames, points, 3)``."""
    values: FloatArray
    """What colours them, in the unit of the label, ``(frames, points)``."""
    radius: float
    """Of the tube about an axis, m."""


@dataclass(frozen=True)
class Springs:
    """The stops of a joint: springs between a face and a rail, which light up while they act."""

    names: tuple[str, ...]
    points: FloatArray
    """Face and foot of each, m, ``(frames, stops, 2, 3)``."""
    acts: IntArray
    """2 where the stop is closed, 1 where it was between this frame and the next or the last, ``(frames, stops)``."""
    radius: float
    """Of the coil, m."""


@dataclass(frozen=True)
class Plates:
    """Rails, walls and posts."""

    cells: IntArray
    points: FloatArray
    """m, ``(frames, points, 3)``."""


@dataclass(frozen=True)
class Word:
    """A name that stands beside something, and goes with it."""

    text: str
    places: FloatArray
    """m, ``(frames, 3)``."""
    side: str
    """Where the place is: at the ``right`` end of the word, or in its ``center``."""


@dataclass(frozen=True)
class Job:
    """A picture, a film or a window."""

    skins: tuple[Skin, ...]
    springs: tuple[Springs, ...]
    plates: tuple[Plates, ...]
    words: tuple[Word, ...]
    """Names of stops, and of joints that stand side by side."""
    title: str
    notes: tuple[str, ...]
    """What every frame says: whose motion it is, at which scale."""
    times: FloatArray
    """Of the frames, s."""
    captions: tuple[str, ...]
    """What each frame says of itself."""
    label: str
    """What the colours are, with its unit."""
    limits: tuple[float, float]
    """Ends of the colour scale, in the unit of the label."""
    size: tuple[int, int]
    """Width and height, pixels."""
    pace: float
    """Frames a second of a film."""
    output: Path | None
    """A picture (.png), a film (.gif, .mp4), or None for a window."""
