"""What the pages in docs/ promise: their Python prints what stands below it, and their links lead somewhere."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
SNIPPET = re.compile(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```$)?", re.DOTALL | re.MULTILINE)


def name_of(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


SNIPPETS = [
    pytest.param(code, shown, id=f"{name_of(page)}-{i + 1}")
    for page in PAGES
    for i, (code, shown) in enumerate(SNIPPET.findall(page.read_text(encoding="utf-8")))
]


@pytest.mark.parametrize(("code", "shown"), SNIPPETS)
def test_python_prints_what_stands_below_it(code: str, shown: str, capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(code, "docs", "exec"), {})
    assert capsys.readouterr().out == shown


@pytest.mark.parametrize("page", PAGES, ids=name_of)
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8")):
        if not link.startswith(("https://", "#")):
            assert (page.parent / link.split("#")[0]).is_file(), link


def test_the_index_lists_every_page() -> None:
    index = (DOCS / "README.md").read_text(encoding="utf-8")
    assert {name_of(page) for page in PAGES} - set(re.findall(r"\((\S+\.md)\)", index)) == {"README.md"}


def test_every_fence_and_formula_is_closed() -> None:
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        assert text.count("```") % 2 == 0
        assert re.sub(r"```.*?```|`[^`]*`", "", text, flags=re.DOTALL).count("$") % 2 == 0
