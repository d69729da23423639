"""A solver for tests of sweeps: answers by formula, takes its time, writes down what it was asked, and dies if told.

It is found by worker processes too, where its package is on their path; see `installed`.  What does not change its
answers is in the environment: the file COUNTING_LOG, and the time that an answer takes, COUNTING_SECONDS.
"""

from __future__ import annotations

import json
import os
import shutil
import struct
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import numpy as np

from lapjoint import FREE, ContactState, History, Outcome, Problem, SteadyState
from lapjoint.answers import Contact, Modes, SectionPoint
from lapjoint.answers.steady_state import Acceptance
from lapjoint.errors import InputError, SolverError
from lapjoint.solver import MODES, Progress

ROOT = Path(__file__).resolve().parents[2]


def installed(folder: Path) -> str:
    """Put this solver into a folder as a package with an entry point; returns a PYTHONPATH with it."""
    shutil.copy(__file__, folder / "counting_solver.py")
    about = folder / "counting_solver-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: counting-solver\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[lapjoint.solvers]\ncounting = counting_solver:Counting\n")
    return os.pathsep.join([str(folder), str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])


def asked(log: Path) -> list[tuple[float, float | None]]:
    """What a solver was asked, in order: the frequency, and the mark of the section point it was to start from."""
    return [tuple(json.loads(line)) for line in log.read_text().splitlines()] if log.exists() else []


def field(x: np.ndarray, t: np.ndarray, dx: int = 0, dt: int = 0) -> np.ndarray:
    return np.zeros((x.size, t.size))


@dataclass(frozen=True)
class Counting:
    fails_at: float = -1.0
    """Frequency at which it gives up."""
    refuses_at: float = -1.0
    """Frequency at which it says that the problem is not valid."""
    dies_at: float = -1.0
    """Frequency at which its process dies, always; or once, if the file `died` can be made."""
    died: str = ""
    tears: bool = False
    """Whether a process dies while it sends an answer: its pool then waits for the rest, the others to send theirs."""

    @property
    def name(self) -> str:
        return "counting"

    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        def shapes(x: np.ndarray, derivative: int = 0) -> np.ndarray:
            return np.stack([1 - np.cos((n + 1) * x) for n in range(count)])

        return Modes(state, np.arange(1.0, count + 1), shapes)

    def simulate(
        self, problem: Problem, duration: float, *, errors: bool = True, progress: Progress | None = None
    ) -> History:
        raise NotImplementedError

    def refined(self, factor: float) -> Counting:
        return self

    def steady_state(
        self,
        problem: Problem,
        *,
        start: SectionPoint | None = None,
        sensitivity: bool = True,
        errors: bool = True,
        progress: Progress | None = None,
    ) -> SteadyState:
        omega = problem.excitation_frequency
        assert omega is not None
        mark = None if start is None else float(start.coordinates[0, 0])
        self._note(omega, mark)
        time.sleep(float(os.environ.get("COUNTING_SECONDS", "0")))
        self._stumble(omega)
        past = 0.0 if mark is None else mark
        tip = float(problem.initial.displacement_at(np.array(problem.beam.length)))
        impulses = np.array([omega * (k + 1) + 1e5 * tip + past / 3 for k in range(len(problem.stops))])
        contacts = tuple(Contact(k, 0.1 * k, 0.1 * k + 0.05, j, 10 * j) for k, j in enumerate(impulses))
        section = SectionPoint(ContactState((0,)), np.array([[omega / 3 + past / 7, 0.1], [-0.0, 1e-300]]))
        contacts = contacts[: int(omega) % (len(impulses) + 1)]
        history = History(problem, self.name, 0.0, 1.0, np.zeros(0), (FREE,), contacts, field)
        multipliers = np.array([-0.3 - 0.4j, -0.3 + 0.4j])
        acceptance = Acceptance(section, 8, growth=omega if sensitivity else None)
        found = Outcome.PERIODIC, 1, False, 1e-9, multipliers, None, section, history, impulses, acceptance
        return SteadyState(problem, self.name, *found, impulse_errors=impulses / 1e3 if errors else None)

    def _note(self, omega: float, mark: float | None) -> None:
        if "COUNTING_LOG" in os.environ:
            descriptor = os.open(os.environ["COUNTING_LOG"], os.O_WRONLY | os.O_APPEND | os.O_CREAT)
            os.write(descriptor, json.dumps([omega, mark]).encode() + b"\n")
            os.close(descriptor)

    def _stumble(self, omega: float) -> None:
        if omega == self.fails_at:
            raise SolverError("stopped at t = 0.1 s")
        if omega == self.refuses_at:
            raise InputError("beam.length = 2.5: not here")
        if omega == self.dies_at:
            if self.died:
                try:
                    os.close(os.open(self.died, os.O_CREAT | os.O_EXCL))
                except FileExistsError:
                    return
            if self.tears:
                tear()
            os.kill(os.getpid(), 9)


def tear() -> None:
    """Send the head of a long answer to the pool whose process this is, as one that is killed half-way does."""
    frame: FrameType | None = sys._getframe()
    while frame is not None and "result_queue" not in frame.f_locals:
        frame = frame.f_back
    assert frame is not None, "this is no process of a pool"
    answers = frame.f_locals["result_queue"]
    answers._wlock.acquire()
    os.write(answers._writer.fileno(), struct.pack("!i", 1000) + b"head")  # length and beginning
