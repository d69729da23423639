"""An append-only journal of work, from which the work resumes after Ctrl-C, a crash or a full disk.

A journal has lines of JSON.  The first line identifies the work.  Each other line holds the answers of a batch and, for
a chain, the section point at which the chain continues.  Each line ends in a checksum of the line and of the work's
identity: a line alone proves that it is whole, and to which work it belongs.  A line is on the disk before the next
batch is waited for.  Damaged lines are dropped with a warning, and their answers are computed again.  A lock on the
file keeps two processes from writing one journal; the system releases the lock however a process ends.
"""

from __future__ import annotations

import json
import os
import re
import secrets
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cached_property
from hashlib import sha256
from io import FileIO
from pathlib import Path
from typing import Any

from lapjoint.campaigns.dataset import FORMAT_VERSION, refusal
from lapjoint.campaigns.job import Answers, Job, Spec
from lapjoint.campaigns.point import PlainSection
from lapjoint.errors import DamageWarning, InputError, Interrupted, OutputError, SolverError
from lapjoint.files.writing import unwritable

BEGINNING = b'{"journal":'
"""First bytes of every journal."""
_OF_HEADER = ("journal", "fingerprint", "checksum")
"""Keys of the first line that are not of the work."""
_CHECKSUM = re.compile(rb',"checksum":"([0-9a-f]{16})"\}\n')
"""End of every line: 64 bits of a digest."""


def journal_path(out: str | Path) -> Path:
    """The path of the journal beside the file `out` of the finished work."""
    return Path(f"{out}.journal")


class Journal(Answers):
    """The answers of a job, and the locked journal beside the file `out`, which keeps them; with `force`, the journal
    of other work is thrown away.

    InputError is raised if another process has the journal, or it belongs to other work; OutputError, if it cannot be
    written.  DamageWarning tells of damaged lines, which are dropped.
    """

    def __init__(self, job: Job[Any, Any], out: str | Path, *, force: bool = False) -> None:
        super().__init__()
        self._job = job
        self.spec: Spec = job.spec
        self.path = journal_path(out)
        self._file = _open_locked(self.path)
        try:
            self._read(force)
        except BaseException:
            self._file.close()
            raise

    def append(self, points: Mapping[Any, Any], section: PlainSection | None = None) -> None:
        """Write answers, and the section point at which a chain continues after them: they are on the disk when this
        returns.

        OutputError is raised if they cannot be written; the lines written before are still good.
        """
        self._write(_sealed(self._job.line(points, section), self._owner))
        super().append(points, section)

    def close(self) -> None:
        """Release the journal to other processes; an empty one is removed."""
        if not self.points and not self._file.closed:
            self.path.unlink(missing_ok=True)
        self._file.close()

    def remove(self) -> None:
        """Remove the journal, when the file of the work is written."""
        self.path.unlink(missing_ok=True)
        self.close()

    @contextmanager
    def going(self) -> Iterator[None]:
        """A context for the work: an error that stops the work tells what is kept, and the journal is closed in the
        end.

        KeyboardInterrupt becomes Interrupted.
        """
        try:
            yield
        except (OutputError, SolverError) as error:
            raise type(error)(f"{error}; {self.kept()}") from None
        except KeyboardInterrupt:
            raise Interrupted(f"interrupted: {self.kept()}") from None
        finally:
            self.close()

    def kept(self) -> str:
        """A message for work that stops here; it is made from the file, because an interrupt can come at any moment."""
        self._load(force=False)
        if not self.points:
            return self.spec.nothing_kept
        return f"{self.spec.kept(len(self.points))} kept in {self.path}; the same command resumes"

    def _read(self, force: bool) -> None:
        """Take the content of the file into memory, and leave only whole lines in the file."""
        whole, damaged = self._load(force)
        if damaged:
            what = "1 line is damaged and dropped" if damaged == 1 else f"{damaged} lines are damaged and dropped"
            kept = f"{self.spec.kept(len(self.points))} whole, and the others are computed again"
            warnings.warn(f"{self.path}: {what}; {kept}", DamageWarning, stacklevel=2)
        if not self._file.seek(0, os.SEEK_END):
            self._write(self._header)
        elif damaged or not whole:
            self._replace(b"".join([self._header, *(raw for raw in whole if raw != self._header)]))

    @cached_property
    def _header(self) -> bytes:
        """The first line, which says which work this is."""
        return _sealed({"journal": FORMAT_VERSION, "fingerprint": self.spec.fingerprint, **self.spec.identity})

    @property
    def _owner(self) -> str:
        """The format and the work, which the checksums of all lines but the first cover, too."""
        return f"{FORMAT_VERSION} {self.spec.fingerprint}"

    def _load(self, force: bool) -> tuple[list[bytes], int]:
        """Take the content of the file into memory; returns its whole lines, and the number of damaged lines.

        A file without a whole line of this work is refused, unless it is empty or may be thrown away.
        """
        self._file.seek(0)
        lines = self._file.readall().splitlines(keepends=True)
        whole = [raw for raw in lines if raw == self._header or self._taken(raw)]
        if whole or not lines or self._cut_at_once(lines):
            return whole, len(lines) - len(whole)
        if not force:
            reason = self._difference(lines[0])
            raise InputError(f"{self.path}: {reason}; choose another --out, or throw it away with --force")
        return [], 0

    @staticmethod
    def _cut_at_once(lines: list[bytes]) -> bool:
        """Whether the first line was cut short, so that no point was kept."""
        return len(lines) == 1 and BEGINNING.startswith(lines[0][: len(BEGINNING)]) and not lines[0].endswith(b"\n")

    def _difference(self, first: bytes) -> str:
        """Why a file that begins with this line is not the journal of this work."""
        header = _parsed(first)
        if header is None or "fingerprint" not in header:
            return f"is there already, and is not a journal of a {self.spec.noun}"
        if "checksum" in header and _opened(first) is None:
            return f"is damaged, and nothing in it is known to be of this {self.spec.noun}"
        if refusal(header.get("journal")):
            return refusal(header.get("journal"))
        here, there = self.spec.identity, {key: header[key] for key in header if key not in _OF_HEADER}
        different = [key for key in here | there if there.get(key) != here.get(key)]
        return f"holds another {self.spec.noun}, not finished (it differs in {', '.join(different)})"

    def _taken(self, raw: bytes) -> bool:
        """Whether a later line is whole; if so, its content is taken into memory."""
        line = _opened(raw, self._owner)
        if line is not None:
            super().append(*self._job.from_line(line))
        return line is not None

    def _write(self, line: bytes) -> None:
        end = self._file.seek(0, os.SEEK_END)
        try:
            _write_all(self._file, line)
        except OSError as error:
            with suppress(OSError):
                self._file.truncate(end)
            raise unwritable(self.path, error) from None

    def _replace(self, content: bytes) -> None:
        """Put a new file in the place of the journal, whole and locked; until then the old one stays."""
        import fcntl

        draft = self.path.with_name(f".journal-{secrets.token_hex(8)}")
        try:
            file = FileIO(os.open(draft, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o666), "r+")
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                _write_all(file, content)
                os.replace(draft, self.path)
            except BaseException:
                file.close()
                draft.unlink(missing_ok=True)
                raise
        except OSError as error:
            raise unwritable(self.path, error) from None
        self._file.close()
        self._file = file


