"""The site in a real browser: no page scrolls sideways or cuts a word, nor fails an accessibility checker.

It is built here, where the extra `docs` is installed, or the environment names the folder of a site that is built:
LAPJOINT_SITE.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from pathlib import Path

import pytest
from browser import DARK, LIGHT, look_at, needs_browser

DOCS = Path(__file__).resolve().parents[1] / "docs"
WHERE = os.environ.get("LAPJOINT_SITE")
FIRST = ("index.html", "tutorial.html", "glossary.html", "gallery/README.html", "api/lapjoint.figures.html")
"""Pages of every sort."""
pytestmark = [
    needs_browser,
    pytest.mark.skipif(
        WHERE is None and importlib.util.find_spec("furo") is None,
        reason="no site: the extra docs is not installed, and LAPJOINT_SITE names none",
    ),
]


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the site."""
    if WHERE is not None:
        return Path(WHERE).resolve()
    target = tmp_path_factory.mktemp("site")
    subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", DOCS, target], check=True, timeout=500)
    return target


def pages(site: Path) -> list[str]:
    """All pages that somebody wrote, or that documents the code; not what lists of words there are."""
    return sorted(
        path.relative_to(site).as_posix()
        for path in site.rglob("*.html")
        if path.stem not in ("genindex", "py-modindex", "search", "look")
    )


def test_no_page_scrolls_sideways_or_cuts_a_word(site: Path, tmp_path: Path) -> None:
    found = look_at(tmp_path, site, pages(site), (1280, 390))
    assert len(found) > 60
    for seen in found:
        assert seen.page_width <= seen.width, seen.page
        assert seen.cut == [], seen.page
        assert seen.overlaps == [], seen.page


@pytest.mark.parametrize(("scheme", "width"), [(LIGHT, 1280), (DARK, 390)])
def test_a_checker_finds_nothing_serious_on_pages_of_every_sort(
    site: Path, tmp_path: Path, scheme: int, width: int
) -> None:
    for seen in look_at(tmp_path, site, FIRST, (width,), checked=True, scheme=scheme):
        assert seen.serious == [], seen.page


@pytest.mark.slow
@pytest.mark.parametrize("scheme", [LIGHT, DARK])
def test_a_checker_finds_nothing_serious_on_any_page(site: Path, tmp_path: Path, scheme: int) -> None:
    for seen in look_at(tmp_path, site, pages(site), (1280,), checked=True, scheme=scheme):
        assert seen.serious == [], seen.page
