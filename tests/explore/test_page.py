"""The page of ``lapjoint explore`` in a real browser, as a person uses it, beside the command line."""

from __future__ import annotations

import csv
import json
import math
import re
import time
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
import xarray as xr
from browser import SERIOUS, needs_browser
from command_line import run, run_well
from explored import PATIENCE, WALK, Explored, Visit, browser, exploring
from playwright.sync_api import Browser, expect

from explore.question import opened, read_back
from lapjoint import paper_joint
from lapjoint.problem.example import commented_example
from lapjoint.problem.files import problem_tables, read_problem

pytestmark = [needs_browser, pytest.mark.thorough]
GAP = "gap [m] *"
FIRST = opened(problem_tables(paper_joint()))
"""What a page asks when it is opened."""


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Explored]:
    """The server of all tests; it says nothing on stderr until its end."""
    with exploring(tmp_path_factory.mktemp("explore")) as one:
        yield one


@pytest.fixture(scope="module")
def shown(server: Explored) -> Iterator[Browser]:
    with browser() as one:
        yield one


@pytest.fixture(scope="module")
def kept(server: Explored, shown: Browser) -> Iterator[Visit]:
    """A page that most tests share."""
    one = Visit(shown, server.address)
    one.finished()
    yield one
    one.close()


@pytest.fixture
def paper(kept: Visit) -> Visit:
    """That page, at the first question, with one stop and its fields open."""
    if kept.state != FIRST:
        kept.start("Lap joint of Rahmani")
        kept.until(lambda: kept.state == FIRST)
    kept.unfold("stops")
    kept.unfold("P2")
    expect(kept.field(GAP)).to_have_value("0.001")
    return kept


def test_a_page_shows_curve_cycle_and_verdict_and_asks_no_other_machine(server: Explored, kept: Visit) -> None:
    assert kept.asked <= {f"127.0.0.1:{server.port}", ""}
    assert kept.page.title()
    assert kept.page.locator("canvas").count() > 3
    assert next(iter(kept.tables())).startswith("Impulse per excitation period")


def test_a_browser_that_takes_its_time_asks_no_other_machine(server: Explored, shown: Browser) -> None:
    """Its page is given up before its scripts are there, and made again."""
    page, asked = shown.new_page(), set()
    page.on("request", lambda one: asked.add(urlsplit(one.url).netloc))
    page.route("**/bokeh.min.js*", lambda route: (time.sleep(7), route.continue_()))
    page.goto(f"{server.address}?state={FIRST.in_unit(hz=True).packed()}")
    expect(page.get_by_role("textbox", name="from [Hz]")).to_be_visible()
    page.close()
    assert asked <= {f"127.0.0.1:{server.port}", ""}


def test_each_kind_of_field_changes_the_problem(paper: Visit) -> None:
    paper.type(GAP, "1.5e-3")
    paper.until(lambda: paper.problem["stops"][0]["gap"] == 1.5e-3)
    paper.type("title", "another")
    paper.until(lambda: paper.problem["title"] == "another")
    paper.choose("side", "top")
    paper.until(lambda: paper.problem["stops"][0]["side"] == "top")
    paper.page.get_by_role("checkbox", name="may_pull").check()
    paper.until(lambda: paper.problem["stops"][0].get("may_pull") is True)
    paper.unfold("base_motion")
    paper.choose("base_motion: kind", "harmonics")
    paper.until(lambda: paper.problem["base_motion"]["kind"] == "harmonics")
    paper.press("Add to stops")
    paper.until(lambda: len(paper.problem["stops"]) == 5)
    assert len({stop["name"] for stop in paper.problem["stops"]}) == 5
    paper.press("Remove P2")
    paper.until(lambda: [stop["name"] for stop in paper.problem["stops"]][:2] == ["P3", "P4"])


@pytest.mark.parametrize(
    ("label", "text"),
    [(GAP, "wide"), (GAP, "0,4e-3"), ("x [m]", "7"), ("stiffness [N/m] *", "-1"), ("stiffness [N/m] *", ""),
     ("between", '["upper:0.3"'), ("side", "")],
)  # fmt: skip
def test_what_is_wrong_stands_at_its_field_in_the_words_of_the_command_line(
    paper: Visit, tmp_path: Path, label: str, text: str
) -> None:
    if label == "side":
        paper.choose("side", "(none)")
        field = paper.page.get_by_label("side", exact=True).first
    else:
        field = paper.type(label, text)
        expect(field).to_have_attribute("aria-invalid", "true")
    saved = paper.save("Save as problem.toml", tmp_path)
    result = run("steady", saved)
    assert result.exit_code == 2
    said = [line.strip() for line in result.stderr.split("\n") if line.startswith(("lapjoint: ", " "))]
    (fault,) = [line.partition("problem.toml: ")[2] or line for line in said if "stops[0]" in line]
    if label == "side":
        expect(paper.page.get_by_text(fault)).to_be_visible()
    else:
        assert paper.message(field) == fault
    expect(paper.page.get_by_text("The problem is not valid; this is the curve")).to_be_visible()
    paper.press("Undo")
    paper.until(lambda: paper.state == FIRST)


