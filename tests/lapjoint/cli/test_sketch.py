"""``lapjoint sketch``: a drawing of the problem, named after it."""

from __future__ import annotations

from pathlib import Path

from command_line import PAPER, assert_refused, run, run_well


def test_a_problem_is_drawn_to_a_file_of_its_name_or_another() -> None:
    run_well("init", "my.toml")
    assert run_well("sketch", "my.toml") == "Wrote my.png\n"
    assert run_well("sketch", PAPER, "--narrow", "--out", "small.svg") == "Wrote small.svg\n"
    assert run_well("sketch", PAPER) == "Wrote paper.png\n"
    assert (
        "gap 0.003 m" in Path(run_well("sketch", PAPER, "--set", "stops.*.gap=3e-3", "-o", "a.svg")[6:-1]).read_text()
    )
    assert_refused(run("sketch", PAPER, "-o", "a.txt"), "--out a.txt: the name must end in .png", 1)
