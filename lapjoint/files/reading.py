"""Reading of files that a user names: a problem, a dataset, a record.

Pipes are read, too, as shells make one of `<(command)`.  A pipe or a device may have no end, as `/dev/zero`, and would
fill the memory; it is read up to a limit.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from lapjoint.errors import InputError

MOST_FROM_PIPES = 100_000_000
"""Most bytes from a pipe or a device: as many as in the problem file of a million stops."""


def read_file(path: str | Path, name: str = "") -> bytes:
    """Everything that a file, a pipe or a device holds; messages call it `name`, by default its path.

    An `InputError` says that it cannot be read, or that a pipe or a device gives more than `MOST_FROM_PIPES` bytes.
    """
    name = name or str(path)
    try:
        with open(path, "rb") as file:
            if stat.S_ISREG(os.fstat(file.fileno()).st_mode):
                return file.read()
            raw = file.read(MOST_FROM_PIPES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{name}: cannot be read: {reason}") from None
    if len(raw) > MOST_FROM_PIPES:
        raise InputError(f"{name}: is no file, and gives more than {MOST_FROM_PIPES // 10**6} MB; it may have no end")
    return raw
