"""The work of one process: it answers the newest question that it was sent, and leaves an older one at once."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from functools import partial
from multiprocessing.connection import Connection

from explore.answers import Answer, Failed
from explore.question import Question
from lapjoint.errors import InputError, SolverError
from lapjoint.machine.one_thread import each_in_one_thread
from lapjoint.machine.processes import end_with_parent
from lapjoint.solver import Progress

_BEHIND = 15
"""By how much the cycle gives way to the curve, as ``nice`` counts: the curve is looked at first."""
_AFTER = 0.3
"""Time for which the cycle lets the curve go first, s: the first curve takes about as long, and who turns a slider asks
for another cycle meanwhile."""


class _SupersededError(Exception):
    """A newer question waits."""


def work(pipe: Connection, share: tuple[int, int] | None) -> None:
    """Answer questions that come through a pipe, until the parent ends.

    A question comes with its number, and each answer goes back with that number.  `share` is which of how many parts
    of the curve this process finds; None for the cycle.
    """
    end_with_parent()
    answers: Callable[[Question, Progress], Iterator[Answer]]
    if share is None:
        os.nice(_BEHIND)
        from explore.cycle import cycle_answers as answers  # imports both solvers and the validation
    else:
        from explore.curve import curve_answers

        answers = partial(curve_answers, share=share)

    def look(done: float, total: float) -> None:
        """Called by solvers now and then: leave the work if a newer question waits."""
        if pipe.poll():
            raise _SupersededError

    while True:
        number, question = pipe.recv()
        if question is None:
            continue
        try:
            if pipe.poll(_AFTER if share is None else 0.0):
                continue
            for answer in each_in_one_thread(answers(question, look)):
                pipe.send((number, answer))
        except _SupersededError:
            continue
        except (InputError, SolverError) as error:
            pipe.send((number, Failed(str(error))))
