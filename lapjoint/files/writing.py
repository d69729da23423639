"""Files that are replaced whole or not at all.

Content goes to a temporary file with a random name in the folder of its target, which takes the target's name when it
is complete and on the disk.  After Ctrl-C, an error or a full disk the target is unchanged, and the temporary file is
gone. Several processes may write one target at once; the last to finish wins.
"""

from __future__ import annotations

import errno
import os
import secrets
import shutil
import stat
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lapjoint.errors import OutputError

_LONGEST_STEM = 40
"""Most characters of the target's name in the name of its temporary file: with up to four bytes a character, and the
random part, the name stays below the limit of 255 bytes."""
_NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_NOFOLLOW", 0)
"""Flags that open a file only if nothing has its name, not even a link."""


def write_file(path: str | Path, content: str | bytes | memoryview) -> None:
    """Write bytes, or text as UTF-8 with its line ends as they are; see `completed` for links and devices."""
    try:
        raw = content.encode() if isinstance(content, str) else content
        with completed(path) as unfinished, open(unfinished, "wb") as file:
            file.write(raw)
    except (OSError, ValueError) as error:
        raise unwritable(path, error) from None


@contextmanager
def completed(path: str | Path) -> Iterator[Path]:
    """Yield an empty temporary file with the ending of its target; when it is written, it is renamed to the target.

    A target that is a link is replaced where the link points to; a device or a pipe is written to when the content is
    complete.  The temporary file is made without following a link.  A new file gets the default rights; a replaced file
    keeps its rights.  `unwritable` puts an `OSError` into words.
    """
    mode = _mode_of(path)
    if mode is not None and not stat.S_ISREG(mode):
        with _sent_to(path) as unfinished:
            yield unfinished
        return
    target = Path(os.path.realpath(path))
    if mode is not None and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
    unfinished = target.with_name(f".{target.stem[:_LONGEST_STEM]}-{secrets.token_hex(8)}{target.suffix}")
    try:
        os.close(os.open(unfinished, _NEW_FILE, 0o666))
        yield unfinished
        if mode is not None:
            os.chmod(unfinished, stat.S_IMODE(mode))
        _bring_to_disk(unfinished)
        os.replace(unfinished, target)
    finally:
        with suppress(OSError, ValueError):
            unfinished.unlink()
    with suppress(OSError):  # not every file system lets a folder be brought to the disk
        _bring_to_disk(target.parent)


@contextmanager
def completed_series(folder: Path, remove_earlier: Callable[[], object]) -> Iterator[Path]:
    """Give an empty temporary folder within `folder` to write the files of a series to; then they move to `folder`.

    Files in a subfolder move first, so that an index beside it never lists a file that is missing. `remove_earlier`
    removes the files of an earlier series; it is called when the new series is complete.
    """
    with tempfile.TemporaryDirectory(prefix=".unfinished-", dir=folder) as name:
        draft = Path(name)
        yield draft
        files = [file.relative_to(draft) for file in draft.rglob("*") if file.is_file()]
        for file in files:
            _check_place(folder / file, folder)
            _bring_to_disk(draft / file)
        remove_earlier()
        for file in sorted(files, key=lambda file: (-len(file.parts), file)):
            (folder / file).parent.mkdir(exist_ok=True)
            os.replace(draft / file, folder / file)


def _check_place(path: Path, folder: Path) -> None:
    """Refuse, before anything is removed, to move a file onto a directory, or into a path that is no directory."""
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    above = path.parent
    if above != folder and (above.is_symlink() or above.exists()) and not above.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, os.strerror(errno.ENOTDIR), str(above))


def unwritable(path: str | Path, error: OSError | ValueError) -> OutputError:
    """The error to raise where a file cannot be written: it names the file, and says why."""
    reason = error.strerror if isinstance(error, OSError) and error.strerror else error
    if isinstance(error, UnicodeEncodeError):
        reason = "its name, or a text in it, has characters that UTF-8 does not hold"
    return OutputError(f"{path}: cannot be written: {reason}")


def _mode_of(path: str | Path) -> int | None:
    """Kind and rights of the file that is there, links followed; None where there is none."""
    try:
        return os.stat(path).st_mode
    except FileNotFoundError:
        return None


@contextmanager
def _sent_to(path: str | Path) -> Iterator[Path]:
    """A device or a pipe cannot be replaced: its content is collected first, and then sent there."""
    if Path(path).is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    with tempfile.TemporaryDirectory(prefix="lapjoint-") as folder:
        collected = Path(folder) / f"content{Path(path).suffix}"
        collected.touch()
        yield collected
        with open(collected, "rb") as file, open(path, "wb") as there:
            shutil.copyfileobj(file, there)


def _bring_to_disk(path: Path) -> None:
    """Wait until a file or a folder is on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
