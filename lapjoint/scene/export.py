"""Motions and mode shapes as files that ParaView, pyvista and meshio open; what they hold: `lapjoint.scene.parts`.

========== ============================================== ===================================================
format     files                                          opened by
========== ============================================== ===================================================
``pvd``    ``motion.pvd``, a folder of ``.vtu`` files     ParaView (5.11 and later), pyvista; meshio a file each
``vtkhdf`` ``motion.vtkhdf``, one file                    ParaView 5.13 and later, VTK 9.4 and later
``xdmf``   ``motion_beam.xdmf``, ``motion_solid.xdmf`` .. meshio, pyvista, ParaView ("XDMF Reader")
========== ============================================== ===================================================
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from lapjoint.contact import state_label
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.scene.scene import Block, Scene, histories_of, mode_scene, motion_scene
from lapjoint.scene.times import chosen_times
from lapjoint.solution import History, Modes
from lapjoint.solver import Progress

Format = Literal["pvd", "vtkhdf", "xdmf"]


def export_motion(
    motion: History | Mapping[str, History],
    directory: str | Path,
    *,
    format: Format = "pvd",  # noqa: A002 - the word a user expects
    times: FloatArray | Sequence[float] | None = None,
    frames: int | None = None,
    tolerance: float | None = None,
    points: int = 81,
    progress: Progress | None = None,
) -> Path:
    """Write a motion, or several side by side, as a time series.

    Parameters
    ----------
    motion : History or mapping
        One motion, or several by short names, as in ``{"analytic": a, "fe": b}``: these stand side by side, and those
        after the first carry their ``difference`` from it.
    directory : path
        Where the files go; made if it is not there.  Files of an earlier export are replaced.
    format : str
        ``pvd``, ``vtkhdf`` or ``xdmf``; see the head of this module.
    times, frames, tolerance
        One of three ways to choose the times; by default, as many as the motion needs.  Every switch of the contact
        state is always among them.  See `lapjoint.scene.times.chosen_times`.
    points : int
        Equidistant stations along the beam, at least 2; the positions of supports and stops are added.
    progress : callable, optional
        Called now and then with the number of frames done and of all.

    Returns
    -------
    Path
        The file to open.

    Raises
    ------
    InputError
        If a parameter is out of its range, or the files cannot be written.
    """
    histories = histories_of(motion)
    scene = motion_scene(motion, points)
    t = chosen_times(histories, times=times, frames=frames, tolerance=tolerance)
    note = f"{histories[0].problem.title or 'motion'}; {', '.join(h.solver for h in histories)}; SI units, time in s"
    return _write(scene, t, directory, "motion", note, format, progress)


def export_modes(
    problem: Problem,
    modes: Sequence[Modes],
    directory: str | Path,
    *,
    solver: str = "",
    format: Format = "pvd",  # noqa: A002
    points: int = 81,
) -> tuple[Path, ...]:
    """Write mass-normalised mode shapes, a series for each contact state; the time of a mode is its number.

    Values are those of a unit of the modal coordinate, 1 m kg^1/2; the field ``angular_frequency`` holds the natural
    angular frequency, rad/s.  `solver` is a note in the files; for the other parameters, what is returned and raised,
    see `export_motion`.
    """
    paths = []
    for one in modes:
        name = f"modes_{_file_name(problem, one)}"
        note = f"{problem.title or 'modes'}; state {one.state.name(problem)}; {solver}; time is the number of the mode"
        numbers = np.arange(1.0, one.angular_frequencies.size + 1)
        scene = mode_scene(problem, one, solver, points)
        paths.append(_write(scene, numbers, directory, name, note, format, None))
    return tuple(paths)


def _file_name(problem: Problem, modes: Modes) -> str:
    """The contact state in the name of a file: ``6_P2+P3``."""
    return re.sub(r"[^\w+]+", "_", state_label(problem, modes.state).replace(" + ", "+"))


def _write(
    scene: Scene,
    times: FloatArray,
    directory: str | Path,
    name: str,
    note: str,
    kind: Format,
    progress: Progress | None,
) -> Path:
    if kind not in get_args(Format):
        raise InputError(f"format = {kind!r}: allowed are {', '.join(get_args(Format))}")
    from lapjoint.scene.pvd import write_pvd
    from lapjoint.scene.vtkhdf import write_vtkhdf
    from lapjoint.scene.xdmf import write_xdmf

    write = {"pvd": write_pvd, "vtkhdf": write_vtkhdf, "xdmf": write_xdmf}[kind]
    folder = Path(directory)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        return write(scene, _shown(scene, times, progress), folder, name, note)
    except OSError as error:
        raise InputError(f"{folder}: cannot be written: {error.strerror or error}") from None


def _shown(scene: Scene, times: FloatArray, progress: Progress | None) -> Iterator[Block]:
    """The blocks of a scene, one after the other, and how far that is."""
    done = 0
    for block in scene.blocks(times):
        yield block
        done += block.times.size
        if progress is not None:
            progress(done, times.size)
