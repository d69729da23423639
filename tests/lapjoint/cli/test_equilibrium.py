"""The command ``lapjoint equilibrium``: what it prints and writes, and what it refuses."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

import analytic
import fe_lapjoint
from lapjoint.cli.equilibrium_printing import differences
from lapjoint.problem.files import from_toml
from tests.helpers.command_line import assert_refused, run, run_well

DOCS = Path(__file__).parents[3] / "docs"
JOINT = """
[beam]
length = 1.0
material = {youngs_modulus = 2e11, density = 7800.0}
section = {shape = "rectangle", breadth = 0.02, height = 0.01}

[[supports]]
x = 0.0
translational = inf
torsional = inf
"""
PRESSED = (
    JOINT + re.findall(r"^```toml\n(\[gravity\].*?)^```$", (DOCS / "problem-files.md").read_text(), re.S | re.M)[-1]
)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "joint.toml"
    path.write_text(PRESSED)
    return path


def test_forces_moment_stress_and_tip_stand_with_their_errors(file: Path) -> None:
    found = analytic.Solver().equilibrium(from_toml(PRESSED))
    text = run_well("equilibrium", file)
    assert "pressing: bush" in text
    force, tip = found.contact_forces[0], found.displacement(1.0)[0]
    for value in (force, found.largest_moment().value, found.largest_stress().value, tip):
        assert re.search(rf"{re.escape(f'{value:.8g}')}  \+- \d", text)
    assert "at x = 0 m" in text
    assert "Numerical errors (+-): rounding of the answer" in text


def test_both_solvers_are_compared_and_written(file: Path) -> None:
    out = file.with_suffix(".json")
    assert "The solvers agree within their errors." in run_well("equilibrium", file, "--solver", "both", "--json", out)
    written = json.loads(out.read_text())
    assert written["agree"]
    one, other = written["solvers"]
    assert one["pressing"] == other["pressing"] == ["bush"]
    assert one["contact_forces_N"]["bush"] == pytest.approx(other["contact_forces_N"]["bush"], rel=1e-11)
    assert 0 < other["contact_force_errors_N"]["bush"] < 1e-9


def test_one_solver_is_written_alone(file: Path) -> None:
    out = file.with_suffix(".json")
    run_well("equilibrium", file, "--solver", "fe", "--json", out)
    assert json.loads(out.read_text())["unique"]


def test_a_difference_beyond_the_errors_is_said() -> None:
    problem = from_toml(PRESSED)
    one, other = (solver.equilibrium(problem) for solver in (analytic.Solver(), fe_lapjoint.Solver()))
    assert differences(one, other) == []
    wrong = replace(other, contact_forces=other.contact_forces * (1 + 1e-9))
    (line,) = differences(one, wrong)
    assert line.startswith("stop 1: ")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--set", "supports=[]"), "lapjoint: equilibrium: there is none: the static loads drive a turn"),
        (("--solver", "both", "--elements", "9"), "lapjoint: --elements: is of one solver, and both are asked"),
        (("--solver", "analytic-published"), "lacks equilibrium of lapjoint.solver.Rests, which equilibria need"),
        (("--set", "gravity.acceleration=wide"), "gravity.acceleration"),
    ],
)
def test_what_is_refused_ends_in_a_message(file: Path, arguments: tuple[str, ...], message: str) -> None:
    assert_refused(run("equilibrium", file, *arguments), message)


def test_an_equilibrium_that_is_not_unique_is_called_so(file: Path) -> None:
    text = run_well("equilibrium", file, "--set", "supports=[]", "--set", "gravity.acceleration=0", "--set", "stops=[]",
                    "--set", "uniform_loads=[]")  # fmt: skip
    assert "The equilibrium is not unique: nothing holds the beam, which may be shifted and turned" in text


def test_a_motion_from_the_page_starts_with_its_stop_closed(file: Path) -> None:
    history = analytic.Solver(n_modes=8).simulate(from_toml(PRESSED), 0.1, errors=False)
    assert history.states[0].closed == (0,)
    assert not history.switch_times.size


def test_several_beams_have_places_links_and_a_tip_each(tmp_path: Path) -> None:
    clamp = "supports = [{x = 0.0, translational = inf, torsional = inf}]"
    beams = "".join(
        f'[[beams]]\nname = "{name}"\nlength = 0.3\nbending_stiffness = 40.0\nmass_per_length = 1.0\n{clamp}\n'
        for name in ("upper", "lower")
    )
    file, out = tmp_path / "pair.toml", tmp_path / "pair.json"
    link = '[[links]]\nbetween = ["upper:0.3", "lower:0.3"]\ntranslational = inf\n'
    file.write_text(beams + link + '[[uniform_loads]]\nbeam = "upper"\nforce_per_length = -50.0\n')
    text = run_well("equilibrium", file, "--solver", "both", "--json", out)
    assert "x = upper:0.3 to lower:0.3" in text
    assert "The solvers agree within their errors." in text
    assert text.count("Displacement of the tip") == 4
    written = json.loads(out.read_text())["solvers"][0]
    assert written["link_forces_N"] == pytest.approx([-50.0 * 0.3 * 3 / 16], rel=1e-12)
    assert [tip["beam"] for tip in written["tip_displacement_m"]] == ["upper", "lower"]
    assert [tip["x_m"] for tip in written["tip_displacement_m"]] == pytest.approx([0.3, 0.3])
