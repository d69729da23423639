"""``lapjoint explore`` as a process of its own, and its page in a real browser, with what a person does there."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

from browser import BROWSER
from open_page import until
from playwright.sync_api import Browser, Error, Locator, Page, expect, sync_playwright

from explore.question import Question, unpacked

PATIENCE = 300.0  # s; the first answer may wait for a compilation
FULL = 401  # frequencies of a whole curve
expect.set_options(timeout=30_000)
# Texts of all shadow roots; a page of Bokeh consists of them.
WALK = """
function* roots(one) {
  yield one;
  for (const e of one.querySelectorAll("*")) if (e.shadowRoot) yield* roots(e.shadowRoot);
}
"""


@dataclass
class Explored:
    """A server of the page, in a process of its own."""

    process: subprocess.Popen[str]
    address: str
    errors: Path
    """The file with what it says on stderr."""

    @property
    def port(self) -> int:
        """Its port."""
        found = urlsplit(self.address).port
        assert found is not None
        return found

    @property
    def pids(self) -> list[int]:
        """The numbers of its processes: its own first, then those that it started."""
        found, parents = [self.process.pid], {}
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                parents[int(folder.name)] = int((folder / "stat").read_text().rsplit(")", 1)[1].split()[1])
            except OSError:  # it ended meanwhile
                continue
        for one in found:
            found += [pid for pid, parent in parents.items() if parent == one]
        return found

    @property
    def memory(self) -> float:
        """Memory of its processes, each page shared between them counted once, MB."""
        total = 0.0
        for pid in self.pids:
            try:
                text = Path(f"/proc/{pid}/smaps_rollup").read_text()
            except OSError:
                continue
            total += int(re.search(r"^Pss:\s+(\d+)", text, re.MULTILINE)[1]) / 1024  # type: ignore[index]
        return total

    @property
    def said(self) -> str:
        """What it said on stderr."""
        return self.errors.read_text(encoding="utf-8")


@contextmanager
def exploring(folder: Path, *arguments: str) -> Iterator[Explored]:
    """A server that is started in a folder, and ended by Ctrl-C; on stderr it says nothing but what it refused."""
    command = [sys.executable, "-m", "lapjoint", "explore", "--no-browser", *arguments]
    errors = folder / "stderr.txt"
    with errors.open("w", encoding="utf-8") as file:
        process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=file, text=True)
    assert process.stdout is not None
    try:
        found = re.search(r"http://\S+", process.stdout.readline())
        assert found, errors.read_text(encoding="utf-8")
        yield Explored(process, found[0], errors)
        process.send_signal(signal.SIGINT)
        assert process.wait(PATIENCE) == 0
        refused = re.compile(r"40[34] GET |ERROR:bokeh.server.views.ws:Refusing ")  # what was asked without a right to
        said = [line for line in errors.read_text(encoding="utf-8").splitlines() if not refused.match(line)]
        assert said == [], said
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


@contextmanager
def browser() -> Iterator[Browser]:
    """The browser."""
    with sync_playwright() as playwright:
        one = playwright.chromium.launch(executable_path=BROWSER)
        yield one
        one.close()


class Visit:
    """One page of a server in a browser: what a person sees and does.

    Parameters
    ----------
    browser : Browser
        The browser.
    address : str
        The address of the page.
    width : int
        Width of the screen, pixels.
    options : dict, optional
        Options of the browser's context.
    """

    def __init__(self, browser: Browser, address: str, width: int = 1280, **options: Any) -> None:
        self.page: Page = browser.new_context(viewport={"width": width, "height": 1000}, **options).new_page()
        self.page.set_default_timeout(30_000)
        self.failures: list[str] = []
        """Errors of scripts, and of the browser's console."""
        self.asked: set[str] = set()
        """Hosts from which something was asked."""
        self.page.on("pageerror", lambda error: self.failures.append(error.stack or str(error)))
        self.page.on("console", lambda line: self.failures.append(line.text) if line.type == "error" else None)
        self.page.on("request", lambda one: self.asked.add(urlsplit(one.url).netloc))
        self.page.goto(address)
        self.link.wait_for()

    def close(self) -> None:
        """Close the page; its scripts may not have failed."""
        self.page.context.close()
        assert self.failures == [], self.failures

    @property
    def link(self) -> Locator:
        """The link to the state."""
        return self.page.get_by_role("link", name="A link to this state")

    @property
    def address(self) -> str:
        """The address that the link leads to."""
        return str(self.link.evaluate("one => one.href"))

    @property
    def state(self) -> Question:
        """What the page asks, as its link has it."""
        return unpacked(parse_qs(urlsplit(self.address).query)["state"][0])

    @property
    def problem(self) -> dict[str, Any]:
        """The tables of the problem of the page."""
        return self.state.tables

    def until(self, true: Callable[[], bool], patience: float = 30.0) -> None:
        """Wait until something holds of the page."""
        until(self.page, true, patience)

    def finished(self, verdict: str = "The solvers agree") -> None:
        """Wait for the whole curve, and the verdict on the cycle."""
        expect(self.page.get_by_text(f"{FULL} of {FULL} frequencies")).to_be_visible(timeout=1000 * PATIENCE)
        expect(self.page.get_by_text(verdict)).to_be_visible(timeout=1000 * PATIENCE)

    def field(self, label: str, which: int = 0) -> Locator:
        """The text field with a label."""
        return self.page.get_by_role("textbox", name=label, exact=True).nth(which)

    def type(self, label: str, text: str, which: int = 0) -> Locator:
        """Type text into a field, and leave the field."""
        one = self.field(label, which)
        one.fill(text)
        one.press("Tab")
        return one

    def choose(self, label: str, word: str | re.Pattern[str], which: int = 0) -> None:
        """Choose a word in a list with a label."""
        self.page.get_by_label(label, exact=True).nth(which).click()
        self.page.get_by_role("menuitem", name=word).click()

    def press(self, name: str) -> None:
        """Press a button."""
        self.page.get_by_role("button", name=name, exact=True).click()

    def unfold(self, name: str, which: int = 0) -> None:
        """Open a group or a list of the form."""
        heading = self.page.get_by_role("button", name=re.compile(rf"^{re.escape(name)}( \((\d+|none)\))?$")).nth(which)
        if heading.get_attribute("aria-expanded") != "true":
            heading.click()
        expect(heading).to_have_attribute("aria-expanded", "true")

    def start(self, name: str) -> None:
        """Start from a preset, or a problem of the gallery."""
        self.choose("Start from", re.compile(name))

    def save(self, button: str, folder: Path) -> Path:
        """Save what a button saves, into a folder."""
        with self.page.expect_download() as waiting:
            self.press(button)
        path = folder / waiting.value.suggested_filename
        waiting.value.save_as(path)
        return path

    def open(self, file: Path) -> None:
        """Open a file."""
        self.page.locator("input[type=file]").set_input_files(file)

    def message(self, one: Locator) -> str:
        """The text that describes a field."""
        described = one.get_attribute("aria-describedby")
        return str(one.evaluate("(e, id) => e.getRootNode().getElementById(id)?.textContent ?? ''", described))

    def tables(self) -> dict[str, list[list[str]]]:
        """The tables of the page as texts, without their headings, by their captions."""
        script = """tables => tables.map(t => [t.caption.textContent,
            [...t.tBodies[0].rows].map(r => [...r.cells].map(c => c.textContent))])"""
        return dict(self.page.locator("table").evaluate_all(script))

    def at(self, x: float) -> tuple[float, float]:
        """The pixel of an abscissa in the middle of the picture of the curve."""
        script = """x => {
            const views = [...Bokeh.index.query((view) => view.model.name === "curve")];
            const view = views[0], frame = view.frame, box = view.el.getBoundingClientRect();
            return [box.left + frame.x_scale.compute(x), box.top + (frame.bbox.top + frame.bbox.bottom) / 2];
        }"""
        across, down = self.page.evaluate(script, x)
        return float(across), float(down)


def alive(one: Visit) -> bool:
    """Whether a page still answers."""
    try:
        return bool(one.page.evaluate("true"))
    except Error:
        return False
