"""Mutated problem files, assignments and command lines end in an answer or a message, and not in a traceback."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from lapjoint import paper_joint, sdnl104
from lapjoint.cli.arguments import problem_from
from lapjoint.cli.main import main
from lapjoint.errors import InputError, SolverError
from lapjoint.problem.example import commented_example
from lapjoint.problem.files import to_toml

HARMONICS = """
beam = {length = 1.0, bending_stiffness = 1.0, mass_per_length = 1.0}
[base_motion]
kind = "harmonics"
angular_frequency = 60.0
harmonics = [{multiple = 1, amplitude = 2e-3}, {multiple = 3, amplitude = 1e-4, phase = 0.7}]
[[point_loads]]
kind = "harmonics"
x = 0.5
angular_frequency = 60.0
harmonics = [{multiple = 2, force = 3.0}]
"""
VALUES = [
    *("0", "-1", "1e308", "-1e308", "1e-320", "5e-324", "1.8e308", "inf", "-inf", "nan", "true", "[]", "{}", '""', "x"),
    *("9" * 5000, "[" * 300 + "]" * 300, '"\\u0000"', '"\\u001b[2J"', "1979-05-27", "07:32:00", "[1, 2, 3]", "[[]]"),
    *("{x = 1}", "[{x = 1}]", "0x7fffffffffffffffffff", "1_0", "'", '"""', "\x00", "\udcff", "é", "=", "-0.0", "1e400"),
]
FIELDS = """
    title beam beam.length beam.section beam.section.height beam.section.shape beam.material beam.material.density
    beam.material.youngs_modulus beam.bending_stiffness supports supports.0.x supports.0.translational
    supports.*.torsional stops stops.0 stops.P2.gap stops.*.stiffness stops.*.x stops.*.name stops[1].side stops.99.gap
    damping damping.kind damping.ratio base_motion base_motion.kind base_motion.harmonics
    base_motion.harmonics.0.multiple point_loads point_loads.0.harmonics[1].phase base_motion.amplitude
    base_motion.angular_frequency base_motion.phase initial initial.kind initial.displacement
    . .. * stops.-1.gap é.ü beam.length.x beam.section.* title.0 [ ] stops[ \x1b[2J
"""
PATHS = [*FIELDS.split(), "", "a." * 500 + "b", "stops." + "9" * 5000]


def mutated_file(rng: random.Random) -> bytes:
    """A problem file with one to four faults: bytes, values, lines, keys."""
    text = rng.choice([to_toml(paper_joint()), to_toml(sdnl104()), commented_example(), HARMONICS])
    for _ in range(rng.randint(1, 4)):
        lines = text.splitlines(keepends=True) or [""]
        i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
        kind = rng.choice(["value", "value", "line", "twice", "swap", "cut", "key", "sign"])
        if kind == "value" and "=" in lines[i]:
            value = rng.choice(VALUES)
            lines[i] = f"{lines[i].split('=')[0]}= {value}\n"
        elif kind == "line":
            del lines[i]
        elif kind == "twice":
            lines.insert(j, lines[i])
        elif kind == "swap":
            lines[i], lines[j] = lines[j], lines[i]
        elif kind == "cut":
            lines[i] = lines[i][: rng.randrange(len(lines[i]) + 1)]
        elif kind == "key":
            lines[i] = re.sub(r"\w+", rng.choice(["beam", "stops", "x", "kind", '"a.b"', "a.b.c"]), lines[i], count=1)
        elif lines[i]:
            at = rng.randrange(len(lines[i]))
            lines[i] = lines[i][:at] + rng.choice('[]{}=".,\n\x00\x7f#+-eE01 \u202e') + lines[i][at + 1 :]
        text = "".join(lines)
    raw = bytearray(text.encode(errors="surrogateescape"))
    if raw and rng.random() < 0.1:
        raw[rng.randrange(len(raw))] ^= 1 << rng.randrange(8)
    return bytes(raw)


def assignment(rng: random.Random) -> str:
    """An assignment for --set, mostly of a field that is there."""
    path = rng.choice(PATHS) if rng.random() < 0.9 else ".".join(rng.choice(PATHS) for _ in range(3))
    return path + rng.choice(["=", "=", "=", "=", "", "=="]) + rng.choice(VALUES)


def taken(read: Callable[[], object]) -> bool:
    """Whether something was read; if it is refused, then by a message of a readable length that begins with a name."""
    message = ""
    try:
        read()
    except InputError as error:
        message = str(error)
    assert not message or ": " in message
    assert len(message) < 20_000
    return not message


