"""Reports of problems of one's own: the same numbers as the command line, legible on screens and on paper."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from browser import browse, look_at, needs_browser
from command_line import run_well
from own_reports import DURATION, OPTIONS, PROBLEMS, lasting, write_own_report

from lapjoint.problem.files import write_problem
from validation.cases.own_problem import NAMES

WIDTHS = (1280, 390)
NUMBER = re.compile(r"-?\d[\d.]*(?:e[+-]?\d+)?")
KINDS = ["periodic", *(pytest.param(kind, marks=pytest.mark.thorough) for kind in ("recorded", "random", "beams"))]
pages = pytest.mark.parametrize("kind", KINDS)


def rows_of_numbers(text: str) -> set[str]:
    """The numbers of the tables that a command prints, each as it is printed: those at the ends of lines."""
    found = set()
    for line in text.splitlines():
        ending = re.search(r"(?:\s+(?:\+- )?(?:-?[\d.]+(?:e[+-]?\d+)?|\?))+\s*$", line)
        if ending and not line.startswith(("Floquet", "Excitation")):
            found |= set(NUMBER.findall(ending[0]))
    return found


@pages
def test_a_report_has_the_numbers_that_the_command_line_prints(kind: str, tmp_path: Path) -> None:
    problem, result = PROBLEMS[kind], lasting(kind)
    write_problem(problem, tmp_path / "joint.toml")
    command = ["steady"] if result.name == "steady" else ["statistics", "--duration", str(DURATION)]
    for (solver, options), name in zip(OPTIONS.items(), NAMES, strict=True):
        printed = run_well(command[0], tmp_path / "joint.toml", *command[1:], *options)
        printed = printed[printed.index("\n\n") :]
        shown: set[str] = set()
        for table in result.answer:
            mine = [i for i, column in enumerate(table.columns) if column.endswith(name)]
            rows = [row for row in table.rows if "solver" not in table.columns or row[1] == name]
            cells = [row[i] for row in rows for i in mine or range(2, len(row))]
            shown |= {number for cell in cells for number in NUMBER.findall(cell)}
        assert len(shown) > 20, solver
        # places stand in the first columns, and may be numbers
        places = {
            number for table in result.answer for row in table.rows for number in NUMBER.findall(" ".join(row[:2]))
        }
        printed_numbers = rows_of_numbers(printed)
        assert shown <= printed_numbers | {"0"}, (solver, shown - printed_numbers)
        assert printed_numbers - places <= shown, (solver, printed_numbers - places - shown)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("own")


def report(folder: Path, kind: str) -> Path:
    if not (folder / kind).exists():
        write_own_report(kind, folder / kind)
    return folder / kind / "report.html"


@needs_browser
@pages
def test_a_report_fits_its_width_and_no_word_is_cut(kind: str, folder: Path, tmp_path: Path) -> None:
    for seen in look_at(tmp_path, report(folder, kind).parent, ["report.html"], WIDTHS):
        assert seen.page_width <= seen.width
        assert seen.tables > 8
        assert (seen.beyond, seen.cut, seen.overlaps, seen.broken) == (0, [], [], [])


@needs_browser
@pytest.mark.thorough
@pages
def test_an_accessibility_checker_finds_nothing_serious(kind: str, folder: Path, tmp_path: Path) -> None:
    text = report(folder, kind).read_text(encoding="utf-8")
    (tmp_path / "open.html").write_text(re.sub(r'<meta http-equiv="Content-Security-Policy"[^>]*>', "", text))
    for seen in look_at(tmp_path / "profile", tmp_path, ["open.html"], WIDTHS, checked=True):
        assert seen.serious == []


@needs_browser
@pytest.mark.thorough
@pages
def test_on_paper_a_report_has_two_pages_at_most(kind: str, folder: Path, tmp_path: Path) -> None:
    target = tmp_path / "report.pdf"
    browse(tmp_path / "profile", report(folder, kind), f"--print-to-pdf={target}", "--no-pdf-header-footer")
    assert len(re.findall(rb"/Type\s*/Page[^s]", target.read_bytes())) <= 2


@needs_browser
def test_a_figure_is_drawn_for_narrow_screens_too(folder: Path) -> None:
    text = report(folder, "periodic").read_text(encoding="utf-8")
    widths = [float(width) for width in re.findall(r'<svg [^>]*width="([\d.]+)pt"', text)]
    assert len(widths) >= 4
    assert sum(width <= 250 for width in widths) == len(widths) / 2
