"""Builds the contents of each frame of a picture, a film or a window, as numbers and text, from a motion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lapjoint.answers import History
from lapjoint.answers.contact_state import state_label
from lapjoint.errors import InputError
from lapjoint.figures.text import cut_to
from lapjoint.problem import FloatArray
from lapjoint.scene.appearance import Colour, Look
from lapjoint.scene.frames import Drawing, Plates, Skin, Springs, Word
from lapjoint.scene.layout import Layout
from lapjoint.scene.parts import Part, Values
from lapjoint.scene.scene import Scene, histories_of, motion_scene
from lapjoint.scene.section_mesh import IntArray

DEFLECTION, PENETRATION = 0.12, 0.6
"""Largest deflection, divided by the beam's length, and largest penetration of a stop, divided by its spring's length,
in the default scale: visible without distorting the picture."""
FARTHEST = 10.0
"""Largest displacement that is drawn, divided by the length of the beam: with more, the joint cannot be recognised."""
FEWEST_A_PERIOD = 8
"""Least number of frames in an excitation period of a film without a warning: fewer may show another motion."""
LONGEST_NAME = 24
"""Largest number of characters of a name in a picture, so that names do not cover the joint."""


class _Shade(NamedTuple):
    """A value that can colour the beam."""

    field: str
    """Name of the point value, as in `lapjoint.scene.parts`."""
    factor: float
    """Factor from the SI unit to the unit of the label."""
    label: str
    """Label of the colour scale, with its unit."""


_SHADES = {
    "stress": _Shade("bending_stress", 1e-6, "bending stress [MPa]"),
    "velocity": _Shade("velocity", 1.0, "velocity [m/s]"),
    "moment": _Shade("moment", 1.0, "bending moment [N m]"),
    "displacement": _Shade("displacement", 1e3, "displacement [mm]"),
}


def drawing_of(
    motion: History | Mapping[str, History],
    times: FloatArray,
    step: float,
    look: Look,
    size: tuple[int, int],
    pace: float,
    output: Path | None,
) -> Drawing:
    """The drawing of one motion, or of several side by side, for the process that draws.

    `times`, (frames,), and `step`, 0 for a picture, are in s.  `size`, in pixels, is used if `look` has none.  `pace`
    is in frames a second, 0 for a picture; `output` is None for a window.
    """
    scene, histories = motion_scene(motion), histories_of(motion)
    shade = _SHADES[_colour(look, histories)]
    block = scene.block(times)
    carried = "displacement" if look.frame == "relative" else "displacement_absolute"
    s = _scale(look, scene, block.values, carried)

    skins: list[Skin] = []
    springs, plates, words = [], [], []
    rest = iter(block.values)
    for (name, _), layout, group, history in zip(scene.sources, scene.layouts, scene.groups, histories, strict=True):
        carrying = [(part, next(rest)) for part in group]
        values = {part.name: (part, carries) for part, carries in carrying}
        shown, first = "solid" if "solid" in values else "beam", len(skins)
        skins += [_skin(*one, layout, shade, s, carried) for one in carrying if one[0].name == shown]
        if "stops" in values:
            springs.append(_springs(*values["stops"], layout, s, carried, _acting(history, times, step)))
            if len(springs) == 1 or springs[-1].names != springs[0].names:
                words += _stop_words(springs[-1], layout)
        for rigid in ("base", "masses"):
            if rigid in values:
                part, carries = values[rigid]
                plates.append(Plates(part.cells, _moved(part, carries, s, carried)))
        if len(histories) > 1:
            root = skins[first].points[:, 0] * [1, 0, 1] + [-0.03 * layout.longest, layout.offset, 0.0]
            words.append(Word(cut_to(name, LONGEST_NAME), root, "right"))
    largest = _round_up(max(float(np.abs(skin.values).max()) for skin in skins))
    notes = [*(history.solver for history in histories), _scale_note(s, look, histories, pace * step)]
    period = 2 * math.pi / (histories[0].problem.forces.fastest or math.inf)
    if FEWEST_A_PERIOD * step > period > 0:
        notes.append(f"only {_three_digits(period / step)} frames a period")
    if output is None:
        notes.append("space: play and pause, q: close")
    return Drawing(
        skins=tuple(skins),
        springs=tuple(springs),
        plates=tuple(plates),
        words=tuple(words),
        title=histories[0].problem.title or "Motion",
        notes=tuple(notes),
        times=times,
        captions=tuple(_captions(histories[0], times, springs[0].acts if springs else None)),
        label=shade.label,
        limits=(-largest, largest),
        size=look.size or size,
        pace=pace,
        output=output,
    )


def _colour(look: Look, histories: Sequence[History]) -> Colour:
    sections = all(history.problem.line.has_sections for history in histories)
    if look.colour == "stress" and not sections:
        raise InputError("colour = 'stress': the beam has no section; allowed are velocity, moment, displacement")
    return look.colour or ("stress" if sections else "moment")


def _scale(look: Look, scene: Scene, values: Sequence[Values], carried: str) -> float:
    """The scale of `look`, or else the largest 1, 2 or 5 times a power of ten within `DEFLECTION` and `PENETRATION`."""
    if look.scale is not None:
        length = max(layout.longest for layout in scene.layouts)
        largest = max(float(np.abs(carries.point[carried]).max(initial=0.0)) for carries in values)
        if look.scale * largest > FARTHEST * length:
            raise InputError(
                f"scale = {look.scale:g}: draws displacements longer than {FARTHEST:g} beams; "
                f"allowed is at most {_three_digits(FARTHEST * length / largest)} here"
            )
        return look.scale
    limits = [math.inf]
    for (_, part), carries in zip(scene.parts, values, strict=True):
        length, reach = part.layout.longest, part.layout.reach
        deflection = float(np.abs(carries.point[carried]).max(initial=0.0))
        pressed = float(np.max(carries.cell.get("penetration", np.zeros(1)), initial=0.0))
        limits += [DEFLECTION * length / deflection] if deflection else []
        limits += [PENETRATION * reach / pressed] if pressed else []
    return _round_down(min(limits))


def _round_down(limit: float) -> float:
    """The largest 1, 2 or 5 times a power of ten that is at most `limit`; at least 1, and 1 for an infinite limit."""
    if not 1 < limit < math.inf:
        return 1.0
    power = 10.0 ** math.floor(math.log10(limit))
    return float(max(step for step in (1, 2, 5) if step * power <= limit * (1 + 1e-12)) * power)


def _round_up(value: float) -> float:
    """The least number of two digits that is not below `value`; 1 for 0."""
    if value == 0:
        return 1.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 1)
    return math.ceil(value / unit * (1 - 1e-12)) * unit


def _three_digits(value: float) -> str:
    """A number rounded to three digits, without an exponent."""
    return f"{float(f'{value:.3g}'):.10g}"


def _scale_note(scale: float, look: Look, histories: Sequence[History], slowed: float) -> str:
    """A note on the scale, the frame of reference (if the base moves) and the pace."""
    words = "true scale" if scale == 1 else f"displacements and gaps ×{scale:g}, beam at true scale"
    if any(history.problem.base_motion for history in histories):
        words += ", seen from the base" if look.frame == "relative" else ", seen from outside"
    if slowed:
        words += f", slowed {_three_digits(1 / slowed)}×" if slowed < 1 else f", sped up {_three_digits(slowed)}×"
    return words


def _stop_words(springs: Springs, layout: Layout) -> list[Word]:
    """The names of the stops, a little beyond the feet of their springs; stops at one position have one label."""
    stops = layout.problem.structure.stops
    places: dict[tuple[float, int], list[int]] = {}
    for i, stop in enumerate(stops):
        places.setdefault((stop.x, stop.sign), []).append(i)
    words = []
    for (_, sign), here in places.items():
        foot = springs.points[:, here, 1].mean(axis=1)
        text = cut_to(", ".join(springs.names[i] for i in here), LONGEST_NAME)
        words.append(Word(text, foot + np.array([0.0, 0.0, 0.15 * sign * layout.reach]), "center"))
    return words


def _moved(part: Part, values: Values, scale: float, carried: str) -> FloatArray:
    moved: FloatArray = part.points + scale * values.point[carried]
    return moved


def _skin(part: Part, values: Values, layout: Layout, shade: _Shade, scale: float, carried: str) -> Skin:
    field = carried if shade.field == "displacement" else shade.field
    if carried == "displacement_absolute" and field == "velocity":
        field = "velocity_absolute"
    shown = values.point[field]
    colours = shade.factor * np.asarray(shown if shown.ndim == 2 else shown[:, :, 2], dtype=float)
    return Skin(part.cells, _moved(part, values, scale, carried), colours, layout.longest / 120)


def _springs(part: Part, values: Values, layout: Layout, scale: float, carried: str, acts: IntArray) -> Springs:
    points = _moved(part, values, scale, carried)
    shape = (len(points), -1, 2, 3)
    radius = min(layout.reach, layout.breadth) / 6
    return Springs(layout.problem.stop_names, points.reshape(shape), acts, radius)


def _acting(history: History, times: FloatArray, step: float) -> IntArray:
    """2 if a stop is closed at a time, 1 if it is closed only within half a step of this time, else 0; (frames, stops).

    The last time also stands for the whole step after it.
    """
    acts = np.zeros((times.size, len(history.problem.stops)), dtype=np.int64)
    first, last = times - step / 2, times + step / 2
    if step:
        last[-1] = times[-1] + step
    for contact in history.contacts:
        acts[(contact.start <= last) & (contact.end >= first), contact.stop] = 1
    for at, time in enumerate(times):
        acts[at, list(history.state_at(float(time)).closed)] = 2
    return acts


def _captions(history: History, times: FloatArray, acts: IntArray | None) -> Iterator[str]:
    """The time and contact state of each frame, and the stops that are closed only between two frames."""
    seconds = float(np.abs(times).max()) >= 10
    for at, time in enumerate(times):
        clock = f"t = {time:.4f} s" if seconds else f"t = {1e3 * time:.3f} ms"
        names = history.problem.stop_names
        brief = [] if acts is None else [names[stop] for stop in np.flatnonzero(acts[at] == 1)]
        between = f", {' + '.join(brief)} in between" if brief else ""
        yield f"{clock}, state {state_label(history.problem, history.state_at(float(time)))}{between}"
