"""The command line: what its commands print, draw and write."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from command_line import FEW, PAPER, assert_refused, run, run_well

from analytic import Solver
from lapjoint import FREE, ContactState, Outcome, StepLoad, Stop, paper_joint, time_series, write_problem
from lapjoint.cli.options import DRAWINGS
from lapjoint.figures.text import error_text
from lapjoint.problem.example import commented_example


def test_the_schema_is_json() -> None:
    assert json.loads(run_well("schema"))["title"] == "Problem"


def test_init_writes_the_example_and_overwrites_only_when_told() -> None:
    path = Path("joint.toml")
    assert run_well("init") == commented_example()
    run_well("init", path)
    assert path.read_text() == commented_example()
    path.write_text("mine")
    assert_refused(run("init", path), "--force")
    assert path.read_text() == "mine"
    run_well("init", path, "--force")
    assert path.read_text() == commented_example()
    assert run_well("init", "--preset", "lap") == commented_example("lap")


def test_modes_prints_every_state_and_writes_all_digits() -> None:
    printed = run_well("modes", PAPER, "--n-modes", "3", "--json", "modes.json")
    assert len(printed.splitlines()) == 10
    states = json.loads(Path("modes.json").read_text())["states"]
    joint = paper_joint()
    for state in (FREE, ContactState((0, 1))):
        exact = Solver().modes(joint, state, 3).angular_frequencies
        found = [s["angular_frequencies"] for s in states if s["name"] == state.name(joint)]
        np.testing.assert_array_equal(found, [exact])


@pytest.mark.parametrize("state", ["6", "P2+P3", "P3 + P2"])
def test_a_state_is_chosen_by_number_or_by_names(state: str) -> None:
    printed = run_well("modes", PAPER, "--state", state, "--n-modes", "2", "--figure", "shapes.svg")
    assert printed.splitlines()[1].startswith("6  P2 + P3")
    assert Path("shapes.svg").exists()


def rows_of(path: str) -> list[dict[str, str]]:
    """The rows of a CSV file, by its headings."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_simulate_and_steady_write_time_series() -> None:
    wanted = ("--at", "x=2.5,1.25", "--quantity", "moment, absolute_velocity,force", "--rate", "1000")
    command = ("simulate", PAPER, "--duration", "0.02", "--no-errors", *FEW)
    run_well(*command, "--series", "a.nc", *wanted)
    run_well(*command, "--series", "a.csv", *wanted)
    history = Solver(n_modes=8).simulate(paper_joint(), 0.02)
    expected = time_series(history, at=[2.5, 1.25], quantities=["moment", "absolute_velocity", "force"], rate=1000.0)
    xr.testing.assert_equal(xr.load_dataset("a.nc"), expected)
    moments = [float(row["moment at x = 2.5 m [N m]"]) for row in rows_of("a.csv")]
    assert moments == expected.moment.values[0].tolist()
    run_well("steady", PAPER, "--no-errors", *FEW, "--series", "a.nc")
    found = xr.load_dataset("a.nc")
    assert set(found.data_vars) == {"displacement", "force"}
    assert "of a mode of the solver" in found.attrs["rate_source"]


def test_simulate_prints_and_writes_the_contacts() -> None:
    files = ("--contacts", "contacts.csv", "--figure", "motion.png")
    printed = run_well("simulate", PAPER, "--duration", "0.02", *FEW, *files)
    history = Solver(n_modes=8).simulate(paper_joint(), 0.02)
    rows = rows_of("contacts.csv")
    for column, name in (
        ("impulse_Ns", "impulse"),
        ("impulse_error_Ns", "impulse_error"),
        ("peak_force_error_N", "peak_force_error"),
    ):
        assert [float(row[column]) for row in rows] == [getattr(contact, name) for contact in history.contacts]
    assert f"{len(rows)} contacts" in printed
    first = history.contacts[0]
    assert f"{first.start:15.9f}{first.start_error:10.1e}" in printed
    assert f"{first.impulse:15.6g}{first.impulse_error:10.1e}" in printed
    assert f"{first.peak_force:13.5g}{first.peak_force_error:10.1e}" in printed
    assert f"Numerical errors (+-): {history.error_source}" in printed
    assert Path("motion.png").stat().st_size > 1000


def test_errors_are_left_out_if_asked() -> None:
    for command in (("simulate", PAPER, "--duration", "0.02"), ("steady", PAPER)):
        printed = run_well(*command, *FEW, "--no-errors")
        assert "Numerical errors (+-): no errors were estimated" in printed
        assert "\nExcitation: 515 rad/s (81.96 Hz)\n" in printed
    assert printed.count("+-") == 1


