"""The journal of a sweep: exact, tolerant of a cut line, locked, and clear when it cannot be written."""

from __future__ import annotations

import errno
import json
import math
import os
import subprocess
import sys
from dataclasses import astuple
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from counting_solver import asked, installed

import lapjoint.campaigns.batch
import lapjoint.campaigns.dataset
from lapjoint import ContactState, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.campaigns import FREQUENCY, Axis, run
from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.journal import Journal, journal_path
from lapjoint.campaigns.plan import Plan
from lapjoint.campaigns.point import Point, plain_section, section_from
from lapjoint.errors import InputError, OutputError

JOINT = paper_joint()
POINT = Point(
    "PERIODIC",
    1,
    True,
    0.1 + 0.2,
    -0.7,
    0.1,
    math.nan,
    math.inf,
    (-0.0, 1e-320, 1 / 3),
    1.0,
    ((0, 0.0, 1.0, 2.0, 3.0, 1),),
)


def plan(**changes: Any) -> Plan:
    given = {"grid": Grid(JOINT, (Axis(FREQUENCY, range(100, 120)),)), "solver": "counting"} | changes
    return Plan(**given)


@pytest.fixture
def out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file to sweep to, with the counting solver installed."""
    folder = tmp_path / "package"
    folder.mkdir()
    monkeypatch.setenv("PYTHONPATH", installed(folder))
    monkeypatch.setenv("COUNTING_LOG", str(tmp_path / "log"))
    monkeypatch.syspath_prepend(str(folder))
    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    lapjoint.campaigns.batch._made.cache_clear()
    return tmp_path / "curve.nc"


class StopHereError(Exception):
    """Ends a sweep in the middle."""


def stop_at(number: int) -> Any:
    def progress(done: float, total: float) -> None:
        if done >= number:
            raise StopHereError

    return progress


def interrupted(out: Path, number: int = 10, **changes: Any) -> Plan:
    """A sweep that was stopped when `number` points were done."""
    this = plan(**changes)
    with pytest.raises(StopHereError):
        run(this, out=out, progress=stop_at(number))
    return this


@pytest.mark.parametrize("modal", [True, False])
def test_what_it_keeps_comes_back_exactly(modal: bool, tmp_path: Path) -> None:
    journal = Journal(plan(), tmp_path / "curve.nc")
    coordinates, nodes = np.array([[1 / 3, -0.0], [5e-324, 1e300]]), None if modal else np.array([0.0, 0.1, 2 / 3])
    section = SectionPoint(ContactState((1, 3)), coordinates, nodes)
    journal.append({7: POINT, 8: Point(message="é")}, plain_section(section))
    journal.close()
    again = Journal(plan(), tmp_path / "curve.nc")
    assert list(again.points) == [7, 8]
    assert json.dumps(astuple(again.points[7])) == json.dumps(astuple(POINT))
    assert again.points[8].message == "é"
    back = section_from(again.sections[8] or {})
    assert back.state == section.state
    assert back.coordinates.tobytes() == section.coordinates.tobytes()
    np.testing.assert_array_equal(back.nodes, section.nodes)
    again.close()


@pytest.mark.parametrize("start", ["rest", "up"])
@pytest.mark.parametrize("damage", ["cut", "garbage", "cut to the first line", "empty"])
def test_a_line_that_was_cut_short_is_computed_again(damage: str, start: Any, out: Path) -> None:
    this = interrupted(out, start=start)
    path = journal_path(out)
    raw = path.read_bytes()
    lines = raw.splitlines(keepends=True)
    left, content = {
        "cut": (11, raw[:-20]),
        "garbage": (10, raw + b"\x00\xff\n"),
        "cut to the first line": (20, lines[0][:50]),
        "empty": (20, b""),
    }[damage]
    path.write_bytes(content)
    before = len(asked(out.parent / "log"))
    resumed = run(this, out=out)
    assert len(asked(out.parent / "log")) - before == left
    xr.testing.assert_identical(resumed, run(this))
    assert not path.exists()


def test_a_finished_sweep_is_not_computed_again(out: Path) -> None:
    first = run(plan(), out=out)
    before = len(asked(out.parent / "log"))
    xr.testing.assert_identical(run(plan(), out=out), first)
    assert len(asked(out.parent / "log")) == before


def test_another_sweep_is_thrown_away_only_when_told(out: Path) -> None:
    interrupted(out)
    other = plan(seed=1)
    with pytest.raises(InputError, match=r"journal: holds another sweep, not finished \(it differs in seed\)"):
        run(other, out=out)
    run(other, out=out, force=True)
    with pytest.raises(InputError, match="is the result of another sweep"):
        run(plan(), out=out)
    assert run(plan(), out=out, force=True).attrs["seed"] == 0


@pytest.mark.parametrize(("version", "whose"), [(1, "an older"), (3, "a newer")])
def test_a_journal_of_another_format_is_refused(version: int, whose: str, out: Path) -> None:
    this = interrupted(out)
    path = journal_path(out)
    path.write_bytes(path.read_bytes().replace(b'{"journal":2,', f'{{"journal":{version},'.encode()))
    sentence = (
        f"{path}: is of format version {version}, which {whose} lapjoint wrote; this one reads version 2 only; "
        "choose another --out, or throw it away with --force"
    )
    with pytest.raises(InputError) as error:
        run(this, out=out)
    assert str(error.value) == sentence
    xr.testing.assert_identical(run(this, out=out, force=True), run(this))


def test_what_is_not_a_sweep_is_not_overwritten(out: Path) -> None:
    out.write_text("mine")
    with pytest.raises(InputError, match="is not a NetCDF-4 file"):
        run(plan(), out=out)
    journal_path(out).write_text("mine\n")
    out.unlink()
    with pytest.raises(InputError, match="is not a journal of a sweep"):
        run(plan(), out=out)
    assert journal_path(out).read_text() == "mine\n"


def test_two_at_once_are_refused(out: Path) -> None:
    journal = Journal(plan(), out)
    with pytest.raises(InputError, match="another process is at work on it"):
        run(plan(), out=out)
    journal.close()
    run(plan(), out=out)


def test_the_lock_does_not_outlive_its_process(out: Path) -> None:
    interrupted(out)
    code = (
        "import fcntl, os, signal, sys; file = open(sys.argv[1], 'r+'); fcntl.flock(file, fcntl.LOCK_EX); "
        "os.kill(os.getpid(), signal.SIGKILL)"
    )
    subprocess.run([sys.executable, "-c", code, str(journal_path(out))], timeout=30)
    run(plan(), out=out)


def test_a_place_where_nothing_can_be_written_is_named(out: Path) -> None:
    with pytest.raises(InputError, match=r"no/curve\.nc\.journal: cannot be written: No such file or directory"):
        run(plan(), out=out.parent / "no" / "curve.nc")


def test_a_full_disk_gives_one_message_and_the_journal_stays(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written = os.fsync
    calls = []

    def full(descriptor: int) -> None:
        calls.append(descriptor)
        if len(calls) == 8:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written(descriptor)

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError) as error:
        run(plan(), out=out)
    path = journal_path(out)
    assert str(error.value) == (
        f"{path}: cannot be written: No space left on device; "
        f"6 of 20 points are kept in {path}; the same command resumes"
    )
    xr.testing.assert_identical(run(plan(), out=out), run(plan()))


FULL = """
import resource, sys
from lapjoint.cli.main import main
if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
    main(["sweep", "preset:paper", "--from", "100", "--to", "119", "--solver", "counting", "--out", sys.argv[2]])
