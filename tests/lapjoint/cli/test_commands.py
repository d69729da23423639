"""The command line: what it prints, and that bad input gives one message, exit status 2 and no traceback."""

from __future__ import annotations

import csv
import json
import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import click
import numpy as np
import pytest
import xarray as xr
from click.testing import CliRunner, Result

from analytic import Solver
from lapjoint import FREE, ContactState, Outcome, Problem, SteadyState, Stop, paper_joint, read_problem, time_series
from lapjoint.answers import Exponent
from lapjoint.cli.main import main
from lapjoint.cli.options import DRAWINGS
from lapjoint.cli.printing import error_text
from lapjoint.cli.progress import duration_text, lines_of_progress, lines_with_time_left
from lapjoint.errors import SolverError
from lapjoint.problem.example import commented_example
from lapjoint.problem.files import from_toml, to_toml

PAPER = "preset:paper"
FEW = ("--modes", "8")  # the least that is quick; no accuracy is asked of these tests


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def run_well(*arguments: str | Path) -> str:
    result = run(*arguments)
    assert result.exit_code == 0, result.output
    return result.stdout


def test_the_schema_is_json() -> None:
    assert json.loads(run_well("schema"))["title"] == "Problem"


def test_init_writes_the_example_and_overwrites_only_when_told(tmp_path: Path) -> None:
    path = tmp_path / "joint.toml"
    assert run_well("init") == commented_example()
    run_well("init", path)
    assert path.read_text() == commented_example()
    path.write_text("mine")
    refused = run("init", path)
    assert refused.exit_code == 2
    assert "--force" in refused.stderr
    assert path.read_text() == "mine"
    run_well("init", path, "--force")
    assert path.read_text() == commented_example()


def test_modes_prints_every_state_and_writes_all_digits(tmp_path: Path) -> None:
    path = tmp_path / "modes.json"
    printed = run_well("modes", PAPER, "--modes", "3", "--json", path)
    assert len(printed.splitlines()) == 10
    states = json.loads(path.read_text())["states"]
    joint = paper_joint()
    for state in (FREE, ContactState((0, 1))):
        exact = Solver().modes(joint, state, 3).angular_frequencies
        found = [s["angular_frequencies"] for s in states if s["name"] == state.name(joint)]
        np.testing.assert_array_equal(found, [exact])


@pytest.mark.parametrize("state", ["6", "P2+P3", "P3 + P2"])
def test_a_state_is_chosen_by_number_or_by_names(state: str, tmp_path: Path) -> None:
    figure = tmp_path / "shapes.svg"
    printed = run_well("modes", PAPER, "--state", state, "--modes", "2", "--figure", figure)
    assert printed.splitlines()[1].startswith("6  P2 + P3")
    assert figure.exists()


def test_simulate_and_steady_write_time_series(tmp_path: Path) -> None:
    path, table = tmp_path / "a.nc", tmp_path / "a.csv"
    wanted = ("--at", "x=2.5,1.25", "--quantity", "moment, absolute_velocity,force", "--rate", "1000")
    command = ("simulate", PAPER, "--duration", "0.02", "--no-errors", *FEW)
    run_well(*command, "--series", path, *wanted)
    run_well(*command, "--series", table, *wanted)
    history = Solver(n_modes=8).simulate(paper_joint(), 0.02)
    expected = time_series(history, at=[2.5, 1.25], quantities=["moment", "absolute_velocity", "force"], rate=1000.0)
    with xr.open_dataset(path, engine="h5netcdf") as found:
        xr.testing.assert_equal(found.load(), expected)
    with table.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["moment at x = 2.5 m [N m]"]) for row in rows] == expected.moment.values[0].tolist()
    run_well("steady", PAPER, "--no-errors", *FEW, "--series", path)
    with xr.open_dataset(path, engine="h5netcdf") as found:
        assert set(found.data_vars) == {"displacement", "force"}
        assert "of a mode of the solver" in found.attrs["rate_source"]


def test_simulate_prints_and_writes_the_contacts(tmp_path: Path) -> None:
    path, figure = tmp_path / "contacts.csv", tmp_path / "motion.png"
    printed = run_well("simulate", PAPER, "--duration", "0.02", *FEW, "--contacts", path, "--figure", figure)
    history = Solver(n_modes=8).simulate(paper_joint(), 0.02)
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["impulse_Ns"]) for row in rows] == [contact.impulse for contact in history.contacts]
    assert [float(row["impulse_error_Ns"]) for row in rows] == [contact.impulse_error for contact in history.contacts]
    assert f"{len(rows)} contacts" in printed
    first = history.contacts[0]
    assert f"{first.start:15.9f}{first.start_error:10.1e}" in printed
    assert f"{first.impulse:15.6g}{first.impulse_error:10.1e}" in printed
    assert f"Numerical errors (+-): {history.error_source}" in printed
    assert figure.stat().st_size > 1000


