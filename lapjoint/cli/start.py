"""Entry point of the command ``lapjoint``: Ctrl-C ends it at any time, with one line and status 130.

Python raises KeyboardInterrupt in the middle of any code.  Code that imports modules or compiles functions may turn
this exception into another error, or lose it.  Ctrl-C is therefore remembered, and raised again if it was lost.  Only
the standard library is imported before the handlers are installed.
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
"""Exit status after Ctrl-C: 128 plus the number of the signal, as shells define it."""


class _Interrupts:
    """Handlers of Ctrl-C, which is remembered, and of errors that no code catches."""

    def __init__(self) -> None:
        self._pressed = False
        self._uncaught, self._unraisable = sys.excepthook, sys.unraisablehook
        sys.excepthook, sys.unraisablehook = self._end, self._raise_again
        signal.signal(signal.SIGINT, self._take)

    def _take(self, number: int, frame: FrameType | None) -> None:
        self._pressed = True
        raise KeyboardInterrupt

    def ended(self, status: object) -> None:
        """Ignore Ctrl-C from now on, as the command has ended; raise one that the command lost."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if self._pressed and status != INTERRUPTED:
            raise KeyboardInterrupt

    def _raise_again(self, lost: sys.UnraisableHookArgs) -> None:
        """Raise Ctrl-C again a moment later, if it was lost where no exception can be raised, e.g. in a destructor."""
        if isinstance(lost.exc_value, KeyboardInterrupt):
            _thread.start_new_thread(_interrupt_soon, ())
        elif not self._pressed:
            self._unraisable(lost)

    def _end(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        """End the process; any error after Ctrl-C counts as a consequence of Ctrl-C, and is not shown."""
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
