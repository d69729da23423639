"""A scene: one motion, or several side by side, as parts that have values at any time."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from lapjoint.answers import History, Modes
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.scene.layout import Layout
from lapjoint.scene.parts import UNITS, Arrays, Part, Values, parts_of
from lapjoint.scene.sampled_motion import ModeSeries, Motion, Source

BLOCK = 64
"""Number of times that are evaluated at once: enough for fast array operations, with limited memory."""
APART = 1.5
"""Clear distance between joints side by side, divided by the breadth of a beam or by 1/15 of its length, whichever is
larger."""


class Block(NamedTuple):
    """All values of a scene at some times."""

    times: FloatArray
    """Times, s, shape ``(m,)``; numbers for modes."""
    values: tuple[Values, ...]
    """The values of each part."""
    whole: Arrays
    """Values of the whole scene by name, each of shape ``(m,)``."""


@dataclass(frozen=True)
class Scene:
    """Joints in motion, in the order of `sources`, each shifted along -y past the previous one."""

    sources: tuple[tuple[str, Source], ...]
    """The motions, each with a short name; if there are several, the names of parts begin with it."""
    points: int = 81
    """Number of equidistant stations along each beam."""

    @cached_property
    def layouts(self) -> tuple[Layout, ...]:
        """The layout of each joint."""
        found: list[Layout] = []
        pressed = max(source.pressed for _, source in self.sources)
        for _, source in self.sources:
            wide = max(max(beam.length for beam in source.problem.line.beams) / 15, found[-1].breadth) if found else 0.0
            offset = found[-1].offset - (APART + 1) * wide if found else 0.0
            found.append(Layout(source.problem, self.points, offset, pressed))
        return tuple(found)

    @cached_property
    def groups(self) -> tuple[tuple[Part, ...], ...]:
        """The parts of each joint."""
        return tuple(
            parts_of(layout, gaps=isinstance(source, Motion))
            for layout, (_, source) in zip(self.layouts, self.sources, strict=True)
        )

    @property
    def parts(self) -> tuple[tuple[str, Part], ...]:
        """All parts, each with its name in the scene."""
        several = len(self.sources) > 1
        return tuple(
            (f"{name}_{part.label}" if several else part.label, part)
            for (name, _), group in zip(self.sources, self.groups, strict=True)
            for part in group
        )

    def block(self, times: FloatArray) -> Block:
        """All values of the scene at times, s, (m,); for modes the times are their numbers, from 1.

        Beams and solids of every motion after the first also carry ``difference``, their displacement minus the
        displacement of the first motion, if both motions have the same points.
        """
        values: list[Values] = []
        whole: Arrays = {}
        first: Arrays = {}
        for (name, source), layout, group in zip(self.sources, self.layouts, self.groups, strict=True):
            sample = source.sample(layout, times)
            alike = np.array_equal(layout.stations, self.layouts[0].stations)
            values += [_compared(part, part.values(sample), first if alike else {}) for part in group]
            prefix = f"{name}_" if len(self.sources) > 1 else ""
            whole |= {prefix + key: value for key, value in sample.whole.items()}
        return Block(times, tuple(values), whole)

    def blocks(self, times: FloatArray) -> Iterator[Block]:
        """All values of the scene at times, s, (m,), in blocks of at most `BLOCK` times."""
        for start in range(0, times.size, BLOCK):
            yield self.block(times[start : start + BLOCK])

    def unit(self, name: str) -> str:
        """The SI unit of a value, ``1`` if it has none; values of a mode are divided by its coordinate, m kg^1/2."""
        if name == "angular_frequency":
            return "rad/s"
        unit = UNITS.get(name, "1")
        moved = isinstance(self.sources[0][1], ModeSeries) and name in UNITS and name not in ("closed", "stop")
        return f"{unit} m-1 kg-1/2" if moved else unit


def motion_scene(motion: History | Mapping[str, History], points: int = 81) -> Scene:
    """The scene of a history, or of several by short names, as in ``{"analytic": a, "fe": b}``, side by side along -y.

    There are `points` equidistant stations along the beam, at least 2; the positions of supports, stops, masses and
    steps are added.
    """
    named = {"motion": motion} if isinstance(motion, History) else dict(motion)
    for name in named:
        if not re.fullmatch(r"[\w+-]+", name):
            raise InputError(f"motion: {name!r} names one; allowed are letters, digits, +, - and _")
    scene = Scene(tuple((name, Motion(history)) for name, history in named.items()), points)
    _ = scene.layouts  # raises an error if `points` is out of range
    return scene


def histories_of(motion: History | Mapping[str, History]) -> list[History]:
    """The histories of one motion or several, at least one."""
    if isinstance(motion, History):
        return [motion]
    if not motion:
        raise InputError("motion: there is none to show")
    return list(motion.values())


def mode_scene(problem: Problem, modes: Modes, points: int = 81) -> Scene:
    """The scene of the modes of one contact state, which follow one another at the times 1, 2, 3 and so on.

    There are `points` equidistant stations along the beam, at least 2; the positions of supports, stops, masses and
    steps are added.
    """
    scene = Scene((("modes", ModeSeries(problem, modes)),), points)
    _ = scene.layouts
    return scene


def _compared(part: Part, values: Values, first: Arrays) -> Values:
    """The values of a part of a later motion, with ``difference``, its displacement minus that of the first motion."""
    moved = values.point["displacement"]
    if part.name not in ("beam", "solid"):
        return values
    if part.label not in first:
        first[part.label] = moved
        return values
    return Values(values.point | {"difference": moved - first[part.label]}, values.cell)