def test_errors_are_left_out_if_asked() -> None:
    for command in (("simulate", PAPER, "--duration", "0.02"), ("steady", PAPER)):
        printed = run_well(*command, *FEW, "--no-errors")
        assert "Numerical errors (+-): no errors were estimated" in printed
    assert printed.count("+-") == 1


def test_an_error_that_cannot_be_stated_is_a_question_mark() -> None:
    assert [error_text(error) for error in (None, 1.23e-5, math.inf)] == ["", "1.2e-05", "?"]


@pytest.mark.parametrize("drawing", DRAWINGS)
def test_an_answer_is_drawn_in_the_way_chosen(drawing: str, tmp_path: Path) -> None:
    figure = tmp_path / "figure.svg"
    command = ("simulate", PAPER, "--duration", "0.02", *FEW, "--figure", figure)
    run_well(*command, "--draw", drawing)
    chosen = figure.read_bytes()
    run_well(*command)
    assert (figure.read_bytes() == chosen) == (drawing == "motion")


def test_a_steady_state_is_drawn(tmp_path: Path) -> None:
    figure = tmp_path / "spectrum.svg"
    run_well("steady", PAPER, *FEW, "--figure", figure, "--draw", "spectrum")
    assert "Fourier series of 1 period" in figure.read_text()


def test_the_shapes_of_all_states_are_drawn_in_one_figure(tmp_path: Path) -> None:
    figure = tmp_path / "shapes.svg"
    run_well("modes", PAPER, "--modes", "2", "--figure", figure)
    assert all(
        text in figure.read_text() for text in ("State 1:", "States 2, 4:", "States 3, 5:", "States 6, 7, 8, 9:")
    )


def test_steady_prints_the_impulse_of_every_stop(tmp_path: Path) -> None:
    path = tmp_path / "steady.json"
    printed = run_well("steady", PAPER, *FEW, "--json", path)
    content = json.loads(path.read_text())
    exact = Solver(n_modes=8).steady_state(paper_joint())
    assert list(content["impulses_Ns"].values()) == exact.impulses.tolist()
    assert content["period_multiple"] == exact.period_multiple
    assert [
        complex(*parts) for parts in zip(content["multipliers_real"], content["multipliers_imag"], strict=True)
    ] == (exact.multipliers.tolist())
    assert "Floquet multipliers" in printed
    assert all(name in printed for name in ("P2", "P3", "P4", "P5"))
    assert exact.impulse_errors is not None
    assert list(content["impulse_errors_Ns"].values()) == exact.impulse_errors.tolist()
    assert f"{exact.impulses[2]:14.8g}  +- {exact.impulse_errors[2]:.1e}" in printed
    assert exact.error_source in printed


def test_values_of_a_problem_are_changed_on_the_command_line(tmp_path: Path) -> None:
    path = tmp_path / "joint.toml"
    path.write_text(to_toml(paper_joint(angular_frequency=820.0, gap=2e-3)))
    changes = ("--set", "base_motion.angular_frequency=820", "--set", "stops.*.gap=2e-3")
    command = ("--duration", "0.01", *FEW)
    assert run_well("simulate", PAPER, *changes, *command) == run_well("simulate", path, *command)


@pytest.mark.parametrize("what", [("--duration", "0.01"), ("--steady",)])
def test_export_writes_a_series(what: tuple[str, ...], tmp_path: Path) -> None:
    printed = run_well("export", PAPER, "-o", tmp_path / "out", *what, *FEW, "--frames", "3", "--points", "5")
    assert printed == f"Wrote {tmp_path / 'out' / 'motion.pvd'}\n"
    assert len(list((tmp_path / "out" / "motion").glob("beam_*.vtu"))) >= 3


def test_export_puts_another_solver_beside_at_the_times_given(tmp_path: Path) -> None:
    what = ("--duration", "0.002", "--times", "0,1e-3", "--beside", "analytic:n_modes=3", "--points", "5")
    run_well("export", PAPER, "-o", tmp_path, *what, *FEW)
    beams = sorted((tmp_path / "motion").glob("*_beam_*.vtu"))
    assert {path.name.split("_")[0] for path in beams} == {"analytic", "analytic-2"}
    series = (tmp_path / "motion.pvd").read_text()
    assert 'timestep="0.0"' in series
    assert 'timestep="0.001"' in series


