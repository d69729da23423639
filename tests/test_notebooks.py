"""Each tutorial is a notebook that runs: its commands print what its page shows, its answers are tables."""

from __future__ import annotations

import os
import re
import runpy
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from nbformat import NotebookNode
from pages import assert_shown, blocks, sessions

DOCS = Path(__file__).resolve().parents[1] / "docs"
MADE = runpy.run_path(str(DOCS / "notebooks.py"))
ANSI = re.compile(r"\x1b\[[\d;?]*[A-Za-z]")


@pytest.fixture(autouse=True)
def environment(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The command is found as in an activated environment, and no settings of a person are read."""
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    for name in ("IPYTHONDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR"):
        monkeypatch.setenv(name, str(tmp_path / "jupyter"))


def run(notebook: NotebookNode, folder: Path) -> list[NotebookNode]:
    """Run a notebook in a folder, which is made; its cells of code.  A command that fails is an error here, not in
    IPython."""
    cells = notebook.cells
    for i in reversed([i for i, cell in enumerate(cells) if cell.source.startswith("!")]):
        cells.insert(i + 1, nbformat.v4.new_code_cell("assert _exit_code == 0, _exit_code"))
    folder.mkdir()
    NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(folder)}}).execute()
    return [cell for cell in cells if cell.cell_type == "code"]


def printed(cell: NotebookNode) -> str:
    """What a cell has printed."""
    return ANSI.sub("", "".join(out.text for out in cell.outputs if out.output_type == "stream"))


@pytest.mark.thorough
@pytest.mark.parametrize("page", MADE["PAGES"])
def test_a_page_runs_as_a_notebook_and_shows_what_the_page_shows(page: str, tmp_path: Path) -> None:
    text = (DOCS / page).read_text(encoding="utf-8")
    notebook = MADE["notebook_of"](text)
    nbformat.validate(notebook)
    cells = run(notebook, tmp_path / "here")
    commands = [cell for cell in cells if cell.source.startswith("!")]
    asked = [one for block in blocks("console", text) for one in sessions(block)]
    for cell, (line, shown) in zip(commands, asked, strict=True):
        assert_shown(line, shown, printed(cell))
        for figure in re.findall(r"\S+\.pdf", line):
            assert (tmp_path / "here" / figure).stat().st_size > 1000
    displayed = [out.data for cell in cells for out in cell.outputs if out.output_type == "display_data"]
    assert len(displayed) == sum(cell.source.count("\ndisplay(") for cell in cells)
    assert all("<table" in data["text/html"] for data in displayed)
    assert commands or displayed


@pytest.mark.thorough
def test_a_command_that_fails_stops_a_notebook(tmp_path: Path) -> None:
    page = "# Page\n\n```console\n$ lapjoint steady missing.toml\n```\n"
    with pytest.raises(Exception, match=r"AssertionError.*: 2"):
        run(MADE["notebook_of"](page), tmp_path / "here")


def test_the_same_page_makes_the_same_notebook_and_no_link_leads_nowhere() -> None:
    for page in MADE["PAGES"]:
        text = (DOCS / page).read_text(encoding="utf-8")
        one, other = (nbformat.writes(MADE["notebook_of"](text)) for _ in range(2))
        assert one == other
        prose = [cell.source for cell in nbformat.reads(one, 4).cells if cell.cell_type == "markdown"]
        assert not any(re.search(r"\]\((?!https)", source) for source in prose)
