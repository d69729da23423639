"""One cycle of the motion as a film on the page: the beams moving between the faces of their stops."""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import ClassVar

import numpy as np
import param
from panel.custom import JSComponent

from explore.answers import Bar, Cycle
from lapjoint.figures.sketch import Plan
from lapjoint.problem import FloatArray, Problem

WIDTH, LANE = 1000.0, 240.0
"""Width of the picture, and height of the room in which one beam moves, in units of the picture."""
_SIDE = 40.0
"""Room beside the beams, in units of the picture: half a stop is there."""
_GROUND = 34.0
"""Room for a stop and its ground beyond the largest displacement, in units of the picture."""
_TIMES = ((1.0, "s"), (1e-3, "ms"), (1e-6, "us"))
"""Units of time, s, and their names."""


@dataclass(frozen=True)
class Scene:
    """A cycle in the units of its picture, from the left and from the top."""

    size: tuple[float, float]
    """Width and height of the picture."""
    rest: list[tuple[float, float, float]]
    """Left end, right end and height of each beam at rest."""
    x: list[list[float]]
    """Points of each beam, from the left: ``beams x points``."""
    y: list[list[list[float]]]
    """Their heights in each frame: ``beams x frames x points``."""
    stops: list[tuple[float, int, bool]]
    """Of each stop where it is, from the left, its side of the beam (1 above, -1 below), and whether a ground, not a
    beam, carries it."""
    names: list[str]
    """Names of the stops."""
    faces: list[list[float]]
    """Heights of the faces: ``frames x stops``."""
    lit: list[list[bool]]
    """Whether each stop is in contact: ``frames x stops``."""
    times: list[float]
    """Times of the frames since the start of the motion, s."""
    labels: list[str]
    """These times as they are shown."""
    exaggeration: str
    """By how much displacements are larger than lengths in the picture."""
    said: str
    """What the film shows, for those who do not see it."""


def scene_of(problem: Problem, cycle: Cycle) -> Scene:
    """A cycle as a picture: all displacements on one scale, by which the largest of them, and all faces, fit."""
    plan, line = Plan(problem), problem.line
    levels = sorted(set(plan.heights), reverse=True)
    middles = [LANE * (levels.index(height) + 0.5) for height in plan.heights]
    wide = (WIDTH - 2 * _SIDE) / (plan.ends[1] - plan.ends[0])
    largest = max(float(np.max(np.abs(z), initial=0.0)) for z in (cycle.frames, cycle.faces))
    high = (LANE / 2 - _GROUND) / largest if largest else 0.0

    def across(x: float) -> float:
        return round(_SIDE + (plan.along(x) - plan.ends[0]) * wide, 1)

    on = [line.own(cycle.x, j) for j in range(len(line.beams))]
    stops = problem.structure.stops
    below = np.array([middles[line.beam_at(stop.met)] for stop in stops])
    ends = zip(line.starts, line.ends, middles, strict=True)
    labels = _labels(cycle.frame_times)
    return Scene(
        size=(WIDTH, LANE * len(levels)),
        rest=[(across(start), across(end), middle) for start, end, middle in ends],
        x=[[across(x) for x in cycle.x[here]] for here in on],
        y=[
            np.round(middle - high * cycle.frames[:, here], 1).tolist()
            for here, middle in zip(on, middles, strict=True)
        ],
        stops=[(across(stop.met), stop.sign, stop.side != "between") for stop in stops],
        names=list(problem.stop_names),
        faces=np.round(below - high * cycle.faces, 1).tolist(),
        lit=lit(cycle.bars, cycle.frame_times, len(stops)),
        times=cycle.frame_times.tolist(),
        labels=labels,
        exaggeration=f"{high / wide:.2g}",
        said=_said(problem, cycle.bars, labels[-1]),
    )


def lit(bars: tuple[Bar, ...], times: FloatArray, stops: int) -> list[list[bool]]:
    """Whether each stop is in contact in each frame: a contact lights the frames nearest to it, at least one.

    Parameters
    ----------
    bars : tuple of Bar
        The contacts.
    times : FloatArray, shape (f,)
        Equidistant times of the frames, s.
    stops : int
        Number of stops.

    Returns
    -------
    list of list of bool
        A list of `stops` values for each of the f frames.
    """
    half = (times[-1] - times[0]) / max(times.size - 1, 1) / 2
    found = np.zeros((times.size, stops), dtype=bool)
    for bar in bars:
        found[:, bar.stop] |= (bar.start <= times + half) & (bar.end >= times - half)
    lists: list[list[bool]] = found.tolist()
    return lists


def _labels(times: FloatArray) -> list[str]:
    """Times in one unit, with three digits of the last one."""
    last = float(times[-1])
    size, unit = next((one for one in _TIMES if last >= one[0]), _TIMES[-1])
    digits = max(0, 2 - math.floor(math.log10(last / size))) if last > 0 else 0
    return [f"{t / size:.{digits}f} {unit}" for t in times]


def _said(problem: Problem, bars: tuple[Bar, ...], end: str) -> str:
    """The contacts in words."""
    touched = [name for k, name in enumerate(problem.stop_names) if any(bar.stop == k for bar in bars)]
    return f"The motion from 0 to {end}. Stops in contact: {', '.join(touched) or 'none'}."


class Film(JSComponent):
    """The film of a cycle, with a button that plays it, and a slider for its time.

    A film runs at first, unless the reader asked for less motion; one that is halted stays so when the cycle changes.
    """

    scene = param.ClassSelector(class_=Scene, default=None, allow_None=True, precedence=-1)
    """What is shown."""
    time = param.Number(default=None, allow_None=True)
    """The time of the frame that is shown, s since the start of the motion; None while the film runs."""
    rests = param.Boolean(default=False)
    """Whether the film stands still, as one of an older question does: the next curve needs the processor."""
    shown = param.String(default="null")
    """What the browser shows, as JSON."""

    _esm = Path(__file__).with_name("film.js")
    _rename: ClassVar[dict[str, str | None]] = {"scene": None}  # it stays in Python

    @param.depends("scene", watch=True, on_init=True)
    def _show(self) -> None:
        self.shown = json.dumps(asdict(self.scene) if self.scene is not None else None)
