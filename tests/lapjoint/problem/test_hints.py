"""Hints at slips of unit: those that people make are named, and no sensible joint is troubled."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from lapjoint import Problem, paper_joint, sdnl104
from lapjoint.cli.main import main
from lapjoint.problem.example import commented_example
from lapjoint.problem.files import from_toml

EXAMPLE = commented_example()
SLIPS = {
    "E in GPa": (("2.05e11", "205"), "youngs_modulus = 205 Pa", "GPa meant? Then it is 2.05e+11"),
    "E in MPa": (("2.05e11", "205000"), "youngs_modulus = 205000 Pa", "MPa meant? Then it is 2.05e+11"),
    "density in g/cm3": (("7890.0", "7.89"), "density = 7.89 kg/m3", "g/cm3 meant? Then it is 7890"),
    "density in t/mm3": (("7890.0", "7.89e-9"), "density = 7.89e-09 kg/m3", "t/mm3 meant? Then it is 7890"),
    "height in mm": (("height = 0.05 ", "height = 50.0 "), "50 m deep", "mm meant? Then it is 0.05"),
    "length in mm": (("length = 2.5 ", "length = 2500.0 "), "length = 2500 m", "mm meant? Then it is 2.5"),
    "gap in mm": (("gap = 1e-3 ", "gap = 1.0 "), "stops[0].gap = 1 m", "mm meant? Then it is 0.001"),
    "damping in percent": (("ratio = 0.08", "ratio = 8"), "damping.ratio = 8", "8 % meant? Then it is 0.08"),
    "mass in grams": (
        ("[[supports]]", "[[masses]]\nx = 2.5\nmass = 1.2e7\n\n[[supports]]"),
        "masses[0].mass = 1.2e+07 kg",
        "units right?",
    ),
    "gravity without its sign": (
        ("[initial]", "[gravity]\nacceleration = 9.81\n\n[initial]"),
        "gravity.acceleration = 9.81 m/s2: acts upwards",
        "downwards it is -9.81",
    ),
    "gravity in mm/s2": (
        ("[initial]", "[gravity]\nacceleration = -9810.0\n\n[initial]"),
        "gravity.acceleration = 9810 m/s2",
        "mm/s2 meant? Then it is 9.81",
    ),
    "speed of rotation": (
        ("angular_frequency = 515.0", "angular_frequency = 5.15e6"),
        "5.15e+06 rad/s",
        "units right?",
    ),
}


def example(old: str, new: str) -> str:
    """The example with a value changed where it stands first; positions follow a changed length."""
    assert old in EXAMPLE, old
    text = EXAMPLE.replace(old, new, 1)
    return text.replace("x = 2.5 ", "x = 2500.0 ").replace("x = 1.25 ", "x = 1250.0 ") if "2500" in new else text


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_named_with_the_unit_that_was_meant(slip: str) -> None:
    change, what, meant = SLIPS[slip]
    found = from_toml(example(*change)).hints
    assert any(what in line and meant in line for line in found), found


@pytest.mark.parametrize("problem", [paper_joint(), from_toml(EXAMPLE)], ids=["paper", "example"])
def test_sensible_joints_are_not_troubled(problem: Problem) -> None:
    assert problem.hints == ()


def test_a_support_without_a_spring_is_hinted_at() -> None:
    loose = EXAMPLE.replace("translational = inf", "translational = 0.0").replace("torsional = inf", "torsional = 0.0")
    (line,) = from_toml(loose).hints
    assert line.startswith("supports[0]: has neither a translational nor a torsional stiffness, and holds nothing")


def test_a_heavy_benchmark_is_only_hinted_at() -> None:
    (line,) = sdnl104().hints  # its density is 1e6 kg/m3
    assert "density" in line


@pytest.mark.parametrize("scale", [1e-3, 1.0, 30.0])
@pytest.mark.parametrize(("youngs_modulus", "density"), [(5e6, 1100.0), (7e10, 2700.0), (1.1e12, 3500.0)])
def test_small_and_large_joints_of_real_materials(scale: float, youngs_modulus: float, density: float) -> None:
    joint = paper_joint()
    beam = joint.beam.model_copy(update={"length": 2.5 * scale})
    assert beam.material is not None
    assert beam.section is not None
    changed = beam.material.model_copy(update={"youngs_modulus": youngs_modulus, "density": density})
    size = {"height": 0.05 * scale, "breadth": 0.3 * scale}
    beam = beam.model_copy(update={"material": changed, "section": beam.section.model_copy(update=size)})
    stops = tuple(
        stop.model_copy(update={"x": stop.x * scale, "gap": 1e-3 * scale, "stiffness": 3600 * beam.EI / beam.length**3})
        for stop in joint.stops
    )
    assert Problem(beam=beam, supports=joint.supports, stops=stops).hints == ()


def test_the_command_line_says_it_once_and_goes_on(tmp_path: Path) -> None:
    path = tmp_path / "slip.toml"
    path.write_text(example("2.05e11", "205"), encoding="utf-8")
    result = CliRunner().invoke(main, ["modes", str(path), "--state", "free"])
    assert result.exit_code == 0
    assert result.stderr.count("hint: beam.material.youngs_modulus") == 1
    assert "Natural" in result.stdout
    assert "hint" not in result.stdout
