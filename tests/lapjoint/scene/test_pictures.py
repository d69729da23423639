"""Pictures and films: what is drawn is the motion, and what cannot be drawn is said in a sentence."""

from __future__ import annotations

import signal
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import analytic
from lapjoint import FREE, History, InputError, paper_joint
from lapjoint.answers import Contact
from lapjoint.errors import OutputError
from lapjoint.scene import Look, check_can_show, pictures, render_process, save_film, save_picture, show_window
from lapjoint.scene.frames import Drawing

LIT = np.array([0xE6, 0x9F, 0x00])


@pytest.fixture
def jobs(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> list[Drawing]:
    """What would be drawn; nothing is."""
    kept: list[Drawing] = []

    def keep(drawing: Drawing, progress: Any) -> None:
        kept.append(drawing)
        assert drawing.output is not None
        drawing.output.touch()

    monkeypatch.setattr(pictures, "draw", keep)
    monkeypatch.chdir(tmp_path)
    return kept


def test_the_scale_is_one_two_or_five_times_a_power_of_ten_and_stated(solid: History, jobs: list[Drawing]) -> None:
    save_picture(solid, "x.png", at=0.25)
    # 0.12 m over 3 mm is 40, and 0.6 of the spring's 1/15 m over 2 mm is 20.
    assert any(note == "displacements and gaps ×20, beam at true scale" for note in jobs[0].notes)
    save_picture(solid, "x.png", at=0.25, look=Look(scale=1.0, frame="absolute"))
    assert "true scale" in jobs[1].notes
    moved = [drawing.skins[0].points[0, -1, 2] - 0.01 for drawing in jobs]
    np.testing.assert_allclose(moved, [20 * 3e-3, 3e-3], rtol=1e-12)


def test_a_picture_of_a_moving_base_says_where_one_stands(jobs: list[Drawing]) -> None:
    motion = analytic.Solver(n_modes=2).simulate(paper_joint(), 1e-3)
    for frame, words in (("relative", "seen from the base"), ("absolute", "seen from outside")):
        save_picture(motion, "x.png", look=Look(frame=frame))  # type: ignore[arg-type]
        assert jobs[-1].notes[-1].endswith(words)


def test_colours_are_the_values_in_the_unit_of_their_label(solid: History, jobs: list[Drawing]) -> None:
    for colour in ("stress", "velocity", "moment", "displacement"):
        save_picture(solid, "x.png", at=0.2, look=Look(colour))
    stress, velocity, moment, displacement = jobs
    root = 0
    assert stress.label == "bending stress [MPa]"
    height = -0.01  # of the first point of the section
    exact = -2e11 * height * solid.evaluate(0.0, 0.2, dx=2)[0, 0] / 1e6
    assert stress.skins[0].values[0, root] == pytest.approx(exact, rel=1e-14)
    assert velocity.skins[0].values[0, -1] == solid.velocity(1.0, 0.2)[0, 0]
    assert moment.skins[0].values[0, root] == solid.moment(0.0, 0.2)[0, 0]
    assert displacement.skins[0].values[0, -1] == pytest.approx(1e3 * solid.displacement(1.0, 0.2)[0, 0], rel=1e-15)
    for drawing in jobs:
        assert drawing.limits[1] == -drawing.limits[0] >= np.abs(drawing.skins[0].values).max()


@pytest.mark.parametrize(("start", "frame"), [(0.26, 3), (0.97, 9)])
def test_a_stop_that_acts_between_two_frames_lights_up_faintly_in_the_nearer_one(
    history: History, jobs: list[Drawing], start: float, frame: int
) -> None:
    tap = {"contacts": (Contact(0, start, start + 1e-4, 1.0, 1.0),), "switch_times": np.zeros(0), "states": (FREE,)}
    save_film(replace(history, **tap), "x.gif", frames=10)
    assert jobs[0].springs[0].acts[:, 0].tolist() == [int(i == frame) for i in range(10)]
    assert [", above in between" in caption for caption in jobs[0].captions] == [i == frame for i in range(10)]


def test_a_stop_that_is_closed_in_a_frame_is_lit_as_the_caption_says(history: History, jobs: list[Drawing]) -> None:
    save_film(history, "x.gif", frames=4)
    assert (jobs[0].springs[0].acts == 2).tolist() == [[False, False], [True, False], [False, False], [False, True]]
    assert [caption.split(", ")[1] for caption in jobs[0].captions[1::2]] == ["state above", "state below"]


def test_a_gif_says_the_pace_that_it_has(history: History, jobs: list[Drawing]) -> None:
    save_film(history, "x.gif", frames=10, pace=30.0)  # three hundredths of a second each: 33.3 a second, of 0.1 s each
    assert jobs[0].notes[-1].endswith("sped up 3.33×")
    save_film(history, "x.mp4", frames=10, pace=30.0)
    assert jobs[1].notes[-1].endswith("sped up 3×")


def test_too_few_frames_a_period_are_said(jobs: list[Drawing]) -> None:
    motion = analytic.Solver(n_modes=2).simulate(paper_joint(), 0.1)
    save_film(motion, "x.gif", frames=20)
    assert jobs[0].notes[-1] == "only 2.44 frames a period"


def test_names_go_with_what_they_name(jobs: list[Drawing]) -> None:
    motion = analytic.Solver(n_modes=2).simulate(paper_joint(), 0.01)
    save_film({"analytic": motion, "fe": motion}, "x.gif", frames=20, look=Look(frame="absolute", scale=1.0))
    base = 0.06 * np.sin(515.0 * jobs[0].times)
    for word in jobs[0].words:
        np.testing.assert_allclose(np.diff(word.places[:, 2]), np.diff(base), atol=1e-12)
    assert [word.text for word in jobs[0].words if word.side == "right"] == ["analytic", "fe"]


def test_stops_at_one_place_stand_side_by_side(history: History, jobs: list[Drawing]) -> None:
    twin = history.problem.stops[0].model_copy(update={"name": "hard"})
    problem = history.problem.replace(stops=(*history.problem.stops, twin))
    save_picture(replace(history, problem=problem), "x.png", at=0.0)
    across = jobs[0].springs[0].points[0, :, 0, 1]
    np.testing.assert_allclose(across, [-1 / 120, 0.0, 1 / 120], rtol=1e-12)


def test_a_display_that_does_not_answer_is_said(history: History, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("DISPLAY", ":77")
    monkeypatch.setattr(render_process, "run_process", lambda *_: (0, "bad X server connection", False))
    with pytest.raises(InputError, match="DISPLAY = ':77': no window can be opened there"):
        show_window(history)
    monkeypatch.setattr(render_process, "run_process", lambda *_: (1, "the window was destroyed", True))
    show_window(history)


def test_a_film_that_is_not_complete_is_not_called_one(
    history: History, jobs: list[Drawing], monkeypatch: pytest.MonkeyPatch
) -> None:
    import imageio_ffmpeg

    from lapjoint.scene import render

    save_film(history, "x.mp4", frames=2)
    monkeypatch.setattr(imageio_ffmpeg, "count_frames_and_secs", lambda path: (1, 0.1))
    with pytest.raises(OSError, match="is the disk full"):
        render.save_mp4([np.zeros((20, 20, 3), dtype=np.uint8)] * 2, jobs[0])


def test_a_film_leaves_out_the_end_which_is_the_beginning(history: History, jobs: list[Drawing]) -> None:
    save_film(history, "x.gif", frames=4, pace=2.0)
    assert [caption.split(", ")[0] for caption in jobs[0].captions] == [
        "t = 0.000 ms", "t = 250.000 ms", "t = 500.000 ms", "t = 750.000 ms"
    ]  # fmt: skip
    assert jobs[0].notes[-1].endswith("slowed 2×")


def test_a_picture_is_taken_when_the_stops_push_hardest(history: History, jobs: list[Drawing]) -> None:
    save_picture(history, "x.png")
    assert jobs[0].captions == ("t = 250.000 ms, state above",)


def test_a_beam_without_a_section_is_a_tube_coloured_by_its_moment(history: History, jobs: list[Drawing]) -> None:
    save_picture(history, "x.png")
    assert jobs[0].label == "bending moment [N m]"
    assert jobs[0].skins[0].cells.shape[1] == 2
    with pytest.raises(InputError, match="the beam has no section"):
        save_picture(history, "x.png", look=Look("stress"))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda h: save_picture(h, "x.jpg"), r"x.jpg: must end in .png"),
        (lambda h: save_film(h, "film"), "without an ending"),
        (lambda h: save_picture(h, "x.png", at=2.0), "at = 2"),
        (lambda h: save_picture(h, "x.png", at=float("nan")), "at = nan"),
        (lambda h: save_film(h, "x.gif", frames=1), "frames = 1"),
        (lambda h: save_film(h, "x.gif", pace=0.0), "pace = 0: allowed are 0.1 to 50"),
        (lambda h: save_picture({}, "x.png"), "none to show"),
        (lambda h: Look(colour="red"), "colour = 'red'"),
        (lambda h: Look(frame="moving"), "frame = 'moving'"),
        (lambda h: Look(scale=0.0), "scale = 0"),
        (lambda h: Look(size=(10, 10)), "size = 10x10"),
        (lambda h: Look(size=(300,)), "size = 300"),
        (lambda h: Look(size=(300.5, 300)), "size = 300.5x300"),
        (lambda h: save_picture(h, "x.png", look=Look(scale=1e30)), "scale = 1e.30: draws displacements longer"),
        (lambda h: save_film(h, "x.gif", pace=60.0), "pace = 60: allowed are 0.1 to 50"),
        (lambda h: save_film(h, "no/such/x.gif"), "cannot be written"),
    ],
)
def test_bad_arguments_are_refused(history: History, call: Any, message: str) -> None:
    with pytest.raises((InputError, OutputError), match=message):
        call(history)


