"""Memory that a solver is going to take: logged if it is much, and refused if it is too much.

The system ends a process that takes more memory than there is, without a message.  A solver knows the sizes of its
tables and of its record of a motion before it makes them, and calls `require` first.
"""

from __future__ import annotations

import logging
import math
import os
from contextlib import suppress
from functools import cache
from pathlib import Path

from lapjoint.errors import SolverError

LOGGER = logging.getLogger(__name__)
WORTH_SAYING = 500_000_000
"""Memory from which on a size is logged, bytes: as much as the largest export without --large."""
SHARE = 0.25
"""Largest fraction of the machine's memory that one motion may take.  The error estimate solves again with 1.5 times as
many modes, which takes 2.25 times the memory; both together take 0.25 x 3.25 = 0.81 of the machine's."""
_UNKNOWN = 8e9
"""Memory that is assumed where the machine does not state its memory, bytes: that of a usual machine."""
_CONTAINER = Path("/sys/fs/cgroup/memory.max")


@cache
def machine_bytes() -> float:
    """The memory of this machine, or of the container that the process is in, bytes."""
    found = _UNKNOWN
    with suppress(AttributeError, ValueError, OSError):
        found = float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    with suppress(ValueError, OSError):
        found = min(found, float(_CONTAINER.read_text()))
    return found


def require(size: float, what: str, remedy: str, before: float = 0.0) -> None:
    """Log that `what` takes `size` bytes, if that is much; above `SHARE` of the machine's memory, refuse it with a
    `remedy`.

    `what` is a plural noun phrase that says what decides the size.  A size is logged again only when it has doubled
    since `before`, the previous size.
    """
    most = SHARE * machine_bytes()
    if size > most:
        raise SolverError(
            f"{what} take {_text(size)} of memory; allowed are {_text(most)}, {SHARE:.0%} of what this machine has: "
            f"{remedy}"
        )
    if _doublings(size) > _doublings(before):
        LOGGER.info(f"{what} take {_text(size)} of memory, of {_text(most)} that are allowed")


def _text(size: float) -> str:
    return f"{size / 1e9:.2g} GB" if size >= 1e9 else f"{size / 1e6:.3g} MB"


def _doublings(size: float) -> int:
    """How often `WORTH_SAYING` has been reached and doubled."""
    return math.floor(math.log2(size / WORTH_SAYING)) + 1 if size >= WORTH_SAYING else 0
