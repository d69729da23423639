"""What the pages in docs/ promise: their Python prints what stands below it, and their links lead somewhere."""

from __future__ import annotations

import re
import shlex
import tomllib
from pathlib import Path

import pytest
from click.testing import CliRunner
from pages import SCATTER, alike, blocks, sessions

from lapjoint import AtEquilibrium, paper_joint, write_problem
from lapjoint.cli.main import main
from lapjoint.errors import InputError
from lapjoint.problem.files import from_toml, problem_from_tables, problem_tables

DOCS = Path(__file__).resolve().parents[1] / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
SNIPPET = re.compile(r"^```python\n(.*?)^```\n(?:\n```text\n(.*?)^```$)?", re.DOTALL | re.MULTILINE)


FROM_BESIDE = {"readme.md", "contributing.md", "changes.md"}
"""Pages of the site that include a file from beside the folder."""


def name_of(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


SECONDS = {"branches.md-2", "errata.md-7", "errata.md-8", "errata.md-9"}
"""Snippets that take seconds, by their page and their number on it."""
SNIPPETS = [
    pytest.param(code, shown, id=name, marks=pytest.mark.thorough if name in SECONDS else ())
    for page in PAGES
    for i, (code, shown) in enumerate(SNIPPET.findall(page.read_text(encoding="utf-8")))
    for name in [f"{name_of(page)}-{i + 1}"]
]


@pytest.mark.parametrize(("code", "shown"), SNIPPETS)
def test_python_prints_what_stands_below_it(code: str, shown: str, capsys: pytest.CaptureFixture[str]) -> None:
    exec(compile(code, "docs", "exec"), {})
    assert capsys.readouterr().out == shown


def test_the_problem_files_of_their_page_are_valid(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rows = (f"{i / 1000},{i % 3}" for i in range(9))
    Path("shaker.csv").write_text("\n".join(["t,a_z", *rows]), encoding="utf-8")
    page = (DOCS / "problem-files.md").read_text(encoding="utf-8")
    whole, *parts, several, drawn = blocks("toml", page)
    linked = from_toml(several)
    assert linked.structure.links[0].second == linked.position("lower:0.03")
    assert [one.name for one in from_toml(_with_part(whole, drawn)).uncertain] == ["gap", "stiffness"]
    problem = from_toml(whole)
    assert problem.stop_names == ("tip",)
    found = [from_toml(_with_part(whole, part)) for part in parts]
    stepped, heavy, wall, harmonics, record, noise, weighed, pressed = found
    for other in (harmonics, record, noise):
        assert other.replace(base_motion=problem.base_motion) == problem
    assert len(stepped.beam.pieces) == 2
    assert heavy.masses[0].name == "clevis"
    assert wall.stops[-1].in_space
    assert weighed.uniform_loads[0].start == 0.5
    assert pressed.initial == AtEquilibrium()


def test_the_keys_of_the_page_on_records_read_the_files_beside_them(tmp_path: Path) -> None:
    page = (DOCS / "records.md").read_text(encoding="utf-8")
    message, *files = blocks("text", page)
    *keys, universal = blocks("toml", page)
    assert "dataset = 2" in universal
    for content, part in zip(files, keys, strict=True):
        tables = {**problem_tables(paper_joint()), **tomllib.loads(part)}
        record = tables["base_motion"] if "[base_motion]" in part else tables["point_loads"][0]
        (tmp_path / record["file"]).write_text(content, encoding="utf-8")
        found = problem_from_tables(tables, folder=tmp_path)
        (read,) = found.records.values()
        assert read.values is not None
        assert read.values.array.tolist() == [0.5149, -0.512, 0.2044]
        record |= {"skip": 0, "decimal": "."}
        if "skip" in part:
            with pytest.raises(InputError, match=r'skip = \d+ and decimal = "," would read it'):
                problem_from_tables(tables, folder=tmp_path)
    (tmp_path / "table.csv").write_text("a\n" * 6 + "0,0012;3,4\n0,0013;3,5\n", encoding="utf-8")
    of = {"kind": "record", "quantity": "acceleration", "file": "table.csv", "rate": 10.0}
    with pytest.raises(InputError, match=re.escape(message.strip())):
        problem_from_tables({**problem_tables(paper_joint()), "base_motion": of}, folder=tmp_path)


def _with_part(whole: str, part: str) -> str:
    """A problem file with one more part, or with the part in place of its own beam or base motion."""
    if part.startswith("[beam]"):
        return part + whole[whole.index("[[supports]]") :]
    return (whole.split("[base_motion]")[0] if part.startswith("[base_motion]") else whole) + "\n" + part


def test_the_session_of_the_page_on_sweeps_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = (DOCS / "sweeps.md").read_text(encoding="utf-8")
    (session,) = blocks("pycon", page)
    *lines, last = re.findall(r"^>>> (.*)$", session, re.MULTILINE)
    names: dict[str, object] = {}
    for line in lines:
        exec(line, names)
    assert "impulse" in str(eval(last, names))


def test_the_session_of_the_page_on_uncertain_numbers_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    page = (DOCS / "uncertainty.md").read_text(encoding="utf-8")
    tables = {**problem_tables(paper_joint()), **tomllib.loads(blocks("toml", page)[0])}
    write_problem(problem_from_tables(tables), "my.toml")
    (session,) = blocks("pycon", page)
    few = session.replace("range(100, 1500, 7)", "(400.0,)")
    few = few.replace("samples=256", 'samples=64, options={"n_modes": 2}')
    *lines, interval, indices = re.findall(r"^>>> (.*)$", few, re.MULTILINE)
    names: dict[str, object] = {}
    for line in lines:
        exec(line, names)
    low, high = eval(interval, names).values
    assert 0 <= low <= high <= 1
    assert eval(indices, names).dims == ("uncertain",)


def test_every_dependency_is_explained() -> None:
    project = tomllib.loads((DOCS.parent / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    table = (DOCS / "layout.md").read_text(encoding="utf-8").split("## Dependencies")[1]
    extras = [one for group in project["optional-dependencies"].values() for one in group]
    names = {re.split(r"[<>=\[;~ ]", one)[0] for one in [*project["dependencies"], *extras]} - {"lapjoint"}
    assert {name for name in names if name not in table} <= {"pytest-xdist"}  # "pytest" is


def test_the_layout_names_every_folder_two_levels_deep() -> None:
    root = DOCS.parent
    table = (DOCS / "layout.md").read_text(encoding="utf-8").split("## Dependencies")[0]
    named = {path.rstrip("/") for path in re.findall(r"`([\w/]+/)`", table)}
    tops = {path.split("/")[0] for path in named}
    assert {"lapjoint", "analytic", "fe_lapjoint", "validation", "explore", "tests", "benchmarks", "docs"} == tops
    inner = {path for top in tops for path in (root / top).iterdir() if any(path.rglob("*.py"))}
    assert named == tops | {path.relative_to(root).as_posix() for path in inner}


def anchors(page: Path) -> set[str]:
    """The headings of a page as links name them, what it includes too."""
    text = re.sub(r"^```\{include\} (\S+)$", lambda m: (page.parent / m[1]).read_text("utf-8"), page.read_text("utf-8"))
    headings = re.findall(r"^#+ (.+)$", re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


BESIDE = [DOCS.parent / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]


@pytest.mark.parametrize("page", [*PAGES, *BESIDE], ids=lambda page: page.name)
def test_links_between_pages_lead_to_pages_and_headings(page: Path) -> None:
    for link, _, heading in re.findall(r"\]\((?!https)([^)#\s]*)(#([^)]+))?\)", page.read_text(encoding="utf-8")):
        target = page.parent / link if link else page
        assert target.is_file(), link
        assert not heading or heading in anchors(target), (link, heading)


def test_the_glossary_explains_the_words_that_the_house_uses() -> None:
    """All that CONTRIBUTING.md names, each once, and what a certificate or a verdict is called."""
    from lapjoint import Outcome
    from validation.verdict import Verdict

    text = (DOCS / "glossary.md").read_text(encoding="utf-8").lower()
    words = re.findall(r"^### (.+)\n\n\S", text, re.MULTILINE)
    assert len(words) == len(set(words)) == text.count("\n### ")
    (listed,) = re.findall(r"\*\*Words of the field\*\*: ([^.]+)\.", (BESIDE[1]).read_text(encoding="utf-8"))
    for word in listed.replace("\n", " ").split(","):
        assert " ".join(word.split()) in words
    called = {outcome.name.lower().replace("quasiperiodic", "quasi-periodic") for outcome in Outcome} - {"no_contact"}
    for word in (*called, *(verdict.value for verdict in Verdict)):
        assert word in text, word


def test_the_index_lists_every_page() -> None:
    index = (DOCS / "index.md").read_text(encoding="utf-8")
    linked = {link.split("#")[0] for link in re.findall(r"\((\S+\.md(?:#\S+)?)\)", index)}
    assert {name_of(page) for page in PAGES} - linked == {"index.md", *FROM_BESIDE}


def test_every_fence_and_formula_is_closed() -> None:
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        assert text.count("```") % 2 == 0
        assert re.sub(r"```.*?```|`[^`]*`", "", text, flags=re.DOTALL).count("$") % 2 == 0


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("title", "friction = 0.2\ntitle"),
        ("title", "wear = 0.1\ntitle"),
        ("[beam]", "[[beam]]"),
        ("450.0 ", "[450.0, 900.0]"),
        ("gap = 1e-3", "gap = 1e-3\nrestitution = 0.7"),
        ("gap = 1e-3", "gap = 1e-3\nfriction = 0.3"),
    ],
)
def test_what_a_problem_cannot_say_is_refused(old: str, new: str) -> None:
    """The page of limitations promises a message; a key that comes to mean something changes that page."""
    assert "An unknown key" in (DOCS / "limitations.md").read_text(encoding="utf-8")
    page = (DOCS / "problem-files.md").read_text(encoding="utf-8")
    problem = blocks("toml", page)[0]
    assert from_toml(problem)
    with pytest.raises(InputError):
        from_toml(problem.replace(old, new, 1))


SHAKER = (DOCS / "from-a-shaker.md").read_text(encoding="utf-8")
ROW = re.compile(r"[-+.\de]*\d[-+.\de]*\*?")


def test_the_page_of_the_shaker_prints_its_table(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Word for word, and the first number of each row to a quarter: the motion is chaotic, rounding makes another.

    So it does of the place where something is largest, and of whether that is one of those asked for.
    """
    monkeypatch.chdir(tmp_path)
    makes_file, draws = blocks("py", SHAKER)
    (problem,) = blocks("toml", SHAKER)
    Path("rattle.toml").write_text(problem, encoding="utf-8")
    exec(compile(makes_file, "docs", "exec"), {})
    shown_rows = re.findall(r"^[-\d.]+;.*$", SHAKER, re.MULTILINE)
    assert Path("shaker.csv").read_text(encoding="utf-8").splitlines()[2:4] == shown_rows
    (block,) = blocks("console", SHAKER)
    line, _, shown = block.replace("\\\n", "").removeprefix("$ lapjoint ").partition("\n")
    result = CliRunner().invoke(main, shlex.split(line))
    assert result.exit_code == 0, result.output
    both = ([row for row in text.splitlines() if "*" not in row] for text in (shown, result.stdout))
    for expected, printed in zip(*both, strict=True):
        assert ROW.sub("#", expected).split() == ROW.sub("#", printed).split()
        numbers = [ROW.findall(text.partition("]")[2] or text)[:1] for text in (expected, printed)]
        if all(numbers):
            assert float(numbers[1][0]) == pytest.approx(float(numbers[0][0]), rel=0.25)
    exec(compile(draws, "docs", "exec"), {})
    assert Path("forces.pdf").stat().st_size > 1000


ALL_PAGES = {name_of(page): page for page in PAGES} | {page.name: page for page in BESIDE}
LONGEST = 92
"""Letters of a line of a terminal that the site shows without scrolling, at the width of a laptop."""
SHOWN = [
    pytest.param(line.partition(" #")[0].strip().removesuffix("&").strip(), id=f"{name}: {line[:50].strip()}")
    for name, page in ALL_PAGES.items()
    for block in blocks("console", page.read_text(encoding="utf-8").replace("\\\n", ""))
    for line in re.findall(r"^\$ ((?:\.venv/bin/)?(?:lapjoint|dask) .*)$", block, re.MULTILINE)
]


@pytest.mark.parametrize("line", SHOWN)
def test_every_command_that_a_page_shows_has_these_options(line: str) -> None:
    """It is parsed, not run: a name or an option that is gone is an error."""
    program, name, *words = shlex.split(line)
    if program == "dask":
        module = pytest.importorskip(f"distributed.cli.dask_{name}")
        module.main.make_context(name, words)
        return
    context = main.make_context("lapjoint", [name, *words])
    command = main.get_command(context, name)
    assert command is not None, name
    with command.make_context(name, words, parent=context) as parsed:
        assert parsed.params


def test_no_command_is_cut_at_the_margin_of_the_site() -> None:
    for name, page in ALL_PAGES.items():
        for block in blocks("console", page.read_text(encoding="utf-8")):
            for line in re.findall(r"^(?:\$|   ) .*$", block, re.MULTILINE):
                assert len(line) <= LONGEST, (name, line)


def test_every_option_that_a_page_names_is_one() -> None:
    """Those in the text, as `--set`, are of some command, or of pip, pytest or dask where the page says so."""
    context = main.make_context("lapjoint", ["--help"], resilient_parsing=True)
    commands = [main.get_command(context, name) for name in main.list_commands(context)]
    known = {option for command in commands if command for one in command.params for option in one.opts}
    known |= {option for command in commands if command for one in command.params for option in one.secondary_opts}
    known |= {"--help", "--version", "--page"}  # the last is of `python -m validation.faults.mutants`
    for name, page in ALL_PAGES.items():
        text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.DOTALL | re.MULTILINE)
        for code in re.findall(r"`([^`]+)`", text):
            for option in re.findall(r"(?:^|(?<=\s))--[a-z][a-z-]*", code):
                assert option in known or code.startswith(("pip ", "dask ")), (name, code)


TUTORIALS = [DOCS / "tutorial.md", *sorted((DOCS / "tutorials").glob("*.md"))]
FIVE_AND_MORE = {"init", "modes", "steady", "sweep", "validate", "statistics", "plot"}
"""The README's five commands, and two that it names beside them."""


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda page: page.stem)
def test_a_tutorial_has_one_problem_file_and_takes_few_commands(page: Path) -> None:
    """`test_notebooks.py` runs the commands."""
    text = page.read_text(encoding="utf-8")
    assert len(blocks("toml", text)) == 1
    assert len(set(re.findall(r"^\$ lapjoint \w+ (\S+\.toml)", text, re.MULTILINE))) == 1
    lines = [line for block in blocks("console", text) for line, _ in sessions(block)]
    assert len(lines) >= 3
    assert {line.split()[0] for line in lines} <= FIVE_AND_MORE


def test_a_row_of_statistics_is_compared_by_its_words_and_its_first_number() -> None:
    row = "plate 1, above   {:.5g}   26.37   {}"
    assert alike(row.format(27.0, 28.87), row.format(27.0 * (1 + 0.9 * SCATTER), "?"))
    assert not alike(row.format(27.0, 28.87), row.format(27.0 * (1 + 1.1 * SCATTER), 28.87))
    assert not alike(row.format(27.0, 28.87), row.format(27.0, 28.87).replace("above", "below"))
    assert not alike(row.format(27.0, 28.87), row.format(27.0, ""))
