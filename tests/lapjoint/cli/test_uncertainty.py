"""``lapjoint sweep --samples`` and ``lapjoint uncertainty``, as a user types them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from command_line import assert_refused, run, run_well
from small_joints import cantilever

from lapjoint import write_problem
from lapjoint.problem.uncertain import Lognormal, Uniform

JOINT = cantilever(
    title="Cantilever",
    uncertain=(
        Uniform(name="gap", paths=("stops.*.gap",), kind="uniform", low=4e-4, high=1e-3),
        Lognormal(
            name="stiffness", paths=("stops.0.stiffness",), apply="factor", kind="lognormal", mean=1, deviation=0.1
        ),
    ),
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a problem and its finished sweep with samples."""
    path = tmp_path_factory.mktemp("uncertain")
    write_problem(JOINT, path / "my.toml")
    found = swept(path, "--out", path / "samples.nc")
    assert "128 points" in found
    return path


def swept(path: Path, *more: str | Path) -> str:
    few = ("--from", "4", "--to", "5", "--samples", "64", "--n-modes", "2", "--summary", "force_peak")
    return run_well("sweep", path / "my.toml", *few, *more)


def test_the_command_prints_bands_probabilities_and_what_matters(folder: Path) -> None:
    figure, ranking, numbers = (folder / name for name in ("bands.png", "ranking.svg", "all.json"))
    more = ("--figure", figure, "--ranking", ranking, "--json", numbers)
    said = run_well("uncertainty", folder / "samples.nc", "--limit", "force=1e-3", *more)
    assert "64 samples of gap, stiffness, in 8 independent sets" in said
    assert "All 128 points have an answer." in said
    assert "force_peak [N], largest over all swept points" in said
    assert "stop 1 P(> 0.001)" in said
    assert "first order" in said
    assert all(len(line) <= 80 for line in said.replace(str(folder), "").splitlines())
    assert figure.stat().st_size > 0
    assert ranking.stat().st_size > 0
    written = json.loads(numbers.read_text())
    assert written["variables"]["force_peak_quantile"]["over"] == ["probability", "angular_frequency", "stop"]
    assert written["coordinates"]["uncertain"] == ["gap", "stiffness"]


def test_a_finished_sweep_with_other_samples_is_another_one(folder: Path) -> None:
    few = ("--from", "4", "--to", "5", "--n-modes", "2", "--summary", "force_peak", "--out", folder / "samples.nc")
    for other in (("--samples", "128"), ("--samples", "64", "--sample-seed", "1"), ()):
        assert_refused(run("sweep", folder / "my.toml", *few, *other), "is the result of another sweep")
    assert "holds this sweep already" in run_well("sweep", folder / "my.toml", *few, "--samples", "64")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--limit", "force"), "--limit force: must be NAME=VALUE, as in stress=120e6"),
        (("--limit", "force=much"), "--limit force=much: must be NAME=VALUE"),
        (("--limit", "force=-1"), "limit force = -1.0: must be positive and finite"),
        (("--limit", "stress=1"), "variable 'stress': is not in this file, which has impulse, "),
        (("--variable", "nothing"), "variable 'nothing': is not in this file"),
        (("--figure", "bands.txt"), "bands.txt"),
    ],
)
def test_what_cannot_be_read_off_is_refused(folder: Path, arguments: tuple[str, ...], message: str) -> None:
    assert_refused(run("uncertainty", folder / "samples.nc", *arguments), message, lines=1)


def test_files_without_samples_and_samples_without_uncertain_numbers_are_refused(folder: Path) -> None:
    write_problem(cantilever(), folder / "certain.toml")
    given = (
        "sweep",
        folder / "certain.toml",
        "--from",
        "4",
        "--to",
        "5",
        "--n-modes",
        "2",
        "--out",
        folder / "certain.nc",
    )
    assert_refused(run(*given, "--samples", "64"), "samples: nothing in this problem is uncertain", lines=1)
    run_well(*given)
    assert_refused(run("uncertainty", folder / "certain.nc"), "the file has no samples", lines=1)
    said = f"{folder / 'samples.nc'}: has samples of uncertain numbers"
    assert_refused(run("plot", folder / "certain.nc", folder / "samples.nc"), said, lines=1)