"""


@pytest.mark.parametrize("room", [6000, 12000])
def test_a_file_that_may_not_grow_ends_the_command_with_status_1(room: int, out: Path) -> None:
    """The limit is the system's own; with less room the journal does not fit, with more the dataset does not."""
    script = out.parent / "script.py"
    script.write_text(FULL)
    done = subprocess.run(
        [sys.executable, str(script), str(room), str(out)], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 1, done.stderr
    (message,) = [line for line in done.stderr.splitlines() if not line.startswith("sweep: ")]
    where = journal_path(out) if room == 6000 else out
    assert message.startswith(f"lapjoint: {where}: cannot be written: File too large; ")
    assert message.endswith("the same command resumes")
    assert sorted(path.name for path in out.parent.glob("*curve*")) == ["curve.nc.journal"]
    before = len(asked(out.parent / "log"))
    resumed = run(plan(), out=out)
    assert len(asked(out.parent / "log")) - before < 20
    xr.testing.assert_identical(resumed, run(plan()))


def test_a_finished_sweep_is_read_once_and_a_new_one_not_at_all(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read, reads = lapjoint.campaigns.dataset.read_curve, []
    monkeypatch.setattr(lapjoint.campaigns.dataset, "read_curve", lambda path: reads.append(path) or read(path))
    made = run(plan(), out=out)
    assert reads == []
    xr.testing.assert_identical(run(plan(), out=out), made)
    assert reads == [out]


def test_a_journal_that_is_a_link_is_not_followed(out: Path) -> None:
    (out.parent / "victim").write_text("mine")
    journal_path(out).symlink_to(out.parent / "victim")
    with pytest.raises(InputError, match=r"curve\.nc\.journal: cannot be written"):
        run(plan(), out=out, force=True)
    assert (out.parent / "victim").read_text() == "mine"
