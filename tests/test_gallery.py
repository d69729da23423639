"""What docs/gallery shows is what its scripts do; copies of them are run, so that the pictures stay as they are."""

from __future__ import annotations

import math
import re
import runpy
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

GALLERY = Path(__file__).resolve().parents[1] / "docs" / "gallery"
PAGE = (GALLERY / "README.md").read_text(encoding="utf-8")
SECTIONS = re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:]
SCRIPTS = sorted(path.stem for path in GALLERY.glob("*.py"))
PICTURE = re.compile(r"!\[([^\]]+)\]\((\w+)(\.png|\.svg|\.gif)\)")
MEASURED = re.compile(r"(-?[\d.]+) ± ([\d.]+)")
COARSE: dict[str, dict[str, Any]] = {  # whole curves take longer: here a point now and then
    "figure_4": {"step": 100.0, "workers": 1},
    "first_result": {"step": 100.0, "fe_step": 500.0, "workers": 1},
}
LARGEST = {".png": 100_000, ".svg": 100_000, ".gif": 1_000_000}  # bytes: the page should load at once
THREE_DIMENSIONAL = ("film", "side_by_side")


def picture_of(script: str) -> Path:
    (ending,) = (ending for _, name, ending in PICTURE.findall(PAGE) if name == script)
    return GALLERY / (script + ending)


def size(picture: Path) -> tuple[float, ...]:
    """Width and height, in pixels or, of an SVG, points."""
    if picture.suffix == ".svg":
        head = picture.read_text(encoding="utf-8")[:1000]
        return tuple(float(value) for value in re.findall(r'(?:width|height)="([\d.]+)pt"', head)[:2])
    with Image.open(picture) as image:
        return image.size


def is_blank(picture: Path) -> bool:
    if picture.suffix == ".svg":
        return picture.read_text(encoding="utf-8").count("<path") < 20
    with Image.open(picture) as image:
        pixels = np.asarray(image.convert("RGB")).reshape(-1, 3)
    return bool(np.mean(np.any(pixels < 230, axis=1)) < 0.01)  # of them are not white, or nearly


def assert_same_text(printed: str, shown: str) -> None:
    """Word for word, but measured numbers, those with a standard error, to within four of these."""
    assert MEASURED.sub("±", printed) == MEASURED.sub("±", shown)
    for (a, u), (b, v) in zip(MEASURED.findall(printed), MEASURED.findall(shown), strict=True):
        assert abs(float(a) - float(b)) <= 4 * math.hypot(float(u), float(v))


def run(script: str, folder: Path, **coarse: Any) -> Path:
    """Run a copy of a script, and return its picture."""
    copy = Path(shutil.copy(GALLERY / f"{script}.py", folder))
    if coarse:
        runpy.run_path(str(copy))["main"](**coarse)
    else:
        runpy.run_path(str(copy), run_name="__main__")
    return folder / picture_of(script).name


def shown_by(script: str) -> str:
    (section,) = (section for section in SECTIONS if f"({script}.py)" in section)
    (text,) = re.findall(r"^```text\n(.*?)^```$", section, re.DOTALL | re.MULTILINE)
    return str(text)


@pytest.mark.parametrize("script", SCRIPTS)
def test_a_script_draws_its_picture_and_prints_what_the_page_shows(
    script: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], request: pytest.FixtureRequest
) -> None:
    if script in THREE_DIMENSIONAL:
        request.getfixturevalue("graphics")
    picture = run(script, tmp_path, **COARSE.get(script, {}))
    assert not is_blank(picture)
    assert size(picture) == size(picture_of(script))
    if script not in COARSE:
        assert_same_text(capsys.readouterr().out, shown_by(script))


@pytest.mark.slow
@pytest.mark.parametrize("script", COARSE)
def test_a_whole_curve_prints_what_the_page_shows(
    script: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run(script, tmp_path)
    assert_same_text(capsys.readouterr().out, shown_by(script))


def test_every_section_shows_one_script_and_its_picture_and_every_script_is_shown() -> None:
    found = []
    for section in SECTIONS:
        ((_, name, _),) = PICTURE.findall(section)
        assert set(re.findall(r"\]\((\w+)\.py\)", section)) == {name}
        found.append(name)
    assert sorted(found) == SCRIPTS


def test_every_picture_is_on_the_page_and_loads_at_once() -> None:
    pictures = {path for path in GALLERY.iterdir() if path.suffix in LARGEST}
    assert pictures == {picture_of(script) for script in SCRIPTS}
    for picture in pictures:
        assert picture.stat().st_size <= LARGEST[picture.suffix], picture
        assert not is_blank(picture), picture


def test_every_picture_is_described_in_words() -> None:
    for words, *_ in PICTURE.findall(PAGE):
        assert len(words.split()) >= 5, words


def test_every_script_begins_with_what_one_sees() -> None:
    for script in SCRIPTS:
        text = (GALLERY / f"{script}.py").read_text(encoding="utf-8")
        assert re.match(r'""".+?"""\n', text, re.DOTALL), script


def test_the_contents_lead_to_every_section() -> None:
    anchors = [re.sub(r"[^\w\- ]", "", section.splitlines()[0].lower()).replace(" ", "-") for section in SECTIONS]
    assert sorted(re.findall(r"\(#([\w-]+)\)", PAGE)) == sorted(anchors)
