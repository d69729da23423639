"""What the command line says of fatigue: at places of several beams, and of S-N lines that cannot be used."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import xarray as xr
from command_line import assert_refused, run, run_well

JOINT = """
[beam]
length = 0.8
{beam}
[beam.material]
youngs_modulus = 2.1e11
density = 7850.0
[beam.material.fatigue]
{fatigue}
[[supports]]
x = 0.0
translational = inf
torsional = inf
[[stops]]
x = 0.8
side = "top"
gap = 1.0
stiffness = 4000.0
[damping]
kind = "modal"
ratio = 0.02
[base_motion]
amplitude = 4e-3
angular_frequency = 60.0
"""
LINE = "slope = 3.0\nreference_range = 80e6\nreference_cycles = 2e6"
SECTION = 'section = {shape = "rectangle", breadth = 0.03, height = 0.008}'
STEADY = ("steady", "joint.toml", "--n-modes", "3", "--no-errors")


def test_a_steady_state_prints_and_writes_the_damage_at_a_place() -> None:
    Path("joint.toml").write_text(JOINT.format(beam=SECTION, fatigue=LINE))
    lines = run_well(*STEADY, "--at", "x=0.4", "--json", "steady.json").splitlines()
    (row,) = (line for line in lines if line.startswith("damage rate [s-1]"))
    assert row.split()[3:5] == ["0.4", "m"]
    written = json.loads(Path("steady.json").read_text())["summary"]["damage_rate"]
    assert float(row.split()[5]) == pytest.approx(written["values"][0], rel=1e-4)
    (row,) = (line for line in lines if line.startswith("along the beam"))
    assert float(row.split()[-1]) == pytest.approx(1 / max(written["values"]) / 3600, rel=1e-4)


def test_a_sweep_keeps_what_a_steady_state_prints() -> None:
    Path("joint.toml").write_text(JOINT.format(beam=SECTION, fatigue=LINE))
    run_well(*STEADY, "--json", "steady.json")
    values = json.loads(Path("steady.json").read_text())["summary"]
    names = ("damage_rate", "equivalent_range", "largest_range")
    few = ("sweep", "joint.toml", "--n-modes", "3", "--from", "60", "--to", "61")
    run_well(*few, "--summary", ",".join(names), "--errors", "--out", "curve.nc")
    curve = xr.load_dataset("curve.nc")
    for name in names:
        assert float(curve[name][0]) == pytest.approx(max(values[name]["values"]), rel=1e-9)
        assert float(curve[f"{name}_x"][0]) == 0.0
        assert 0 < float(curve[f"{name}_error"][0]) < 0.1 * float(curve[name][0])
    run_well("plot", "curve.nc", "--variable", "damage_rate", "-o", "curve.svg")
    Path("joint.toml").write_text(JOINT.format(beam=SECTION, fatigue="").replace("[beam.material.fatigue]", ""))
    said = "summary 'damage_rate': no material has an S-N line; give [beam.material.fatigue]"
    assert_refused(run(*few, "--summary", "damage_rate", "--out", "other.nc"), said, lines=1)


@pytest.mark.thorough
def test_of_several_beams_the_place_has_the_name_of_its_beam() -> None:
    run_well("init", "--preset", "lap", "lap.toml")
    text = Path("lap.toml").read_text()
    first = text.index("density", text.index("material"))
    end = text.index("\n", first) + 1
    inline = "}" in text[first:end]
    line = "{slope = 3.0, reference_range = 80e6, reference_cycles = 2e6}"
    given = text[:end].replace("}\n", f", fatigue = {line}}}\n") if inline else text[:end] + f"fatigue = {line}\n"
    Path("lap.toml").write_text(given + text[end:])
    name = json.dumps(text).split('name = \\"')[1].split('\\"')[0]
    lines = run_well("steady", "lap.toml", "--n-modes", "4", "--no-errors", "--at", f"x={name}:0.01").splitlines()
    assert any(line.startswith("damage rate [s-1]") and f"{name}:0.01" in line for line in lines)


@pytest.mark.parametrize(
    ("fatigue", "words"),
    [
        (LINE.replace("slope", "slop"), "slop"),
        (LINE.replace("3.0", "0.5"), "slope"),
        (LINE + "\nknee_cycles = 1e7", "second_slope"),
        ("slope = 3.0", "reference_range"),
    ],
)
def test_a_wrong_line_is_refused_in_one_message(fatigue: str, words: str) -> None:
    Path("joint.toml").write_text(JOINT.format(beam=SECTION, fatigue=fatigue))
    assert_refused(run(*STEADY), words)


def test_a_line_without_sections_everywhere_has_a_hint() -> None:
    segments = f"segments = [{{to = 0.5, {SECTION}}}, {{to = 0.8, bending_stiffness = 200.0, mass_per_length = 2.0}}]"
    Path("joint.toml").write_text(JOINT.format(beam=segments, fatigue=LINE))
    result = run(*STEADY)
    assert result.exit_code == 0, result.output
    assert "no damage is stated" in result.stderr
    assert "damage" not in result.stdout
