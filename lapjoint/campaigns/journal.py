"""An append-only journal of a sweep, from which it resumes after Ctrl-C, a crash or a full disk.

A journal has lines of JSON.  The first says which sweep this is.  Each other line holds the points of a batch and, for
a chain, the section point from which it goes on.  A line is on the disk before the next batch is waited for, and a line
that was cut short is dropped.  A lock on the file keeps two processes from writing the same journal; the system
releases it however a process ends.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from contextlib import suppress
from io import FileIO
from pathlib import Path
from typing import Any

from lapjoint.campaigns.format_version import FORMAT_VERSION, refusal
from lapjoint.campaigns.plan import Plan
from lapjoint.campaigns.point import Point
from lapjoint.errors import InputError, OutputError

BEGINNING = b'{"journal":'
"""First bytes of every journal."""


def journal_path(out: str | Path) -> Path:
    """The path of the journal, which lies beside the file of the sweep.

    Parameters
    ----------
    out : str or Path
        The file that the sweep writes when it is done.

    Returns
    -------
    Path
        The path of the journal: that of the file, followed by ``.journal``.
    """
    return Path(f"{out}.journal")


class Journal:
    """The locked journal beside `out`, and the points that it holds.

    Parameters
    ----------
    plan : Plan
        The sweep.
    out : str or Path
        The file that the sweep writes when it is done.
    force : bool
        Whether the journal of another sweep may be thrown away.

    Raises
    ------
    InputError
        If another process has the journal, it belongs to another sweep, or it cannot be opened.
    OutputError
        If the journal cannot be written.
    """

    def __init__(self, plan: Plan, out: str | Path, *, force: bool = False) -> None:
        self.plan = plan
        self.path = journal_path(out)
        self.points: dict[int, Point] = {}
        self.sections: dict[int, dict[str, Any] | None] = {}
        """Section point from which a chain goes on, by the last cell of each batch; None where there is no chain."""
        self._file = _open_locked(self.path)
        try:
            self._read(force)
        except BaseException:
            self._file.close()
            raise

    def append(self, points: Mapping[int, Point], section: dict[str, Any] | None = None) -> None:
        """Keep points: they are on the disk when this returns.

        Parameters
        ----------
        points : mapping of int to Point
            What was found, by the number of the cell.
        section : dict of str to Any, optional
            Section point from which the chain goes on after the last of these cells, as `plain_section` gives it.

        Raises
        ------
        OutputError
            If they cannot be written; what the journal held before is still good.
        """
        line: dict[str, Any] = {"cells": list(points), "points": [vars(point) for point in points.values()]}
        if section is not None:
            line["section"] = section
        self._write(line)
        self._take(line)

    def close(self) -> None:
        """Release the journal to other processes; an empty one is removed."""
        if not self.points and not self._file.closed:
            self.path.unlink(missing_ok=True)
        self._file.close()

    def remove(self) -> None:
        """Remove the journal, when the file of the sweep is written."""
        self.path.unlink(missing_ok=True)
        self.close()

    def kept(self) -> str:
        """A message for a sweep that stops here: it reads the file, because an interrupt can come at any moment."""
        self._load(force=False)
        if not self.points:
            return f"none of {self.plan.size} points was done"
        return f"{len(self.points)} of {self.plan.size} points are kept in {self.path}; the same command resumes"

    def _read(self, force: bool) -> None:
        """Read the journal, and cut off what cannot be read."""
        good = self._load(force)
        self._file.seek(good)
        self._file.truncate()
        if good == 0:
            self._write({"journal": FORMAT_VERSION, "fingerprint": self.plan.fingerprint, **self.plan.identity})

    def _load(self, force: bool) -> int:
        """Take the points in the file; returns the number of bytes that are good."""
        good = 0
        self._file.seek(0)
        for number, raw in enumerate(self._file.readall().splitlines(keepends=True)):
            if not (self._taken(raw) if number else self._mine(raw, force)):
                break
            good += len(raw)
        return good

    def _mine(self, raw: bytes, force: bool) -> bool:
        """Whether a first line belongs to this sweep; that of another sweep is thrown away only if `force` says so."""
        header = _parsed(raw)
        if header is None and BEGINNING.startswith(raw[: len(BEGINNING)]):
            return False  # cut short, before any point was kept
        if header is not None and self._same_format(header) and header.get("fingerprint") == self.plan.fingerprint:
            return True
        if not force:
            raise InputError(
                f"{self.path}: {self._difference(header)}; choose another --out, or throw it away with --force"
            )
        return False

    def _difference(self, header: dict[str, Any] | None) -> str:
        if header is None or "fingerprint" not in header:
            return "is there already, and is not a journal of a sweep"
        if not self._same_format(header):
            return refusal(header.get("journal"))
        different = [key for key, value in self.plan.identity.items() if header.get(key) != value]
        return f"holds another sweep, not finished (it differs in {', '.join(different)})"

    @staticmethod
    def _same_format(header: dict[str, Any]) -> bool:
        return not refusal(header.get("journal"))

    def _taken(self, raw: bytes) -> bool:
        """Whether a later line could be read."""
        line = _parsed(raw)
        try:
            if line is not None:
                self._take(line)
        except (KeyError, TypeError, IndexError, ValueError):
            return False
        return line is not None

    def _take(self, line: dict[str, Any]) -> None:
        cells = line["cells"]
        self.points.update({cell: Point(**fields) for cell, fields in zip(cells, line["points"], strict=True)})
        self.sections[cells[-1]] = line.get("section")

    def _write(self, line: dict[str, Any]) -> None:
        end = self._file.tell()
        try:
            left = json.dumps(line, separators=(",", ":")).encode() + b"\n"
            while left:
                left = left[self._file.write(left) :]
            os.fsync(self._file.fileno())
        except OSError as error:
            with suppress(OSError):
                self._file.truncate(end)
            raise OutputError(f"{self.path}: cannot be written: {error.strerror or error}") from None


def _parsed(raw: bytes) -> dict[str, Any] | None:
    """A line, or None if it is cut short or damaged."""
    if not raw.endswith(b"\n"):
        return None
    try:
        line = json.loads(raw)
    except ValueError:
        return None
    return line if isinstance(line, dict) else None


def _open_locked(path: Path) -> FileIO:
    """The file, made if it is not there, and locked; a link of that name is refused, not followed."""
    import fcntl

    while True:
        try:
            file = FileIO(os.open(path, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW, 0o666), "r+")
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}") from None
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
