"""Starts the process that draws, and turns its failures into errors with a message."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from lapjoint.errors import InputError, OutputError
from lapjoint.scene.frames import Drawing
from lapjoint.solver import Progress

COMMAND = (sys.executable, "-m", "lapjoint.scene.render")
"""Command of the process that draws, without its argument."""
SOFTWARE = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkOSOpenGLRenderWindow"}
"""Environment variable that lets VTK draw by software alone, with Mesa's library OSMesa."""
NO_GRAPHICS = (
    "this machine cannot draw: VTK found neither a display nor a graphics library; "
    "on Debian and Ubuntu, install libosmesa6 (or libegl1 and libgl1-mesa-dri)"
)
DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
"""Environment variables that name a display, of X and of Wayland."""
NO_DISPLAY = "output: is missing, and there is no display to open a window on; allowed: .png, .gif, .mp4"
NO_MP4 = ".mp4: needs the package imageio[ffmpeg]; install lapjoint[film], or choose .gif"


def draw(drawing: Drawing, progress: Progress | None) -> None:
    """Draw in a separate process, with graphics hardware or else by software.

    If this machine cannot draw, raise an `OutputError` that says what is missing.
    """
    with tempfile.TemporaryDirectory(prefix="lapjoint-") as folder:
        file = Path(folder) / "drawing.pickle"
        file.write_bytes(pickle.dumps(drawing))
        if drawing.output is None:
            _draw_window(file)
            return
        status, said = 0, ""
        for way in ({}, SOFTWARE):
            status, said, _ = run_process(file, way, len(drawing.captions), progress)
            if status == 0:
                return
            if status > 0:  # Python gave the reason, and drawing by software would fail, too
                break
        _explain(status, said)


def _draw_window(file: Path) -> None:
    """Open a window.  The end of a window that was open is never an error: the user or the display closed it."""
    _, _, opened = run_process(file, {}, 1, None)
    if not opened:
        shown = " or ".join(f"{key} = {os.environ[key]!r}" for key in DISPLAYS if os.environ.get(key))
        raise InputError(f"{shown or 'the display'}: no window can be opened there; give a file instead (output)")


def check_can_show(output: str | Path | None) -> None:
    """Refuse a window without a display, and a film that cannot be written, before the computation begins.

    Parameters
    ----------
    output : str, Path or None
        File of a picture or film; None for a window.

    Raises
    ------
    InputError
        If there is no display, and no output.
    OutputError
        If the package that writes MP4 is missing.
    """
    if output is None and not has_display():
        raise InputError(NO_DISPLAY)
    if str(output).lower().endswith(".mp4") and find_spec("imageio_ffmpeg") is None:
        raise OutputError(NO_MP4)


def has_display() -> bool:
    """Whether windows can be opened: always on macOS and Windows, elsewhere if X or Wayland is running."""
    return sys.platform in ("darwin", "win32") or any(os.environ.get(key) for key in DISPLAYS)


def run_process(file: Path, way: dict[str, str], frames: int, progress: Progress | None) -> tuple[int, str, bool]:
    """The exit status of the drawing process, its standard error, and whether it drew any frame."""
    drew = False
    with tempfile.TemporaryFile("w+") as errors:
        environment = {**os.environ, **way}
        command = [*COMMAND, str(file)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True, env=environment) as process:
            assert process.stdout is not None
            try:
                for line in process.stdout:
                    drew |= line.startswith("frame ")
                    if progress is not None and line.startswith("frame "):
                        progress(float(line.split()[1]), frames)
            except BaseException:
                process.kill()
                raise
        errors.seek(0)
        return process.returncode, errors.read(), drew


def _explain(status: int, said: str) -> None:
    """Raise the error of the drawing process, whose last line is ``KIND: message`` if Python noticed the error."""
    last = said.strip().splitlines()[-1] if said.strip() else ""
    kind, _, message = last.partition(": ")
    if kind == "OSError":
        raise OSError(0, message)
    if status < 0:
        raise OutputError(NO_GRAPHICS)
    raise OutputError(f"drawing failed: {last or f'exit status {status}'}")