def read_mutated_files(number: int, seed: int, folder: Path) -> int:
    """Read so many mutated files; returns how many of them are problems."""
    path, found = folder / "problem.toml", 0
    for i in range(number):
        path.write_bytes(mutated_file(random.Random(f"{seed} {i}")))
        found += taken(lambda: problem_from(str(path)))
    return found


def assign_at_random(number: int, seed: int) -> int:
    """Take so many assignments; returns how many of them leave a problem."""
    rng = random.Random(seed)
    return sum(taken(lambda: problem_from("preset:paper", (assignment(rng),))) for _ in range(number))


MAIN = click.Context(main)
COMMANDS = [*main.list_commands(MAIN), "nothing"]
PARAMETERS = [one for name in COMMANDS[:-1] for one in getattr(main.get_command(MAIN, name), "params", ())]
OPTIONS = ["--help", *sorted({text for one in PARAMETERS if isinstance(one, click.Option) for text in one.opts})]
WORDS = """
    preset:paper preset: preset:x problem.toml loop folder missing/x.nc /dev/full - a.nc a.png a.csv a.json a.pdf
    loop.nc 0 -1 3 1e400 nan inf all P2+P4 fe analytic opensees fe:elements=2 n_modes=3 n_modes=[1] tolerance=x
    damping.ratio=1:2:2 stops.*.gap=1,2 = 1x1 900x400 0,1 free motion phase = z(2.5),v(2.5) x=1 1:2,0:1 \x1b[2J
"""
ARGUMENTS = [*WORDS.split(), "", "9" * 5000, "x" * 300, "\udcff", "a\0b"]


def command_line(rng: random.Random) -> list[str]:
    """Arguments: a command, mostly a problem, and options with values that fit them only by chance."""
    given = [rng.choice(COMMANDS), *(["preset:paper"] if rng.random() < 0.5 else [])]
    for _ in range(rng.randint(0, 5)):
        given += [rng.choice(OPTIONS), *([rng.choice(ARGUMENTS)] if rng.random() < 0.8 else [])]
    return given + [rng.choice(ARGUMENTS) for _ in range(rng.randint(0, 1))]


def run_command_lines(number: int, seed: int, folder: Path, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Run so many command lines up to the point where something would be computed; returns their exit statuses."""
    for name in ("loop", "loop.nc"):
        (folder / name).symlink_to(name)
    (folder / "folder").mkdir()
    (folder / "a.nc").write_bytes(b"\x89HDF\r\n\x1a\n fingerprint checksum")
    (folder / "problem.toml").write_text(to_toml(sdnl104()))
    answers = ("modes", "simulate", "stream", "steady_state", "period_map")
    solvers = [f"{it}.Solver.{answer}" for it in ("analytic", "fe_lapjoint") for answer in answers]
    for each in (*solvers, "validation.suite.main", "validation.faults.run.main"):
        monkeypatch.setattr(each, nothing_computed)
    statuses = []
    for i in range(number):
        given = command_line(random.Random(f"{seed} {i}"))
        result = CliRunner().invoke(main, given)
        assert result.exception is None or isinstance(result.exception, SystemExit), (given, result.exception)
        assert result.exit_code in (0, 1, 2, 3), given
        assert all(sign.isprintable() or sign == "\n" for sign in result.stderr), given
        statuses.append(result.exit_code)
    return statuses


def nothing_computed(*_: object, **__: object) -> None:
    """In the place of what takes long: the solver gives up."""
    raise SolverError("nothing is computed here")


def test_a_mutated_file_is_a_problem_or_has_a_message(tmp_path: Path) -> None:
    assert 20 < read_mutated_files(400, 1, tmp_path) < 300


def test_an_assignment_leaves_a_problem_or_has_a_message() -> None:
    assert 5 < assign_at_random(300, 1) < 200


def test_a_command_line_ends_with_a_status(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    statuses = run_command_lines(80, 1, tmp_path, monkeypatch)
    assert {0, 1, 2} <= set(statuses)


@pytest.mark.slow
def test_of_many_mutated_inputs_none_ends_in_a_traceback(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read_mutated_files(10_000, 2, tmp_path)
    assign_at_random(5000, 2)
    (tmp_path / "problem.toml").unlink()
    run_command_lines(500, 2, tmp_path, monkeypatch)
