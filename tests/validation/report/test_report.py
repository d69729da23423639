"""The report as a document: its structure, its files, and that no text of a result can break it."""

from __future__ import annotations

import csv
import json
import math
import re
from collections import Counter
from html.parser import HTMLParser
from pathlib import Path

import pytest
from report_sample import HOSTILE, checks, estimate, everything

import validation.report.page
from lapjoint import Beam, BeamSegment, Problem, paper_joint
from lapjoint.errors import OutputError
from validation.case import CaseResult
from validation.report.asked import problem_sheets
from validation.report.page import sentence, short, significant
from validation.report.table_files import Sheet, distinct, slug
from validation.report.uncertainty_budget import shares
from validation.report.write import write_reports
from validation.verdict import Check, Estimate, Kind

VOID = {"meta", "link", "br", "hr", "img", "input", "path", "use", "rect", "circle"}


class Outline(HTMLParser):
    """Checks nesting while reading, and keeps what tests ask for."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: Counter[str] = Counter()
        self.ids: list[str] = []
        self.links: list[str] = []
        self.scopes: list[str | None] = []
        self.headings: list[int] = []
        self.boxes: list[dict[str, str | None]] = []
        self.wrong: list[str] = []
        self.text = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found = dict(attrs)
        self.tags[tag] += 1
        self.ids += [str(value) for name, value in attrs if name == "id"]
        if tag == "a":
            self.links.append(str(found["href"]))
        if tag == "th":
            self.scopes.append(found.get("scope"))
        if tag == "table" and self.open[-1] != "div":
            self.wrong.append("a table outside its box")
        if found.get("class") == "wide":
            self.boxes.append(found)
        if re.fullmatch(r"h[1-6]", tag):
            self.headings.append(int(tag[1]))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag in VOID:
            return
        if not self.open or self.open.pop() != tag:
            self.wrong.append(f"</{tag}> at {self.getpos()}")

    def handle_data(self, data: str) -> None:
        self.text += data


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    output = tmp_path_factory.mktemp("report")
    write_reports(everything(), "quick", output, 1.0)
    return output


@pytest.fixture(scope="module")
def outline(folder: Path) -> Outline:
    return Outline((folder / "report.html").read_text(encoding="utf-8"))


def test_its_elements_nest(outline: Outline) -> None:
    assert (outline.wrong, outline.open) == ([], [])


def test_every_id_is_there_once_and_every_link_leads_somewhere(outline: Outline, folder: Path) -> None:
    assert [name for name, times in Counter(outline.ids).items() if times > 1] == []
    for link in outline.links:
        if link.startswith("#"):
            assert link[1:] in outline.ids
        else:
            assert (folder / link).is_file(), link


def test_nothing_in_it_comes_from_elsewhere(folder: Path, outline: Outline) -> None:
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r'(src|href|xlink:href)="(https?:)?//', page)
    assert not re.search(r"@import|url\((?!#)", page)
    assert "default-src 'none'" in page
    assert not {"img", "iframe", "object"} & set(outline.tags)


def test_hostile_text_stays_text(outline: Outline) -> None:
    assert outline.tags["script"] == 1  # its own, for printing
    assert HOSTILE in outline.text
    assert outline.text.count("alert") > 20


def test_headings_come_in_order_and_tables_are_labelled(outline: Outline) -> None:
    assert outline.headings[0] == 1
    assert outline.headings.count(1) == 1
    assert all(after <= before + 1 for before, after in zip(outline.headings, outline.headings[1:], strict=False))
    assert outline.tags["caption"] == outline.tags["table"] > 10
    assert set(outline.scopes) == {"col", "row"}
    for box in outline.boxes:
        assert box["tabindex"] == "0"
        assert box["aria-labelledby"] in outline.ids


def test_every_table_has_its_files(folder: Path, outline: Outline) -> None:
    index = json.loads((folder / "tables" / "index.json").read_text())
    assert len(index) == outline.tags["table"]
    for entry in index:
        for name in entry["files"]:
            assert f"tables/{name}" in outline.links
        text = (folder / "tables" / entry["files"][0]).read_text(encoding="utf-8")
        rows = list(csv.reader(text.splitlines()))
        data = json.loads((folder / "tables" / entry["files"][1]).read_text(encoding="utf-8"))
        assert rows[0] == data["columns"]
        assert len(rows) - 1 == len(data["rows"])


def test_files_of_an_earlier_report_are_removed_and_nothing_else(tmp_path: Path) -> None:
    write_reports(everything(), "quick", tmp_path, 1.0)
    before = set(tmp_path.rglob("*.csv"))
    (tmp_path / "tables" / "mine.csv").write_text("kept")
    write_reports(everything()[1:2], "quick", tmp_path, 1.0)
    after = set(tmp_path.rglob("*.csv"))
    assert len(after) < len(before)
    assert tmp_path / "tables" / "mine.csv" in after


def test_what_differs_comes_first(outline: Outline) -> None:
    page = outline.text
    case = page[page.index("What differs") :]
    words = ("✗ disagree: 4", "! explained: 2", "Would a mistake be noticed?", "Verdicts", "The cases")
    places = [case.index(word) for word in words]
    assert places == sorted(places)
    inside = case[case.index("The cases") :]
    assert inside.index("Why?") < inside.index("energy created") < inside.index("Checks")
    rows = inside[inside.index("Checks") :]
    assert rows.index("beyond the cap") < rows.index("misprint again") < rows.index("agrees")


def test_the_first_screen_convinces(outline: Outline) -> None:
    """The verdict in a sentence, the joint, what differs, and whether a mistake would be noticed."""
    assert outline.ids.index("joint") < outline.ids.index("differs") < outline.ids.index("faults")
    assert re.search(r"(\d+) faults of the kinds .*: \1 changed a verdict", outline.text, re.S)


def test_an_own_problem_is_what_its_page_is_about(tmp_path: Path) -> None:
    joint = paper_joint(angular_frequency=515.0).replace(title=f"My joint {HOSTILE}")
    write_reports(everything(), "quick", tmp_path, 1.0, joint)
    page = Outline((tmp_path / "report.html").read_text(encoding="utf-8"))
    assert f"My joint {HOSTILE}" in page.text
    assert "paper right" not in page.text
    for value in ("gap [m]", "density 7890 kg/m3", "angular frequency 515 rad/s (81.96 Hz)"):
        assert value in page.text
    parts = ["asked", "answer", "believe", "assumed"]
    assert [name for name in page.ids if name in parts] == parts
    assert page.wrong == []
    assert "faults" not in page.ids


def test_a_verdict_is_never_colour_alone(outline: Outline) -> None:
    for sign in ("✓ agree", "! explained", "✗ disagree"):
        assert sign in outline.text


def test_the_overall_verdict_is_a_sentence() -> None:
    all_of_it, agrees, _, nothing = everything()
    assert sentence([agrees]) == "The one comparison agrees."
    assert sentence([]) == sentence([nothing]) == "Nothing was compared."
    assert sentence([all_of_it, agrees]).startswith("4 of 40 comparisons disagree: see ")
    explained = CaseResult("x", "x", "", checks()[3:5])
    assert sentence([explained, agrees]).startswith("Nothing disagrees: 1 of 3 comparisons agree, and 2 differ")


def test_shares_of_the_uncertainty_add_up_to_one() -> None:
    first = checks()[0]
    found = shares(first)
    assert list(found) == ["modes", "mesh", "rounding"]
    assert sum(found.values()) == pytest.approx(1.0)
    assert found["rounding"] == pytest.approx(0.25)
    assert shares(checks()[5]) == {}


def test_an_uncertainty_that_is_not_broken_down_is_one_source() -> None:
    check = Check("x", "1", Estimate(1.0, 1.0, ""), Estimate(1.0, 1.0, "", Kind.PUBLISHED))
    assert shares(check) == pytest.approx({"stated as a whole": 0.5, "reference: published": 0.5})


def test_the_kind_of_reference_is_that_of_the_number_not_computed_here() -> None:
    assert [check.reference for check in checks()[:4]] == [Kind.CROSS_METHOD] * 3 + [Kind.PUBLISHED]


def test_numbers_have_the_digits_that_their_uncertainty_leaves() -> None:
    assert significant(729.058381, 0.05) == "729.06"
    assert significant(729.0, 0.05) == "729.00"
    assert significant(-123.4567, 2e-3) == "-123.457"
    assert significant(0.0, 1.0) == "0.00000000"


def test_short_numbers_are_read_at_a_glance() -> None:
    shown = [short(value) for value in (100.0, 55.3, 0.0123, -1e-9, 2e7, 0.0, math.inf, -math.inf, math.nan)]
    assert shown == ["100", "55", "0.012", "-1e-09", "2e+07", "0", "∞", "-∞", "nan"]
    assert [short(value, 4) for value in (3.9982, 511.685, 12345.6)] == ["3.998", "511.7", "12346"]


def test_no_text_of_a_table_is_a_formula() -> None:
    rows = (("=1+1", "-0.5", -0.5), ("@x", "+x", "- 0.1 ± 0.2"))
    text = Sheet("a", "A", ("-b", "c", "d"), rows).csv()
    assert text == "'-b,c,d\n'=1+1,-0.5,-0.5\n'@x,'+x,'- 0.1 ± 0.2\n"


def test_a_report_that_cannot_be_written_leaves_the_earlier_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_reports(everything(), "quick", tmp_path, 1.0)
    there = {path: path.read_bytes() for path in tmp_path.rglob("*.*")}
    assert len(there) > 3
    written = []

    def full(descriptor: int) -> None:
        written.append(descriptor)
        if len(written) == 3:
            raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr("os.fsync", full)
        with pytest.raises(OutputError, match="cannot be written: No space left on device"):
            write_reports(everything(), "quick", tmp_path, 2.0)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*")} == there
    write_reports(everything()[:1], "quick", tmp_path, 1.0)
    assert len(list((tmp_path / "tables").iterdir())) < len(there)


def test_names_become_files_safely() -> None:
    assert slug("../Ä <b>") == "a-b"
    assert slug("€") == "x"
    assert distinct(["a", "A", "a!"]) == ["a", "a-2", "a-3"]


def luminance(colour: str) -> float:
    """Relative luminance as WCAG 2 defines it."""
    parts = [int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)]
    r, g, b = (c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts)
    return 0.2126 * r + 0.7152 * g + 0.0722 * b


@pytest.mark.parametrize("scheme", [0, 1], ids=["light", "dark"])
def test_text_stands_out_from_what_is_behind_it(scheme: int) -> None:
    css = (Path(validation.report.page.__file__).parent / "templates" / "report.css").read_text()
    found = dict(re.findall(r"--([a-z-]+): (#[0-9a-f]{6})", re.findall(r":root \{[^}]*\}", css)[scheme]))
    pairs = [(ink, paper) for ink in ("ink", "faint", "link") for paper in found if paper in ("paper", "band")]
    pairs += [(ink, f"{v}-bg") for v in ("agree", "disagree", "explained") for ink in (v, "ink", "faint", "link")]
    pairs += [(v, "paper") for v in ("agree", "disagree", "explained")]
    for ink, paper in pairs:
        dark, light = sorted((luminance(found[ink]), luminance(found[paper])))
        assert (light + 0.05) / (dark + 0.05) >= 4.5, (ink, paper)


def test_frequencies_stand_in_hz_too(tmp_path: Path) -> None:
    both = estimate(300.0, 1e-3)
    result = CaseResult("own", "Own", "Which?", checks=(Check("omega_1", "rad/s", both, both),))
    write_reports([result], "quick", tmp_path, 1.0, paper_joint(angular_frequency=515.0))
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "omega_1 [rad/s]" in page
    assert "47.75 Hz." in page
    assert "angular frequency 515 rad/s (81.96 Hz)" in page


def test_the_segments_of_a_beam_are_written_value_by_value() -> None:
    segments = tuple(BeamSegment(to=to, bending_stiffness=9.0, mass_per_length=2.0) for to in (0.5, 1.0))
    (sheet,) = problem_sheets(Problem(beam=Beam(length=1.0, segments=segments)))
    ((_, values),) = sheet.rows
    each = "bending stiffness 9 N m2, mass per length 2 kg/m"
    assert f"segments: (to 0.5 m, {each}), (to 1 m, {each})" in str(values)
