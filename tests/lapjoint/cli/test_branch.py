"""``lapjoint branch``: what it prints and writes, that ``lapjoint plot`` draws it, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from lapjoint.cli.main import main

PROBLEM = """
[beam]
length = 1.0
bending_stiffness = 1.0
mass_per_length = 1.0

[[supports]]
x = 0.0
translational = inf
torsional = inf

[[stops]]
name = "tip"
x = 1.0
side = "top"
gap = 1e-3
stiffness = 50.0

[damping]
kind = "viscous"
coefficient = 0.8

[base_motion]
amplitude = 3e-4
angular_frequency = 5.0
"""
OVER = ("--over", "base_motion.amplitude", "--modes", "3", "--no-errors")


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("bar.toml").write_text(PROBLEM)


@pytest.mark.usefixtures("here")
def test_branch_writes_a_dataset_once_and_plot_draws_it() -> None:
    command = ("branch", "bar.toml", *OVER, "--from", "3e-4", "--to", "4e-4", "--out", "branch.nc")
    result = run(*command)
    assert result.exit_code == 0, result.output
    assert result.stdout.startswith("Wrote branch.nc\nbranch 0: period multiple 1, ")
    assert "grazing of tip: persists" in result.stdout
    assert result.stdout.count("fold") == 2
    assert run(*command).stdout.startswith("branch.nc: holds these branches already, finished")
    assert run("plot", "branch.nc", "-o", "branch.svg").exit_code == 0
    assert "Wrote" in run("plot", "branch.nc").stdout
    assert Path("branch.svg").read_text().count("fold") >= 1
    refused = run("plot", "branch.nc", "--wide")
    assert (refused.exit_code, refused.stderr) == (
        2,
        "lapjoint: --wide: a diagram of branches has one look; leave it out\n",
    )


@pytest.mark.usefixtures("here")
def test_a_branch_that_takes_too_much_effort_says_so_by_its_status() -> None:
    result = run("branch", "bar.toml", *OVER, "--from", "3e-4", "--to", "4e-4", "--max-points", "6", "--out", "b.nc")
    assert result.exit_code == 1, result.output
    assert "effort" in result.stdout


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("--from", "1", "--to", "2", "--out", "b.png"), "must end in .nc"),
        (("--from", "1", "--to", "1", "--out", "b.nc"), "must differ from 1, where the range begins"),
        (("--from", "0", "--to", "1", "--out", "b.nc"), "base_motion.angular_frequency"),
        (("--over", "beam.colour", "--from", "1", "--to", "2", "--out", "b.nc"), "beam.colour"),
        (("--from", "1", "--to", "2", "--out", "b.nc", "--starts", "-1"), "starts = -1"),
        (("--from", "1", "--to", "2", "--out", "b.nc", "--max-points", "0"), "max_points = 0"),
        (("--from", "1", "--to", "2", "--out", "b.nc", "--workers", "0"), "workers = 0"),
    ],
)
def test_bad_input_ends_with_a_message_and_status_2(arguments: tuple[str, ...], says: str) -> None:
    result = run("branch", "bar.toml", *arguments)
    assert result.exit_code == 2, result.output
    assert says in result.stderr
    assert "Traceback" not in result.stderr
    assert not Path("b.nc.journal").exists()
