"""What a user names as input is read whole, or refused with its name; what has no end does not fill the memory."""

from __future__ import annotations

import os
import threading
from pathlib import Path

import pytest

from lapjoint import paper_joint
from lapjoint.campaigns.sweep.table import read_curve
from lapjoint.errors import InputError
from lapjoint.files import reading
from lapjoint.files.reading import read_file
from lapjoint.problem.files import read_problem, to_toml

ENDLESS = pytest.mark.skipif(not Path("/dev/zero").exists(), reason="this system has no /dev/zero")


def piped(path: Path, content: bytes) -> Path:
    """A named pipe into which someone writes."""
    os.mkfifo(path)
    threading.Thread(target=path.write_bytes, args=(content,), daemon=True).start()
    return path


def test_a_file_larger_than_the_limit_of_pipes_is_read_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MOST_FROM_PIPES", 10)
    (tmp_path / "a").write_bytes(b"x" * 1000)
    assert read_file(tmp_path / "a") == b"x" * 1000


def test_a_problem_comes_through_a_pipe(tmp_path: Path) -> None:
    assert read_problem(piped(tmp_path / "a.toml", to_toml(paper_joint()).encode())) == paper_joint()


def test_a_pipe_up_to_the_limit_is_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reading, "MOST_FROM_PIPES", 10)
    assert read_file(piped(tmp_path / "a", b"x" * 10)) == b"x" * 10


@ENDLESS
@pytest.mark.parametrize("read", [read_problem, read_curve])
def test_what_has_no_end_is_refused(read: object) -> None:
    assert callable(read)
    with pytest.raises(InputError, match=r"^/dev/zero: is no file, and gives more than 100 MB"):
        read("/dev/zero")


@pytest.mark.parametrize("read", [read_problem, read_curve])
def test_what_cannot_be_read_is_named(read: object, tmp_path: Path) -> None:
    assert callable(read)
    for path in (tmp_path, tmp_path / "missing", "a\0b"):
        with pytest.raises(InputError, match="cannot be read: "):
            read(path)


@ENDLESS
def test_a_record_that_has_no_end_is_refused() -> None:
    record = {"kind": "record", "quantity": "acceleration", "rate": 1000.0, "file": "/dev/zero"}
    with pytest.raises(ValueError, match=r"file = \"/dev/zero\": is no file, and gives more than 100 MB"):
        paper_joint().replace(base_motion=record)
