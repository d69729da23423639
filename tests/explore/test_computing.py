"""The processes that compute: what they answer, and what happens when the question changes or a process dies."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from explore.answers import Answer, Compared, CurvePart, CycleFound, Failed, Part
from explore.computing import MOST_DEATHS, Computing
from explore.editing import typed
from explore.question import Question, opened
from lapjoint import Axis, paper_joint, sweep
from lapjoint.campaigns.grid import FREQUENCY
from lapjoint.problem.files import problem_tables
from lapjoint.solver import make_solver
from lapjoint.summaries.blocks import steady_blocks

pytestmark = pytest.mark.thorough
PATIENCE = 120.0  # s; the first answer may wait for a compilation


class Listener:
    """Keeps what is delivered, and waits for it."""

    def __init__(self) -> None:
        self.heard: list[tuple[Part, int, Answer]] = []
        self._changed = threading.Condition()

    def __call__(self, part: Part, number: int, answer: Answer) -> None:
        with self._changed:
            self.heard.append((part, number, answer))
            self._changed.notify_all()

    def until(self, enough: Callable[[], bool]) -> None:
        """Wait until something is true of what was heard."""
        with self._changed:
            assert self._changed.wait_for(enough, PATIENCE)

    def points(self, number: int) -> dict[int, object]:
        """The points of a curve that were heard."""
        found: dict[int, object] = {}
        for part, of, answer in self.heard:
            if part == "curve" and of == number and isinstance(answer, CurvePart):
                found |= answer.points
        return found

    def of(self, number: int, kind: type[Answer]) -> list[Answer]:
        """The answers of a kind about a cycle that were heard."""
        return [answer for part, of, answer in self.heard if (part, of) == ("cycle", number) and type(answer) is kind]


@pytest.fixture(scope="module")
def shared() -> Iterator[tuple[Computing, Listener]]:
    """Processes for the tests that do not harm them."""
    listener = Listener()
    computing = Computing(listener, 2)
    yield computing, listener
    computing.close()


def paper(gap: float = 1e-3) -> Question:
    """The question about the paper's joint with another gap of one stop."""
    return opened(typed(problem_tables(paper_joint()), "stops.0.gap", repr(gap)))


def test_the_curve_is_that_of_a_sweep_to_the_bit(shared: tuple[Computing, Listener]) -> None:
    computing, listener = shared
    asked = paper(1.1e-3)
    number = computing.ask("curve", asked)
    axis = asked.plan(asked.made()).grid.axes[0]
    listener.until(lambda: len(listener.points(number)) == len(axis.values))
    some = [0, 57, 200, 333, 400]
    found = sweep(asked.made(), [Axis(FREQUENCY, [axis.values[i] for i in some])])
    points = listener.points(number)
    assert np.array_equal([points[i].impulses for i in some], found.impulse.values)


def test_the_cycle_is_that_of_the_steady_state_to_the_bit(shared: tuple[Computing, Listener]) -> None:
    computing, listener = shared
    asked = paper(1.2e-3)
    number = computing.ask("cycle", asked)
    listener.until(lambda: bool(listener.of(number, Compared)))
    for answer in listener.of(number, CycleFound):
        assert isinstance(answer, CycleFound)
        found = make_solver(answer.solver).steady_state(asked.made())
        assert answer.cycle.blocks == tuple(steady_blocks(found))
        assert answer.cycle.multipliers == tuple(map(complex, found.multipliers))
    (compared,) = listener.of(number, Compared)
    assert isinstance(compared, Compared)
    assert compared.result.verdict.value == "agree"


def test_no_answer_to_an_older_question_comes_after_a_newer_one_is_asked(shared: tuple[Computing, Listener]) -> None:
    computing, listener = shared
    draw, newest = random.Random(51), 0
    listener.heard.clear()
    for _ in range(30):
        newest = computing.ask("curve", paper(draw.uniform(5e-4, 3e-3)))
        before = len(listener.heard)
        time.sleep(draw.uniform(0.0, 0.1))
        late = [number for part, number, _ in listener.heard[before + 1 :] if part == "curve" and number < newest]
        assert not late  # the first one may have been on its way
    listener.until(lambda: len(listener.points(newest)) == 401)


def test_a_question_without_an_answer_gets_the_message_of_the_command_line(shared: tuple[Computing, Listener]) -> None:
    computing, listener = shared
    still = replace(paper(), problem=paper().problem.replace("amplitude = 0.06", "amplitude = 0.0"))
    number = computing.ask("cycle", still)
    listener.until(lambda: bool(listener.of(number, Failed)))
    assert "there is neither a base_motion" in listener.of(number, Failed)[0].message


def test_a_process_that_dies_is_replaced_and_the_question_answered() -> None:
    listener = Listener()
    computing = Computing(listener, 1)
    try:
        number = computing.ask("curve", paper())
        listener.until(lambda: bool(listener.points(number)))
        os.kill(computing.pids[0], signal.SIGKILL)
        listener.until(lambda: len(listener.points(number)) == 401)
        killed = 0
        number = computing.ask("cycle", paper())
        while not listener.of(number, Failed):
            if killed < MOST_DEATHS:
                os.kill(computing.pids[1], signal.SIGKILL)
                killed += 1
            time.sleep(0.5)
        assert f"died {MOST_DEATHS} times" in listener.of(number, Failed)[0].message
    finally:
        computing.close()


def test_the_processes_end_with_the_program() -> None:
    script = (
        "import sys, time\nfrom explore.computing import Computing\n"
        "if __name__ == '__main__':\n"
        "    computing = Computing(lambda *answer: None, 2)\n"
        "    print(*computing.pids, flush=True)\n    time.sleep(60)"
    )
    with subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        pids = [int(pid) for pid in program.stdout.readline().split()]
        program.kill()
    assert len(pids) == 3
    end = time.monotonic() + PATIENCE
    while any(os.path.exists(f"/proc/{pid}") for pid in pids):
        assert time.monotonic() < end, "a process outlived the program"
        time.sleep(0.1)
