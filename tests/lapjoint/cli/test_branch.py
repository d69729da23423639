"""``lapjoint branch``: what it prints and writes, and that ``lapjoint plot`` draws it."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
from amplitude_ranges import docs_cantilever
from beams import with_stops
from command_line import assert_refused, run, run_well

from lapjoint import write_problem
from lapjoint.campaigns.branches.table import KINDS, read_branches
from lapjoint.cli.branch_printing import bifurcation_text, print_branches

OVER = ("branch", "bar.toml", "--over", "base_motion.amplitude", "--n-modes", "3", "--out", "b.nc")
FOLDS = (*OVER, "--no-errors", "--from", "3e-4", "--to", "4e-4")
"""Over a graze and two folds."""
QUIET = (*OVER, "--no-errors", "--from", "1e-4", "--to", "1.1e-4")
"""Below the first graze, where nothing else exists."""


@pytest.fixture(autouse=True)
def bar(here: Path) -> None:
    write_problem(with_stops(docs_cantilever(), {"name": "tip"}), here / "bar.toml")


def test_branch_writes_a_dataset_once_and_plot_draws_it() -> None:
    printed = run_well(*FOLDS)
    assert printed.startswith("Wrote b.nc\nbranch 0: period multiple 1, ")
    assert "grazing of tip: persists" in printed
    assert printed.count("fold") == 2
    assert run_well(*FOLDS).startswith("b.nc: holds these branches already, finished")
    run_well("plot", "b.nc", "-o", "branch.svg")
    assert "Wrote" in run_well("plot", "b.nc")
    assert Path("branch.svg").read_text().count("fold") >= 1
    assert_refused(run("plot", "b.nc", "--wide"), "--wide: a diagram of branches has one look; leave it out\n")


def test_a_branch_that_takes_too_much_effort_says_so_by_its_status() -> None:
    result = run(*FOLDS, "--max-points", "6")
    assert result.exit_code == 1, result.output
    assert "effort" in result.stdout
    (left,) = [line for line in result.stdout.splitlines() if line.startswith("no branch covers ")]
    assert left.endswith(" m (branch 0: effort; branch 1: effort)")


def test_branches_in_two_numbers_print_their_loci_and_plot_draws_them() -> None:
    lines = run_well(*FOLDS, "--also-over", "stops.*.gap=0.95e-3:1.05e-3:3").splitlines()
    assert lines[1] == "3 branches at 3 values of stops.*.gap; loci:"
    assert lines[2].startswith("  first grazing of tip, 3 of 3 values: 0.000317")
    assert lines[2].endswith(" m at 0.00105 m")
    assert [line.split(",")[0] for line in lines[3:]].count("  fold") == 2
    run_well("plot", "b.nc", "-o", "loci.svg")
    drawn = Path("loci.svg").read_text()
    assert "gap (all stops) [m]" in drawn
    assert "first grazing of tip" in drawn


@pytest.mark.thorough
def test_how_likely_an_unknown_branch_is_is_said_and_kept(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(*QUIET).stdout.splitlines()[-1].startswith("no random starts were made")
    assert "starts_stable" not in read_branches("b.nc")
    said = run(*QUIET, "--force", "--starts", "3").stdout.splitlines()[-1]
    assert said == (
        "3 random starts: 3 led to stable motions on 1 branch, to none of which nothing else led; another one that "
        "leads to a stable motion would find an unknown branch with a probability of about 0 % (95 %: below 78 %)"
    )
    found = read_branches("b.nc")
    assert (int(found.starts_stable), int(found.starts_branches), int(found.starts_alone)) == (3, 1, 0)
    assert float(found.unknown_probability) == 0.0
    assert float(found.unknown_probability_bound) == pytest.approx(1 - 0.01 ** (1 / 3))
    lines = run(*QUIET, "--also-over", "stops.*.gap=1e-3,1.1e-3", "--starts", "2", "--force").stdout.splitlines()
    assert lines[1] == "2 branches at 2 values of stops.*.gap; no bifurcations"
    assert lines[-1].startswith("2 random starts at each of 2 values of stops.*.gap: 4 led to stable motions on 2 bran")
    assert read_branches("b.nc").starts_stable.values.tolist() == [2, 2]
    found["starts_stable"].values[...] = 0
    print_branches(found)
    said = capsys.readouterr().out.splitlines()[-1]
    assert said == "3 random starts: 0 led to stable motions, so that nothing is known of further branches"


@pytest.mark.parametrize("asked", [True, False])
def test_an_error_that_no_finer_solver_confirms_is_said_in_words(asked: bool) -> None:
    result = run(*[word for word in FOLDS if not asked or word != "--no-errors"])
    assert "inf" not in result.stdout
    assert result.stdout.count(" ± ") == 3 * asked
    found = read_branches("b.nc")
    fold = int(np.flatnonzero(found.bifurcation_kind.values == KINDS.index("fold"))[0])
    found.bifurcation_error[fold] = np.inf
    said = bifurcation_text(found, fold)
    assert said.endswith("fold (not confirmed by the finer solver)" if asked else "fold")
    assert "±" not in said


@pytest.mark.parametrize(
    ("most", "repeats"), [(1, "after each excitation period"), (3, "after 3 excitation periods or fewer")]
)
def test_an_end_of_the_range_to_which_no_branch_comes_is_told(
    capsys: pytest.CaptureFixture[str], most: int, repeats: str
) -> None:
    assert "no branch comes" not in run(*FOLDS, "--max-period-multiple", str(most)).stdout
    found = read_branches("b.nc")
    found.attrs["range"] = np.array([3e-4, 5e-4])
    print_branches(found)
    told = f"no branch comes to 0.0005 m: from rest, no motion that repeats {repeats} was found there"
    assert [line for line in capsys.readouterr().out.splitlines() if "no branch" in line] == [told]


def test_whether_branches_that_spring_at_grazes_are_followed_is_another_question() -> None:
    assert run(*QUIET).exit_code == 0
    assert "from_grazes" not in read_branches("b.nc").attrs
    assert_refused(run(*QUIET, "--from-grazes"), "--force")
    assert run(*QUIET, "--from-grazes", "--force").exit_code == 0
    assert int(read_branches("b.nc").attrs["from_grazes"]) == 1


def test_a_branch_in_hz_is_that_in_radians() -> None:
    def found(*over: str, out: str, unit: str) -> list[float]:
        command = ("branch", "bar.toml", *over, "--n-modes", "2", "--no-errors", "--out", out)
        printed = run_well(*command, "--set", "base_motion.amplitude=1e-4", "--max-points", "200")
        lines = [line for line in printed.splitlines() if re.search(r"\d to \d|^  \d", line)]
        assert lines
        assert all(f" {unit}" in line for line in lines), lines
        first, last = re.findall(rf"from (\S+) to (\S+) {unit};", printed)[0]
        return [float(first), float(last)]

    radians = found("--from", f"{2 * math.pi}", "--to", f"{2.5 * math.pi}", out="rad.nc", unit="rad/s")
    hertz = found("--from", "1", "--to", "1.25", "--hz", out="hz.nc", unit="Hz")
    keyed = found("--over", "base_motion.frequency", "--from", "1", "--to", "1.25", out="keyed.nc", unit="Hz")
    assert hertz == keyed == pytest.approx([1.0, 1.25])
    assert radians == pytest.approx([2 * math.pi, 2.5 * math.pi], rel=1e-5)
    assert read_branches("hz.nc").identical(read_branches("keyed.nc"))
    run_well("plot", "hz.nc", "--hz", "-o", "hz.svg")
    assert "frequency [Hz]" in Path("hz.svg").read_text()
    assert_refused(run(*QUIET, "--hz"), "--hz: --over base_motion.amplitude is no angular_frequency; leave it out\n")


def test_motions_that_the_effort_leaves_out_are_told_by_their_number_and_the_status() -> None:
    over = ("--over", "base_motion.angular_frequency", "--from", "5", "--to", "8", "--n-modes", "2", "--no-errors")
    hard = ("--max-period-multiple", "2", "--set", "stops.*.stiffness=500", "--set", "base_motion.amplitude=4e-4")
    result = run("branch", "bar.toml", *hard, *over, "--effort", "1", "--out", "b.nc")
    assert result.exit_code == 1, result.output
    assert "effort = 1 is spent: the branches of " in result.stdout
    assert " were not followed" in result.stdout
