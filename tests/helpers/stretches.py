"""A motion cut in stretches, as a solver that streams hands it on."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lapjoint import FREE, History, Problem
from lapjoint.answers import Contact, ContactState, Modes
from lapjoint.solver import Progress, Solver


def cut(history: History, times: Sequence[float]) -> Iterator[History]:
    """The parts between times; impulses and peak forces of contacts that are cut are taken from the force law."""
    for start, end in pairwise([history.start, *times, history.end]):
        inside = (history.switch_times > start) & (history.switch_times < end)
        first = int(np.searchsorted(history.switch_times, start, side="right"))
        yield replace(
            history,
            start=start,
            end=end,
            switch_times=history.switch_times[inside],
            states=history.states[first : first + int(inside.sum()) + 1],
            contacts=tuple(
                _part(history, one, start, end) for one in history.contacts if one.start < end and start < one.end
            ),
        )


def _part(history: History, contact: Contact, start: float, end: float) -> Contact:
    if contact.start >= start and contact.end <= end:
        return contact
    lo, hi = max(contact.start, start), min(contact.end, end)
    t = np.linspace(lo, hi, 2001)
    force = history.contact_force(t)[contact.stop]
    return replace(
        contact,
        start=lo,
        end=hi,
        impulse=-float(np.trapezoid(force, t)),
        peak_force=float(np.abs(force).max()),
        open_start=contact.open_start or lo > contact.start,
        open_end=contact.open_end or hi < contact.end,
    )


@dataclass(frozen=True)
class Cutting:
    """A solver that hands on the motion of another in stretches of some duration, s."""

    solver: Solver
    length: float

    def modes(self, problem: Problem, state: ContactState = FREE, count: int = 1) -> Modes:
        """Those of the other solver."""
        return self.solver.modes(problem, state, count)

    def stream(self, problem: Problem, duration: float, *, progress: Progress | None = None) -> Iterator[History]:
        """Its motion."""
        motion = self.solver.simulate(problem, duration, errors=False)
        yield from cut(motion, np.arange(self.length, duration, self.length).tolist())
