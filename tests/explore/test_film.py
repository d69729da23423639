"""The film of a cycle: its picture is the motion to scale, each contact is seen, and a reader holds it at any time."""

from __future__ import annotations

import numpy as np
import pytest
from browser import SERIOUS, needs_browser
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from open_page import NARROW, WIDE, open_page, until
from playwright.sync_api import expect

from explore.answers import Bar, Cycle
from explore.film import LANE, WIDTH, Film, lit, scene_of
from lapjoint import Problem, paper_joint
from lapjoint.problem.presets import lap_joint

NO_NUMBERS = np.zeros(0)
TIMES = np.linspace(0.0, 3.9e-3, 40)
JOINTS = {"paper": paper_joint(), "lap": lap_joint()}


def cycle(problem: Problem, bars: tuple[Bar, ...] = (), size: float = 2e-3) -> Cycle:
    """A motion made of a sine, with faces beside it; `size` in m."""
    x = problem.line.grid(11)
    swing = np.sin(2 * np.pi * TIMES / 4e-3)[:, None]
    faces = np.array([stop.sign * stop.gap for stop in problem.structure.stops])
    return Cycle(
        solver="made",
        outcome="",
        period=4e-3,
        place="",
        t=NO_NUMBERS,
        z=NO_NUMBERS,
        v=NO_NUMBERS,
        forces=NO_NUMBERS,
        bars=bars,
        frame_times=TIMES,
        x=x,
        frames=size * swing * (x / x[-1]),
        faces=np.tile(faces, (TIMES.size, 1)),
        multipliers=(),
        blocks=(),
        tables=(),
    )


@pytest.mark.parametrize("name", JOINTS)
def test_beams_and_faces_are_on_one_scale_and_all_is_in_the_picture(name: str) -> None:
    problem, made = JOINTS[name], cycle(JOINTS[name])
    scene = scene_of(problem, made)
    span = max(stop[1] for stop in scene.rest) - min(stop[0] for stop in scene.rest)
    lengths = 2.5 if name == "paper" else 0.54
    high = float(scene.exaggeration) * span / lengths  # units of the picture in a metre, to two digits
    for j, (start, end) in enumerate(zip(problem.line.starts, problem.line.ends, strict=True)):
        on = (made.x >= start) & (made.x <= end)
        drawn = scene.rest[j][2] - np.array(scene.y[j])
        assert np.allclose(drawn, high * made.frames[:, on], atol=0.05 * LANE)
        assert np.all((np.array(scene.y[j]) >= 0) & (np.array(scene.y[j]) <= scene.size[1]))
        assert len(scene.x[j]) == on.sum()
        assert (scene.x[j][0], scene.x[j][-1]) == scene.rest[j][:2]
    for k, stop in enumerate(problem.structure.stops):
        middle = scene.rest[problem.line.beam_at(stop.met)][2]
        assert np.allclose(middle - np.array(scene.faces)[:, k], high * stop.sign * stop.gap, atol=0.05 * LANE)
        assert 0 < scene.stops[k][0] < WIDTH


def test_beams_lie_above_each_other_as_in_the_sketch_and_a_stop_is_at_the_beam_that_meets_it() -> None:
    scene = scene_of(lap_joint(), cycle(lap_joint()))
    upper, lower = scene.rest
    assert upper[2] < lower[2]  # from the top
    assert upper[0] < lower[0] < upper[1] < lower[1]
    assert [ground for *_, ground in scene.stops] == [False] * 3
    assert [scene.faces[0][k] < (upper[2] + lower[2]) / 2 for k in range(3)] == [False, False, True]  # the bolt's head


def test_a_beam_at_rest_has_a_film_too() -> None:
    bare = Problem(beam=paper_joint().beam)
    scene = scene_of(bare, cycle(bare, size=0.0))
    assert {y for frame in scene.y[0] for y in frame} == {scene.rest[0][2]}
    assert "none" in scene.said


def test_times_have_one_unit_and_three_digits() -> None:
    labels = scene_of(paper_joint(), cycle(paper_joint())).labels
    assert (labels[0], labels[1], labels[-1]) == ("0.00 ms", "0.10 ms", "3.90 ms")


contacts = st.tuples(st.integers(0, 2), st.floats(0.0, 3.9e-3), st.floats(0.0, 1e-3))


