"""The journal of a sweep: exact, tolerant of a cut line, locked, and clear when it cannot be written."""

from __future__ import annotations

import errno
import json
import math
import os
import random
import re
import subprocess
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import astuple
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from counting_solver import asked

import lapjoint.campaigns.running
from lapjoint import ContactState, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.campaigns import FREQUENCY, Axis
from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.journal import Journal, journal_path
from lapjoint.campaigns.point import Point, plain_section, section_from
from lapjoint.campaigns.running import run_job
from lapjoint.campaigns.sweep.job import SweepJob
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.errors import DamageWarning, InputError, OutputError

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
    ((0, 0.0, 1.0, 2.0, 3.0, 1, 4.0),),
)


def plan(**changes: Any) -> Plan:
    given = {"grid": Grid(JOINT, (Axis(FREQUENCY, range(100, 120)),)), "solver": "counting"} | changes
    return Plan(**given)


def run(this: Plan, **running: Any) -> xr.Dataset:
    return run_job(SweepJob(this), **running)


@pytest.fixture
def out(counting: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file to sweep to by the counting solver, which hands back each point at once."""
    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    return counting / "curve.nc"


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


@contextmanager
def warns_of(path: Path, kept: str) -> Iterator[None]:
    """Expect one warning that names the journal, and says how many points are kept; none if `kept` is empty."""
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always", DamageWarning)
        yield
    said = [str(each.message) for each in found]
    assert len(said) == bool(kept), said
    assert all(line.startswith(f"{path}: ") and kept in line for line in said), said


@pytest.mark.parametrize("modal", [True, False])
def test_what_it_keeps_comes_back_exactly(modal: bool, tmp_path: Path) -> None:
    journal = Journal(SweepJob(plan()), tmp_path / "curve.nc")
    coordinates, nodes = np.array([[1 / 3, -0.0], [5e-324, 1e300]]), None if modal else np.array([0.0, 0.1, 2 / 3])
    section = SectionPoint(ContactState((1, 3)), coordinates, nodes)
    journal.append({7: POINT, 8: Point(message="é")}, plain_section(section))
    journal.close()
    again = Journal(SweepJob(plan()), tmp_path / "curve.nc")
    assert list(again.points) == [7, 8]
    assert json.dumps(astuple(again.points[7])) == json.dumps(astuple(POINT))
    assert again.points[8].message == "é"
    back = section_from(again.sections[8] or {})
    assert back.state == section.state
    assert back.coordinates.tobytes() == section.coordinates.tobytes()
    np.testing.assert_array_equal(back.nodes, section.nodes)
    again.close()


@pytest.mark.parametrize("start", ["rest", pytest.param("up", marks=pytest.mark.thorough)])
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
    with warns_of(path, f"{20 - left} of 20 points are whole" if content else ""):
        found = run(this, out=out)
    assert len(asked(out.parent / "log")) - before == left
    xr.testing.assert_identical(found, run(this))
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


@pytest.mark.parametrize("sealed", [True, False])
@pytest.mark.parametrize(
    ("version", "whose"), [pytest.param(1, "an older", marks=pytest.mark.thorough), (2, "an older"), (4, "a newer")]
)
def test_a_journal_of_another_format_is_refused(
    version: int, whose: str, sealed: bool, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = journal_path(out)
    with monkeypatch.context() as other:
        other.setattr("lapjoint.campaigns.journal.FORMAT_VERSION", version)
        this = interrupted(out)
    if not sealed:
        path.write_bytes(re.sub(rb',"checksum":"\w+"', b"", path.read_bytes()))
    sentence = (
        f"{path}: is of format version {version}, which {whose} lapjoint wrote; this one reads version 3 only; "
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
    journal = Journal(SweepJob(plan()), out)
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
    with pytest.raises(OutputError, match=r"no/curve\.nc\.journal: cannot be written: No such file or directory"):
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


@pytest.mark.parametrize("room", [6000, pytest.param(12000, marks=pytest.mark.thorough)])
def test_a_file_that_may_not_grow_ends_the_command_with_status_3(room: int, out: Path) -> None:
    """The limit is the system's own; with less room the journal does not fit, with more the dataset does not."""
    script = out.parent / "script.py"
    script.write_text(FULL)
    done = subprocess.run(
        [sys.executable, str(script), str(room), str(out)], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 3, done.stderr
    (message,) = [line for line in done.stderr.splitlines() if not line.startswith("sweep: ")]
    where = journal_path(out) if room == 6000 else out
    assert message.startswith(f"lapjoint: {where}: cannot be written: File too large; ")
    assert message.endswith("the same command resumes")
    assert sorted(path.name for path in out.parent.glob("*curve*")) == ["curve.nc.journal"]
    before = len(asked(out.parent / "log"))
    found = run(plan(), out=out)
    assert len(asked(out.parent / "log")) - before < 20
    xr.testing.assert_identical(found, run(plan()))


def test_a_finished_sweep_is_read_once_and_a_new_one_not_at_all(out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    read, reads = lapjoint.campaigns.running.read_result, []
    counted = lambda path, noun: reads.append(path) or read(path, noun)  # noqa: E731
    monkeypatch.setattr(lapjoint.campaigns.running, "read_result", counted)
    made = run(plan(), out=out)
    assert reads == []
    xr.testing.assert_identical(run(plan(), out=out), made)
    assert reads == [out]


def test_a_journal_that_is_a_link_is_not_followed(out: Path) -> None:
    (out.parent / "victim").write_text("mine")
    journal_path(out).symlink_to(out.parent / "victim")
    with pytest.raises(OutputError, match=r"curve\.nc\.journal: cannot be written"):
        run(plan(), out=out, force=True)
    assert (out.parent / "victim").read_text() == "mine"


def damaged(raw: bytes, rng: random.Random) -> bytes:
    """The bytes of a journal with one to three faults as disks, cut-off writes and editors make them."""
    for _ in range(rng.randint(1, 3)):
        kind = rng.choice(["bit", "digit", "cut", "twice", "swapped", "lost", "cut off"])
        lines = raw.splitlines(keepends=True)
        i, j = (rng.randrange(len(lines)) for _ in range(2))
        if kind == "bit":
            at = rng.randrange(len(raw))
            raw = raw[:at] + bytes([raw[at] ^ 1 << rng.randrange(8)]) + raw[at + 1 :]
            continue
        if kind == "digit":
            at = rng.choice([match.start() for match in re.finditer(rb"\d", raw)])
            raw = raw[:at] + rng.choice(sorted({*"0123456789"} - {chr(raw[at])})).encode() + raw[at + 1 :]
            continue
        if kind == "cut off":
            raw = raw[: rng.randrange(1, len(raw))]
            continue
        if kind == "cut":
            lines[i] = lines[i][: rng.randrange(len(lines[i]))] + b"\n"
        elif kind == "twice":
            lines.insert(j, lines[i])
        elif kind == "swapped":
            lines[i], lines[j] = lines[j], lines[i]
        elif len(lines) > 1:
            del lines[i]
        raw = b"".join(lines)
    return raw


def resumed(this: Plan, out: Path) -> dict[int, str] | None:
    """The points that a journal gives back, and the section points that go on from them; None if it is refused."""
    content = journal_path(out).read_bytes()
    try:
        journal = Journal(SweepJob(this), out)
    except InputError:
        assert journal_path(out).read_bytes() == content
        return None
    journal.close()
    return {cell: json.dumps([astuple(point), journal.sections.get(cell)]) for cell, point in journal.points.items()}


@pytest.mark.filterwarnings("ignore::lapjoint.errors.DamageWarning")
@pytest.mark.parametrize("start", ["rest", "up"])
def test_of_200_damaged_journals_none_gives_a_number_that_was_not_found(
    start: Any, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What cannot be told from the journal of another sweep is refused, and then the file stays as it is."""
    monkeypatch.setattr(os, "fsync", lambda _: None)
    this, rng = interrupted(out, 12, start=start), random.Random(3)
    raw, whole = journal_path(out).read_bytes(), resumed(this, out)
    assert whole is not None
    kept = []
    for _ in range(200):
        journal_path(out).write_bytes(damaged(raw, rng))
        found = resumed(this, out)
        assert found is None or found.items() <= whole.items()
        kept.append(None if found is None else len(found))
    assert kept.count(None) < 20
    assert kept.count(12) < 100


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::lapjoint.errors.DamageWarning")
@pytest.mark.parametrize("start", ["rest", "up"])
def test_sweeps_that_resume_from_100_damaged_journals_change_no_number(
    start: Any, out: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(os, "fsync", lambda _: None)
    this, rng = interrupted(out, 12, start=start), random.Random(4)
    raw, expected = journal_path(out).read_bytes(), run(this)
    for _ in range(100):
        journal_path(out).write_bytes(damaged(raw, rng))
        try:
            found = run(this, out=out)
        except InputError:
            found = run(this, out=out, force=True)
        xr.testing.assert_identical(found, expected)
        out.unlink()


@pytest.mark.parametrize(("good", "bad"), [(b"PERIODIC", b"PERIoDIC"), (b'"cells":[3]', b'"cells":[4]')])
def test_a_line_that_can_be_read_and_is_wrong_is_dropped(good: bytes, bad: bytes, out: Path) -> None:
    this = interrupted(out)
    path = journal_path(out)
    raw = path.read_bytes()
    assert good in raw
    path.write_bytes(raw.replace(good, bad, 1))
    with warns_of(path, "1 line is damaged and dropped; 9 of 20 points are whole, and the others are computed again"):
        xr.testing.assert_identical(run(this, out=out), run(this))


def test_a_journal_is_left_without_its_damaged_lines(out: Path) -> None:
    this = interrupted(out)
    path = journal_path(out)
    lines = path.read_bytes().splitlines(keepends=True)
    path.write_bytes(b"".join([b"x" + lines[0], *lines[1:4], lines[4][:-9], *lines[5:]]))
    with warns_of(path, "2 lines are damaged and dropped; 8 of 20 points are whole"):
        Journal(SweepJob(this), out).close()
    assert path.read_bytes().splitlines(keepends=True) == [*lines[:4], *lines[6:]]
    assert sorted(each.name for each in out.parent.glob("*journal*")) == ["curve.nc.journal"]
    Journal(SweepJob(this), out).close()
