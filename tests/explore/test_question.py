"""A question as a link, a file and commands."""

from __future__ import annotations

import base64
import random
import zlib

import pytest

from explore.editing import removed
from explore.question import MOST_UNPACKED, Question, coarse_to_fine, opened, read_back, unpacked, with_range
from lapjoint import paper_joint
from lapjoint.cli.arguments import frequencies
from lapjoint.errors import InputError
from lapjoint.problem.files import problem_tables


def paper() -> Question:
    """The question about the paper's joint."""
    return opened(problem_tables(paper_joint()))


def test_a_link_and_a_file_bring_the_same_question_back() -> None:
    asked = paper().with_tables({"title": "no joint, with an umlaut: ä", "stops": [{"gap": "0,4e-3"}]})
    assert unpacked(asked.packed()) == asked
    assert read_back(asked.written()) == asked
    assert asked.packed().replace("-", "").replace("_", "").isalnum()


def test_a_link_that_is_damaged_is_refused_or_changes_nothing() -> None:
    """Some bits of base64 are not used, and may change."""
    whole, draw, refused = paper().packed(), random.Random(51), 0
    for _ in range(200):
        at = draw.randrange(len(whole))
        damaged = draw.choice([whole[:at], whole[:at] + draw.choice("aZ9-_ä%") + whole[at + 1 :], whole + "A"])
        try:
            same = unpacked(damaged) == paper()
        except InputError:
            refused += 1
        else:
            assert same
    assert refused > 100


def test_a_link_that_unpacks_to_more_than_any_state_is_refused() -> None:
    bomb = base64.urlsafe_b64encode(zlib.compress(b" " * (MOST_UNPACKED + 1), 9)).decode()
    with pytest.raises(InputError, match="the link"):
        unpacked(bomb)


def test_curves_become_finer_and_hold_each_frequency_once() -> None:
    stages = coarse_to_fine(401)
    assert [len(stage) for stage in stages] == [41, 80, 280]
    assert sorted(i for stage in stages for i in stage) == list(range(401))


def test_the_curve_is_the_sweep_that_the_command_says() -> None:
    asked = paper()
    words = asked.commands("my joint.toml")[0].split()
    first, last, step = (float(words[words.index(name) + 1]) for name in ("--from", "--to", "--step"))
    assert asked.plan(asked.made()).grid.axes[0].values == frequencies(first, last, step)
    assert "'my joint.toml'" in asked.commands("my joint.toml")[0]


def test_a_frequency_that_is_chosen_on_the_curve_is_that_of_the_problem() -> None:
    asked = paper()
    omega = asked.plan(asked.made()).grid.axes[0].values[137]
    assert asked.at_frequency(omega).made().excitation_frequency == omega


def test_a_problem_without_excitation_has_no_curve_and_says_why() -> None:
    asked = opened(removed(paper().tables, "base_motion"))
    with pytest.raises(InputError, match="curve: the excitation must have one angular_frequency"):
        asked.plan(asked.made())
    shaken = asked.with_tables(paper().tables)
    assert with_range(shaken, shaken.made()) == paper()


def test_a_range_that_is_none_is_refused() -> None:
    asked = Question(paper().problem, 500.0, 100.0)
    with pytest.raises(InputError, match="to = 100 rad/s: must be greater than from"):
        asked.plan(asked.made())
