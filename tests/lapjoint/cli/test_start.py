"""The way into the command line: Ctrl-C at any moment, and what cannot be written, end in a line and a status."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from lapjoint.compiled.compiling import MESSAGE

START = (sys.executable, "-c", "import sys; from lapjoint.cli.start import main; main()")
SIMULATE = ("simulate", "preset:sdnl104", "--duration", "0.002", "--n-modes", "3")
IMPORT = """
import builtins
real = builtins.__import__
def interrupted(name, *rest):
    if name == "{module}":
        builtins.__import__ = real
        {interrupt}
    return real(name, *rest)
builtins.__import__ = interrupted
"""
READING = """
import lapjoint.cli.arguments as arguments
real = arguments.problem_from
class Dying:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
def interrupted(*given):
    {interrupt}
    for _ in range(1000):
        pass
    return real(*given)
arguments.problem_from = interrupted
"""
KILL = "os.kill(os.getpid(), signal.SIGINT)"
ERROR = "raise SystemError('returned a result with an exception set') from None"
WAYS = {
    "an import": IMPORT.format(module="scipy", interrupt=KILL),
    "an import that makes another error of it": IMPORT.format(
        module="numpy", interrupt=f"try: {KILL}\n        except BaseException: {ERROR}"
    ),
    "a destructor": READING.format(interrupt="Dying()"),
    "what takes no notice": READING.format(interrupt=f"try: {KILL}\n    except BaseException: pass"),
}


def messages(said: str) -> list[str]:
    """What a command said on standard error but for its progress."""
    progress = ("simulate: ", "export: ", f"lapjoint: {MESSAGE}")
    return [line for line in said.splitlines() if line and not line.startswith(progress)]


@pytest.mark.parametrize(
    "way", [pytest.param(it, marks=pytest.mark.thorough if it == "a destructor" else ()) for it in WAYS]
)
def test_ctrl_c_is_not_lost(way: str) -> None:
    script = f"import os, signal, sys\nfrom lapjoint.cli.start import main\n{WAYS[way]}\nmain()"
    command = [sys.executable, "-c", script, *SIMULATE]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, preexec_fn=listening)
    assert (done.returncode, messages(done.stderr)) == (130, ["lapjoint: interrupted"])


def listening() -> None:
    """Take Ctrl-C: a shell lets what it starts in the background ignore it, these tests included."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def interrupted_after(seconds: float, cache: Path) -> tuple[int, list[str]]:
    """The exit status and the messages of a command that compiles anew and gets Ctrl-C after some time."""
    command = subprocess.Popen(
        [*START, *SIMULATE],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "NUMBA_CACHE_DIR": str(cache)},
        preexec_fn=listening,
    )
    time.sleep(seconds)
    command.send_signal(signal.SIGINT)
    said = command.communicate(timeout=100)[1]
    return command.returncode, messages(said)


@pytest.mark.parametrize("seconds", [0.8, pytest.param(2.4, marks=pytest.mark.thorough)])
def test_ctrl_c_while_it_starts_and_compiles_is_one_line(seconds: float, tmp_path: Path) -> None:
    assert interrupted_after(seconds, tmp_path) in ((130, ["lapjoint: interrupted"]), (0, []))


@pytest.mark.slow
def test_ctrl_c_at_any_moment_is_one_line(tmp_path: Path) -> None:
    found = [interrupted_after(0.3 + 0.35 * i, tmp_path / str(i)) for i in range(40)]
    assert set(map(str, found)) <= {str((130, ["lapjoint: interrupted"])), str((0, []))}
    assert any(status == 130 for status, _ in found)


def limited(room: int) -> None:
    """Let no file grow beyond so many bytes."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))


WRITERS: list[tuple[str, tuple[str, ...]]] = [
    ("a.toml", ("init", "a.toml", "--force")),
    ("a.json", ("modes", "preset:sdnl104", "--n-modes", "3", "--json", "a.json")),
    ("a.csv", (*SIMULATE, "--contacts", "a.csv")),
    ("a.svg", (*SIMULATE, "--figure", "a.svg")),
    ("motion.pvd", ("export", *SIMULATE[1:], "-o", ".", "--frames", "2", "--points", "3")),
]
ONE_AFTER_THE_OTHER = """
import os, sys
from lapjoint.cli.start import main
for name, command in {writers}:
    os.mkdir(name + " alone")
    os.chdir(name + " alone")
    os.link("../" + name, name)
    sys.argv[1:] = command
    try:
        main()
    except SystemExit as end:
        print(end.code, *os.listdir(), file=sys.stderr)
    os.chdir("..")
"""


def test_a_file_that_does_not_fit_leaves_the_one_that_was_there(here: Path, compiled: None) -> None:
    """One process writes them all, each in a folder of its own: a process for each would start five times."""
    for name, _ in WRITERS:
        (here / name).write_text("before")
    command = [sys.executable, "-c", ONE_AFTER_THE_OTHER.format(writers=WRITERS)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=100, preexec_fn=lambda: limited(10))
    said = iter(messages(done.stderr))
    for name, _ in WRITERS:
        assert "cannot be written" in next(said), done.stderr
        assert next(said) == f"3 {name}", done.stderr
        assert (here / f"{name} alone" / name).read_text() == "before"
    assert not list(said)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize(
    "command", [("schema",), pytest.param(("modes", "preset:sdnl104", "--n-modes", "3"), marks=pytest.mark.thorough)]
)
def test_standard_output_on_a_full_disk_is_one_line(command: tuple[str, ...]) -> None:
    with open("/dev/full", "w") as full:
        done = subprocess.run([*START, *command], stdout=full, stderr=subprocess.PIPE, text=True, timeout=100)
    assert (done.returncode, done.stderr) == (3, "lapjoint: output: cannot be written: No space left on device\n")
