"""The site, built where the extra `docs` is installed: a link that leads nowhere, or a page in no table of contents, is
an error; in a real browser no page scrolls sideways or cuts a word, nor fails an accessibility checker."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest
from browser import DARK, LIGHT, look_at, needs_browser

DOCS = Path(__file__).resolve().parents[1] / "docs"
FIRST = ("index.html", "tutorial.html", "glossary.html", "gallery/README.html", "api/lapjoint.figures.html")
"""Pages of every sort."""
pytestmark = [
    pytest.mark.thorough,
    pytest.mark.skipif(importlib.util.find_spec("furo") is None, reason="no site: the extra docs is not installed"),
]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site."""
    target = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", DOCS, target]
    subprocess.run(command, check=True, timeout=500)
    return target


def pages(site: Path) -> list[str]:
    """All pages that somebody wrote, or that documents the code; not what lists of words there are."""
    return sorted(
        path.relative_to(site).as_posix()
        for path in site.rglob("*.html")
        if path.stem not in ("genindex", "py-modindex", "search", "look")
    )


def test_it_is_built_without_a_warning_and_has_every_page(site: Path) -> None:
    written = {page.relative_to(DOCS).with_suffix(".html").as_posix() for page in DOCS.rglob("*.md")}
    assert written <= set(pages(site))


@needs_browser
def test_no_page_scrolls_sideways_or_cuts_a_word(site: Path, tmp_path: Path) -> None:
    found = look_at(tmp_path, site, pages(site), (1280, 390))
    assert len(found) == 2 * len(pages(site))
    for seen in found:
        assert seen.page_width <= seen.width, seen.page
        assert seen.cut == [], seen.page
        assert seen.overlaps == [], seen.page


@needs_browser
@pytest.mark.parametrize(("scheme", "width"), [(LIGHT, 1280), (DARK, 390)])
def test_a_checker_finds_nothing_serious_on_pages_of_every_sort(
    site: Path, tmp_path: Path, scheme: int, width: int
) -> None:
    for seen in look_at(tmp_path, site, FIRST, (width,), checked=True, scheme=scheme):
        assert seen.serious == [], seen.page


@needs_browser
@pytest.mark.slow
@pytest.mark.parametrize("scheme", [LIGHT, DARK])
def test_a_checker_finds_nothing_serious_on_any_page(site: Path, tmp_path: Path, scheme: int) -> None:
    for seen in look_at(tmp_path, site, pages(site), (1280,), checked=True, scheme=scheme):
        assert seen.serious == [], seen.page
