"""The curve: the points of a sweep over the excitation frequency, coarse ones first."""

from __future__ import annotations

import time
from collections.abc import Iterator

from explore.answers import CurvePart
from explore.question import Question, coarse_to_fine
from lapjoint.campaigns.batch import solver_of
from lapjoint.campaigns.sweep.job import SweepJob
from lapjoint.solver import Progress

TOGETHER = 0.04
"""Time over which points are gathered before they are sent, s: shorter than a person sees."""


def curve_answers(question: Question, look: Progress, share: tuple[int, int]) -> Iterator[CurvePart]:
    """The points of a share of the curve, its number and how many there are, several at a time.

    `look` is called now and then, and may end the work by an exception.
    """
    plan = question.plan(question.made())
    job, solver = SweepJob(plan), solver_of(plan)
    points, since = {}, time.monotonic()
    for stage in coarse_to_fine(plan.size):
        mine = stage[share[0] :: share[1]]
        for cell in mine:
            look(0.0, 1.0)
            points[cell], _ = job.answer(cell, solver, None, look)
            if cell == mine[-1] or time.monotonic() > since + TOGETHER:
                yield CurvePart(points)
                points, since = {}, time.monotonic()
