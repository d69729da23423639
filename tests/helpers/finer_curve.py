"""What bifurcations of the lightly damped joint are compared with: the curve that a finer self of the solver has.

It begins at that self's own motion, and is followed; nothing is carried from where another solver has a bifurcation.
"""

from __future__ import annotations

import analytic
from lapjoint import paper_joint
from lapjoint.answers.branches import Bifurcation, MotionThere
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.listing import Listed, listed
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Limits

LOW, HIGH = 100.0, 5000.0  # rad/s
FINER = 3  # as many steps finer than the coarsest self


def family() -> Family:
    """The period maps of the paper's joint with a quarter of its damping."""
    grid = Grid(paper_joint(damping_ratio=0.02), (Axis(FREQUENCY, (LOW, HIGH)),))
    return Family(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, LOW, HIGH)


def unconfirmed(own: Family, kind: str, motion: MotionThere) -> Listed:
    """The bifurcation at a motion of a file, without an error."""
    one = restored(own, Bifurcation(kind, motion.value, float("inf"), 0, motion=motion))  # type: ignore[arg-type]
    assert one is not None
    return one


def both_ways(motion: MotionThere, limits: Limits, finer_by: int = FINER) -> list[list[Bifurcation]]:
    """The bifurcations of a finer self's curve, one way and the other from its motion near one of a file."""
    own = family()
    for _ in range(finer_by):
        finer = own.finer(motion.value)
        assert finer is not None
        own = finer[1]
    start = corrected(own, motion.value, own.adopted(motion.value, motion.point), motion.half_periods)
    assert start is not None
    runs = [follow(own, place, limits) for place in (start, start.turned())]
    return [[one.bifurcation for one in listed(own, run, errors=False)] for run in runs]
