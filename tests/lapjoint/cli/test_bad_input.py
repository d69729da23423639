"""Bad input gives one message, exit status 2 and no traceback."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest
from beams import unit_cantilever, with_stops
from command_line import FEW, PAPER, SIMULATE, assert_refused, problem_file, run, run_well

from lapjoint import paper_joint, write_problem
from lapjoint.problem import RandomBaseMotion
from lapjoint.problem.files import to_toml


@pytest.mark.parametrize("command", ["modes", "steady"])
def test_many_stops_are_taken_only_when_asked_for(command: str, tmp_path: Path) -> None:
    path = tmp_path / "problem.toml"
    stop = '[[stops]]\nx = 0.5\nside = "top"\ngap = 0.0\nstiffness = 1.0\n'
    path.write_text(to_toml(paper_joint().replace(stops=())) + 101 * stop)
    assert_refused(run(command, path), "stops: there are 101; more than 100 are taken only with --large")
    assert run_well("modes", path, "--large", "--n-modes", "1").startswith("Natural")


def test_no_name_of_a_file_is_a_command_to_the_terminal_or_the_spreadsheet(tmp_path: Path) -> None:
    evil, formula = "\x1b[2J\x9b31m\x07\u202e", "=HYPERLINK(1)"
    names = (evil, formula, "-1", "+x")
    path, table = tmp_path / "problem.toml", tmp_path / "contacts.csv"
    write_problem(with_stops(paper_joint().replace(title=evil), *({"name": name} for name in names)), path)
    results = [
        run("simulate", path, "--duration", "0.03", *FEW, "--contacts", table),
        run("modes", path, "--n-modes", "1"),
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


BAD_FILES: list[tuple[str, str, str, str]] = [
    ("stop outside", "x = 2.5", "x = 2.6", "stops[0].x = 2.6: lies outside the beam; allowed are 0 to 2.5 m"),
    ("unreadable TOML", "length = 2.5", "length = ", "is not valid TOML"),
    ("text for a gap", "gap = 0.001", 'gap = "wide"', 'stops[0].gap = "wide": must be a number'),
]


@pytest.mark.parametrize(("change", "to", "message"), [r[1:] for r in BAD_FILES], ids=[r[0] for r in BAD_FILES])
@pytest.mark.parametrize("command", [("modes",), ("simulate", "--duration", "1"), ("steady",)], ids=lambda c: c[0])
def test_a_bad_file_is_refused(command: tuple[str, ...], change: str, to: str, message: str, tmp_path: Path) -> None:
    assert_refused(run(*command, problem_file(tmp_path, change, to)), message)


SERIES, FIGURE = (*SIMULATE, "--series", "a.csv"), (*SIMULATE, "--figure", "a.png")
NOWHERE = ("sweep", PAPER, "--n-modes", "4")
OUT = ("--out", "c.nc")
RANGE = (*OUT, "--from", "1", "--to", "2")
PLANE, BAR_PLANE = ("basins", PAPER, *OUT, "--plane"), ("basins", PAPER, *OUT, "--plane", "z(0.5),v(0.5)")
RANDOM = ("basins", PAPER, *OUT, "--energy", "20")
BRANCH, STATISTICS = ("branch", PAPER, "--n-modes", "3"), ("statistics", "short.toml", "--n-modes", "2")
MOTIONS = (*STATISTICS, "--duration", "3")
BAD_COMMANDS: list[tuple[str, tuple[str, ...], str]] = [
    ("no such file", ("modes", "missing.toml"), "missing.toml: cannot be read: No such file"),
    ("a directory", ("modes", "."), "cannot be read"),
    ("no such preset", ("modes", "preset:other"), "allowed: paper, sdnl104"),
    ("a huge length", ("modes", PAPER, "--set", "beam.length=1e308"), "follows from material.density, section.breadth"),
    ("a huge density", ("modes", PAPER, "--set", "beam.material.density=1.7e308"), "the mass per length m comes to"),
    ("a long index", ("modes", PAPER, "--set", f"stops.{'1' * 5000}.gap=1"), "...: there is no element '1111"),
    ("a deep path", ("modes", PAPER, "--set", f"{'a.' * 3000}b=1"), "is 3001 keys deep; a problem is at most 20"),
    ("a deep list", ("modes", PAPER, "--set", f"stops={'[' * 3000}{']' * 3000}"), "[...: must be a list"),
    ("bad assignment", ("modes", PAPER, "--set", "gap"), "must be key=value"),
    ("a million modes", ("modes", PAPER, "--n-modes", "1000000"), "1000000"),
    ("no modes", ("modes", PAPER, "--n-modes", "0"), "0"),
    ("a million FE modes", ("modes", PAPER, "--solver", "fe", "--n-modes", "1000000"), "1000000"),
    ("modes in the solver", (*SIMULATE, "--n-modes", "1000000"), "n_modes = 1000000"),
    ("negative elements", (*SIMULATE, "--solver", "fe", "--elements", "-1"), "elements = -1"),
    ("unknown state", ("modes", PAPER, "--state", "P7"), "--state P7: there is no such state; allowed: all, free"),
    ("impossible state", ("modes", PAPER, "--state", "P2+P4"), "cannot be closed"),
    ("unknown solver", ("modes", PAPER, "--solver", "magic"), "solver = 'magic' is not installed; allowed: analytic"),
    ("unknown option", (*SIMULATE, "--option", "colour=3"), "has no option 'colour'; allowed: n_modes"),
    (
        "option of the other solver",
        (*SIMULATE, "--elements", "8"),
        "--elements 8: solver analytic has no option elements; allowed: n_modes",
    ),
    (
        "modes of elements",
        (*SIMULATE, "--solver", "fe", "--n-modes", "10"),
        "--n-modes 10: solver fe has no option n_modes; allowed: elements",
    ),
    ("option without a value", (*SIMULATE, "--option", "n_modes"), "must be key=value"),
    ("option of a wrong kind", (*SIMULATE, "--option", "tolerance=tight"), "tolerance = 'tight'"),
    ("series without a file", (*SIMULATE, "--rate", "9"), "--rate: no series is written without --series FILE"),
    ("series as what?", (*SIMULATE, "--series", "a.txt"), "--series a.txt: the name must end in .nc, .csv"),
    ("places without x", (*SERIES, "--at", "2.5"), "--at 2.5: must be x= and numbers"),
    ("places as text", (*SERIES, "--at", "x=tip"), "--at x=tip: must be x= and numbers"),
    ("places of nothing", (*SIMULATE, "--at", "x=1"), "--at: there is neither a series nor a figure that shows places"),
    ("places in time", (*FIGURE, "--draw", "states", "--at", "x=1"), "--at: there is neither a series nor a figure"),
    (
        "two for one",
        (*FIGURE, "--draw", "phase", "--at", "x=1,2"),
        "--at x=1,2: figure phase shows one place; give one",
    ),
    ("place of a figure off the beam", (*FIGURE, "--at", "x=9"), "x = 9: lies outside the beam"),
    ("unknown quantity", (*SERIES, "--quantity", "force,slope"), "quantity 'slope': is unknown; allowed: displacement"),
    ("too many samples", (*SERIES, "--rate", "1e12"), "samples of each of"),
    ("negative duration", ("simulate", PAPER, "--duration", "-1"), "--duration -1: must be positive"),
    ("NaN duration", ("simulate", PAPER, "--duration", "nan"), "--duration nan: must be positive and finite"),
    ("text for duration", ("simulate", PAPER, "--duration", "long"), "'long' is not a valid float"),
    ("contacts as a picture", (*SIMULATE, "--contacts", "a.png"), "must end in .csv, .json"),
    ("a figure as a table", (*SIMULATE, "--figure", "a.csv"), "must end in .png, .svg, .pdf"),
    ("a drawing without a file", (*SIMULATE, "--draw", "phase"), "--draw phase: nothing is drawn without --figure"),
    ("an unknown drawing", (*FIGURE, "--draw", "orbit"), "'orbit' is not one of 'motion', 'ph"),
    (
        "sections of what has no period",
        ("simulate", "preset:sdnl104", "--duration", "1e9", "--figure", "a.png", "--draw", "poincare"),
        "--draw poincare: the excitation must have one angular_frequency, or whole multiples of the lowest; there is",
    ),
    ("nowhere to write", (*SIMULATE, "--contacts", "no/such/a.csv"), "there is no such directory"),
    ("nothing excites", ("steady", "preset:sdnl104"), "angular_frequency"),
    ("no span", ("export", PAPER, "-o", "x"), "--duration, --steady: give one of them"),
    ("two spans", ("show", PAPER, "-o", "x.gif", "--steady", "--duration", "1"), "--duration, --steady: give one"),
    ("frames and times", ("export", PAPER, "-o", "x", "--steady", "--frames", "9", "--times", "0"), "give one of them"),
    ("times in words", ("export", PAPER, "-o", "x", "--steady", "--times", "0,now"), "--times 0,now: must be numbers"),
    ("modes in motion", ("export", PAPER, "-o", "x", "--state", "all", "--steady"), "--steady: mode shapes have none"),
    ("modes of no state", ("export", PAPER, "-o", "x", "--state", "P9"), "--state P9: there is no such state"),
    ("nobody beside", ("export", PAPER, "-o", "x", "--steady", "--beside", "magic"), "'magic' is not installed"),
    ("a picture as a report", ("show", PAPER, "-o", "x.pdf", "--steady"), "must end in .png, .gif, .mp4"),
    ("the pace of a window", ("show", PAPER, "--steady", "--pace", "2"), "--pace: a window has none"),
    ("size in words", ("show", PAPER, "-o", "x.png", "--steady", "--size", "big"), "--size big: must be width and"),
    ("export to a device", ("export", PAPER, "-o", "/dev/null", "--duration", "1e9"), "/dev/null is not a directory"),
    ("a link to itself", ("export", PAPER, "-o", "loop", "--duration", "1e9"), "loop is not a directory"),
    ("a name with a zero byte", ("export", PAPER, "-o", "a\0", "--duration", "1e9"), "embedded null byte"),
    ("a file with a zero byte", (*SIMULATE, "--contacts", "a\0.csv"), "embedded null byte"),
    ("no name of a curve", ("plot", ""), "'': is no file"),
    ("a folder as a curve", ("plot", "."), "'.': is no file"),
    ("a curve with a zero byte", ("plot", "a\0"), "embedded null byte"),
    ("report in a device", ("validate", "-o", "/dev/null/x"), "/dev/null is not a directory"),
    ("report in a link to itself", ("validate", "-o", "loop"), "loop is not a directory"),
    ("contacts on a directory", (*SIMULATE, "--contacts", "."), "must end in"),
    ("JSON on a directory", ("steady", PAPER, "--json", "."), "it is a directory"),
    ("init nowhere", ("init", "no/such/file.toml"), "cannot be written"),
    ("unknown case", ("validate", "--case", "magic"), "magic"),
    ("no such peer", ("validate", "--peers", "magic"), "--peers magic: solver = 'magic' is not installed"),
    ("a case without its peers", ("validate", "--case", "peers"), "--peers opensees"),
    ("changes to nothing", ("validate", "--set", "stops.*.gap=1"), "--set: it changes a PROBLEM, and none is given"),
    ("a duration of nothing", ("validate", "--duration", "3"), "--duration: it is that of the motions of a PROBLEM"),
    (
        "a duration of a steady state",
        ("validate", "preset:paper", "--duration", "3"),
        "duration = 3: this problem has no record and no random excitation",
    ),
    ("no such file to validate", ("validate", "missing.toml"), "missing.toml: cannot be read"),
    ("nothing swept", (*NOWHERE, *OUT), "nothing is swept; give --from and --to, or --over"),
    ("half a range", (*NOWHERE, *OUT, "--from", "1"), "--to: is missing"),
    ("a range backwards", (*NOWHERE, *OUT, "--from", "2", "--to", "1"), "--to 1: must be at least --from, 2"),
    ("no step", (*NOWHERE, *RANGE, "--step", "0"), "--step 0: must be positive"),
    ("too fine", (*NOWHERE, *RANGE, "--step", "1e-9"), "--step 1e-09: makes 1e+09"),
    ("negative frequency", (*NOWHERE, *OUT, "--from", "-1", "--to", "2"), "--from -1: must be positive"),
    ("sweep as a picture", (*NOWHERE, "--out", "c.png", "--from", "1", "--to", "2"), "must end in .nc"),
    ("sweep nowhere", (*NOWHERE, "--out", "no/c.nc", "--from", "1", "--to", "2"), "there is no such directory"),
    ("over nothing", (*NOWHERE, *OUT, "--over", "damping.ratio"), "--over damping.ratio: must be PATH="),
    ("over text", (*NOWHERE, *OUT, "--over", "damping.ratio=a,b"), "must be FROM:TO:COUNT or numbers"),
    ("over no count", (*NOWHERE, *OUT, "--over", "damping.ratio=0:1:0"), "a count from 1 to"),
    ("a bad point", (*NOWHERE, *OUT, "--over", "damping.ratio=0.1,-1"), "lapjoint: damping.ratio = -1.0: must be"),
    ("no scheduler", (*NOWHERE, *RANGE, "--scheduler", "x://y"), "scheduler = 'x://y'"),
    ("no curve", ("plot", "missing.nc", "-o", "a.png"), "missing.nc: cannot be read: No such file"),
    ("a curve as a table", ("plot", "missing.nc", "-o", "a.csv"), "must end in .png, .svg, .pdf"),
    ("unknown command", ("solve",), "No such command"),
    ("basins of no starts", ("basins", PAPER, *OUT), "no starts are chosen"),
    ("starts on a grid", (*BAR_PLANE, "--starts", "5"), "--starts: is of random starts, and --plane gives a grid"),
    ("energy on a grid", (*BAR_PLANE, "--energy", "5"), "--energy: is of random starts"),
    ("a grid of random starts", (*RANDOM, "--grid", "4x4"), "--grid: is of a grid"),
    ("a plane of one", (*PLANE, "z(0.5)"), "must be two coordinates"),
    ("a plane off the beam", (*PLANE, "z(0.5),v(7)"), "v(7): lies outside the beam; allowed are 0 to 2.5 m"),
    ("a grid of one", (*BAR_PLANE, "--grid", "4"), "--grid 4: must be two numbers of values, as in 40x40"),
    ("a grid of none", (*BAR_PLANE, "--grid", "4x0"), "--grid 4x0: must be two numbers of values"),
    ("one range", (*BAR_PLANE, "--range", "1:2"), "--range 1:2: must be FROM:TO,FROM:TO"),
    ("a range of basins backwards", (*BAR_PLANE, "--range", "2:1,0:1"), "range = 2:1: must have finite ends"),
    ("no energy", ("basins", PAPER, *OUT, "--energy", "nan"), "energy = nan: must be positive and finite"),
    ("values of nothing", (*RANDOM, "--values", "3"), "--values: is of the values of --over PATH"),
    ("half of --over", (*RANDOM, "--over", "damping.ratio", "--from", "1"), "--to: is missing; --over damping.ratio"),
    ("basins over nothing", (*RANDOM, *RANGE, "--over", "no.thing", "--values", "2"), "no.thing"),
    ("basins as a text", ("basins", PAPER, "--energy", "20", "--out", "basins.txt"), "must end in .nc"),
    ("basins as a film", (*RANDOM, "--figure", "basins.gif"), "must end in .png, .svg, .pdf"),
    ("a branch as a picture", (*BRANCH, "--from", "1", "--to", "2", "--out", "b.png"), "must end in .nc"),
    ("a branch of no range", (*BRANCH, *OUT, "--from", "1", "--to", "1"), "must differ from 1, where the range begins"),
    ("a branch from 0", (*BRANCH, *OUT, "--from", "0", "--to", "1"), "base_motion.angular_frequency"),
    ("a branch over nothing", (*BRANCH, *RANGE, "--over", "beam.colour"), "beam.colour"),
    ("a branch of no points", (*BRANCH, *RANGE, "--max-points", "0"), "max_points = 0"),
    ("a branch by no workers", (*BRANCH, *RANGE, "--workers", "0"), "workers = 0"),
    ("loci of no values", (*BRANCH, *RANGE, "--also-over", "stops.*.gap"), "--also-over stops.*.gap: must be"),
    ("loci of nothing", (*BRANCH, *RANGE, "--also-over", "beam.colour=1,2"), "beam.colour"),
    ("statistics of no duration", (*STATISTICS, "--seeds", "2"), "--duration: is missing"),
    ("of a negative one", (*STATISTICS, "--duration", "-1"), "--duration -1: must be positive"),
    ("as a table", (*MOTIONS, "--out", "stats.csv"), "--out stats.csv: the name must end in .nc"),
    ("at no x", (*MOTIONS, "--at", "1"), "--at 1: must be x= and numbers"),
    ("of nothing but a start", (*MOTIONS, "--settle", "4"), "duration = 3: must be longer than the 4 s"),
]


@pytest.mark.parametrize(("arguments", "message"), [r[1:] for r in BAD_COMMANDS], ids=[r[0] for r in BAD_COMMANDS])
def test_bad_input_is_refused(arguments: tuple[str, ...], message: str, here: Path) -> None:
    random = RandomBaseMotion(psd=[[5.0, 1.0], [40.0, 1.0]])
    write_problem(unit_cantilever().replace(base_motion=random), "short.toml")
    Path("loop").symlink_to("loop")
    assert_refused(run(*arguments), message)
    assert {path.name for path in here.iterdir()} <= {"short.toml", "loop", "x"}


def test_a_process_prints_a_message_and_no_traceback(tmp_path: Path) -> None:
    path = problem_file(tmp_path, "gap = 0.001", 'gap = "wide"')
    command = [sys.executable, "-c", "from lapjoint.cli.main import main; main()", "modes", str(path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == f'lapjoint: {path}: stops[0].gap = "wide": must be a number\n'