def test_export_writes_the_mode_shapes_of_all_states(tmp_path: Path) -> None:
    printed = run_well("export", PAPER, "-o", tmp_path, "--state", "all", "--modes", "2", "--format", "vtkhdf")
    assert len(printed.splitlines()) == 9
    assert (tmp_path / "modes_6_P2+P3.vtkhdf").is_file()


@pytest.mark.parametrize("output", ["x.png", "x.gif"])
def test_show_says_what_it_wrote(output: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from lapjoint.scene import pictures

    drawn = []
    monkeypatch.setattr(pictures, "draw", lambda job, progress: (drawn.append(job), job.output.touch()))
    what: tuple[str, ...] = ("--duration", "0.01", "--absolute", "--scale", "3", "--size", "300x200")
    what = what if output == "x.png" else (*what, "--frames", "4")
    printed = run_well("show", PAPER, "-o", tmp_path / output, *what, *FEW, "--colour", "velocity")
    assert printed == f"Wrote {tmp_path / output}\n"
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
def test_stops_whose_names_hold_a_plus_are_chosen(text: str, expected: str, tmp_path: Path) -> None:
    path = tmp_path / "problem.toml"
    stops = [Stop(name=name, x=0.5 + 0.1 * i, side="top", gap=1e-3, stiffness=1e5) for i, name in enumerate(NAMES)]
    path.write_text(to_toml(paper_joint().replace(stops=tuple(stops))))
    result = run("modes", path, "--state", text, "--modes", "2")
    if result.exit_code:
        assert_refused(result, expected)
    else:
        line = result.stdout.splitlines()[1]
        assert line.startswith(expected)
        free = run_well("modes", path, "--state", "free", "--modes", "2").split()[-1]
        assert (line.split()[-1] == free) == (text == "free")


NAMES = ("a", "b", "a+b", "c+d", "free")


@pytest.mark.parametrize("command", ["modes", "steady"])
def test_many_stops_are_taken_only_when_asked_for(command: str, tmp_path: Path) -> None:
    path = tmp_path / "problem.toml"
    stop = '[[stops]]\nx = 0.5\nside = "top"\ngap = 0.0\nstiffness = 1.0\n'
    path.write_text(to_toml(paper_joint().replace(stops=())) + 101 * stop)
    assert_refused(run(command, path), "stops: there are 101; more than 100 are taken only with --large")
    assert run_well("modes", path, "--large", "--modes", "1").startswith("Natural")


def test_no_name_of_a_file_is_a_command_to_the_terminal_or_the_spreadsheet(tmp_path: Path) -> None:
    evil, formula = "\x1b[2J\x9b31m\x07\u202e", "=HYPERLINK(1)"
    names = (evil, formula, "-1", "+x")
    stops = [stop.model_copy(update={"name": name}) for stop, name in zip(paper_joint().stops, names, strict=True)]
    path, table = tmp_path / "problem.toml", tmp_path / "contacts.csv"
    path.write_text(to_toml(paper_joint().replace(stops=tuple(stops), title=evil)))
    results = [
        run("simulate", path, "--duration", "0.03", *FEW, "--contacts", table),
        run("modes", path, "--modes", "1"),
        run("modes", path, "--state", "nothing"),
        run("modes", path, "--set", f'"{evil}"=1'),
        run("modes", path, "--set", f"stops.{evil}.gap=-1"),
        run("modes", tmp_path / "\x1b[31m.toml"),
        run(evil),
    ]
    for result in results:
        assert all(sign.isprintable() or sign == "\n" for sign in result.output), result.output
    with table.open(newline="") as file:
        written = {row["stop"] for row in csv.DictReader(file)}
    assert {f"'{formula}", "-1", "'+x"} & written
    assert not {formula, "+x"} & written


def problem_file(tmp_path: Path, change: str = "", to: str = "") -> Path:
    text = to_toml(paper_joint())
    assert change in text
    path = tmp_path / "problem.toml"
    path.write_text(text.replace(change, to, 1))
    return path


BAD_FILES: list[tuple[str, str, str, str]] = [
    ("negative length", "length = 2.5", "length = -2.5", "beam.length = -2.5: must be greater than 0"),
    ("stop outside", "x = 2.5", "x = 2.6", "stops[0].x = 2.6: lies outside the beam; allowed are 0 to 2.5 m"),
    ("NaN", "gap = 0.001", "gap = nan", "stops[0].gap = nan: must be"),
    ("unknown key", "gap = 0.001", "gpa = 0.001", "stops[0].gpa: unknown key; did you mean gap?"),
    ("unreadable TOML", "length = 2.5", "length = ", "is not valid TOML"),
    ("text for a gap", "gap = 0.001", 'gap = "wide"', 'stops[0].gap = "wide": must be a number'),
]


@pytest.mark.parametrize(("change", "to", "message"), [r[1:] for r in BAD_FILES], ids=[r[0] for r in BAD_FILES])
@pytest.mark.parametrize("command", [("modes",), ("simulate", "--duration", "1"), ("steady",)], ids=lambda c: c[0])
def test_a_bad_file_is_refused(command: tuple[str, ...], change: str, to: str, message: str, tmp_path: Path) -> None:
    assert_refused(run(*command, problem_file(tmp_path, change, to)), message)


def assert_refused(result: Result, message: str) -> None:
    assert result.exit_code == (3 if "cannot be written" in result.stderr else 2), result.output
    assert isinstance(result.exception, SystemExit)
    assert message in result.stderr
    assert result.stderr.startswith(("lapjoint: ", "Usage: "))
    assert "Traceback" not in result.output


SIMULATE = ("simulate", PAPER, "--duration", "0.01")
SERIES = (*SIMULATE, "--series", "a.csv")
NOWHERE = ("sweep", PAPER, "--modes", "4")
BAD_COMMANDS: list[tuple[str, tuple[str, ...], str]] = [
    ("no such file", ("modes", "missing.toml"), "missing.toml: cannot be read: No such file"),
    ("a directory", ("modes", "."), "cannot be read"),
    ("no such preset", ("modes", "preset:other"), "allowed: paper, sdnl104"),
    (
        "moved clamp",
        ("modes", PAPER, "--set", "initial={kind='polynomial', displacement=[1e-3]}"),
        "moves supports[0]",
    ),
    ("bad value", ("modes", PAPER, "--set", "stops.0.gap=wide"), 'stops[0].gap = "wide": must be a number'),
    ("a huge section", ("modes", PAPER, "--set", "beam.section.height=1e200"), "the bending stiffness EI comes to inf"),
    ("a huge length", ("modes", PAPER, "--set", "beam.length=1e308"), "follows from material.density, section.breadth"),
    ("a huge density", ("modes", PAPER, "--set", "beam.material.density=1.7e308"), "the mass per length m comes to"),
    ("an infinite density", ("modes", PAPER, "--set", "beam.material.density=1.8e308"), "density = inf: must be a fin"),
    ("a huge frequency", ("modes", PAPER, "--set", "base_motion.angular_frequency=1e200"), "the acceleration comes to"),
    ("a huge gap", ("modes", PAPER, "--set", "stops.0.gap=1e308"), "stops[0]: stiffness times gap comes to inf"),
    ("a long index", ("modes", PAPER, "--set", f"stops.{'1' * 5000}.gap=1"), "...: there is no element '1111"),
    ("a deep path", ("modes", PAPER, "--set", f"{'a.' * 3000}b=1"), "is 3001 keys deep; a problem is at most 20"),
    ("a deep list", ("modes", PAPER, "--set", f"stops={'[' * 3000}{']' * 3000}"), "[...: must be a list"),
    ("bad assignment", ("modes", PAPER, "--set", "gap"), "must be key=value"),
    ("a million modes", ("modes", PAPER, "--modes", "1000000"), "1000000"),
    ("no modes", ("modes", PAPER, "--modes", "0"), "0"),
    ("a million FE modes", ("modes", PAPER, "--solver", "fe", "--modes", "1000000"), "1000000"),
    ("modes in the solver", (*SIMULATE, "--modes", "1000000"), "n_modes = 1000000"),
    ("negative elements", (*SIMULATE, "--solver", "fe", "--elements", "-1"), "elements = -1"),
    ("unknown state", ("modes", PAPER, "--state", "P7"), "--state P7: there is no such state; allowed: all, free"),
    ("impossible state", ("modes", PAPER, "--state", "P2+P4"), "cannot be closed"),
    (
        "unknown solver",
        ("modes", PAPER, "--solver", "magic"),
        "solver = 'magic' is not installed; allowed: analytic",
    ),
    ("unknown option", (*SIMULATE, "--option", "colour=3"), "has no option 'colour'; allowed: n_modes"),
    ("option of the other solver", (*SIMULATE, "--elements", "8"), "has no option 'elements'"),
    ("option without a value", (*SIMULATE, "--option", "n_modes"), "must be key=value"),
    ("option of a wrong kind", (*SIMULATE, "--option", "tolerance=tight"), "tolerance = 'tight'"),
    ("series without a file", (*SIMULATE, "--rate", "9"), "--rate: no series is written without --series FILE"),
    ("series as what?", (*SIMULATE, "--series", "a.txt"), "--series a.txt: the name must end in .nc, .csv"),
    ("places without x", (*SERIES, "--at", "2.5"), "--at 2.5: must be x= and numbers"),
    ("places as text", (*SERIES, "--at", "x=tip"), "--at x=tip: must be x= and numbers"),
    ("place off the beam", (*SERIES, "--at", "x=1,99"), "x = 99: lies outside the beam; allowed are 0 to "),
    ("unknown quantity", (*SERIES, "--quantity", "force,slope"), "quantity 'slope': is unknown; allowed: displacement"),
    ("too many samples", (*SERIES, "--rate", "1e12"), "samples of each of"),
    ("no rate", (*SERIES, "--rate", "0"), "rate = 0: must be positive and finite, in Hz"),
    ("negative duration", ("simulate", PAPER, "--duration", "-1"), "--duration -1: must be positive"),
    ("no duration", ("simulate", PAPER, "--duration", "0"), "--duration 0: must be positive"),
    ("NaN duration", ("simulate", PAPER, "--duration", "nan"), "--duration nan: must be positive and finite"),
    ("endless duration", ("simulate", PAPER, "--duration", "inf"), "--duration inf: must be positive and finite"),
    ("text for duration", ("simulate", PAPER, "--duration", "long"), "'long' is not a valid float"),
    ("contacts as a picture", (*SIMULATE, "--contacts", "a.png"), "must end in .csv, .json"),
    ("a figure as a table", (*SIMULATE, "--figure", "a.csv"), "must end in .png, .svg, .pdf"),
    ("a drawing without a file", (*SIMULATE, "--draw", "phase"), "--draw phase: nothing is drawn without --figure"),
    ("an unknown drawing", (*SIMULATE, "--figure", "a.png", "--draw", "orbit"), "'orbit' is not one of 'motion', 'ph"),
    (
        "sections of what has no period",
        ("simulate", "preset:sdnl104", "--duration", "1e9", "--figure", "a.png", "--draw", "poincare"),
        "--draw poincare: the excitation must have one angular_frequency, or whole multiples of the lowest; there is",
    ),
    ("nowhere to write", (*SIMULATE, "--contacts", "no/such/a.csv"), "there is no such directory"),
    ("nothing excites", ("steady", "preset:sdnl104"), "angular_frequency"),
    ("one frame", ("export", PAPER, "-o", "x", "--duration", "0.01", *FEW, "--frames", "1"), "frames = 1"),
    ("no span", ("export", PAPER, "-o", "x"), "--duration, --steady: give one of them"),
    ("two spans", ("show", PAPER, "-o", "x.gif", "--steady", "--duration", "1"), "--duration, --steady: give one"),
    ("frames and times", ("export", PAPER, "-o", "x", "--steady", "--frames", "9", "--times", "0"), "give one of them"),
    ("times in words", ("export", PAPER, "-o", "x", "--steady", "--times", "0,now"), "--times 0,now: must be numbers"),
    (
        "modes in motion",
        ("export", PAPER, "-o", "x", "--state", "all", "--steady"),
        "--steady: mode shapes have none",
    ),
    ("modes of no state", ("export", PAPER, "-o", "x", "--state", "P9"), "--state P9: there is no such state"),
    ("nobody beside", ("export", PAPER, "-o", "x", "--steady", "--beside", "magic"), "'magic' is not installed"),
    ("a picture as a report", ("show", PAPER, "-o", "x.pdf", "--steady"), "must end in .png, .gif, .mp4"),
    ("size in words", ("show", PAPER, "-o", "x.png", "--steady", "--size", "big"), "--size big: must be width and"),
    ("tiny picture", ("show", PAPER, "-o", "x.png", "--steady", "--size", "9x9"), "size = 9x9: allowed are 200 to"),
    ("no scale", ("show", PAPER, "-o", "x.png", "--steady", "--scale", "0"), "scale = 0: must be positive"),
    (
        "export to a device",
        ("export", PAPER, "-o", "/dev/null", "--duration", "1e9"),
        "/dev/null is not a directory",
    ),
    ("a name with a zero byte", ("export", PAPER, "-o", "a\0", "--duration", "1e9"), "embedded null byte"),
    ("a file with a zero byte", (*SIMULATE, "--contacts", "a\0.csv"), "embedded null byte"),
    ("a curve with a zero byte", ("plot", "a\0"), "embedded null byte"),
    ("report in a device", ("validate", "-o", "/dev/null/x"), "/dev/null is not a directory"),
    ("contacts on a directory", (*SIMULATE, "--contacts", "."), "must end in"),
    ("JSON on a directory", ("steady", PAPER, "--json", "."), "it is a directory"),
    ("init nowhere", ("init", "no/such/file.toml"), "cannot be written"),
    ("unknown case", ("validate", "--case", "magic"), "magic"),
    ("no such peer", ("validate", "--peers", "magic"), "--peers magic: solver = 'magic' is not installed"),
    ("a case without its peers", ("validate", "--case", "peers"), "--peers opensees"),
    ("changes to nothing", ("validate", "--set", "stops.*.gap=1"), "--set: it changes a PROBLEM, and none is given"),
    ("no such file to validate", ("validate", "missing.toml"), "missing.toml: cannot be read"),
    ("nothing swept", (*NOWHERE, "--out", "c.nc"), "nothing is swept; give --from and --to, or --over"),
    ("half a range", (*NOWHERE, "--out", "c.nc", "--from", "1"), "--to: is missing"),
    (
        "a range backwards",
        (*NOWHERE, "--out", "c.nc", "--from", "2", "--to", "1"),
        "--to 1: must be at least --from, 2",
    ),
    ("no step", (*NOWHERE, "--out", "c.nc", "--from", "1", "--to", "2", "--step", "0"), "--step 0: must be positive"),
    (
        "too fine",
        (*NOWHERE, "--out", "c.nc", "--from", "1", "--to", "2", "--step", "1e-9"),
        "--step 1e-09: makes 1e+09",
    ),
    ("negative frequency", (*NOWHERE, "--out", "c.nc", "--from", "-1", "--to", "2"), "--from -1: must be positive"),
    ("sweep as a picture", (*NOWHERE, "--out", "c.png", "--from", "1", "--to", "2"), "must end in .nc"),
    ("sweep nowhere", (*NOWHERE, "--out", "no/c.nc", "--from", "1", "--to", "2"), "there is no such directory"),
    ("over nothing", (*NOWHERE, "--out", "c.nc", "--over", "damping.ratio"), "--over damping.ratio: must be PATH="),
    ("over text", (*NOWHERE, "--out", "c.nc", "--over", "damping.ratio=a,b"), "must be FROM:TO:COUNT or numbers"),
    ("over no count", (*NOWHERE, "--out", "c.nc", "--over", "damping.ratio=0:1:0"), "a count from 1 to"),
    ("over what is not there", (*NOWHERE, "--out", "c.nc", "--over", "stops.P9.gap=1e-3"), "no element 'P9'"),
    ("a bad point", (*NOWHERE, "--out", "c.nc", "--over", "damping.ratio=0.1,-1"), "damping.ratio = -1: damping.ratio"),
    (
        "no scheduler",
        (*NOWHERE, "--out", "c.nc", "--from", "1", "--to", "2", "--scheduler", "x://y"),
        "scheduler = 'x://y'",
    ),
    ("no curve", ("plot", "missing.nc", "-o", "a.png"), "missing.nc: cannot be read: No such file"),
    ("a curve as a table", ("plot", "missing.nc", "-o", "a.csv"), "must end in .png, .svg, .pdf"),
    ("unknown command", ("solve",), "No such command"),
]


@pytest.mark.parametrize(("arguments", "message"), [r[1:] for r in BAD_COMMANDS], ids=[r[0] for r in BAD_COMMANDS])
def test_bad_input_is_refused(
    arguments: tuple[str, ...], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert_refused(run(*arguments), message)
    assert list(tmp_path.iterdir()) in ([], [tmp_path / "x"])


@pytest.mark.parametrize("arguments", [("export", PAPER, "--duration", "1e9"), ("validate",)], ids=["export", "report"])
def test_a_link_to_itself_is_no_directory(
    arguments: tuple[str, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "loop").symlink_to("loop")
    assert_refused(run(*arguments, "-o", "loop"), "loop is not a directory")


def test_a_process_prints_a_message_and_no_traceback(tmp_path: Path) -> None:
    path = problem_file(tmp_path, "gap = 0.001", 'gap = "wide"')
    command = [sys.executable, "-c", "from lapjoint.cli.main import main; main()", "modes", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == f'lapjoint: {path}: stops[0].gap = "wide": must be a number\n'


def test_ctrl_c_ends_with_status_130(monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Solver, "simulate", interrupted)
    result = run(*SIMULATE)
    assert result.exit_code == 130
    assert result.stderr == "lapjoint: interrupted\n"


def test_a_solver_that_gives_up_ends_with_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    def gives_up(*_: object, **__: object) -> None:
        raise SolverError("stopped at t = 0.1 s")

    monkeypatch.setattr(Solver, "simulate", gives_up)
    result = run(*SIMULATE)
    assert result.exit_code == 1
    assert result.stderr == "lapjoint: stopped at t = 0.1 s\n"


def test_an_undecided_motion_ends_with_status_1(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Solver(n_modes=8).steady_state(paper_joint())
    exponent = Exponent(0.1, 0.2, 400, time=4.0, halves=(0.0, 0.2), quarters=(0.0, 0.0, 0.2, 0.2))
    undecided = replace(found, outcome=Outcome.UNDECIDED, period_multiple=0, multipliers=np.zeros(0), exponent=exponent)
    monkeypatch.setattr(Solver, "steady_state", lambda *_, **__: undecided)
    result = run("steady", PAPER)
    assert result.exit_code == 1
    assert "the motion did not settle" in result.stdout
    assert "exponent: 0.1 1/s +- 0.2, over 400 periods" in result.stdout
    assert "Repeats" not in result.stdout
    assert "max_period_multiple" not in result.stdout


def test_a_motion_of_more_periods_than_were_looked_for_is_said_to_be_one(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Solver(n_modes=8).steady_state(paper_joint())
    exponent = Exponent(-0.3, 0.01, 4000, time=200.0, halves=(-0.3, -0.3), quarters=(-0.3,) * 4)
    longer = replace(found, outcome=Outcome.UNDECIDED, period_multiple=0, multipliers=np.zeros(0), exponent=exponent)
    monkeypatch.setattr(Solver, "steady_state", lambda *_, **__: longer)
    assert "repeats, but after more periods than max_period_multiple" in run("steady", PAPER).stdout


@pytest.mark.parametrize("status", [0, 1])
def test_validate_passes_on_what_is_asked_and_the_verdict(
    status: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[object] = []

    def suite_main(
        problem: Problem, cases: tuple[str, ...], level: str, output: Path, console: object, peers: tuple[str, ...]
    ) -> int:
        asked.extend([problem, cases, level, output, peers])
        return status

    monkeypatch.setattr("validation.suite.main", suite_main)
    options = ("--case", "a", "--case", "b", "--quick", "-o", tmp_path / "out", *("--peers", "x") * 2)
    result = run("validate", PAPER, "--set", "base_motion.angular_frequency=820", *options)
    assert result.exit_code == status
    assert asked == [paper_joint(angular_frequency=820.0), ("a", "b"), "quick", tmp_path / "out", ("x",)]


def test_validate_lists_its_cases() -> None:
    assert "table4" in run_well("validate", "--list")


def test_a_fault_of_the_program_is_not_dressed_up_as_bad_input(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise ValueError("a bug")

    monkeypatch.setattr(Solver, "simulate", broken)
    assert isinstance(run(*SIMULATE).exception, ValueError)


def test_progress_off_a_terminal_is_a_line_for_every_tenth() -> None:
    @click.command()
    def work() -> None:
        progress = lines_of_progress("work")
        for i in range(1001):
            progress(i, 1000)

    lines = CliRunner().invoke(work).stderr.splitlines()
    assert lines == [f"work: {percent} %" for percent in range(10, 101, 10)]


def test_a_written_problem_is_a_problem(tmp_path: Path) -> None:
    run_well("init", tmp_path / "a.toml")
    assert read_problem(tmp_path / "a.toml") == from_toml(commented_example())


SWEEP = ("sweep", PAPER, "--from", "500", "--to", "520", "--step", "10", "--modes", "4", "--out", "curve.nc")


def test_sweep_writes_a_dataset_and_plot_draws_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from lapjoint.campaigns.dataset import read_curve

    monkeypatch.chdir(tmp_path)
    printed = run_well(*SWEEP, "--over", "stops.*.gap=1e-3:2e-3:2")
    assert printed.splitlines()[0] == "Wrote curve.nc"
    assert printed.splitlines()[1].startswith("6 points: ")
    curve = read_curve("curve.nc")
    assert curve.angular_frequency.values.tolist() == [500.0, 510.0, 520.0]
    assert curve.stops_all_gap.values.tolist() == [1e-3, 2e-3]
    exact = Solver(n_modes=4).steady_state(paper_joint(angular_frequency=510.0, gap=2e-3))
    np.testing.assert_array_equal(curve.impulse[1, 1], exact.impulses)
    assert run_well(*SWEEP, "--over", "stops.*.gap=1e-3:2e-3:2").startswith("curve.nc: holds this sweep already")
    assert run_well("plot", "curve.nc") == "Wrote curve.pdf\n"
    assert run_well("plot", "curve.nc", "--wide", "-o", "wide.svg") == "Wrote wide.svg\n"
    assert_refused(run(*SWEEP), "curve.nc: is the result of another sweep; choose another --out, or overwrite it")
    run_well(*SWEEP, "--force")


def test_a_sweep_needs_no_frequencies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from lapjoint.campaigns.dataset import read_curve

    monkeypatch.chdir(tmp_path)
    run_well("sweep", PAPER, "--over", "damping.ratio=0.1,0.08", "--start", "up", "--modes", "4", "--out", "curve.nc")
    assert read_curve("curve.nc").damping_ratio.values.tolist() == [0.1, 0.08]


def test_a_sweep_with_points_that_failed_ends_with_status_1(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def gives_up(*_: object, **__: object) -> None:
        raise SolverError("stopped at t = 0.1 s")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Solver, "steady_state", gives_up)
    result = run(*SWEEP)
    assert result.exit_code == 1
    assert result.stdout.splitlines() == ["Wrote curve.nc", "3 points: 3 failed", *["failed: stopped at t = 0.1 s"] * 3]


@pytest.mark.parametrize("done", [0, 2])
def test_ctrl_c_in_a_sweep_says_how_to_resume(done: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    found, asked = Solver(n_modes=4).steady_state(paper_joint()), 0

    def interrupted(*_: object, **__: object) -> SteadyState:
        nonlocal asked
        asked += 1
        if asked > done:
            raise KeyboardInterrupt
        return found

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    monkeypatch.setattr(Solver, "steady_state", interrupted)
    result = run(*SWEEP)
    assert result.exit_code == 130
    kept = "2 of 3 points are kept in curve.nc.journal; the same command resumes"
    assert result.stderr.splitlines()[-1] == f"lapjoint: interrupted: {kept if done else 'none of 3 points was done'}"


def test_progress_of_a_sweep_says_how_much_time_is_left() -> None:
    now = 0.0

    @click.command()
    def work() -> None:
        nonlocal now
        progress = lines_with_time_left("sweep", lambda: now)
        for done in (2000, 2500, 4000, 4010, 5000):
            progress(done, 5000)
            now += 600.0

    assert CliRunner().invoke(work).stderr.splitlines() == [
        "sweep: goes on from 2000 of 5000",
        "sweep: 50 %, 2500 of 5000, 50 min left",
        "sweep: 80 %, 4000 of 5000, 10 min left",
        "sweep: 100 %, 5000 of 5000",
    ]
    assert [duration_text(seconds) for seconds in (40.4, 700.0, 12000.0)] == ["40 s", "12 min", "3 h 20 min"]


def test_frequencies_in_hz_and_within_the_width_of_a_terminal(tmp_path: Path) -> None:
    path = tmp_path / "modes.json"
    slow = run_well("modes", PAPER, "--modes", "9", "--hz", "--json", path)
    assert slow.startswith("Natural frequencies [Hz]")
    assert max(len(line) for line in slow.splitlines()) <= 80
    free = json.loads(path.read_text())["states"][0]
    numbers = [float(word) for word in "".join(slow.splitlines()[1:3]).split()[-9:]]
    assert numbers == pytest.approx(free["frequencies_Hz"], rel=1e-5)
    assert numbers == pytest.approx([w / (2 * math.pi) for w in free["angular_frequencies"]], rel=1e-5)


def test_many_states_are_cut_and_it_says_how_to_see_the_rest(tmp_path: Path) -> None:
    path = tmp_path / "many.toml"
    stops = tuple(Stop(name=f"s{i}", x=0.3 * i, side="top", gap=1e-3, stiffness=1e5) for i in range(1, 8))
    path.write_text(to_toml(paper_joint().replace(stops=stops)))
    printed = run_well("modes", path, "--modes", "1")
    assert len(printed.splitlines()) == 34
    assert "... and 96 more states (--json writes all, --state prints one)" in printed
