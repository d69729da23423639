"""A motion made visible: a picture, a film, or a window where there is a display; drawn by pyvista.

Nothing is drawn in this process: VTK ends its process when it finds no graphics, and that must not end yours.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple, get_args

import numpy as np

from lapjoint.contact import state_label
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray
from lapjoint.scene.job import Job, Plates, Skin, Springs
from lapjoint.scene.layout import Layout
from lapjoint.scene.parts import Part, Values
from lapjoint.scene.process import check_can_show, draw
from lapjoint.scene.scene import Scene, histories_of, motion_scene
from lapjoint.scene.section import IntArray
from lapjoint.scene.times import check_frames, span_of
from lapjoint.solution import History
from lapjoint.solver import Progress

Colour = Literal["stress", "velocity", "moment", "displacement"]
Frame = Literal["relative", "absolute"]
PICTURES = (".png",)
FILMS = (".gif", ".mp4")
DEFLECTION, PENETRATION = 0.12, 0.6
"""An exaggerated motion takes this part of the beam's length, and of a spring's, at most."""
MOST_PIXELS = 8192
PICTURE_SIZE, FILM_SIZE = (1200, 520), (900, 400)


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


@dataclass(frozen=True)
class Look:
    """How a motion is shown."""

    colour: Colour | None = None
    """What colours the beam: ``stress`` (the default where the problem gives a section), ``velocity``, ``moment`` or
    ``displacement``."""
    scale: float | None = None
    """Factor of all displacements and gaps, 1 for true scale; by default what makes them visible: 1, 2 or 5 times a
    power of ten, never less than 1.  The picture states it."""
    frame: Frame = "relative"
    """``relative`` to the base, or ``absolute``."""
    size: tuple[int, int] | None = None
    """Width and height, pixels; by default 1200 by 520, films 900 by 400."""

    def __post_init__(self) -> None:
        for name, value, allowed in (("colour", self.colour, get_args(Colour)), ("frame", self.frame, get_args(Frame))):
            if value is not None and value not in allowed:
                raise InputError(f"{name} = {value!r}: allowed are {', '.join(allowed)}")
        if self.scale is not None and not 0 < self.scale < math.inf:
            raise InputError(f"scale = {self.scale:g}: must be positive and finite; 1 is true scale")
        if self.size is not None and not all(100 <= pixels <= MOST_PIXELS for pixels in self.size):
            raise InputError(f"size = {self.size[0]}x{self.size[1]}: allowed are 100 to {MOST_PIXELS} pixels each way")


DEFAULT = Look()


def save_picture(
    motion: History | Mapping[str, History], path: str | Path, *, at: float | None = None, look: Look = DEFAULT
) -> Path:
    """Draw a motion at one time, as PNG.

    Parameters
    ----------
    motion : History or mapping
        One motion, or several by short names, as in ``{"analytic": a, "fe": b}``, which stand side by side.
    path : path
        Where the picture goes, ``.png``.
    at : float, optional
        Time, s, within the history; by default that of the largest contact force, or the largest deflection.
    look : Look
        Colours, scale, frame of reference and size.

    Returns
    -------
    Path
        The picture.

    Raises
    ------
    InputError
        If a parameter is out of its range, or the file cannot be written.
    OutputError
        If this machine cannot draw; the message says what it lacks.
    """
    _check_ending(path, PICTURES)
    histories = histories_of(motion)
    start, end = span_of(histories)
    if at is not None and not start <= at <= end:
        raise InputError(f"at = {at:g}: allowed is a time within the history, {start:g} to {end:g} s")
    time = _telling_time(histories[0], start, end) if at is None else at
    return _drawn(_job(motion, np.array([time]), 0.0, look, PICTURE_SIZE, 0.0, Path(path)), None)


def save_film(
    motion: History | Mapping[str, History],
    path: str | Path,
    *,
    frames: int = 60,
    pace: float = 20.0,
    look: Look = DEFAULT,
    progress: Progress | None = None,
) -> Path:
    """Draw a motion as a film, GIF or MP4, that begins again where it ends.

    A stop that acts only between two frames lights up in the nearer one.

    Parameters
    ----------
    motion, look, Returns, Raises
        As in `save_picture`.
    path : path
        Where the film goes: ``.gif``, or ``.mp4`` where the extra ``film`` is installed.
    frames : int
        Number of frames, equidistant in time; that of the motion's end is left out, for a cycle to close.
    pace : float
        Frames a second.
    progress : callable, optional
        Called with the number of frames done and of all.
    """
    _check_ending(path, FILMS)
    times = _film_times(histories_of(motion), frames)
    if not 0 < pace <= 100:
        raise InputError(f"pace = {pace:g}: must be above 0, and at most 100 frames a second")
    step = float(times[1] - times[0])
    return _drawn(_job(motion, times, step, look, FILM_SIZE, pace, Path(path)), progress)


def show_window(motion: History | Mapping[str, History], *, frames: int = 120, look: Look = DEFAULT) -> None:
    """Open a window with the motion: the slider is time, the space bar plays and pauses, q closes it.

    For parameters and errors, see `save_film`; InputError also where there is no display.
    """
    check_can_show(None)
    times = _film_times(histories_of(motion), frames)
    draw(_job(motion, times, float(times[1] - times[0]), look, PICTURE_SIZE, 25.0, None), None)


def _check_ending(path: str | Path, endings: Sequence[str]) -> None:
    ending = Path(path).suffix.lower()
    if ending not in endings:
        raise InputError(f"{path}: must end in {' or '.join(endings)}, not {ending or 'without an ending'}")


def _film_times(histories: Sequence[History], frames: int) -> FloatArray:
    """Equidistant times without the last, s."""
    check_frames(frames)
    start, end = span_of(histories)
    return np.linspace(start, end, frames, endpoint=False)


def _telling_time(history: History, start: float, end: float) -> float:
    """When the stops push hardest; where none does, when the beam is bent most."""
    times = np.linspace(start, end, 2001)
    force = np.abs(history.contact_force(times)).sum(axis=0)
    x = np.linspace(0.0, history.problem.beam.length, 9)
    telling = force if force.any() else np.abs(history.displacement(x, times)).max(axis=0)
    return float(times[int(np.argmax(telling))])


def _drawn(job: Job, progress: Progress | None) -> Path:
    assert job.output is not None
    try:
        job.output.parent.mkdir(parents=True, exist_ok=True)
        draw(job, progress)
    except OSError as error:
        raise InputError(f"{job.output}: cannot be written: {error.strerror or error}") from None
    return job.output


def _job(
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
