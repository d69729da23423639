"""A file that is written is replaced whole or not at all, whatever goes wrong and whoever writes at the same time."""

from __future__ import annotations

import errno
import os
import stat
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from lapjoint.errors import OutputError
from lapjoint.files.writing import completed, write_file

WRITER = """
import sys
from lapjoint.files.writing import write_file
for _ in range(50):
    write_file(sys.argv[1], sys.argv[2] * 100_000)
"""


def files_in(folder: Path) -> dict[str, bytes]:
    """All files of a folder, hidden ones too, with their content."""
    return {each.name: each.read_bytes() for each in folder.iterdir()}


@pytest.mark.parametrize("content", ["line\nµ\n", b"\x00\xff", b""])
def test_text_and_bytes_are_written_as_they_are(tmp_path: Path, content: str | bytes) -> None:
    write_file(tmp_path / "a.txt", "before")
    write_file(tmp_path / "a.txt", content)
    assert files_in(tmp_path) == {"a.txt": content.encode() if isinstance(content, str) else content}


@pytest.mark.parametrize("before", [{}, {"a.txt": b"before"}])
@pytest.mark.parametrize("failure", [KeyboardInterrupt, ValueError, OSError(errno.ENOSPC, "No space left on device")])
def test_a_write_that_fails_half_way_leaves_what_was_there(
    tmp_path: Path, before: dict[str, bytes], failure: BaseException | type[BaseException]
) -> None:
    for name, content in before.items():
        (tmp_path / name).write_bytes(content)

    def write_half() -> None:
        with completed(tmp_path / "a.txt") as unfinished:
            unfinished.write_bytes(b"half")
            raise failure

    with pytest.raises(failure if isinstance(failure, type) else type(failure)):
        write_half()
    assert files_in(tmp_path) == before


@pytest.mark.parametrize("broken", ["fsync", "replace", "chmod"])
@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EPERM])
def test_what_the_system_refuses_is_said_in_its_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, broken: str, number: int
) -> None:
    (tmp_path / "a.txt").write_text("before")

    def fail(*_: object) -> None:
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(os, broken, fail)
    with pytest.raises(OutputError, match=f"a\\.txt: cannot be written: {os.strerror(number)}"):
        write_file(tmp_path / "a.txt", "after")
    assert files_in(tmp_path) == {"a.txt": b"before"}


@pytest.mark.parametrize("name", [".", "no/a.txt", "a\0b", "x" * 300])
def test_a_name_that_cannot_be_is_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(OutputError, match="cannot be written"):
        write_file(f"{tmp_path}/{name}", "")
    assert files_in(tmp_path) == {}


def test_a_long_name_is_written(tmp_path: Path) -> None:
    write_file(tmp_path / f"{'µ' * 120}.txt", "all")
    assert files_in(tmp_path) == {f"{'µ' * 120}.txt": b"all"}


def test_the_temporary_file_has_a_name_that_nobody_can_foretell_and_the_ending_asked_for(tmp_path: Path) -> None:
    names = set()
    for _ in range(20):
        with completed(tmp_path / "a.png") as unfinished:
            names.add(unfinished.name)
    assert len(names) == 20
    assert {Path(name).suffix for name in names} == {".png"}


def test_no_link_is_followed_to_the_temporary_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Names that could be foretold, those of former versions among them, and even the right one."""
    (tmp_path / "victim").write_text("mine")
    monkeypatch.setattr("secrets.token_hex", lambda _: "guessed")
    for name in (".a.txt.part", "a.txt.part", ".a.unfinished.txt", "a.txt.tmp", ".a-guessed.txt"):
        (tmp_path / name).symlink_to(tmp_path / "victim")
    with pytest.raises(OutputError, match="cannot be written: File exists"):
        write_file(tmp_path / "a.txt", "all")
    monkeypatch.undo()
    write_file(tmp_path / "a.txt", "all")
    assert (tmp_path / "victim").read_text() == "mine"
    assert (tmp_path / "a.txt").read_text() == "all"


def test_a_target_that_is_a_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "folder").mkdir()
    (tmp_path / "a.txt").symlink_to(tmp_path / "folder" / "real.txt")
    for content in ("first", "second"):  # the file pointed to is not there at first
        write_file(tmp_path / "a.txt", content)
        assert (tmp_path / "a.txt").is_symlink()
        assert files_in(tmp_path / "folder") == {"real.txt": content.encode()}


def test_rights_are_those_of_the_file_replaced_or_of_any_new_file(tmp_path: Path) -> None:
    (tmp_path / "plain").touch()
    write_file(tmp_path / "new", "")
    assert (tmp_path / "new").stat().st_mode == (tmp_path / "plain").stat().st_mode
    (tmp_path / "new").chmod(0o640)
    write_file(tmp_path / "new", "again")
    assert stat.S_IMODE((tmp_path / "new").stat().st_mode) == 0o640


def test_a_file_that_may_not_be_written_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.txt").write_text("before")
    monkeypatch.setattr(os, "access", lambda *_: False)  # as for everyone but root
    with pytest.raises(OutputError, match="Permission denied"):
        write_file(tmp_path / "a.txt", "after")
    assert files_in(tmp_path) == {"a.txt": b"before"}


def test_a_pipe_is_written_to_and_not_replaced(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    read: list[bytes] = []
    reader = threading.Thread(target=lambda: read.append((tmp_path / "pipe").read_bytes()))
    reader.start()
    write_file(tmp_path / "pipe", "all")
    reader.join(30)
    assert read == [b"all"]
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


def test_six_writers_at_once_all_succeed(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    command = [sys.executable, "-c", WRITER, str(path)]
    writers = [subprocess.Popen([*command, letter]) for letter in "abcdef"]
    while any(writer.poll() is None for writer in writers):
        if path.exists():
            content = path.read_text()
            assert content == content[0] * 100_000
    assert [writer.returncode for writer in writers] == [0] * 6
    assert list(files_in(tmp_path)) == ["a.txt"]