def test_a_click_on_the_curve_chooses_one_of_its_frequencies_to_the_bit(paper: Visit) -> None:
    omegas = FIRST.plan(FIRST.made()).grid.axes[0].values
    paper.unfold("base_motion")
    for i in (123, 7, 400):
        paper.page.evaluate("scrollTo(0, 0)")
        paper.page.wait_for_timeout(500)  # two clicks in quick succession are a double click
        paper.page.mouse.click(*paper.at(omegas[i]))
        paper.until(lambda omega=omegas[i]: paper.problem["base_motion"]["angular_frequency"] == omega)  # type: ignore[misc]
        assert float(paper.field("angular_frequency [rad/s]").input_value()) == omegas[i]
        assert f"Cycle at {omegas[i]:.4g}"[:12] in paper.page.get_by_role("heading", name="Cycle at").inner_text()


def test_hertz_are_kept_by_link_state_and_command(server: Explored, shown: Browser, tmp_path: Path) -> None:
    one = Visit(shown, server.address)
    one.page.get_by_label("Hz", exact=True).check()
    one.until(lambda: one.state == FIRST.in_unit(hz=True))
    one.type("from [Hz]", "20")
    expect(one.page.get_by_text("sweep problem.toml --hz --from 20.0 --to")).to_be_visible()
    one.type("to [Hz]", "10")
    expect(one.page.get_by_text("to = 10 Hz: must be greater than from, 20 Hz")).to_be_visible()
    assert read_back(one.save("Save the state", tmp_path).read_text(encoding="utf-8")) == one.state
    one.page.goto(one.address)
    expect(one.field("from [Hz]")).to_have_value("20.0")
    one.start("Lap joint of two plates")
    one.until(lambda: "beams" in one.problem)
    assert one.state.hz
    one.close()


def test_undo_and_redo_by_keys(paper: Visit) -> None:
    states = [paper.state]
    for label, text in ((GAP, "0.002"), ("stiffness [N/m] *", "2e9"), (GAP, "wrong")):
        paper.type(label, text)
        paper.until(lambda: paper.state != states[-1])
        states.append(paper.state)
    for button, order in (("Undo", states[-2::-1]), ("Redo", states[1:])):
        for state in order:
            paper.page.get_by_role("button", name=button).press("Enter")
            paper.until(lambda state=state: paper.state == state)  # type: ignore[misc]
    assert paper.field(GAP).input_value() == "wrong"
    expect(paper.page.get_by_role("button", name="Redo")).to_be_disabled()


def test_what_is_saved_is_what_is_read_and_link_state_and_reload_bring_it_back(
    paper: Visit, server: Explored, shown: Browser, tmp_path: Path
) -> None:
    paper.type(GAP, "0.00123456789012345")
    paper.type("from [rad/s]", "111.1")
    paper.until(lambda: paper.state.first == 111.1)
    state = paper.state
    assert read_problem(paper.save("Save as problem.toml", tmp_path)) == state.made()
    saved, link = paper.save("Save the state", tmp_path), paper.address
    paper.page.reload()
    paper.link.wait_for()
    assert paper.state == state
    paper.unfold("P2")
    expect(paper.field(GAP)).to_have_value("0.00123456789012345")
    paper.start("two plates")
    paper.until(lambda: paper.problem["title"] != state.tables["title"])
    paper.open(saved)
    paper.until(lambda: paper.state == state)
    another = Visit(shown, link)
    assert another.state == state
    another.close()
    for damaged in ("x", link.partition("state=")[2][:-9], "A" * 200):
        another = Visit(shown, f"{server.address}?state={damaged}")
        assert another.state == FIRST
        another.close()


def test_a_problem_of_the_presets_has_its_own_form_and_curve(paper: Visit) -> None:
    paper.start("two plates")
    paper.until(lambda: len(paper.problem.get("beams", ())) == 2)
    paper.unfold("left edge")
    expect(paper.field("between")).to_have_value('["upper:0.24", "lower:0"]')
    names = "|".join(re.escape(stop["name"]) for stop in paper.problem["stops"])
    said = paper.page.get_by_text(re.compile(f"frequencies: .*; largest impulse .* of ({names}) at"))
    expect(said).to_be_visible(timeout=1000 * PATIENCE)


