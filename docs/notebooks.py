"""A page of these documents as a notebook: ``python docs/notebooks.py docs/tutorial.md tutorial.ipynb``.

The page is the only source.  Its problem file, its commands and its Python become cells, its text becomes Markdown.
What the page shows below a command is left out, because the cell shows its own.
"""

from __future__ import annotations

import re
import shlex
import sys
from pathlib import Path

import nbformat
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

PAGES = (
    "tutorial.md",
    *sorted(f"tutorials/{page.name}" for page in (Path(__file__).parent / "tutorials").glob("*.md")),
    "library.md",
)
"""The pages that the site offers as notebooks."""
_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$\n?", re.DOTALL | re.MULTILINE)
_LINK = re.compile(r"\[([^]]+)\]\((?!https)[^)]*\)")
"""A link to another page, which does not lie beside the notebook; its text stays."""
_PRINTED_NAME = re.compile(r"^print\((\w+)\)$", re.MULTILINE)
"""A line that prints one answer; a notebook displays the answer instead, as a table."""


def notebook_of(page: str) -> nbformat.NotebookNode:
    """The notebook of a page in Markdown with one problem file at most."""
    named = re.search(r"^\$ lapjoint \w+ (\S+\.toml)", page, re.MULTILINE)
    cells, end, language = [], 0, ""
    for block in _BLOCK.finditer(page):
        cells += _prose(page[end : block.start()])
        before, (language, content), end = language, block.groups(), block.end()
        if language == "toml" and named:
            cells.append(new_code_cell(f"%%writefile {named[1]}\n{content.rstrip()}"))
        elif language == "console":
            lines = re.findall(r"^\$ (.*)$", content.replace("\\\n", ""), re.MULTILINE)
            cells += [new_code_cell(f"!{shlex.join(shlex.split(line))}") for line in lines]
        elif language == "python":
            cells.append(new_code_cell(_PRINTED_NAME.sub(r"display(\1)", content.rstrip())))
        elif not (language == "text" and before == "python"):
            cells.append(new_markdown_cell(block[0].rstrip()))
    cells += _prose(page[end:])
    for i, cell in enumerate(cells):
        cell["id"] = f"cell-{i + 1}"  # the same page makes the same file
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return new_notebook(cells=cells, metadata={"kernelspec": kernel})


def _prose(text: str) -> list[nbformat.NotebookNode]:
    text = _LINK.sub(r"\1", text).strip()
    return [new_markdown_cell(text)] if text else []


if __name__ == "__main__":
    nbformat.write(notebook_of(Path(sys.argv[1]).read_text(encoding="utf-8")), sys.argv[2])