def test_without_a_display_a_window_is_refused_before_any_work(
    history: History, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(render_process, "has_display", lambda: False)
    for ask in (lambda: show_window(history), lambda: check_can_show(None)):
        with pytest.raises(InputError, match="no display"):
            ask()


def test_without_its_package_mp4_is_refused_before_any_work(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(render_process, "find_spec", lambda name: None)
    with pytest.raises(OutputError, match="imageio"):
        check_can_show("x.mp4")


def test_a_crash_of_vtk_becomes_a_sentence(history: History, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    ways: list[dict[str, str]] = []

    def crash(file: Path, way: dict[str, str], frames: int, progress: Any) -> tuple[int, str, bool]:
        ways.append(way)
        return -signal.SIGSEGV, "Failed to load an X11 library", False

    monkeypatch.setattr(render_process, "run_process", crash)
    with pytest.raises(OutputError, match="install libosmesa6"):
        save_picture(history, tmp_path / "x.png")
    assert ways == [{}, render_process.SOFTWARE]


def test_what_ends_the_drawing_process_is_told_apart(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    run = render_process.run_process
    for code, status in (("import os; os.abort()", -signal.SIGABRT), ("raise SystemExit(3)", 3)):
        monkeypatch.setattr(render_process, "COMMAND", (sys.executable, "-c", code))
        assert run(tmp_path, {}, 1, None)[0] == status


@pytest.mark.usefixtures("graphics")
class TestDrawn:
    """What is drawn, looked at."""

    def test_a_picture_shows_the_beam_and_lights_the_stop_that_acts(
        self, solid: History, tmp_path: Path, graphics: Path
    ) -> None:
        lit = pixels(save_picture(solid, tmp_path / "x.png", at=0.25, look=Look(size=(600, 300))))
        dark = pixels(graphics)  # of another joint, at rest
        assert lit.shape == (300, 600, 3)
        assert coloured(lit, LIT) > 50
        assert coloured(dark, LIT) == 0
        assert (lit == 255).all(axis=2).mean() > 0.3  # white around it
        assert len(np.unique(lit.reshape(-1, 3), axis=0)) > 500  # shaded, coloured

    @pytest.mark.thorough
    def test_a_film_moves_and_begins_again(self, history: History, tmp_path: Path) -> None:
        shown: list[float] = []
        path = save_film(
            history,
            tmp_path / "x.gif",
            frames=6,
            pace=10.0,
            look=Look(size=(300, 200)),
            progress=lambda done, of: shown.append(done / of),
        )
        with Image.open(path) as film:
            assert (film.n_frames, film.size, film.info["loop"], film.info["duration"]) == (6, (300, 200), 0, 100)
            frames = []
            for i in range(6):
                film.seek(i)
                frames.append(np.asarray(film.convert("RGB")))
        assert all((a != b).any() for a, b in pairwise(frames))
        assert shown == [i / 6 for i in range(1, 7)]
        assert all((frame[-1, 0] == 255).all() for frame in frames)
        scales = [frame[170:].astype(int) for frame in frames]  # the colour scale stands still
        assert max(np.abs(scale - scales[0]).max() for scale in scales) < 60
        assert coloured(frames[1].astype(int), LIT) > 20  # as orange as in a picture

    @pytest.mark.thorough
    def test_mp4_is_written_where_its_package_is(self, history: History, tmp_path: Path) -> None:
        import imageio_ffmpeg

        path = save_film(history, tmp_path / "x.mp4", frames=5, look=Look(size=(301, 201)))
        frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
        assert (frames, seconds) == (5, 0.25)

    @pytest.mark.thorough
    def test_two_motions_stand_side_by_side(self, solid: History, tmp_path: Path) -> None:
        both = {"analytic": solid, "fe": solid}
        path = save_picture(both, tmp_path / "x.png", at=0.25, look=Look(size=(600, 300)))
        assert coloured(pixels(path), LIT) > 50

    def test_a_file_that_cannot_be_written_is_said(self, solid: History, tmp_path: Path) -> None:
        (tmp_path / "x.png").mkdir()
        with pytest.raises(OutputError, match="cannot be written"):
            save_picture(solid, tmp_path / "x.png", look=Look(size=(200, 200)))
        assert [path.name for path in tmp_path.iterdir()] == ["x.png"]


def pixels(path: Path) -> Any:
    """RGB, ``(height, width, 3)``."""
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def coloured(image: Any, colour: Any) -> int:
    """How many pixels have the hue of a colour: its channels in proportion, as shading leaves them."""
    bright = image.max(axis=2) > 80
    unit = image / np.maximum(np.linalg.norm(image, axis=2, keepdims=True), 1)
    return int((bright & (unit @ (colour / np.linalg.norm(colour)) > 0.995)).sum())