@given(st.lists(contacts, max_size=4))
@settings(max_examples=40, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
def test_every_contact_is_seen_and_nothing_else(found: list[tuple[int, float, float]]) -> None:
    bars = tuple(Bar(stop, start, min(start + lasts, 3.9e-3), 1.0) for stop, start, lasts in found)
    seen, half = lit(bars, TIMES, 3), 0.05e-3
    for bar in bars:
        nearest = int(np.argmin(np.abs(TIMES - (bar.start + bar.end) / 2)))
        assert seen[nearest][bar.stop]
    for i, t in enumerate(TIMES):
        for k in range(3):
            near = [b for b in bars if b.stop == k and b.start - half * 1.001 <= t <= b.end + half * 1.001]
            assert not seen[i][k] or near


def test_time_is_known_to_python_and_the_picture_is_replaced() -> None:
    film = Film()
    assert (film.time, film.shown) == (None, "null")
    film.scene = scene_of(paper_joint(), cycle(paper_joint()))
    assert '"labels": ["0.00 ms"' in film.shown


BARS = (Bar(0, 1.0e-3, 1.3e-3, 1.0),)


@needs_browser
@pytest.mark.thorough
@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_it_runs_without_traffic_and_is_held_and_stepped_by_keys(width: int) -> None:
    film = Film(scene=scene_of(paper_joint(), cycle(paper_joint(), BARS)), sizing_mode="stretch_width")
    with open_page(lambda: film, width) as page:
        slider = page.get_by_role("slider", name="Time in the cycle")
        first = slider.input_value()
        expect(slider).not_to_have_value(first)  # it runs
        sent: list[object] = []
        film.param.watch(lambda event: sent.append(event.new), "time")
        page.wait_for_timeout(500)
        assert (sent, film.time) == ([], None)
        page.get_by_role("button", name="Pause").click()
        held = int(slider.input_value())
        page.wait_for_timeout(300)
        until(page, lambda: film.time == TIMES[held])
        assert slider.input_value() == str(held)
        slider.press("Home")
        lit_face = page.locator("g.lit path.face")
        for i in range(14):
            assert lit_face.count() == (1 if 10 <= i <= 13 else 0), i
            page.keyboard.press("ArrowRight")
        expect(page.get_by_text("t = 1.40 ms")).to_be_visible()
        expect(slider).to_have_attribute("aria-valuetext", "1.40 ms")
        until(page, lambda: film.time == TIMES[14])
        film.scene = scene_of(lap_joint(), cycle(lap_joint()))
        expect(page.locator("path.beam")).to_have_count(2)
        expect(slider).to_have_value("14")
        page.get_by_role("button", name="Play").click()
        expect(slider).not_to_have_value("14")
        assert page.evaluate("document.documentElement.scrollWidth") <= width


@needs_browser
@pytest.mark.thorough
def test_a_contact_is_shown_by_more_than_a_colour() -> None:
    film = Film(scene=scene_of(paper_joint(), cycle(paper_joint(), BARS)), sizing_mode="stretch_width")
    with open_page(lambda: film, reduced_motion="reduce") as page:
        slider, width = page.get_by_role("slider"), "e => parseFloat(getComputedStyle(e).strokeWidth)"
        slider.fill("12")
        lit_face, dark = page.locator("g.lit path.face"), page.locator("g:not(.lit) path.face").first
        assert lit_face.evaluate(width) > 2 * dark.evaluate(width)


@needs_browser
@pytest.mark.thorough
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_it_stands_still_for_who_wants_less_motion_and_a_checker_finds_nothing_serious(scheme: str) -> None:
    from axe_core_python.sync_playwright import Axe

    film = Film(scene=scene_of(paper_joint(), cycle(paper_joint(), BARS)), sizing_mode="stretch_width")
    with open_page(lambda: film, reduced_motion="reduce", color_scheme=scheme) as page:
        slider = page.get_by_role("slider", name="Time in the cycle")
        expect(page.get_by_role("button", name="Play")).to_be_visible()
        page.wait_for_timeout(300)
        until(page, lambda: film.time == 0.0)
        assert slider.input_value() == "0"
        expect(page.get_by_role("img")).to_have_accessible_name("The motion from 0 to 3.90 ms. Stops in contact: P2.")
        found = Axe().run(page, options={"runOnly": ["wcag2a", "wcag2aa", "wcag21aa", "wcag22aa"]})["violations"]
        assert [(v["id"], v["nodes"][0]["html"][:100]) for v in found if v["impact"] in SERIOUS] == []
