"""The way into the command ``lapjoint``: Ctrl-C ends it with one line and status 130, whatever is going on.

Python raises KeyboardInterrupt in the middle of any code.  While modules are imported and functions compiled, that code
may turn the exception into another error, or be unable to raise any.  Ctrl-C is therefore remembered, and raised again
where it was lost.  Only the standard library is imported before this is set up.
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
    """Takes Ctrl-C, remembers it, and handles errors that nothing catches."""

    def __init__(self) -> None:
        self._pressed = False
        self._uncaught, self._unraisable = sys.excepthook, sys.unraisablehook
        sys.excepthook, sys.unraisablehook = self._end, self._raise_again
        signal.signal(signal.SIGINT, self._take)

    def _take(self, number: int, frame: FrameType | None) -> None:
        self._pressed = True
        raise KeyboardInterrupt

    def ended(self, status: object) -> None:
        """Ignore Ctrl-C when the command has ended; raise one that the command swallowed."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        if self._pressed and status != INTERRUPTED:
            raise KeyboardInterrupt

    def _raise_again(self, lost: sys.UnraisableHookArgs) -> None:
        """Raise Ctrl-C again, soon, that was lost where nothing can be raised, as in a destructor."""
        if isinstance(lost.exc_value, KeyboardInterrupt):
            _thread.start_new_thread(_interrupt_soon, ())
        elif not self._pressed:
            self._unraisable(lost)

    def _end(self, kind: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        """End the process; after Ctrl-C every error is taken for its consequence."""
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
