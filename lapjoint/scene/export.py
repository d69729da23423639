"""Motions and mode shapes as files that ParaView, pyvista and meshio open.

`lapjoint.scene.parts` lists the contents of the files.

========== ============================================== ===================================================
format     files                                          opened by
========== ============================================== ===================================================
``pvd``    ``motion.pvd``, a folder of ``.vtu`` files     ParaView (5.11 and later), pyvista; meshio a file each
``vtkhdf`` ``motion.vtkhdf``, one file                    ParaView 5.12 and later, VTK 9.3 and later
``xdmf``   ``motion_beam.xdmf``, ``motion_solid.xdmf`` .. meshio, pyvista, ParaView ("XDMF Reader")
========== ============================================== ===================================================
"""

from __future__ import annotations

import errno
import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import state_label
from lapjoint.errors import InputError
from lapjoint.figures.text import plain
from lapjoint.files.writing import unwritable
from lapjoint.problem import FloatArray, Problem
from lapjoint.scene.frame_times import chosen_times
from lapjoint.scene.scene import Block, Scene, histories_of, mode_scene, motion_scene
from lapjoint.solver import Progress

ROOM = 1_000_000
"""Bytes that an export leaves free on a disk, for headers and tables in addition to the values."""
MOST_BYTES, MOST_FILES = 500_000_000, 10_000
"""Largest size of all files of a motion, bytes, and largest number of files, that are written without ``large``."""
SAMPLED = 16
"""Number of frames that are written to estimate the size of all frames."""
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
    large: bool = False,
    say: Callable[[str], None] | None = None,
    progress: Progress | None = None,
) -> Path:
    """Write a motion, or several side by side, as a time series for ParaView and other programs.

    Parameters
    ----------
    motion : History or mapping
        One motion, or several by short names, as in ``{"analytic": a, "fe": b}``.  Several motions stand side by side,
        and each one after the first carries its ``difference`` from the first.
    directory : str or Path
        Folder of the files; it is made if it is not there.  Files of an earlier export are replaced.
    format : {"pvd", "vtkhdf", "xdmf"}
        Format of the files; the head of this module compares them.
    times : FloatArray or sequence of float, shape (m,), optional
        Times to be written, s.  At most one of `times`, `frames` and `tolerance` may be given; without any, there are
        as many times as the motion needs.  The switches of the contact state are always among them.
    frames : int, optional
        Number of equidistant times.
    tolerance : float, optional
        Largest error of linear interpolation between two times, divided by the largest value; see
        `lapjoint.scene.frame_times.chosen_times`.
    points : int
        Number of equidistant stations along the beam, at least 2; the positions of supports, stops, masses and
        steps are added.
    large : bool
        Whether more than `MOST_BYTES` in all, or more than `MOST_FILES` files, may be written.
    say : callable, optional
        Called with a sentence about the size of the files, before any file is written.
    progress : callable, optional
        Called from time to time with the number of finished frames and the number of all frames.

    Returns
    -------
    Path
        The file to open.

    Raises
    ------
    InputError
        If a parameter is out of its range, or the files would be too large without `large`.
    OutputError
        If the files cannot be written.
    """
    histories = histories_of(motion)
    scene = motion_scene(motion, points)
    t = chosen_times(histories, times=times, frames=frames, tolerance=tolerance)
    note = f"{histories[0].problem.title or 'motion'}; {', '.join(h.solver for h in histories)}; SI units, time in s"
    check = partial(_check_size, scene, t, kind=format, large=large, say=say)
    return _write(scene, t, directory, "motion", note, format, progress, check)


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

    The values belong to a modal coordinate of 1 m kg^1/2.  The field ``angular_frequency`` holds the natural angular
    frequency, rad/s.

    Parameters
    ----------
    problem : Problem
        The beam and its stops.
    modes : sequence of Modes
        The modes of each contact state.
    directory : str or Path
        Folder of the files; it is made if it is not there.  Files of an earlier export are replaced.
    solver : str
        Name of the solver, which the files hold as a note.
    format : {"pvd", "vtkhdf", "xdmf"}
        Format of the files; the head of this module compares them.
    points : int
        Number of equidistant stations along the beam, at least 2; the positions of supports, stops, masses and
        steps are added.

    Returns
    -------
    tuple of Path
        The file to open, for each contact state.

    Raises
    ------
    InputError
        If a parameter is out of its range.
    OutputError
        If the files cannot be written.
    """
    names = _file_names(problem, modes)
    paths = []
    for name, one in zip(names, modes, strict=True):
        note = f"{problem.title or 'modes'}; state {one.state.name(problem)}; {solver}; time is the number of the mode"
        numbers = np.arange(1.0, one.angular_frequencies.size + 1)
        scene = mode_scene(problem, one, points)
        paths.append(_write(scene, numbers, directory, name, note, format, None))
    return tuple(paths)


def _file_names(problem: Problem, modes: Sequence[Modes]) -> list[str]:
    """Names of files for contact states, such as ``modes_6_P2+P3``; they differ even if stops have similar names."""
    names: list[str] = []
    for one in modes:
        name = "modes_" + re.sub(r"[^\w+]+", "_", state_label(problem, one.state).replace(" + ", "+"))
        names.append(name if name not in names else f"{name}_{len(names)}")
    return names


def _check_size(
    scene: Scene, times: FloatArray, folder: Path, kind: Format, large: bool, say: Callable[[str], None] | None
) -> None:
    """Say how large the files of a series will be, estimated from a few frames, and refuse files that are too large."""
    sampled = times[:: -(-times.size // SAMPLED)]
    with tempfile.TemporaryDirectory(prefix=".unfinished-", dir=folder) as name:
        _writer(kind)(scene, _blocks_with_room(scene, sampled, folder, None), Path(name), "sample", "")
        sizes = [file.stat().st_size for file in Path(name).rglob("*") if file.is_file()]
    files = 1 + (len(sizes) - 1) * times.size // sampled.size if kind == "pvd" else len(sizes)
    size = sum(sizes) * times.size / sampled.size
    amount = f"{times.size} times in {files} file{'s' if files > 1 else ''}, about {size / 1e6:.3g} MB"
    if say is not None:
        say(amount)
    if not large and (size > MOST_BYTES or files > MOST_FILES):
        limit = f"{MOST_BYTES / 1e6:.0f} MB or {MOST_FILES} files"
        raise InputError(
            f"export: {amount}; more than {limit} are written only with --large (large=True); "
            "fewer frames or points, or another format, make less"
        )


def _writer(kind: Format) -> Callable[[Scene, Iterator[Block], Path, str, str], Path]:
    """The function that writes a format."""
    from lapjoint.scene.pvd import write_pvd
    from lapjoint.scene.vtkhdf import write_vtkhdf
    from lapjoint.scene.xdmf import write_xdmf

    return {"pvd": write_pvd, "vtkhdf": write_vtkhdf, "xdmf": write_xdmf}[kind]


def _write(
    scene: Scene,
    times: FloatArray,
    directory: str | Path,
    name: str,
    note: str,
    kind: Format,
    progress: Progress | None,
    check: Callable[[Path], None] | None = None,
) -> Path:
    """Write the files of a series; `check`, called with their folder beforehand, may raise an error."""
    if kind not in get_args(Format):
        raise InputError(f"format = {kind!r}: allowed are {', '.join(get_args(Format))}")
    folder = Path(directory)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if check is not None:
            check(folder)
        return _writer(kind)(scene, _blocks_with_room(scene, times, folder, progress), folder, name, plain(note))
    except (OSError, UnicodeEncodeError) as error:
        raise unwritable(folder, error) from None


def _blocks_with_room(scene: Scene, times: FloatArray, folder: Path, progress: Progress | None) -> Iterator[Block]:
    """The blocks of a scene, one after the other; `progress` is called after each block is written.

    HDF5 ends the process if the disk is full, so a block is yielded only if the disk has room for it.
    """
    done = 0
    for block in scene.blocks(times):
        if shutil.disk_usage(folder).free < 2 * _size(block) + ROOM:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        yield block
        done += block.times.size
        if progress is not None:
            progress(done, times.size)


def _size(block: Block) -> int:
    """Number of bytes of all values of a block."""
    return sum(array.nbytes for values in block.values for array in (*values.point.values(), *values.cell.values()))
