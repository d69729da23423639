"""``lapjoint confirm``: what it prints and writes, what it refuses, and that it is not taken in."""

from __future__ import annotations

from pathlib import Path

import pytest
from amplitude_ranges import docs_cantilever
from command_line import assert_refused, run, run_well

import lapjoint
from lapjoint.campaigns.branches.table import read_branches
from lapjoint.campaigns.confirm.table import VERDICTS
from lapjoint.campaigns.dataset import read_result
from lapjoint.files.netcdf import write_netcdf

ELEMENTS = ("--elements", "4")


@pytest.fixture(scope="module")
def branches(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Branches of a cantilever with one stop: a graze and two folds."""
    path = tmp_path_factory.mktemp("confirm") / "branch.nc"
    lapjoint.branch(docs_cantilever(), "base_motion.amplitude", 3e-4, 4e-4, options={"n_modes": 8}, out=path)
    return path


def test_both_solvers_agree_and_the_table_says_so_once(branches: Path) -> None:
    command = ("confirm", branches, *ELEMENTS, "--out", "c.nc")
    printed = run_well(*command)
    assert printed.startswith("Wrote c.nc\nanalytic (modes 8), and FE (4 elements, exact):\n")
    rows = {line.split("  ")[0]: line.split()[-7:] for line in printed.splitlines()[3:]}
    assert {name: row[1:4] for name, row in rows.items()} == dict.fromkeys(("fold", "grazing", "all"), ["0"] * 3)
    assert run_well(*command).startswith("c.nc: holds this confirmation already, finished")
    found = read_result("c.nc", "confirmation")
    assert (found.ratio.values <= 1).all()
    assert (found.other_value.values != found.value.values).all()


def test_bifurcations_that_were_shifted_are_apart(branches: Path) -> None:
    found = read_branches(branches)
    found.bifurcation_value.values[:] *= 1 + 1e-3  # four elements state errors below 1e-4
    write_netcdf(found, "shifted.nc")
    result = run("confirm", "shifted.nc", *ELEMENTS, "--out", "c.nc")
    assert result.exit_code == 1
    found = read_result("c.nc", "confirmation")
    assert [VERDICTS[code] for code in found.verdict.values] == ["apart"] * 3
    assert result.stdout.count(": apart\n") == 3


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--share", "0"), "share = 0.0: must be above 0, and at most 1"),
        (("--share", "nan"), "share = nan: must be above 0, and at most 1"),
        (("--seed", "-1"), "seed = -1: must be"),
        (("--elements", "0"), "elements = 0: must be"),
        (("--solver", "analytic-published"), "lacks period_map of"),
        (("--solver", "none"), "none"),
        (("--option", "colour=red"), "colour"),
    ],
)
def test_wrong_options_are_refused_in_a_line(branches: Path, here: Path, arguments: tuple[str, ...], said: str) -> None:
    assert_refused(run("confirm", branches, *arguments, "--out", "c.nc"), said, lines=1)
    assert not list(here.iterdir())


def test_files_that_cannot_be_confirmed_are_refused_in_a_line(branches: Path) -> None:
    found = read_branches(branches)
    write_netcdf(found.drop_vars("bifurcation_arcs"), "older.nc")
    write_netcdf(found.assign_attrs(errors=0), "without.nc")
    write_netcdf(found.isel(bifurcation=slice(0, 0)), "none.nc")
    Path("text.nc").write_text("no NetCDF")
    for name, reason in (
        ("older.nc", "hold no motions at their bifurcations"),
        ("without.nc", "state no errors of their bifurcations"),
        ("none.nc", "there is nothing to confirm"),
        ("text.nc", "cannot be read"),
        ("missing.nc", "missing.nc"),
    ):
        assert_refused(run("confirm", name, *ELEMENTS, "--out", "c.nc"), reason, lines=1)


def test_another_confirmation_in_the_file_is_not_thrown_away(branches: Path) -> None:
    command = ("confirm", branches, *ELEMENTS, "--share", "0.3", "--out", "c.nc")
    run_well(*command)
    assert_refused(run(*command, "--seed", "1"), "is the result of another confirmation")
