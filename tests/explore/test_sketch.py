"""The sketch on the page: what Python takes from the browser, and what a mouse, a finger and keys do in a browser."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import pytest
from browser import SERIOUS, needs_browser
from open_page import NARROW, WIDE, centre, open_page, until
from playwright.sync_api import Locator, Page, expect

from explore.drawing import drawn
from explore.sketch import Sketch
from lapjoint import Problem, Stop, paper_joint
from lapjoint.problem.files import problem_from_tables, problem_tables
from lapjoint.problem.override import assign, toml_value
from lapjoint.problem.presets import lap_joint

Move = tuple[str, str, bool]


def heard(sketch: Sketch, *moves: list[Any]) -> list[Move]:
    """What the page hears of moves that a browser sends."""
    found: list[Move] = []
    sketch.param.watch(lambda event: found.append(event.new), "moved", onlychanged=False)
    for move in moves:
        sketch._handle_msg(move)
    return found


def test_a_move_is_heard_as_a_value_of_a_file() -> None:
    path = "stops.1.between.0"
    moves = heard(Sketch(drawn=drawn(lap_joint())), [path, 0.234, False], ["stops.2.gap", 7.533e-05, True])
    assert moves == [(path, '"upper:0.234"', False), ("stops.2.gap", "7.533e-5", True)]
    assert [toml_value(text) for _, text, _ in moves] == ["upper:0.234", 7.533e-05]


def test_a_move_stays_within_the_beam_and_one_of_nothing_is_not_heard() -> None:
    moves = heard(
        Sketch(drawn=drawn(paper_joint())),
        ["stops.0.x", 7, False],
        ["stops.0.x", -1.0, True],
        ["stops.9.x", 1.0, True],
        ["beam.length", 1.0, True],
        ["stops.0.x", float("nan"), True],
        ["stops.0.x", "1.0", True],
    )
    assert moves == [("stops.0.x", "2.5", False), ("stops.0.x", "0", True)]
    assert heard(Sketch(), ["stops.0.x", 1.0, True]) == []


def test_a_move_is_heard_again_after_it_was_undone() -> None:
    assert len(heard(Sketch(drawn=drawn(paper_joint())), *([["stops.0.x", 2.0, True]] * 3))) == 3


@dataclass
class Played:
    """A page with a sketch."""

    page: Page
    problem: Problem
    answers: bool
    """Whether the sketch is drawn anew after moves, a moment later."""
    moves: list[Move] = field(default_factory=list)
    sketch: Sketch | None = None

    def make(self) -> Sketch:
        """The sketch of the page that opens."""
        import panel as pn

        tables, waits = problem_tables(self.problem), False
        self.sketch = made = Sketch(drawn=drawn(self.problem), sizing_mode="stretch_width")

        def answer() -> None:
            nonlocal waits
            waits = False
            made.drawn = drawn(problem_from_tables(tables))

        def take(event: Any) -> None:
            nonlocal waits
            self.moves.append(event.new)
            path, text, _ = event.new
            assign(tables, path, toml_value(text), "")
            if self.answers and not waits:
                waits = True
                pn.state.curdoc.add_timeout_callback(answer, 50)

        made.param.watch(take, "moved", onlychanged=False)
        return made

    def ends_with(self, path: str, text: str) -> None:
        """Wait for the end of a move."""
        until(self.page, lambda: self.moves[-1:] == [(path, text, True)])

    def handle(self, label: str) -> Locator:
        """The handle with a label."""
        found = self.page.get_by_role("slider", name=label, exact=True)
        found.wait_for()
        return found


@contextmanager
def played(
    problem: Problem | None = None, width: int = WIDE, *, answers: bool = True, **options: Any
) -> Iterator[Played]:
    """A sketch in a browser."""
    one = Played(None, problem or paper_joint(), answers)  # type: ignore[arg-type]  # the page opens next
    with open_page(one.make, width, **options) as one.page:
        one.handle(f"{one.problem.stop_names[0]}, gap in m")
        yield one


def pulled(one: Played, handle: Locator, across: float, down: float, steps: int = 8) -> None:
    """Move the mouse with a handle, and hold it."""
    x, y = centre(handle)
    one.page.mouse.move(x, y)
    one.page.mouse.down()
    one.page.mouse.move(x + across, y + down, steps=steps)


@needs_browser
@pytest.mark.thorough
@pytest.mark.parametrize("width", [WIDE, NARROW])
def test_a_stop_follows_the_mouse_by_hundredths_of_the_beam(width: int) -> None:
    with played(width=width) as one:
        handle = one.handle("P3, position in m")
        along = centre(one.handle("P2, position in m"))[0] - centre(handle)[0]  # 1.25 m
        pulled(one, handle, -0.5 * along, 0)
        expect(handle).to_have_attribute("aria-valuenow", "0.625")
        one.page.mouse.up()
        expect(handle).to_have_attribute("aria-valuetext", "0.625 m")
        expect(one.page.locator(f".{'wide' if width == WIDE else 'narrow'} svg")).to_contain_text("0.625")
        one.ends_with("stops.1.x", "0.625")
        assert not any(done for *_, done in one.moves[:-1])
        for _, text, _ in one.moves:
            assert float(text) / 0.025 == pytest.approx(round(float(text) / 0.025), abs=1e-9)
        pulled(one, handle, -2 * along, 0)
        expect(handle).to_have_attribute("aria-valuenow", "0")
        one.page.mouse.up()
        assert one.page.evaluate("document.documentElement.scrollWidth") <= width


@needs_browser
@pytest.mark.thorough
def test_a_gap_doubles_when_its_face_is_pulled_away_by_a_drawn_gap() -> None:
    with played() as one:
        above, below = one.handle("P4, gap in m"), one.handle("P2, gap in m")
        x, y = centre(below)
        gap = 0.42 / 0.55 * ((y - centre(above)[1]) / 2)  # a beam of half depth 0.13, and the drawn gap
        for handle, sign in ((below, 1), (above, -1)):
            pulled(one, handle, 0, sign * gap)
            assert float(handle.get_attribute("aria-valuenow") or 0) == pytest.approx(0.002, rel=0.02)
            one.page.mouse.up()
            expect(one.page.locator(".wide svg")).to_contain_text(f"gap {handle.get_attribute('aria-valuenow')} m")
        assert centre(below) == pytest.approx((x, y), abs=1)  # no gap is to scale


@needs_browser
@pytest.mark.thorough
def test_keys_move_by_steps_and_hold_at_the_ends() -> None:
    stop = Stop(name="P", x=1.0, side="top", gap=-5e-5, stiffness=1e8)
    still = Problem(beam=paper_joint().beam, supports=paper_joint().supports, stops=(stop,))
    with played(still) as one:
        at, gap = one.handle("P, position in m"), one.handle("P, gap in m")
        for key, value in (
            *(("ArrowRight", "1.025"), ("ArrowUp", "1.05"), ("ArrowLeft", "1.025"), ("Shift+ArrowDown", "1.0225")),
            *(("PageUp", "1.2725"), ("PageDown", "1.0225"), ("End", "2.5"), ("ArrowRight", "2.5"), ("Home", "0")),
        ):
            at.press(key)
            expect(at).to_have_attribute("aria-valuenow", value)
        for key, value in (
            *(("ArrowUp", "-0.000025"), ("ArrowUp", "0"), ("ArrowUp", "0.000025"), ("ArrowUp", "0.00002625")),
            *(("ArrowDown", "0.000025"), ("Home", "0"), ("ArrowDown", "-0.000025")),
        ):
            gap.press(key)
            expect(gap).to_have_attribute("aria-valuenow", value)
        one.ends_with("stops.0.gap", "-2.5e-5")


@needs_browser
@pytest.mark.thorough
def test_a_new_picture_takes_neither_the_focus_nor_a_drag() -> None:
    with played(answers=False) as one:
        handle, other = one.handle("P3, position in m"), one.handle("P4, gap in m")
        handle.focus()
        pulled(one, handle, -200, 0)
        before, held = centre(handle), handle.get_attribute("aria-valuenow")
        tables = problem_tables(paper_joint())
        assign(tables, "stops.2.gap", 0.005, "")
        assert one.sketch is not None
        one.sketch.drawn = drawn(problem_from_tables(tables))  # in which P3 is where it was
        expect(other).to_have_attribute("aria-valuenow", "0.005")
        expect(handle).to_be_focused()
        assert handle.get_attribute("aria-valuenow") == held
        assert centre(handle) == pytest.approx(before, abs=1)
        one.page.mouse.move(before[0] - 100, before[1])
        further = handle.get_attribute("aria-valuenow")
        assert float(further or 0) < float(held or 0)
        one.page.mouse.up()
        one.page.wait_for_timeout(1200)
        expect(handle).to_have_attribute("aria-valuenow", str(further))  # no picture came since
        assign(tables, "stops.2.gap", 0.004, "")
        one.sketch.drawn = drawn(problem_from_tables(tables))
        expect(handle).to_have_attribute("aria-valuenow", "1.25")  # the server did not take the move
        assign(tables, "stops.1.x", 0.5, "")
        del tables["stops"][3]
        one.sketch.drawn = drawn(problem_from_tables(tables))
        expect(handle).to_have_attribute("aria-valuenow", "0.5")
        expect(handle).to_be_focused()
        expect(one.page.get_by_role("slider")).to_have_count(7)


@needs_browser
@pytest.mark.thorough
def test_quick_keys_are_all_counted_while_pictures_come() -> None:
    with played() as one:
        handle = one.handle("P3, position in m")
        handle.focus()
        for _ in range(20):
            one.page.keyboard.press("ArrowLeft")
            one.page.wait_for_timeout(30)
        expect(handle).to_have_attribute("aria-valuenow", "0.75")
        one.page.wait_for_timeout(1500)
        expect(handle).to_have_attribute("aria-valuenow", "0.75")
        one.ends_with("stops.1.x", "0.75")


@needs_browser
@pytest.mark.thorough
def test_moves_are_sent_25_times_a_second_at_most() -> None:
    with played(answers=False) as one:
        x, y = centre(handle := one.handle("P3, position in m"))
        one.page.mouse.move(x, y)
        one.page.mouse.down()
        took = one.page.evaluate("() => performance.now()")
        for i in range(100):
            one.page.mouse.move(x - 4 * i, y)
        one.page.mouse.up()
        took = one.page.evaluate("() => performance.now()") - took
        one.ends_with("stops.1.x", str(handle.get_attribute("aria-valuenow")))
        assert len(one.moves) <= took / 40 + 2


@needs_browser
@pytest.mark.thorough
def test_a_finger_drags_a_stop_and_does_not_scroll_the_page() -> None:
    with played(width=NARROW, has_touch=True, is_mobile=True) as one:
        handle = one.handle("P3, position in m")
        x, y = centre(handle)
        send = one.page.context.new_cdp_session(one.page).send
        send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]})
        for i in range(1, 9):
            send("Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": [{"x": x + 8 * i, "y": y + 10 * i}]})
        send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        expect(handle).not_to_have_attribute("aria-valuenow", "1.25")
        until(one.page, lambda: centre(handle) == pytest.approx((x + 64, y), abs=4))
        assert one.page.evaluate("[scrollX, scrollY]") == [0, 0]
        one.ends_with("stops.1.x", str(handle.get_attribute("aria-valuenow")))


@needs_browser
@pytest.mark.thorough
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_a_checker_finds_nothing_serious_and_the_keyboard_reaches_all(scheme: str) -> None:
    from axe_core_python.sync_playwright import Axe

    with played(lap_joint(), color_scheme=scheme) as one:
        found = Axe().run(one.page, options={"runOnly": ["wcag2a", "wcag2aa", "wcag21aa", "wcag22aa"]})["violations"]
        assert [(v["id"], v["nodes"][0]["html"][:100]) for v in found if v["impact"] in SERIOUS] == []
        reached = []
        for _ in drawn(lap_joint()).handles:
            one.page.keyboard.press("Tab")
            reached.append(one.page.locator("[role=slider]:focus").get_attribute("aria-label"))
        assert reached == [handle.label for handle in drawn(lap_joint()).handles]
        ring = "e => getComputedStyle(e, '::before').outlineStyle"
        assert one.page.locator("[role=slider]:focus").evaluate(ring) == "solid"
