"""The process that draws, with pyvista.

``python -m lapjoint.scene.render FILE`` takes the file of a pickled `Drawing`.  It prints ``frame N`` after each frame,
and a message on standard error if it fails.
"""

from __future__ import annotations

import errno
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np

from lapjoint.scene.frames import Drawing
from lapjoint.scene.plotter import BRIEF, INK, LIT, SILENT, Stage


def draw_picture(drawing: Drawing) -> None:
    """Draw one frame as PNG."""
    from PIL import Image

    assert drawing.output is not None
    Image.fromarray(Stage(drawing, off_screen=True).image()).save(drawing.output, optimize=True)
    print("frame 1", flush=True)


def draw_film(drawing: Drawing) -> None:
    """Draw all frames as GIF or MP4."""
    assert drawing.output is not None
    frames = _frames(drawing)
    if drawing.output.suffix.lower() == ".mp4":
        save_mp4(frames, drawing)
    else:
        _save_gif(frames, drawing)


def save_mp4(frames: Any, drawing: Drawing) -> None:
    """Write the frames as MP4; an incomplete film raises `OSError`."""
    import imageio.v3
    import imageio_ffmpeg

    assert drawing.output is not None
    images = np.stack(list(frames))
    even = images[:, : images.shape[1] // 2 * 2, : images.shape[2] // 2 * 2]  # the codec wants even sizes
    imageio.v3.imwrite(drawing.output, even, extension=".mp4", fps=drawing.pace, codec="libx264", macro_block_size=1)
    try:  # the encoder does not report a full disk
        written = imageio_ffmpeg.count_frames_and_secs(str(drawing.output))[0]
    except RuntimeError:
        written = 0
    if written != len(images):
        raise OSError(errno.ENOSPC, "the film is not complete; is the disk full?")


def _frames(drawing: Drawing) -> Any:
    stage = Stage(drawing, off_screen=True)
    for frame in range(len(drawing.captions)):
        stage.at(frame)
        yield stage.image()
        print(f"frame {frame + 1}", flush=True)


def _save_gif(frames: Any, drawing: Drawing) -> None:
    """Write a GIF with one palette for all frames, so that parts that do not move are stored only once."""
    from PIL import Image

    assert drawing.output is not None
    images = [Image.fromarray(frame) for frame in frames]
    palette = _palette(images)
    flat = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    duration = 10 * round(100 / drawing.pace)  # a GIF counts in hundredths of a second
    flat[0].save(drawing.output, save_all=True, append_images=flat[1:], duration=duration, loop=0, optimize=False)


def _palette(images: list[Any]) -> Any:
    """The palette of all frames, with pure white and the colours of the stops, even if stops have few pixels."""
    from PIL import Image, ImageColor

    width, height = images[0].size
    some = images[:: max(1, len(images) // 8)]
    stripe = max(8, height // 20)
    sheet = Image.new("RGB", (width, (height + 3 * stripe) * len(some)), "white")
    for i, image in enumerate(some):
        sheet.paste(image, (0, height * i))
    shades = [
        tuple(round(channel * light) for channel in ImageColor.getrgb(colour))
        for colour in (SILENT, BRIEF, LIT)
        for light in (1.0, 0.85, 0.7, 0.55)
    ]
    top = height * len(some)
    patch = width // len(shades)
    for i, shade in enumerate(shades):
        sheet.paste(shade, (patch * i, top, patch * (i + 1), sheet.height))
    palette = sheet.quantize(colors=255, dither=Image.Dither.NONE)
    colours = np.array(palette.getpalette()).reshape(-1, 3)
    colours[colours.min(axis=1) >= 248] = 255  # because the quantiser matches colours coarsely
    palette.putpalette(colours.ravel().tolist())
    return palette


def open_window(drawing: Drawing) -> None:
    """Open a window with a slider for time; the space bar plays and pauses.

    The process prints ``frame 0`` when the window is open, because VTK ends without a message if it finds no display.
    """
    stage = Stage(drawing, off_screen=False)
    milliseconds = 1e3 * drawing.times
    playing = {"now": True, "frame": 0, "open": False}

    def show(time: float) -> None:
        playing["frame"] = int(np.argmin(np.abs(milliseconds - time)))
        stage.at(playing["frame"])

    def toggle() -> None:
        playing["now"] = not playing["now"]

    slider = stage.plotter.add_slider_widget(
        show,
        (milliseconds[0], milliseconds[-1]),
        value=milliseconds[0],
        title="time [ms]",
        fmt="%.2f",
        color=INK,
        style="modern",
        pointa=(0.72, 0.08),
        pointb=(0.97, 0.08),
    )

    def step(_: int) -> None:
        if not playing["open"]:
            playing["open"] = True
            print("frame 0", flush=True)
        if playing["now"]:
            frame = (playing["frame"] + 1) % drawing.times.size
            show(milliseconds[frame])
            slider.GetRepresentation().SetValue(milliseconds[frame])
            stage.plotter.render()

    stage.plotter.add_key_event("space", toggle)
    stage.plotter.add_timer_event(max_steps=10**9, duration=round(1000 / drawing.pace), callback=step)
    stage.plotter.show(title=drawing.title)


def main() -> int:
    """Draw the drawing in the file named by the first argument; return the exit status."""
    drawing: Drawing = pickle.loads(Path(sys.argv[1]).read_bytes())
    try:
        if drawing.output is None:
            open_window(drawing)
        elif len(drawing.captions) == 1 and drawing.pace == 0:
            draw_picture(drawing)
        else:
            draw_film(drawing)
    except Exception as error:
        reason = error.strerror if isinstance(error, OSError) else error
        kind = "OSError" if isinstance(error, OSError) else type(error).__name__
        print(f"{kind}: {reason}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
