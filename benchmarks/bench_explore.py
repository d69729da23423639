"""A page of ``lapjoint explore`` in a browser: how long a curve takes to follow a slider, and what long play costs."""

from __future__ import annotations

import itertools
import random
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from browser import needs_browser
from explored import PATIENCE, Explored, Visit, browser, exploring
from playwright.sync_api import Error, Locator

from explore.question import coarse_to_fine, opened
from explore.slider import AROUND, DIGITS, POSITIONS
from lapjoint import Axis, paper_joint, sweep
from lapjoint.campaigns.grid import FREQUENCY
from lapjoint.problem.files import problem_tables

pytestmark = needs_browser
MOVES = 50
SIZES = 41, 101, 401
"""Numbers of frequencies of the curves that follow each other."""
WARM = 180.0
"""Time after which memory may not grow by more than `GROWTH`, s: a process has met most of its code by then."""
GROWTH = 200.0
"""Most growth of memory in play, MB."""
GAP, OMEGAS = 1e-3, opened(problem_tables(paper_joint())).plan(paper_joint()).grid.axes[0].values
# Each curve that the browser gets: when the slider was last moved, when the curve was painted, how many of the
# frequencies of each of the curves that follow each other it has, and its value at the first frequency.
LISTEN = """stages => {
  window.moved = 0; window.curves = [];
  document.addEventListener("keydown", event => { window.moved = event.timeStamp; }, true);
  const picture = Bokeh.documents[0].get_model_by_name("curve");
  const source = picture.renderers.find(one => one.name === "curve lines").data_source;
  source.properties.data.change.connect(() => {
    if (!source.data.xs.length) return;  // between two problems
    const xs = source.data.xs[0], ys = source.data.ys[0], found = new Set(xs);
    const whole = stages.filter(stage => stage.every(omega => found.has(omega))).length;
    const curve = {moved: window.moved, first: xs[0], value: ys[0], whole};
    requestAnimationFrame(() => requestAnimationFrame(now => {
      curve.painted = performance.now();
      window.curves.push(curve);
    }));
  });
}"""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explored]:
    """A server for this module."""
    with exploring(tmp_path_factory.mktemp("explore")) as one:
        yield one


@pytest.fixture(scope="module")
def visit(server: Explored) -> Iterator[Visit]:
    """A page that listens to what the browser paints."""
    with browser() as one:
        visit = Visit(one, server.address)
        visit.finished()
        stages = list(itertools.accumulate(coarse_to_fine(len(OMEGAS))))
        visit.page.evaluate(LISTEN, [[OMEGAS[i] for i in stage] for stage in stages])
        yield visit
        visit.close()


def slider(visit: Visit) -> Locator:
    """The slider of the gap."""
    return visit.page.get_by_role("slider", name=re.compile(r"^stops\.\*\.gap"))