def _write_all(file: FileIO, content: bytes) -> None:
    """Write bytes, and wait until they are on the disk."""
    while content:
        content = content[file.write(content) :]
    os.fsync(file.fileno())


def _sealed(line: dict[str, Any], owner: str = "") -> bytes:
    """A line as the file holds it, with the checksum of its bytes and of the work to which it belongs."""
    body = json.dumps(line, separators=(",", ":")).encode()
    return body[:-1] + b',"checksum":"' + _checksum(body, owner) + b'"}\n'


def _checksum(body: bytes, owner: str) -> bytes:
    return sha256(owner.encode() + body).hexdigest()[:16].encode()


def _opened(raw: bytes, owner: str = "") -> dict[str, Any] | None:
    """The content of a line made by `_sealed`; None if it is damaged, or has another owner."""
    end = _CHECKSUM.search(raw)
    if end is None or end.end() < len(raw):
        return None
    body = raw[: end.start()] + b"}"
    return json.loads(body) if _checksum(body, owner) == end[1] else None


def _parsed(raw: bytes) -> dict[str, Any] | None:
    """The content of a first line, whatever its checksum, for the message that refuses it; None if it is no JSON
    object."""
    try:
        line = json.loads(raw)
    except (ValueError, RecursionError):
        return None
    return line if isinstance(line, dict) else None


def _open_locked(path: Path) -> FileIO:
    """The file, made if it is not there, and locked; a link of that name is refused, not followed."""
    import fcntl

    while True:
        try:
            file = FileIO(os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666), "r+")
        except OSError as error:
            raise unwritable(path, error) from None
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            file.close()
            taken = isinstance(error, BlockingIOError)
            reason = "another process is at work on it; wait for that, or end it" if taken else error.strerror
            raise InputError(f"{path}: cannot be locked: {reason}") from None
        if _is_at(file.fileno(), path):
            return file
        file.close()  # the other process has finished and removed it in between


def _is_at(descriptor: int, path: Path) -> bool:
    try:
        return os.path.samestat(os.fstat(descriptor), os.stat(path))
    except FileNotFoundError:
        return False
