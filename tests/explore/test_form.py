"""Problems as forms, and changes of problems by forms."""

from __future__ import annotations

import random
from functools import partial
from typing import Any

import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

import explore.form
from explore.editing import added, changed_kind, removed, typed
from explore.faults import at_fields, checked
from explore.form import Field, Group, Listing, all_parts, form_of, number_text
from explore.page import Page
from explore.question import Question, opened
from explore.starts import starts, tables_of
from lapjoint import InputError, paper_joint
from lapjoint.problem.example import commented_example
from lapjoint.problem.files import json_schema, problem_from_tables, problem_tables, tables_from_toml

EXAMPLES = [tables_from_toml(commented_example(name)) for name in ("paper", "lap")]
TYPED = ("", "0.3", "-1e300", "inf", "nan", "0,4e-3", "[1, 2", '["upper:0.3", 7]', "top", "ä", "true", "1" * 5000, "{}")


def leaves(value: Any, path: str = "") -> set[str]:
    """The paths of all single values in tables."""
    if isinstance(value, dict):
        return set().union(*(leaves(below, f"{path}.{key}".strip(".")) for key, below in value.items()))
    if isinstance(value, list) and value and isinstance(value[0], dict):
        return set().union(*(leaves(below, f"{path}.{i}") for i, below in enumerate(value)))
    return {path}


@pytest.mark.parametrize("tables", EXAMPLES)
def test_a_form_shows_each_value_of_a_problem_at_its_path(tables: dict[str, Any]) -> None:
    parts = list(all_parts(form_of(tables)))
    shown = {part.path for part in parts if isinstance(part, Field) and part.text}
    shown |= {f"{part.path}.{part.tag}" for part in parts if isinstance(part, Group) and part.tag and not part.absent}
    assert leaves(tables) - {"schema_version"} <= shown


@pytest.mark.parametrize("tables", EXAMPLES)
def test_what_a_field_shows_is_read_back_as_the_same_value(tables: dict[str, Any]) -> None:
    problem = problem_from_tables(tables)
    for part in all_parts(form_of(tables)):
        if isinstance(part, Field) and part.text:
            assert problem_from_tables(typed(tables, part.path, part.text)) == problem, part.path


def test_the_text_of_a_number_gives_the_same_bits_back() -> None:
    draw = random.Random(5)
    for _ in range(2000):
        value = draw.choice([-1, 1]) * draw.uniform(1, 10) * 10.0 ** draw.randint(-320, 307)
        assert float(number_text(value)) == value
    assert number_text(2.05e11) == "2.05e11"
    assert number_text(0.001) == "0.001"


def test_a_field_that_the_schema_gets_later_appears_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    schema = json_schema()
    schema["$defs"]["Stop"]["properties"]["friction"] = {"type": "number", "default": 0.0, "description": "Of Coulomb."}
    monkeypatch.setattr(explore.form, "_schema", lambda: schema)
    fields = [part for part in all_parts(form_of(EXAMPLES[0])) if isinstance(part, Field)]
    found = [field for field in fields if field.label == "friction"]
    assert [field.path for field in found] == [f"stops.{i}.friction" for i in range(4)]
    assert found[0].hint == "Of Coulomb."


def test_any_sequence_of_changes_leaves_a_form_and_messages_that_belong_to_its_fields() -> None:
    """Whatever a person clicks and types, there is a form, and a verdict on the problem without a traceback."""
    draw, fields_with_faults = random.Random(51), 0
    for run in range(6):
        asked = opened(EXAMPLES[run % 2])
        for _ in range(25):
            tables, parts = asked.tables, list(all_parts(form_of(asked.tables)))
            part = draw.choice(parts)
            if isinstance(part, Field):
                tables = typed(tables, part.path, draw.choice((*TYPED, *part.choices)))
            elif isinstance(part, Listing) or part.absent:
                tables = added(tables, part.path)
            elif part.words and draw.random() < 0.6:
                tables = changed_kind(tables, part.path, draw.choice(part.words))
            elif draw.random() < 0.3:
                tables = removed(tables, part.path)
            asked = asked.with_tables(tables)
            found = checked(asked)
            paths = [one.path for one in all_parts(form_of(asked.tables))]
            placed = at_fields(found.faults, paths)
            assert (found.problem is None) == bool(found.faults)
            fields_with_faults += len(placed.keys() - {""})
    assert fields_with_faults > 50


def test_a_message_stands_at_its_field() -> None:
    asked = opened(problem_tables(paper_joint()))
    tables = added(typed(asked.tables, "stops.1.gap", "0,4e-3"), "gravity")
    found = checked(asked.with_tables(tables))
    placed = at_fields(found.faults, [part.path for part in all_parts(form_of(tables))])
    assert placed.keys() == {"stops.1.gap", "gravity.acceleration"}
    assert "a point begins the fraction: 0.4e-3" in placed["stops.1.gap"][0]


def test_a_hint_at_a_slip_of_unit_stands_at_its_field() -> None:
    asked = opened(problem_tables(paper_joint()))
    found = checked(asked.with_tables(typed(asked.tables, "beam.material.density", "7.89")))
    assert [path for path, _ in found.hints] == ["beam.material.density"]


def test_a_stop_that_is_added_is_like_the_last_one_with_a_name_of_its_own() -> None:
    tables = added(problem_tables(paper_joint()), "stops")
    assert len({stop["name"] for stop in tables["stops"]}) == 5
    assert tables["stops"][4]["gap"] == tables["stops"][3]["gap"]


def test_another_kind_keeps_the_fields_that_both_kinds_have() -> None:
    tables = changed_kind(problem_tables(paper_joint()), "base_motion", "harmonics")
    assert tables["base_motion"] == {"kind": "harmonics", "angular_frequency": 515.0}
    assert isinstance(Question("", 1.0, 2.0).with_tables(tables), Question)


def test_a_change_of_another_problem_fits_or_is_refused_in_a_message() -> None:
    """A form or a sketch that was shown before may still send a change of it."""
    problems = [tables_of(start) for start in starts().values()]
    refused = 0
    for before, now in zip(problems, [*problems[1:], problems[0]], strict=True):
        for part in all_parts(form_of(before)):
            edits = [partial(removed, path=part.path), partial(typed, path=part.path, text="7")]
            edits += [partial(added, path=part.path), partial(changed_kind, path=part.path, word="sine")]
            for edit in edits:
                try:
                    form_of(edit(now))
                except InputError:
                    refused += 1
    assert refused


def test_a_page_takes_no_change_of_what_is_gone() -> None:
    first = opened(problem_tables(paper_joint()))
    with set_curdoc(Document()):
        page = Page(first)
        page._edit(partial(typed, path="stops.7.gap", text="0.002"), "stops.7.gap")
        assert page._question == first
        page._edit(partial(typed, path="stops.3.gap", text="0.002"), "stops.3.gap")
    assert page._question.tables["stops"][3]["gap"] == 0.002