class Clock:
    """A clock that stands still but for the times that it is given."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


CLOCK = Clock()


@pytest.fixture(scope="module")
def latencies(visit: Visit) -> dict[int, list[float]]:
    """Times from moves of the slider to painted curves, s, by their numbers of frequencies."""
    found: dict[int, list[float]] = {size: [] for size in SIZES}
    for move in range(MOVES + 5):
        visit.page.evaluate("window.curves = []")
        slider(visit).press("ArrowRight" if move % 2 else "ArrowLeft")
        whole = f"window.curves.some(one => one.whole === {len(SIZES)})"
        visit.page.wait_for_function(whole, timeout=1000 * PATIENCE)
        curves = visit.page.evaluate("window.curves")
        for stage, size in enumerate(SIZES, 1):
            first = next(one for one in curves if one["whole"] >= stage)
            found[size].append((first["painted"] - first["moved"]) / 1000)
        visit.page.wait_for_timeout(400)  # until the cycle has its first answer, too
    return {size: times[5:] for size, times in found.items()}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.benchmark(group="explore: from a move of the slider to the painted curve", timer=CLOCK)
def bench_slider(benchmark: Any, latencies: dict[int, list[float]], size: int) -> None:
    times = iter(latencies[size])

    def move() -> None:
        CLOCK.now += next(times)

    benchmark.pedantic(move, rounds=MOVES)


def gap_at(position: int) -> float:
    """The gap at a position of the slider, steps from the middle."""
    return float(f"{GAP * AROUND ** (position / POSITIONS):.{DIGITS}g}")


def bench_order(benchmark: Any, visit: Visit) -> None:
    """Moves as fast as keys come: no curve of an older gap is painted after one of a newer gap."""
    visit.start("SDNL104")
    visit.start("Rahmani")
    visit.finished()
    draw, here, walk = random.Random(51), 0, [0]
    visit.page.evaluate("window.curves = []")

    def play() -> None:
        nonlocal here
        for _ in range(40):
            step = draw.choice((-1, 1))
            for _ in range(draw.randint(1, 12)):
                if abs(here + step) < POSITIONS:
                    slider(visit).press("ArrowRight" if step > 0 else "ArrowLeft")
                    here += step
                    walk.append(here)
            visit.page.wait_for_timeout(draw.choice((0, 30, 150, 600)))
        visit.page.wait_for_function(f"window.curves.at(-1)?.whole === {len(SIZES)}", timeout=1000 * PATIENCE)

    benchmark.pedantic(play, rounds=1)
    assert visit.problem["stops"][0]["gap"] == gap_at(here)
    gaps = sorted({gap_at(one) for one in walk})
    axes = [Axis("stops.*.gap", gaps), Axis(FREQUENCY, OMEGAS[:1])]
    answers = sweep(paper_joint(), axes).impulse.values.reshape(len(gaps), -1)[:, 0]
    moves = {float(answer): [i for i, one in enumerate(walk) if gap_at(one) == gap]
             for gap, answer in zip(gaps, answers, strict=True)}  # fmt: skip
    curves = visit.page.evaluate("window.curves")
    known = [one for one in curves if one["first"] == OMEGAS[0]]
    benchmark.extra_info.update(moves=len(walk), curves=len(curves), known=len(known))
    newest = 0
    for one in known:
        newest = next(i for i in moves[one["value"]] if i >= newest)  # StopIteration: an older one after a newer one
    assert len(known) > len(curves) / 2
    assert walk[newest] == here


WRONG = "", "wide", "-1", "0", "1e400", "nan", "0,4e-3", "[1, 2", "<b>ä</b>", "9" * 400
"""What is typed besides numbers."""


class Player:
    """Somebody who plays with a page at random.

    Parameters
    ----------
    visit : Visit
        The page.
    seed : int
        Of the choices.
    """

    def __init__(self, visit: Visit, seed: int) -> None:
        self.visit, self.draw, self.done = visit, random.Random(seed), 0
        self.moves = (self.slide, self.slide, self.type, self.type, self.click, self.undo, self.start, self.button,
                      self.unfold, self.word, self.tick)  # fmt: skip
        visit.page.set_default_timeout(3000)

    def move(self) -> None:
        """One move; one on something that vanishes meanwhile is none."""
        try:
            self.draw.choice(self.moves)()
            self.done += 1
        except Error:
            self.visit.page.keyboard.press("Escape")
            self.visit.page.mouse.click(3, 3)  # beside a menu that stays open
        self.visit.page.wait_for_timeout(self.draw.choice((10, 100, 300, 1500)))

    def any(self, found: Locator) -> Locator:
        """One of several elements."""
        return found.nth(self.draw.randrange(max(found.count(), 1)))

    def slide(self) -> None:
        one = self.any(self.visit.page.get_by_role("slider"))
        for _ in range(self.draw.randint(1, 15)):
            one.press(self.draw.choice(("ArrowLeft", "ArrowRight", "ArrowRight")))

    def type(self) -> None:
        one = self.any(self.visit.page.get_by_role("textbox"))
        try:
            text = f"{float(one.input_value()) * self.draw.uniform(0.5, 2):.4g}"
        except ValueError:
            text = self.draw.choice(WRONG)
        one.fill(text if self.draw.random() < 0.8 else self.draw.choice(WRONG))
        one.press("Tab")

    def click(self) -> None:
        state = self.visit.state
        self.visit.page.mouse.click(*self.visit.at(self.draw.uniform(state.first, state.last)))

    def undo(self) -> None:
        for _ in range(self.draw.randint(1, 4)):
            self.visit.press(self.draw.choice(("Undo", "Undo", "Redo")))

    def start(self) -> None:
        self.visit.page.get_by_label("Start from").click()
        self.any(self.visit.page.get_by_role("menuitem")).click()

    def button(self) -> None:
        self.any(self.visit.page.get_by_role("button", name=re.compile("^(Add|Remove)"))).click()

    def unfold(self) -> None:
        self.any(self.visit.page.locator("button[aria-expanded]")).click()

    def word(self) -> None:
        self.any(self.visit.page.get_by_role("combobox")).click()
        self.any(self.visit.page.get_by_role("menuitem")).click()

    def tick(self) -> None:
        self.any(self.visit.page.get_by_role("checkbox")).click()


@pytest.mark.benchmark(group="explore: memory in random play, MB; growth since three minutes")
def bench_play(benchmark: Any, request: pytest.FixtureRequest, tmp_path: Path) -> None:
    minutes = float(request.config.getoption("--play-minutes"))
    curve: list[tuple[float, float]] = []
    with exploring(tmp_path) as server, browser() as one:
        visit = Visit(one, server.address)
        visit.finished()
        crew, player = set(server.pids), Player(visit, 51)

        def play() -> None:
            begin = sampled = time.monotonic()
            while time.monotonic() < begin + 60 * minutes:
                player.move()
                if time.monotonic() > sampled + 10:
                    sampled = time.monotonic()
                    curve.append((sampled - begin, server.memory))

        benchmark.pedantic(play, rounds=1)
        warm = [memory for at, memory in curve if at <= WARM]
        benchmark.extra_info.update(moves=player.done, memory=[(round(at), round(memory)) for at, memory in curve])
        print(benchmark.extra_info)
        assert max(memory for _, memory in curve) < max(warm, default=0.0) + GROWTH
        visit.page.set_default_timeout(60_000)
        visit.page.keyboard.press("Escape")
        visit.start("two plates")
        visit.start("Rahmani")
        visit.finished()
        assert set(server.pids) == crew, "a process died"
        assert server.said == ""
        visit.close()
