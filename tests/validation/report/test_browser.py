"""The report in a real browser, where one is installed: no request, no overflow at any width, paper, light and dark."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from report_sample import everything

from validation.report.write import write_reports

NAMES = ("chromium", "chromium-browser", "google-chrome")
BROWSER = next(filter(None, map(shutil.which, NAMES)), None)
pytestmark = pytest.mark.skipif(BROWSER is None, reason=f"no browser: none of {', '.join(NAMES)} is installed")
QUIET = (
    *("--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--hide-scrollbars"),
    *("--disable-background-networking", "--disable-sync", "--disable-component-update", "--disable-extensions"),
)
MEASURE = """<!doctype html><iframe id="page" src="report.html" style="width:{width}px;height:800px;border:0"></iframe>
<script>
document.getElementById("page").onload = (event) => {{
  const page = event.target.contentDocument, folded = page.documentElement.scrollHeight;
  for (const d of page.querySelectorAll("details")) d.open = true;
  const width = page.documentElement.scrollWidth, boxes = [...page.querySelectorAll(".wide")];
  const wide = boxes.filter((box) => box.scrollWidth > box.clientWidth + 1).length;
  document.body.dataset.measured = `${{width}} ${{wide}} ${{boxes.length}} ${{folded}}`;
}};
</script>"""
WIDTHS = (1280, 768, 390, 360)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    output = tmp_path_factory.mktemp("report")
    write_reports(everything(), "quick", output, 1.0)
    return output


def browse(profile: Path, page: Path, *options: str, fragment: str = "") -> str:
    """What the browser prints for a page, in a profile of its own and without a network."""
    assert BROWSER is not None
    command = [BROWSER, *QUIET, f"--user-data-dir={profile}", "--host-resolver-rules=MAP * ~NOTFOUND", *options]
    done = subprocess.run([*command, page.as_uri() + fragment], capture_output=True, text=True, timeout=120, check=True)
    return done.stdout


def requests(log: Path) -> set[str]:
    """What the page asked of a network; what the browser asks for itself has no origin."""
    asked = [event.get("params", {}) for event in json.loads(log.read_text())["events"]]
    by_page = {str(p["url"]) for p in asked if "url" in p and p.get("initiator", "not an origin") != "not an origin"}
    return {url for url in by_page if re.match(r"(https?|wss?|ftp):", url)}


def test_it_is_read_whole_and_asks_for_nothing(folder: Path, tmp_path: Path) -> None:
    log = tmp_path / "net.json"
    page = browse(tmp_path, folder / "report.html", f"--log-net-log={log}", "--dump-dom")
    assert page.rstrip().endswith("</html>")
    assert "<script>alert" not in page
    assert requests(log) == set()


def test_a_request_would_have_been_seen(tmp_path: Path) -> None:
    log, control = tmp_path / "net.json", tmp_path / "control.html"
    control.write_text('<!doctype html><img src="http://picture.invalid/x.png">')
    browse(tmp_path, control, f"--log-net-log={log}", "--dump-dom")
    assert requests(log) == {"http://picture.invalid/x.png"}


@pytest.mark.parametrize("width", WIDTHS)
def test_every_table_fits_its_box_and_the_page_its_width(folder: Path, tmp_path: Path, width: int) -> None:
    measure = folder / f"measure-{width}.html"
    measure.write_text(MEASURE.format(width=width))
    page = browse(tmp_path, measure, "--allow-file-access-from-files", "--dump-dom")
    found = re.search(r'data-measured="(\d+) (\d+) (\d+) (\d+)"', page)
    assert found, page[-300:]
    assert int(found[1]) <= width
    assert int(found[2]) == 0
    assert int(found[3]) > 10  # or nothing was measured


def test_paper_holds_the_verdicts_and_not_the_evidence(folder: Path, tmp_path: Path) -> None:
    target = tmp_path / "report.pdf"
    browse(tmp_path / "profile", folder / "report.html", f"--print-to-pdf={target}", "--no-pdf-header-footer")
    pages = len(re.findall(rb"/Type\s*/Page[^s]", target.read_bytes()))
    assert 1 <= pages <= 4


def test_a_link_to_a_row_opens_the_table_that_holds_it(folder: Path, tmp_path: Path) -> None:
    row = re.findall(r'id="([\w-]+-check-\d+)"', (folder / "report.html").read_text(encoding="utf-8"))[-2]
    for target, expected in ((f"#{row}", " open"), ("", "")):
        page = browse(tmp_path, folder / "report.html", "--dump-dom", fragment=target)
        before = page[: page.index(f'id="{row}"')]
        attributes = re.findall(r"<details([^>]*)>", before)[-1]
        assert (" open" in attributes) == bool(expected)


def test_light_and_dark_differ(folder: Path, tmp_path: Path) -> None:
    brightness = []
    for scheme in (1, 0):  # light, dark
        picture = tmp_path / f"{scheme}.png"
        options = (f"--blink-settings=preferredColorScheme={scheme}", "--window-size=800,3000")
        browse(tmp_path / "profile", folder / "report.html", *options, f"--screenshot={picture}")
        brightness.append(float(np.median(imread(picture)[..., :3])))
    assert brightness[0] > 0.9
    assert brightness[1] < 0.2
