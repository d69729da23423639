"""The contents of pictures and films as numbers and text, which another process draws."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from lapjoint.problem import FloatArray
from lapjoint.scene.section_mesh import IntArray


@dataclass(frozen=True)
class Skin:
    """A beam, coloured by a value: the surface of its solid, or a tube about its axis."""

    cells: IntArray
    """Indices of points: hexahedra of a solid, shape ``(cells, 8)``, or lines of an axis, shape ``(cells, 2)``."""
    points: FloatArray
    """Positions of the points, m, shape ``(frames, points, 3)``."""
    values: FloatArray
    """Values that colour the points, in the unit of the label, shape ``(frames, points)``."""
    radius: float
    """Radius of the tube about an axis, m."""


@dataclass(frozen=True)
class Springs:
    """The stops of a joint: springs between a face and a rail, which light up while the stop is closed."""

    names: tuple[str, ...]
    """Names of the stops."""
    points: FloatArray
    """Positions of the face and the foot of each spring, m, shape ``(frames, stops, 2, 3)``."""
    acts: IntArray
    """2 if the stop is closed at the frame, 1 if it is closed only between this frame and its neighbours, else 0; shape
    ``(frames, stops)``."""
    radius: float
    """Radius of the coils, m."""


@dataclass(frozen=True)
class Plates:
    """Rails, walls and posts."""

    cells: IntArray
    """Indices of points: quadrilaterals, shape ``(cells, 4)``."""
    points: FloatArray
    """Positions of the points, m, shape ``(frames, points, 3)``."""


@dataclass(frozen=True)
class Word:
    """A name beside a part of the scene, with which it moves."""

    text: str
    """The name."""
    places: FloatArray
    """Positions of the name, m, shape ``(frames, 3)``."""
    side: str
    """The point of the name that lies at its position: its ``right`` end or its ``center``."""


@dataclass(frozen=True)
class Drawing:
    """Everything that the drawing process needs for a picture, a film or a window."""

    skins: tuple[Skin, ...]
    """The beams, one for each joint."""
    springs: tuple[Springs, ...]
    """The stops, for each joint that has some."""
    plates: tuple[Plates, ...]
    """The bases, for each joint that has one."""
    words: tuple[Word, ...]
    """Names of stops, and of joints that stand side by side."""
    title: str
    """Title of the motion."""
    notes: tuple[str, ...]
    """Text in every frame: the solvers, and the scale."""
    times: FloatArray
    """Times of the frames, s, shape ``(frames,)``."""
    captions: tuple[str, ...]
    """Text of each frame: its time and contact state."""
    label: str
    """Name of the value that colours the beams, with its unit."""
    limits: tuple[float, float]
    """Ends of the colour scale, in the unit of the label."""
    size: tuple[int, int]
    """Width and height, pixels."""
    pace: float
    """Frames a second of a film or window; 0 for a picture."""
    output: Path | None
    """File of a picture (``.png``) or a film (``.gif``, ``.mp4``); None for a window."""
