"""What a motion looks like in numbers: everything that is drawn, for each frame of a picture, a film or a window."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lapjoint.contact import state_label
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray
from lapjoint.scene.job import Job, Plates, Skin, Springs
from lapjoint.scene.layout import Layout
from lapjoint.scene.look import Colour, Frame, Look
from lapjoint.scene.parts import Part, Values
from lapjoint.scene.scene import Scene, histories_of, motion_scene
from lapjoint.scene.section import IntArray
from lapjoint.solution import History

DEFLECTION, PENETRATION = 0.12, 0.6
"""An exaggerated motion takes this part of the beam's length, and of a spring's, at most."""


class _Shade(NamedTuple):
    """How a value becomes a colour."""

    field: str
    factor: float
    label: str


_SHADES = {
    "stress": _Shade("bending_stress", 1e-6, "bending stress [MPa]"),
    "velocity": _Shade("velocity", 1.0, "velocity [m/s]"),
    "moment": _Shade("moment", 1.0, "bending moment [N m]"),
    "displacement": _Shade("displacement", 1e3, "displacement [mm]"),
}


def job_of(
    motion: History | Mapping[str, History],
    times: FloatArray,
    step: float,
    look: Look,
    size: tuple[int, int],
    pace: float,
    output: Path | None,
) -> Job:
    """All that is drawn: `times` are those of the frames, `step` the time between two of them."""
    scene, histories = motion_scene(motion), histories_of(motion)
    shade = _SHADES[_colour(look, histories)]
    block = scene.block(times)
    carried = "displacement" if look.frame == "relative" else "displacement_absolute"
    s = look.scale or _visible_scale(scene, block.values, carried)

    skins, springs, plates = [], [], []
    rest = iter(block.values)
    for layout, group, history in zip(scene.layouts, scene.groups, histories, strict=True):
        values = {part.name: (part, next(rest)) for part in group}
        skins.append(_skin(*values.get("solid", values["beam"]), layout, shade, s, carried))
        if "stops" in values:
            springs.append(_springs(*values["stops"], layout, s, carried, _acting(history, times, step)))
        if "base" in values:
            part, carries = values["base"]
            plates.append(Plates(part.cells, _moved(part, carries, s, carried)))
    largest = _round_up(max(float(np.abs(skin.values).max()) for skin in skins))
    keys = ("space: play and pause, q: close",) if output is None else ()
    moving = any(history.problem.base_motion for history in histories)
    several = len(histories) > 1
    names = tuple(
        (name, (-0.06 * layout.problem.beam.length, layout.offset, 0.0))
        for (name, _), layout in zip(scene.sources, scene.layouts, strict=True)
        if several
    )
    return Job(
        skins=tuple(skins),
        springs=tuple(springs),
        plates=tuple(plates),
        names=names,
        title=histories[0].problem.title or "Motion",
        notes=(*(h.solver for h in histories), _scale_note(s, look.frame if moving else None, pace * step), *keys),
        captions=tuple(_caption(histories[0], float(t)) for t in times),
        label=shade.label,
        limits=(-largest, largest),
        size=look.size or size,
        pace=pace,
        output=output,
    )


def _colour(look: Look, histories: Sequence[History]) -> Colour:
    sections = all(history.problem.beam.section for history in histories)
    if look.colour == "stress" and not sections:
        raise InputError("colour = 'stress': the beam has no section; allowed are velocity, moment, displacement")
    return look.colour or ("stress" if sections else "moment")


def _visible_scale(scene: Scene, values: Sequence[Values], carried: str) -> float:
    """The largest of 1, 2 or 5 times a power of ten that keeps the scene in shape."""
    limits = [math.inf]
    for (_, part), carries in zip(scene.parts, values, strict=True):
        length, reach = part.layout.problem.beam.length, part.layout.reach
        deflection = float(np.abs(carries.point[carried]).max(initial=0.0))
        pressed = float(np.max(carries.cell.get("penetration", np.zeros(1)), initial=0.0))
        limits += [DEFLECTION * length / deflection] if deflection else []
        limits += [PENETRATION * reach / pressed] if pressed else []
    return _round_down(min(limits))


def _round_down(limit: float) -> float:
    """1, 2 or 5 times a power of ten, at most `limit`; at least 1, and 1 where there is no limit."""
    if not 1 < limit < math.inf:
        return 1.0
    power = 10.0 ** math.floor(math.log10(limit))
    return float(max(step for step in (1, 2, 5) if step * power <= limit * (1 + 1e-12)) * power)


def _round_up(value: float) -> float:
    """The next number of two digits; 1 for 0."""
    if value == 0:
        return 1.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit * (1 - 1e-12)) * unit


def _three_digits(value: float) -> str:
    """A number rounded to three digits, without an exponent."""
    return f"{float(f'{value:.3g}'):.10g}"


def _scale_note(scale: float, frame: Frame | None, slowed: float) -> str:
    """Scale, point of view (None where the base does not move) and pace, in words."""
    scaled = "true scale" if scale == 1 else f"displacements and gaps ×{scale:g}, beam at true scale"
    seen = {None: "", "relative": ", seen from the base", "absolute": ", seen from outside"}[frame]
    return scaled + seen + (f", slowed {_three_digits(1 / slowed)}×" if slowed else "")


def _moved(part: Part, values: Values, scale: float, carried: str) -> FloatArray:
    moved: FloatArray = part.points + scale * values.point[carried]
    return moved


def _skin(part: Part, values: Values, layout: Layout, shade: _Shade, scale: float, carried: str) -> Skin:
    field = carried if shade.field == "displacement" else shade.field
    if carried == "displacement_absolute" and field == "velocity":
        field = "velocity_absolute"
    shown = values.point[field]
    colours = shade.factor * np.asarray(shown if shown.ndim == 2 else shown[:, :, 2], dtype=float)
    return Skin(part.cells, _moved(part, values, scale, carried), colours, layout.problem.beam.length / 120)


def _springs(part: Part, values: Values, layout: Layout, scale: float, carried: str, acts: IntArray) -> Springs:
    points = _moved(part, values, scale, carried)
    shape = (len(points), -1, 2, 3)
    radius = min(layout.reach, layout.breadth) / 6
    return Springs(layout.problem.stop_names, points.reshape(shape), acts, radius)


def _acting(history: History, times: FloatArray, step: float) -> IntArray:
    """Which stops are closed at any time within half a step of each time, ``(frames, stops)``."""
    acts = np.zeros((times.size, len(history.problem.stops)), dtype=np.int64)
    for contact in history.contacts:
        acts[(contact.start <= times + step / 2) & (contact.end >= times - step / 2), contact.stop] = 1
    return acts


def _caption(history: History, time: float) -> str:
    return f"t = {1e3 * time:.3f} ms   state {state_label(history.problem, history.state_at(time))}"