def test_an_own_file_is_opened_or_refused_in_a_sentence(paper: Visit, tmp_path: Path) -> None:
    def written(name: str, content: bytes | str) -> Path:
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path

    example = commented_example()
    good = written("good.toml", example.replace("Lap joint", "Löse joint"))
    deep = json.dumps({"problem": "[" * 5000, "from": 1, "to": 2})
    for path, said in (
        (written("broken.toml", "[beam\nlength = 1"), "broken.toml"),
        (written("latin.toml", 'title = "Träger"'.encode("latin-1")), "UTF-8"),
        (written("binary.toml", bytes(range(256)) * 9), "binary.toml"),
        (written("other.json", '{"cells": []}'), "was not written by this page"),
        (written("broken.json", "{"), "was not written by this page"),
        (written("deep.json", deep), "problem"),
        (written("large.toml", "# ä\n" * 2_600_000), "has 13 MB; at most 10 MB are opened"),
        (written("list.toml", "beam = [1, 2]\nstops = 3\n[supports]"), "stops"),
    ):
        before = paper.state
        paper.open(path)
        expect(paper.page.get_by_role("alert").filter(has_text=said).first).to_be_visible()
        if path.name == "list.toml":  # it is a problem, though not a valid one
            paper.until(lambda before=before: paper.state != before)  # type: ignore[misc]
            before = paper.state
        assert paper.state == before
        paper.open(good)
        paper.until(lambda: "Löse" in paper.problem.get("title", ""))
        paper.press("Undo")
        paper.until(lambda before=before: paper.state == before)  # type: ignore[misc]


EVIL = '<img src=x onerror="window.hit=1"><script>window.hit=1</script>'


def test_html_in_texts_of_a_problem_is_shown_and_not_run(paper: Visit, tmp_path: Path) -> None:
    example = problem_tables(paper_joint())
    example |= {"title": EVIL}
    example["stops"][0]["name"] = EVIL
    path = tmp_path / "evil.toml"
    path.write_text(opened(example).problem, encoding="utf-8")
    paper.open(path)
    paper.until(lambda: paper.problem["title"] == EVIL)
    paper.finished()
    expect(paper.page.get_by_role("cell", name=EVIL).first).to_be_visible()
    heading = paper.page.get_by_role("button", name=EVIL).first
    if heading.get_attribute("aria-expanded") != "true":
        heading.click()
    expect(paper.field(GAP)).to_be_visible()
    paper.type(GAP, EVIL)
    expect(paper.page.get_by_text("The problem is not valid; this is the curve")).to_be_visible()
    paper.unfold("damping")
    paper.page.get_by_text("must be a number").first.wait_for()
    images = f"() => {{ {WALK} return [...roots(document)].map(r => r.querySelectorAll('img[src=x]').length) }}"
    assert sum(paper.page.evaluate(images)) == 0
    assert paper.page.evaluate("window.hit") is None


def test_the_tables_are_what_the_command_line_prints_row_for_row(paper: Visit, tmp_path: Path) -> None:
    paper.type(GAP, "0.0011")
    paper.until(lambda: paper.problem["stops"][0]["gap"] == 0.0011)
    paper.page.get_by_text("Computing the cycle").wait_for(state="hidden")
    paper.finished()
    saved = paper.save("Save as problem.toml", tmp_path)
    rows = [row for table in paper.tables().values() for row in table if any(" ± " in cell for cell in row)]
    for column, solver in enumerate(("analytic", "fe")):
        printed = run_well("steady", saved, "--solver", solver).splitlines()
        lines = [" ".join(line.replace("+-", "±").split()) for line in printed if " +- " in line]
        for row, line in zip(rows, lines, strict=True):
            labels = [cell for cell in row if " ± " not in cell]
            values = " ".join([cell for cell in row if " ± " in cell][column::2])
            assert values
            assert line.endswith(values), (solver, row, line)
            assert labels[-1].split()[-1] in line.removesuffix(values).replace("*", "").split(), (solver, row, line)


