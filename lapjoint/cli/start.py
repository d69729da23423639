"""The way into the command ``lapjoint``: Ctrl-C ends it with one line and status 130, whatever is going on.

Python raises KeyboardInterrupt in the middle of whatever runs.  While modules are imported and functions compiled, that
may be inside code that makes another error of it, or that cannot raise anything.  So it is remembered that Ctrl-C was
pressed, and raised again where it was lost.  Only the standard library is imported before that is set up.
"""

from __future__ import annotations

import _thread
import os
import signal
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import FrameType, TracebackType

INTERRUPTED = 130
"""Exit status after Ctrl-C: 128 and the number of the signal, as shells have it."""


class _Interrupts:
    """Takes Ctrl-C, remembers that it was pressed, and has the last word on errors that nothing catches."""

    def __init__(self) -> None:
        self._pressed = False
        self._uncaught, self._unraisable = sys.excepthook, sys.unraisablehook
        sys.excepthook, sys.unraisablehook = self._end, self._raise_again
        signal.signal(signal.SIGINT, self._take)

    def _take(self, number: int, frame: FrameType | None) -> None:
        self._pressed = True
        raise KeyboardInterrupt

    def ended(self, status: object) -> None:
        """Take no more notice of Ctrl-C when the command has ended; raise what it swallowed."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if self._pressed and status != INTERRUPTED:
            raise KeyboardInterrupt

    def _raise_again(self, lost: sys.UnraisableHookArgs) -> None:
        """Where nothing can be raised, as in a destructor, raise it as soon as something can."""
        if isinstance(lost.exc_value, KeyboardInterrupt):
            _thread.start_new_thread(_interrupt_soon, ())
        elif not self._pressed:
            self._unraisable(lost)

    def _end(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        """End the process: after Ctrl-C every error is due to it."""
        if not self._pressed:
            self._uncaught(kind, error, trace)
            return
        print("lapjoint: interrupted", file=sys.stderr, flush=True)
        os._exit(INTERRUPTED)


def _interrupt_soon() -> None:
    """Interrupt the main thread when it has left the code in which the first interrupt was lost."""
    time.sleep(0.01)
    _thread.interrupt_main()


def main() -> None:
    """Run the command line; `lapjoint.cli.main` lists its exit statuses."""
    interrupts = _Interrupts()
    try:
        from lapjoint.cli.main import main as command
        from lapjoint.cli.progress import tell_of_delays

        tell_of_delays()
        command()
    except SystemExit as end:
        interrupts.ended(end.code)
        raise
