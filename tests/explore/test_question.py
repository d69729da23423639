"""A question as a link, a file and commands."""

from __future__ import annotations

import base64
import random
import zlib

import numpy as np
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
    for one in (asked, asked.in_unit(hz=True)):
        assert unpacked(one.packed()) == one
        assert read_back(one.written()) == one
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


@pytest.mark.parametrize("hz", [False, True])
def test_the_curve_is_the_sweep_that_the_command_says(hz: bool) -> None:
    asked = paper().in_unit(hz)
    words = asked.commands("my joint.toml")[0].split()
    first, last, step = (float(words[words.index(name) + 1]) for name in ("--from", "--to", "--step"))
    assert ("--hz" in words) == hz
    assert asked.plan(asked.made()).grid.axes[0].values == frequencies(first, last, step, hz)
    assert "'my joint.toml'" in asked.commands("my joint.toml")[0]


def test_another_unit_keeps_six_digits_of_a_range() -> None:
    for first, last in np.random.default_rng(0).uniform(0.1, 1e4, (200, 2)).tolist():
        asked = Question("", first, last)
        turned = asked.in_unit(hz=True)
        assert [2 * np.pi * value for value in (turned.first, turned.last)] == pytest.approx([first, last], rel=5e-6)
        assert turned.in_unit(hz=True) == turned
        back = turned.in_unit(hz=False)
        assert [back.first, back.last] == pytest.approx([first, last], rel=1e-5)


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
    with pytest.raises(InputError, match="to = 100 rad/s: must be greater than from, 500 rad/s"):
        asked.plan(asked.made())
    with pytest.raises(InputError, match=r"to = 15\.9155 Hz: must be greater than from, 79\.5775 Hz"):
        asked.in_unit(hz=True).plan(asked.made())
