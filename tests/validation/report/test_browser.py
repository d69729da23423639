"""The report in a real browser, where one is installed: no request, no overflow at any width, paper, light and dark."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest
from browser import DARK, LIGHT, browse, look_at, needs_browser
from matplotlib.image import imread
from report_sample import everything

from validation.report.write import write_reports

pytestmark = needs_browser
WIDTHS = (1280, 768, 390, 360)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    output = tmp_path_factory.mktemp("report")
    write_reports(everything(), "quick", output, 1.0)
    return output


def requests(log: Path) -> set[str]:
    """What the page asked of a network; what the browser asks for itself has no origin."""
    asked = [event.get("params", {}) for event in json.loads(log.read_text())["events"]]
    by_page = {str(p["url"]) for p in asked if "url" in p and p.get("initiator", "not an origin") != "not an origin"}
    return {url for url in by_page if re.match(r"(https?|wss?|ftp):", url)}


@pytest.fixture(scope="module")
def shown(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[str, set[str]]:
    """The page as the browser has it, and what it asked for."""
    profile = tmp_path_factory.mktemp("profile")
    log = profile / "net.json"
    page = browse(profile, folder / "report.html", f"--log-net-log={log}", "--dump-dom")
    return page, requests(log)


def test_it_is_read_whole_and_asks_for_nothing(shown: tuple[str, set[str]]) -> None:
    page, asked = shown
    assert page.rstrip().endswith("</html>")
    assert "<script>alert" not in page
    assert asked == set()


def test_a_request_would_have_been_seen(tmp_path: Path) -> None:
    log, control = tmp_path / "net.json", tmp_path / "control.html"
    control.write_text('<!doctype html><img src="http://picture.invalid/x.png">')
    browse(tmp_path, control, f"--log-net-log={log}", "--dump-dom")
    assert requests(log) == {"http://picture.invalid/x.png"}


def test_every_table_fits_its_box_and_the_page_its_width(folder: Path, tmp_path: Path) -> None:
    for seen in look_at(tmp_path, folder, ["report.html"], WIDTHS):
        assert seen.page_width <= seen.width
        assert seen.tables > 10  # or nothing was measured
        assert (seen.beyond, seen.cut, seen.overlaps) == (0, [], [])


@pytest.mark.thorough
@pytest.mark.parametrize(("scheme", "width"), [(LIGHT, 390), (DARK, 1280)])
def test_an_accessibility_checker_finds_nothing_serious(folder: Path, tmp_path: Path, scheme: int, width: int) -> None:
    page = (folder / "report.html").read_text(encoding="utf-8")
    (tmp_path / "open.html").write_text(re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", page))
    for seen in look_at(tmp_path / "profile", tmp_path, ["open.html"], (width,), checked=True, scheme=scheme):
        assert seen.serious == []


def test_the_checker_would_have_found_something(tmp_path: Path) -> None:
    (tmp_path / "bad.html").write_text(
        '<!doctype html><html lang="en"><title>Bad</title><p style="color:#999;background:#aaa">pale</p>'
        '<img src="x.png">'
        '<p style="width:600px">wide</p><p style="width:50px;overflow:hidden;white-space:nowrap">cut off at its end</p>'
        '<p style="margin:0">below</p><p style="margin-top:-1em">above</p>'
    )
    (seen,) = look_at(tmp_path / "profile", tmp_path, ["bad.html"], (390,), checked=True)
    assert {"color-contrast", "image-alt"} <= {rule for rule, *_ in seen.serious}
    assert seen.page_width > 390
    assert len(seen.cut) == 1
    assert seen.overlaps == [["below", "above"]]


def test_paper_holds_the_verdicts_and_not_the_evidence(folder: Path, tmp_path: Path) -> None:
    target = tmp_path / "report.pdf"
    browse(tmp_path / "profile", folder / "report.html", f"--print-to-pdf={target}", "--no-pdf-header-footer")
    pages = len(re.findall(rb"/Type\s*/Page[^s]", target.read_bytes()))
    assert 1 <= pages <= 4


def test_a_link_to_a_row_opens_the_table_that_holds_it(
    folder: Path, tmp_path: Path, shown: tuple[str, set[str]]
) -> None:
    row = re.findall(r'id="([\w-]+-check-\d+)"', (folder / "report.html").read_text(encoding="utf-8"))[-2]
    linked = browse(tmp_path, folder / "report.html", "--dump-dom", fragment=f"#{row}")
    for page, expected in ((linked, " open"), (shown[0], "")):
        before = page[: page.index(f'id="{row}"')]
        attributes = re.findall(r"<details([^>]*)>", before)[-1]
        assert (" open" in attributes) == bool(expected)


def test_light_and_dark_differ(folder: Path, tmp_path: Path) -> None:
    brightness = []
    for scheme in (LIGHT, DARK):
        picture = tmp_path / f"{scheme}.png"
        options = (f"--blink-settings=preferredColorScheme={scheme}", "--window-size=800,3000")
        browse(tmp_path / "profile", folder / "report.html", *options, f"--screenshot={picture}")
        brightness.append(float(np.median(imread(picture)[..., :3])))
    assert brightness[0] > 0.9
    assert brightness[1] < 0.2