def test_an_error_that_cannot_be_stated_is_a_question_mark() -> None:
    assert [error_text(error) for error in (None, 1.23e-5, math.inf, 0.0)] == ["", "1.2e-05", "?", "0"]


@pytest.mark.parametrize("drawing", DRAWINGS)
def test_an_answer_is_drawn_in_the_way_chosen(drawing: str) -> None:
    figure = Path("figure.svg")
    command = ("simulate", PAPER, "--duration", "0.02", *FEW, "--figure", figure)
    run_well(*command, "--draw", drawing)
    chosen = figure.read_bytes()
    run_well(*command)
    assert (figure.read_bytes() == chosen) == (drawing == "motion")


def test_the_shapes_of_all_states_are_drawn_in_one_figure() -> None:
    figure = Path("shapes.svg")
    run_well("modes", PAPER, "--n-modes", "2", "--figure", figure)
    titles = ("State 1:", "States 2, 4:", "States 3, 5:", "States 6, 7, 8, 9:", "natural frequency [rad/s]")
    assert all(text in figure.read_text() for text in titles)
    printed = run_well("modes", PAPER, "--n-modes", "2", "--figure", figure, "--hz", "--state", "free")
    assert "natural frequency [Hz]" in figure.read_text()
    assert f"1: {float(printed.splitlines()[1].split()[-2]):.4g}" in figure.read_text()


def test_steady_prints_the_impulse_of_every_stop_and_draws_the_motion() -> None:
    files = ("--json", "steady.json", "--figure", "spectrum.svg", "--draw", "spectrum")
    printed = run_well("steady", PAPER, *FEW, *files)
    content = json.loads(Path("steady.json").read_text())
    exact = Solver(n_modes=8).steady_state(paper_joint())
    assert list(content["impulses_Ns"].values()) == exact.impulses.tolist()
    assert content["period_multiple"] == exact.period_multiple
    assert content["multipliers_real"] == exact.multipliers.real.tolist()
    assert content["multipliers_imag"] == exact.multipliers.imag.tolist()
    assert "Floquet multipliers" in printed
    assert all(name in printed for name in ("P2", "P3", "P4", "P5"))
    assert exact.impulse_errors is not None
    assert list(content["impulse_errors_Ns"].values()) == exact.impulse_errors.tolist()
    assert f"{exact.impulses[2]:14.8g}  +- {exact.impulse_errors[2]:.1e}" in printed
    assert exact.error_source in printed
    assert "Fourier series of 1 period" in Path("spectrum.svg").read_text()


def test_values_of_a_problem_are_changed_on_the_command_line() -> None:
    write_problem(paper_joint(angular_frequency=820.0, gap=2e-3), "joint.toml")
    changes = ("--set", "base_motion.angular_frequency=820", "--set", "stops.*.gap=2e-3")
    command = ("--duration", "0.01", *FEW)
    assert run_well("simulate", PAPER, *changes, *command) == run_well("simulate", "joint.toml", *command)


@pytest.mark.parametrize("what", [("--duration", "0.01"), ("--steady",)])
def test_export_writes_a_series(what: tuple[str, ...]) -> None:
    printed = run_well("export", PAPER, "-o", "out", *what, *FEW, "--frames", "3", "--points", "5")
    assert printed == "Wrote out/motion.pvd\n"
    assert len(list(Path("out/motion").glob("beam_*.vtu"))) >= 3


def test_export_puts_another_solver_beside_at_the_times_given() -> None:
    what = ("--duration", "0.002", "--times", "0,1e-3", "--beside", "analytic:n_modes=3", "--points", "5")
    run_well("export", PAPER, "-o", ".", *what, *FEW)
    beams = Path("motion").glob("*_beam_*.vtu")
    assert {path.name.split("_")[0] for path in beams} == {"analytic", "analytic-2"}
    series = Path("motion.pvd").read_text()
    assert 'timestep="0.0"' in series
    assert 'timestep="0.001"' in series


def test_export_writes_the_mode_shapes_of_all_states() -> None:
    printed = run_well("export", PAPER, "-o", ".", "--state", "all", "--n-modes", "2", "--format", "vtkhdf")
    assert len(printed.splitlines()) == 9
    assert Path("modes_6_P2+P3.vtkhdf").is_file()


