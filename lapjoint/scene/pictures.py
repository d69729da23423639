"""Pictures and films of a motion, and a window if there is a display; pyvista draws them.

The drawing is done by another process, because VTK ends its process if it finds no graphics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from lapjoint.answers import History
from lapjoint.errors import InputError
from lapjoint.files.writing import completed, unwritable
from lapjoint.problem import FloatArray
from lapjoint.scene.appearance import Look
from lapjoint.scene.frame_builder import drawing_of
from lapjoint.scene.frame_times import check_frames, common_time
from lapjoint.scene.frames import Drawing
from lapjoint.scene.render_process import check_can_show, draw
from lapjoint.scene.scene import histories_of
from lapjoint.solver import Progress

PICTURES = (".png",)
FILMS = (".gif", ".mp4")
PICTURE_SIZE, FILM_SIZE = (1200, 520), (900, 400)
"""Default width and height of a picture or window, and of a film, pixels."""
DEFAULT = Look()
MOST_FRAMES = 5000
"""Largest number of frames of a film, as all frames are kept in memory."""
SLOWEST = 0.1
"""Least pace of a film, frames a second: a frame then lasts for ten seconds."""


def save_picture(
    motion: History | Mapping[str, History], path: str | Path, *, at: float | None = None, look: Look = DEFAULT
) -> Path:
    """Draw a motion at one time, as PNG.

    Parameters
    ----------
    motion : History or mapping
        One motion, or several by short names, as in ``{"analytic": a, "fe": b}``, which stand side by side.
    path : str or Path
        The picture's file, which ends in ``.png``.
    at : float, optional
        Time within the history, s; by default the time of the largest contact force or, without contact, of the largest
        deflection.
    look : Look
        Colours, scale, frame of reference and size.

    Returns
    -------
    Path
        The picture.

    Raises
    ------
    InputError
        If a parameter is out of its range.
    OutputError
        If the file cannot be written, or this machine cannot draw; the message says what it lacks.
    """
    _check_ending(path, PICTURES)
    histories = histories_of(motion)
    start, end = common_time(histories)
    if at is not None and not start <= at <= end:
        raise InputError(f"at = {at:g}: allowed is a time within the history, {start:g} to {end:g} s")
    time = _telling_time(histories[0], start, end) if at is None else at
    return _drawn(drawing_of(motion, np.array([time]), 0.0, look, PICTURE_SIZE, 0.0, Path(path)), Path(path), None)


def save_film(
    motion: History | Mapping[str, History],
    path: str | Path,
    *,
    frames: int = 60,
    pace: float = 20.0,
    look: Look = DEFAULT,
    progress: Progress | None = None,
) -> Path:
    """Draw a motion as a film, GIF or MP4, which a viewer repeats without end.

    A stop that is closed only between two frames lights up in the nearer frame.

    Parameters
    ----------
    motion : History or mapping
        One motion, or several by short names, as in ``{"analytic": a, "fe": b}``, which stand side by side.
    path : str or Path
        The film's file, which ends in ``.gif``, or in ``.mp4`` if the extra ``film`` is installed.
    frames : int
        Number of frames, equidistant in time.  The motion's end is left out, so that a cycle closes.
    pace : float
        Frames a second, from 0.1 to 100.  In a GIF at most 50, and a frame lasts for whole hundredths of a second.
    look : Look
        Colours, scale, frame of reference and size.
    progress : callable, optional
        Called with the number of frames done and the number of all.

    Returns
    -------
    Path
        The film.

    Raises
    ------
    InputError
        If a parameter is out of its range.
    OutputError
        If the file cannot be written, or this machine cannot draw; the message says what it lacks.
    """
    _check_ending(path, FILMS)
    times = _film_times(histories_of(motion), frames)
    pace = _shown_pace(Path(path), pace)
    step = float(times[1] - times[0])
    return _drawn(drawing_of(motion, times, step, look, FILM_SIZE, pace, Path(path)), Path(path), progress)


def show_window(motion: History | Mapping[str, History], *, frames: int = 120, look: Look = DEFAULT) -> None:
    """Open a window with the motion: the slider is time, the space bar plays and pauses, q closes it.

    Parameters
    ----------
    motion : History or mapping
        One motion, or several by short names, as in ``{"analytic": a, "fe": b}``, which stand side by side.
    frames : int
        Number of frames, equidistant in time.  The motion's end is left out, so that a cycle closes.
    look : Look
        Colours, scale, frame of reference and size.

    Raises
    ------
    InputError
        If a parameter is out of its range, or there is no display.
    OutputError
        If this machine cannot draw; the message says what it lacks.
    """
    check_can_show(None)
    times = _film_times(histories_of(motion), frames)
    draw(drawing_of(motion, times, float(times[1] - times[0]), look, PICTURE_SIZE, 25.0, None), None)


def _check_ending(path: str | Path, endings: Sequence[str]) -> None:
    ending = Path(path).suffix.lower()
    if ending not in endings:
        raise InputError(f"{path}: must end in {' or '.join(endings)}, not {ending or 'without an ending'}")


def _film_times(histories: Sequence[History], frames: int) -> FloatArray:
    """Equidistant times, s, shape ``(frames,)``, without the motion's end."""
    check_frames(frames, MOST_FRAMES)
    start, end = common_time(histories)
    return np.linspace(start, end, frames, endpoint=False)


def _shown_pace(path: Path, pace: float) -> float:
    """The pace, frames a second; in a GIF, the nearest pace with frames of whole hundredths of a second."""
    gif = path.suffix.lower() == ".gif"
    most = 50.0 if gif else 100.0
    if not SLOWEST <= pace <= most:
        raise InputError(f"pace = {pace:g}: allowed are {SLOWEST:g} to {most:g} frames a second in {path.suffix}")
    return 100 / round(100 / pace) if gif else pace


def _telling_time(history: History, start: float, end: float) -> float:
    """The time of the largest contact force, s; without contact, of the largest deflection."""
    contacts = [c for c in history.contacts if c.start <= end and c.end >= start]
    if contacts:
        hardest = contacts[_first_largest(np.array([contact.peak_force for contact in contacts]))]
        times = np.linspace(max(hardest.start, start), min(hardest.end, end), 401)
        return float(times[_first_largest(np.abs(history.contact_force(times)).sum(axis=0))])
    times = np.linspace(start, end, 2001)
    x = history.problem.line.grid(9)
    return float(times[_first_largest(np.abs(history.displacement(x, times)).max(axis=0))])


def _first_largest(values: FloatArray) -> int:
    """Index of the first of the largest values, (m,); in a symmetric motion it lies in the first half.

    Values that differ by less than a millionth count as equal, so that rounding does not choose the picture.
    """
    return int(np.flatnonzero(values >= (1 - 1e-6) * values.max())[0])


def _drawn(drawing: Drawing, path: Path, progress: Progress | None) -> Path:
    """Draw into a file that gets the name `path` when it is complete."""
    try:
        with completed(path) as unfinished:
            draw(replace(drawing, output=unfinished), progress)
    except OSError as error:
        raise unwritable(path, error) from None
    return path
