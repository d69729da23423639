"""The cycle at one frequency by both solvers: what a page draws of it, and the comparison."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from explore.answers import Bar, Compared, Cycle, CycleFound, Drawn, Natural
from explore.drawing import drawn
from explore.question import Question
from lapjoint.answers.steady_state import SteadyState
from lapjoint.solver import Progress, make_solver
from lapjoint.summaries.blocks import steady_blocks
from validation.cases.both_answers import tables_of
from validation.cases.own_problem import SOLVERS, steady_by_both

TIMES = 1200
"""Number of equidistant times of a time history; more than the pixels of its picture."""
FRAMES = 120
"""Number of frames in which the beam moves through its cycle."""
PLACES = 61
"""Number of points along each beam in a frame."""
LONGEST = 16
"""Most excitation periods of a motion that are shown."""


def cycle_answers(question: Question, look: Progress) -> Iterator[Drawn | Natural | CycleFound | Compared]:
    """The sketch of the problem, its natural frequencies, the cycle by each solver, and then their comparison.

    `look` is called now and then, and may end the work by an exception.
    """
    problem, found = question.made(), []
    yield drawn(problem)
    yield Natural(make_solver("analytic").modes(problem).angular_frequencies)
    for name, options in SOLVERS.items():
        found.append(make_solver(name, **options).steady_state(problem, progress=look))
        yield CycleFound(name, cycle_of(found[-1], name))

    def say(line: str) -> None:
        look(0.0, 1.0)

    yield Compared(steady_by_both(problem, found, "quick", say))


def cycle_of(found: SteadyState, solver: str) -> Cycle:
    """A steady state that a solver found, by its short name, as a page draws it."""
    problem, history = found.problem, found.history
    period = problem.require_excitation_period("cycle")
    end = min(history.end, history.start + LONGEST * period)
    t, frames = np.linspace(history.start, end, TIMES), np.linspace(history.start, end, FRAMES, endpoint=False)
    x = np.concatenate(
        [np.linspace(start, stop, PLACES) for start, stop in zip(problem.line.starts, problem.line.ends, strict=True)]
    )
    place, blocks = problem.one_position(), tuple(steady_blocks(found))
    bars = [
        Bar(c.stop, c.start - history.start, min(c.end, end) - history.start, c.impulse)
        for c in history.contacts
        if c.start < end
    ]
    return Cycle(
        found.solver,
        found.outcome.value,
        period,
        problem.line.place(place),
        t - history.start,
        history.displacement(place, t)[0],
        history.velocity(place, t)[0],
        history.contact_force(t),
        tuple(bars),
        frames - history.start,
        x,
        history.displacement(x, frames).T,
        history.faces(frames).T,
        tuple(complex(value) for value in found.multipliers if math.isfinite(abs(value))),
        blocks,
        tables_of(problem, {solver: blocks}),
    )
