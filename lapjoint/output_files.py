"""How files are written: as they are, or under their names only when they are complete."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from lapjoint.errors import InputError


@contextmanager
def completed(path: str | Path) -> Iterator[Path]:
    """Give a path beside `path`, with its ending, to write to; what stands there then takes the name `path`.

    Until then, and if the block raises, a file of that name stays as it is, and nothing else is left.  A link is
    followed, not replaced.
    """
    target = Path(os.path.realpath(path))
    unfinished = target.with_name(f".{target.stem}.unfinished{target.suffix}")
    try:
        yield unfinished
        os.replace(unfinished, target)
    finally:
        with suppress(OSError):
            unfinished.unlink()


def write_text(path: str | Path, text: str) -> None:
    """Write UTF-8 text with the line ends as they are.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    try:
        Path(path).write_bytes(text.encode())
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else str(error)
        raise InputError(f"{path}: cannot be written: {reason}") from None
