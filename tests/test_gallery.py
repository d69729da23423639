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

from lapjoint.problem import FloatArray

GALLERY = Path(__file__).resolve().parents[1] / "docs" / "gallery"
PAGE = (GALLERY / "README.md").read_text(encoding="utf-8")
SECTIONS = re.split(r"^## ", PAGE, flags=re.MULTILINE)[1:]
SCRIPTS = sorted(path.stem for path in GALLERY.glob("*.py"))
PICTURE = re.compile(r"!\[([^\]]+)\]\((\w+)(\.png|\.svg|\.gif)\)")
MEASURED = re.compile(r"(-?[\d.]+) ± ([\d.]+)")
COARSE: dict[str, dict[str, Any]] = {  # whole curves take longer: here a point now and then
    "basins": {"points": 12},
    "cascade": {"marches": 9, "multiple": 2},
    "figure_4": {"step": 100.0, "workers": 1},
    "first_graze": {"points": 3},
    "five_systems": {"points": 13},
    "first_result": {"step": 100.0, "fe_step": 500.0, "workers": 1},
}
LARGEST = {".png": 100_000, ".svg": 100_000, ".gif": 1_000_000}  # bytes: the page should load at once
HUES, COLOURS_APART = 12, 0.045
"""Colours told apart, and the largest difference in them: what matplotlib 3.9 and 3.11 draw is up to 0.03 apart, and a
motion with and without the strips of its contacts 0.06 and more."""
OF_CHANCE = {"cascade": 0.15, "chaos": 0.15, "shaken": 0.15}
"""Differences in colours where rounding makes another motion each time: two marches are 0.05 apart."""
BLOCK, BLOCKS_APART = 16, 0.25
"""Pixels, and the largest difference in blocks of that size, between pictures of one matplotlib: two marches of one
strange attractor are 0.12 apart, pictures with and without strips 0.39 and more."""
THREE_DIMENSIONAL = ("film", "side_by_side")
LONG = (
    *THREE_DIMENSIONAL,
    *("basins", "branch_of_figure_4", "cascade", "chaos", "convergence", "figure_4", "first_result", "hardening"),
    *("first_graze", "five_systems", "lap_joint", "loose_pinned_beam", "shaken", "single_stop", "spectrum"),
    "three_stops_one_side",
)


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


def colours_of(picture: Path) -> FloatArray:
    """How much of a picture has which hue, greys left out: the same wherever on the picture the axes lie.

    Of an SVG, where there are no pixels, it is the length of the curves of each colour, in units of its size.
    """
    if picture.suffix == ".svg":
        return curves_of(picture)
    with Image.open(picture) as image:
        hue, saturation, _ = np.asarray(image.convert("HSV"), dtype=float).reshape(-1, 3).T / 256.0
    first, share = np.divmod(HUES * hue, 1.0)  # each pixel counts for the two hues that it lies between
    places = first.astype(int) % HUES, (first.astype(int) + 1) % HUES
    weights = saturation * (1.0 - share), saturation * share
    found = sum(np.bincount(place, weight, HUES) for place, weight in zip(places, weights, strict=True))
    return np.asarray(found / hue.size)


def curves_of(picture: Path) -> FloatArray:
    lengths = np.zeros(4096)
    text, across = picture.read_text(encoding="utf-8"), math.hypot(*size(picture))
    for path, colour in re.findall(r'<path d="([^"]+)"[^>]+stroke: #(\w{6})', text):
        for part in path.split("M")[1:]:
            points = np.array(re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", part), dtype=float).reshape(-1, 2)
            lengths[int(colour[::2], 16)] += np.hypot(*np.diff(points, axis=0).T).sum() / across
    return lengths


def blocks_of(picture: Path) -> FloatArray:
    """How far blocks of a picture are from its ground, so large that a line may lie a pixel off."""
    with Image.open(picture) as image:
        grey = image.convert("L")
        small = grey.resize((grey.width // BLOCK, grey.height // BLOCK), Image.Resampling.BOX)
    return np.abs(np.asarray(small, dtype=float) - np.median(np.asarray(small)))


def difference(one: FloatArray, other: FloatArray) -> float:
    return float(np.sum(np.abs(one - other)) / np.sum(one))


def layout_of(picture: Path) -> str:
    """The minor version of matplotlib that laid a picture out; versions differ in the width of letters."""
    with Image.open(picture) as image:
        return ".".join(str(image.info.get("Software", "")).split(".")[:2])


def assert_same_picture(drawn: Path, shown: Path) -> None:
    np.testing.assert_allclose(size(drawn), size(shown), atol=2.0)
    assert difference(colours_of(shown), colours_of(drawn)) < OF_CHANCE.get(shown.stem, COLOURS_APART)
    if shown.suffix == ".png" and layout_of(drawn) == layout_of(shown):
        assert difference(blocks_of(shown), blocks_of(drawn)) < BLOCKS_APART


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


@pytest.mark.parametrize(
    "script", [pytest.param(it, marks=pytest.mark.thorough if it in LONG else ()) for it in SCRIPTS]
)
def test_a_script_draws_its_picture_and_prints_what_the_page_shows(
    script: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], request: pytest.FixtureRequest
) -> None:
    if script in THREE_DIMENSIONAL:
        request.getfixturevalue("graphics")
    picture = run(script, tmp_path, **COARSE.get(script, {}))
    assert not is_blank(picture)
    if script not in COARSE:
        assert_same_picture(picture, picture_of(script))
        assert_same_text(capsys.readouterr().out, shown_by(script))


@pytest.mark.slow
@pytest.mark.parametrize("script", COARSE)
def test_a_whole_curve_prints_what_the_page_shows(
    script: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert_same_picture(run(script, tmp_path), picture_of(script))
    assert_same_text(capsys.readouterr().out, shown_by(script))


def test_a_picture_that_its_script_no_longer_draws_is_noticed(tmp_path: Path) -> None:
    shown = GALLERY / "own_joint.png"
    with Image.open(shown) as image:
        stale = image.convert("RGB")
    stale.paste((255, 255, 255), (0, stale.height * 3 // 4, stale.width, stale.height))
    stale.save(tmp_path / "stale.png")
    with pytest.raises(AssertionError):
        assert_same_picture(tmp_path / "stale.png", shown)
    svg = (GALLERY / "state_shapes.svg").read_text(encoding="utf-8")
    (tmp_path / "stale.svg").write_text(re.sub(r'<path d="[^"]+"[^>]+stroke: #d55e00', "<path ", svg), encoding="utf-8")
    with pytest.raises(AssertionError):
        assert_same_picture(tmp_path / "stale.svg", GALLERY / "state_shapes.svg")


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
