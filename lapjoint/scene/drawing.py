"""The process that draws: ``python -m lapjoint.scene.drawing JOB``, with pyvista.

It prints ``frame N`` after each frame, and ends with a message on standard error where it fails.
"""

from __future__ import annotations

import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np

from lapjoint.scene.job import Job
from lapjoint.scene.stage import INK, Stage


def draw_picture(job: Job) -> None:
    """One frame, as PNG."""
    from PIL import Image

    assert job.output is not None
    Image.fromarray(Stage(job, off_screen=True).image()).save(job.output, optimize=True)
    print("frame 1", flush=True)


def draw_film(job: Job) -> None:
    """All frames, as GIF or MP4."""
    assert job.output is not None
    frames = _frames(job)
    if job.output.suffix.lower() == ".mp4":
        import imageio.v3

        images = np.stack(list(frames))
        even = images[:, : images.shape[1] // 2 * 2, : images.shape[2] // 2 * 2]  # the codec wants even sizes
        imageio.v3.imwrite(job.output, even, extension=".mp4", fps=job.pace, codec="libx264", macro_block_size=1)
    else:
        _save_gif(frames, job)


def _frames(job: Job) -> Any:
    stage = Stage(job, off_screen=True)
    for frame in range(len(job.captions)):
        stage.at(frame)
        yield stage.image()
        print(f"frame {frame + 1}", flush=True)


def _save_gif(frames: Any, job: Job) -> None:
    """A GIF with one palette for all frames, so that what does not move is stored once."""
    from PIL import Image

    assert job.output is not None

    images = [Image.fromarray(frame) for frame in frames]
    width, height = images[0].size
    some = images[:: max(1, len(images) // 8)]
    sheet = Image.new("RGB", (width, height * len(some)))
    for i, image in enumerate(some):
        sheet.paste(image, (0, height * i))
    palette = sheet.quantize(colors=255, dither=Image.Dither.NONE)
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    flat[0].save(job.output, save_all=True, append_images=flat[1:], duration=1000 / job.pace, loop=0, optimize=False)


def open_window(job: Job) -> None:
    """A window with a slider for time; the space bar plays and pauses."""
    stage = Stage(job, off_screen=False)
    last = len(job.captions) - 1
    playing = {"now": True, "frame": 0}

    def show(frame: float) -> None:
        playing["frame"] = int(frame)
        stage.at(int(frame))

    def toggle() -> None:
        playing["now"] = not playing["now"]

    slider = stage.plotter.add_slider_widget(
        show,
        (0, last),
        value=0,
        title="frame",
        fmt="%.0f",
        color=INK,
        style="modern",
        pointa=(0.72, 0.08),
        pointb=(0.97, 0.08),
    )

    def step(_: int) -> None:
        if playing["now"]:
            show((playing["frame"] + 1) % (last + 1))
            slider.GetRepresentation().SetValue(playing["frame"])
            stage.plotter.render()

    stage.plotter.add_key_event("space", toggle)
    stage.plotter.add_timer_event(max_steps=10**9, duration=round(1000 / job.pace), callback=step)
    stage.plotter.show(title=job.title)


def main() -> int:
    """Draw the job in the file given."""
    job: Job = pickle.loads(Path(sys.argv[1]).read_bytes())
    try:
        if job.output is None:
            open_window(job)
        elif len(job.captions) == 1 and job.pace == 0:
            draw_picture(job)
        else:
            draw_film(job)
    except Exception as error:
        reason = error.strerror if isinstance(error, OSError) else error
        kind = "OSError" if isinstance(error, OSError) else type(error).__name__
        print(f"{kind}: {reason}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
