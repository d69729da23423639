"""The processes that compute what a page asks, and the thread that hands their answers on.

Processes of the curve share its frequencies; one more process finds the cycle.  Each part has a newest question, and a
newer one ends the work on the one before.
"""

from __future__ import annotations

import multiprocessing
import os
import threading
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import wait
from typing import Any

from explore.answers import Answer, Failed, Part
from explore.question import Question
from explore.working import work
from lapjoint.machine.processes import interrupts_held

MOST_PROCESSES = 4
"""Most processes of the curve: the 401 points of the paper's joint take a second in two of them, and each takes some
200 MB."""
MOST_DEATHS = 3
"""Number of deaths of its processes after which a question is given up: one or two deaths may have other causes, such
as a lack of memory."""
Deliver = Callable[[Part, int, Answer], None]
"""Called with the part, the number of the question and an answer to it, in a thread of its own."""


class Computing:
    """Processes that answer the newest question of each part.

    Parameters
    ----------
    deliver : Deliver, optional
        Gets the answers to the newest questions; it can be set later.
    processes : int, optional
        Number of processes of the curve; by default one for each processor, at most `MOST_PROCESSES`.
    """

    def __init__(self, deliver: Deliver | None, processes: int | None = None) -> None:
        self.deliver = deliver
        shares = processes or min(MOST_PROCESSES, len(os.sched_getaffinity(0)))
        self._lock = threading.Lock()
        self._asked: dict[Part, _Asked] = {"curve": _Asked(), "cycle": _Asked()}
        self._crew = [_Process("curve", (i, shares)) for i in range(shares)] + [_Process("cycle", None)]
        self._closing, self._closed = multiprocessing.Pipe()
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def ask(self, part: Part, question: Question | None) -> int:
        """Ask for a part of a question, instead of the one before, and return its number; None asks nothing."""
        with self._lock:
            asked = self._asked[part] = _Asked(question, self._asked[part].number + 1)
            for process in self._crew:
                if process.part == part:
                    process.ask(asked)
            return asked.number

    def newest(self, part: Part) -> int:
        """The number of the newest question of a part."""
        return self._asked[part].number

    def rest(self) -> None:
        """Ask nothing, and deliver nothing, until there is another question."""
        self.deliver = None
        for part in self._asked:
            self.ask(part, None)

    def close(self) -> None:
        """End the processes; no answer is handed on afterwards."""
        self._closing.send(None)
        self._thread.join()
        for process in self._crew:
            process.end()

    @property
    def pids(self) -> list[int]:
        """The numbers of the processes."""
        return [process.process.pid or 0 for process in self._crew]

    def _listen(self) -> None:
        """Hand answers on, and replace processes that died, until `close`."""
        while True:
            ready = wait([self._closed, *(process.pipe for process in self._crew)])
            if self._closed in ready:
                return
            for i, process in enumerate(self._crew):
                if process.pipe in ready:
                    try:
                        number, answer = process.pipe.recv()
                    except (EOFError, OSError):
                        answer, number = self._replace(i)
                    deliver = self.deliver
                    if deliver is not None and answer is not None and number == self.newest(process.part):
                        deliver(process.part, number, answer)

    def _replace(self, i: int) -> tuple[Failed | None, int]:
        """Put another process in the place of one that died, and ask it the same, unless the question kills them."""
        with self._lock:
            dead = self._crew[i]
            dead.end()
            asked = self._asked[dead.part]
            asked.deaths += 1
            self._crew[i] = _Process(dead.part, dead.share)
            if asked.deaths < MOST_DEATHS:
                self._crew[i].ask(asked)
                return None, asked.number
        return Failed(f"the process that computes it died {asked.deaths} times"), asked.number


class _Asked:
    """A question with its number, and how often processes died of it."""

    def __init__(self, question: Question | None = None, number: int = 0) -> None:
        self.question, self.number, self.deaths = question, number, 0


class _Process:
    """A process that works on a part, and the pipe to it."""

    def __init__(self, part: Part, share: tuple[int, int] | None) -> None:
        self.part, self.share = part, share
        context = multiprocessing.get_context("spawn")
        self.pipe, there = context.Pipe()
        self.process: Any = context.Process(target=work, args=(there, share), daemon=True)
        with interrupts_held():
            self.process.start()
        there.close()

    def ask(self, asked: _Asked) -> None:
        """Send a question, or None; a process that is dead misses it, and is replaced when its death is noticed."""
        with suppress(OSError):
            self.pipe.send((asked.number, asked.question))

    def end(self) -> None:
        """End the process, whatever it is doing."""
        self.process.kill()
        self.process.join()
        self.pipe.close()