@pytest.mark.parametrize("output", ["x.png", "x.gif"])
def test_show_says_what_it_wrote(output: str, monkeypatch: pytest.MonkeyPatch) -> None:
    from lapjoint.scene import pictures

    drawn = []
    monkeypatch.setattr(pictures, "draw", lambda job, progress: (drawn.append(job), job.output.touch()))
    what: tuple[str, ...] = ("--duration", "0.01", "--absolute", "--scale", "3", "--size", "300x200")
    what = what if output == "x.png" else (*what, "--frames", "4")
    assert run_well("show", PAPER, "-o", output, *what, *FEW, "--colour", "velocity") == f"Wrote {output}\n"
    assert (drawn[0].size, drawn[0].label) == ((300, 200), "velocity [m/s]")
    assert len(drawn[0].captions) == (1 if output == "x.png" else 4)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a+b", "several ways; put each name in quotes, as in "),
        ('"a+b"', "a+b  "),
        ('"a"+"b"', "a + b  "),
        ("b + a+b", "several ways"),
        ("c+d+a", "a + c+d  "),
        ('"free"', "free  "),
        ("free", "free  "),
        ("a+c", "there is no such state"),
    ],
)
def test_stops_whose_names_hold_a_plus_are_chosen(text: str, expected: str) -> None:
    path = with_stops_named("a", "b", "a+b", "c+d", "free")
    result = run("modes", path, "--state", text, "--n-modes", "2")
    if result.exit_code:
        assert_refused(result, expected)
    else:
        line = result.stdout.splitlines()[1]
        assert line.startswith(expected)
        free = run_well("modes", path, "--state", "free", "--n-modes", "2").split()[-1]
        assert (line.split()[-1] == free) == (text == "free")


def with_stops_named(*names: str) -> str:
    """A problem file of the paper's beam with other stops."""
    stops = [Stop(name=name, x=0.3 * (i + 1), side="top", gap=1e-3, stiffness=1e5) for i, name in enumerate(names)]
    write_problem(paper_joint().replace(stops=tuple(stops)), "named.toml")
    return "named.toml"


def test_frequencies_in_hz_and_within_the_width_of_a_terminal() -> None:
    path = Path("modes.json")
    slow = run_well("modes", PAPER, "--n-modes", "9", "--hz", "--json", path)
    assert slow.startswith("Natural frequencies [Hz]")
    assert max(len(line) for line in slow.splitlines()) <= 80
    free = json.loads(path.read_text())["states"][0]
    numbers = [float(word) for word in "".join(slow.splitlines()[1:3]).split()[-9:]]
    assert numbers == pytest.approx(free["frequencies_Hz"], rel=1e-5)
    assert numbers == pytest.approx([w / (2 * math.pi) for w in free["angular_frequencies"]], rel=1e-5)


def test_many_states_are_cut_and_it_says_how_to_see_the_rest() -> None:
    printed = run_well("modes", with_stops_named(*(f"s{i}" for i in range(1, 7))), "--n-modes", "1")
    assert len(printed.splitlines()) == 34
    assert "... and 32 more states (--json writes all, --state prints one)" in printed


def test_a_motion_that_touches_nothing_says_how_near_it_comes() -> None:
    changes = ("--set", "stops.*.gap=1.0", "--set", "stops.P5.gap=0.5")
    printed = run_well("steady", PAPER, *FEW, "--no-errors", *changes)
    found = Solver(n_modes=8).steady_state(paper_joint(gap=1.0), errors=False)
    t = np.linspace(found.history.start, found.history.end, 20001)
    tip, middle = found.history.displacement([2.5, 1.25], t).max(axis=1)
    assert found.outcome is Outcome.NO_CONTACT
    stop, part, gap = ("P5", middle / 0.5, 0.5) if middle / 0.5 > tip else ("P2", tip, 1.0)
    assert f"\nNearest to a stop: {stop}, {100 * part:.3g} % of its gap of {gap:g} m\n" in printed
    assert "Nearest" not in run_well("steady", PAPER, *FEW, "--no-errors")


def test_a_stop_that_would_press_the_straight_beam_is_told_to_be_some_way_off(tmp_path: Path) -> None:
    path = tmp_path / "pushed.toml"
    stop = Stop(x=2.5, side="top", gap=-1e-3, stiffness=1e3)
    write_problem(paper_joint().replace(stops=(stop,), point_loads=(StepLoad(x=2.5, force=-1e7),)), path)
    printed = run_well("steady", path, *FEW, "--no-errors", "--set", "base_motion.amplitude=1e-6")
    assert "Nearest to a stop: stop 1, at a distance of " in printed