def test_the_curve_as_csv_is_the_sweep_of_the_command_to_the_bit(
    paper: Visit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    paper.type(GAP, "0.0012")
    paper.until(lambda: paper.problem["stops"][0]["gap"] == 0.0012)
    paper.finished()
    paper.save("Save as problem.toml", tmp_path)
    with paper.save("Curve as CSV", tmp_path).open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    commands = paper.page.get_by_role("group", name="The commands that do this").inner_text().split("\n")
    sweep = next(line for line in commands if line.startswith("lapjoint sweep "))
    monkeypatch.chdir(tmp_path)
    run_well(*sweep.split()[1:])
    with xr.open_dataset(tmp_path / "curve.nc") as found:
        impulses, omegas = found.impulse.values, found.angular_frequency.values
        flags = found.outcome.attrs
        words = dict(zip(np.atleast_1d(flags["flag_values"]), flags["flag_meanings"].split(), strict=True))
        outcomes = [words[i] for i in found.outcome.values]
    assert len(rows) == len(omegas) == 401
    assert [float(row[0]) for row in rows] == list(omegas)
    assert [row[1].lower() for row in rows] == outcomes
    np.testing.assert_array_equal(np.array([[float(value) for value in row[2:]] for row in rows]), impulses)
    assert len(head) == 2 + impulses.shape[1]
    assert not any(math.isnan(value) for value in impulses.ravel())


# What of all texts lies on another one, is cut off, or has words that are torn apart; pictures have their own texts.
LOOK = (
    f"() => {{ {WALK}"
    + """
  const seen = (e) => { for (let one = e; one; one = one.parentElement ?? one.getRootNode().host)
      { const style = getComputedStyle(one);
        if (style.opacity === "0" || style.visibility === "hidden" || style.position === "fixed"
            || (one.clientWidth === 1 && one.clientHeight === 1)) return false; }
    return e.checkVisibility(); };
  const lines = [], torn = [], cut = [];
  for (const root of roots(document)) {
    const texts = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
    while (texts.nextNode()) {
      const text = texts.currentNode, parent = text.parentElement;
      if (!parent || !text.data.trim() || parent.closest("script, style, svg") || !seen(parent)) continue;
      const range = document.createRange();
      range.selectNodeContents(text);
      for (const r of range.getClientRects()) {
        const inset = r.height / 4;
        lines.push({text: text.data.trim().slice(0, 40), node: text, l: r.left + 1, r: r.right - 1,
          t: r.top + inset, b: r.bottom - inset});
      }
      for (const word of text.data.matchAll(/[\\p{L}]+/gu)) {
        range.setStart(text, word.index);
        range.setEnd(text, word.index + word[0].length);
        if (new Set([...range.getClientRects()].map((r) => Math.round(r.top))).size > 1) torn.push(word[0]);
      }
      for (let one = parent; one; one = one.parentElement) {
        const hides = ["hidden", "clip"].includes(getComputedStyle(one).overflowX);
        if (hides && one.clientWidth > 1 && one.scrollWidth > one.clientWidth + 1
            && getComputedStyle(one).textOverflow !== "ellipsis") cut.push(one.outerHTML.slice(0, 200));
      }
    }
  }
  lines.sort((a, b) => a.t - b.t);
  const overlaps = [];
  for (let i = 0; i < lines.length; i++) for (let j = i + 1; j < lines.length && lines[j].t < lines[i].b; j++) {
    const a = lines[i], b = lines[j];
    if (a.node !== b.node && a.l < b.r && b.l < a.r) overlaps.push([a.text, b.text]);
  }
  return {texts: lines.length, overlaps, torn, cut: [...new Set(cut)], width: document.documentElement.scrollWidth};
}"""
)


@pytest.mark.parametrize(("width", "scheme"), [(1280, "light"), (390, "light"), (1280, "dark")])
def test_no_text_lies_on_another_or_is_cut_and_no_barrier_is_serious(
    server: Explored, shown: Browser, width: int, scheme: str, tmp_path: Path
) -> None:
    one: Any = Visit(shown, server.address, width)
    one.finished()
    if scheme == "dark":
        one.press("Toggle theme")
    one.unfold("damping")
    one.unfold("P2")
    one.type(GAP, "wide")
    one.page.get_by_text("must be a number").wait_for()
    one.page.wait_for_timeout(500)  # what unfolds has come to rest
    one.page.screenshot(path=tmp_path / f"{width}-{scheme}.png", full_page=True)
    found = one.page.evaluate(LOOK)
    assert found.pop("texts") > 100
    assert found == {"overlaps": [], "torn": [], "cut": [], "width": width}
    one.page.evaluate(files("axe_core_python").joinpath("axe.min.js").read_text(encoding="utf-8"))
    result = one.page.evaluate("axe.run(document, {resultTypes: ['violations']})")
    bad = [(v["id"], v["impact"], [n["html"][:200] for n in v["nodes"]]) for v in result["violations"]
           if v["impact"] in SERIOUS]  # fmt: skip
    assert bad == []
    one.close()
