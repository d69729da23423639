"""Motions in stretches: the same motion as in one piece, whatever drives it."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import fe_lapjoint
from lapjoint import History, InputError, PolynomialShape, Problem, paper_joint
from lapjoint.problem import RecordBaseMotion
from lapjoint.solver import Streams

SOLVER = fe_lapjoint.Solver(elements=4)


def recorded() -> tuple[Problem, float]:
    noise = np.random.default_rng(3).standard_normal(40001) * 250.0
    return paper_joint().replace(base_motion=RecordBaseMotion(quantity="acceleration", rate=4000.0, values=noise)), 7.0


def shaken() -> tuple[Problem, float]:
    return paper_joint(angular_frequency=515.0), 40.3 * 2 * math.pi / 515.0


def free() -> tuple[Problem, float]:
    shape = PolynomialShape(displacement=(0.0, 0.0, -2e-2))
    return paper_joint().replace(base_motion=None, initial=shape), 7.0


def chained(stretches: list[History]) -> list[tuple[int, float, float, float, float]]:
    """Contacts with those that go on over an end put together: stop, start, end, impulse and peak force."""
    done: list[tuple[int, float, float, float, float]] = []
    going: dict[int, tuple[float, float, float]] = {}
    for stretch in stretches:
        for c in stretch.contacts:
            start, impulse, peak = going.pop(c.stop) if c.open_start and c.stop in going else (c.start, 0.0, 0.0)
            whole = start, impulse + c.impulse, max(peak, c.peak_force)
            if c.open_end:
                assert c.end == stretch.end
                going[c.stop] = whole
            else:
                done.append((c.stop, start, c.end, *whole[1:]))
    return sorted(done, key=lambda contact: (contact[1], contact[0]))


@pytest.mark.parametrize("excitation", [recorded, shaken, free])
def test_the_stretches_are_the_motion(excitation: object) -> None:
    problem, duration = excitation()  # type: ignore[operator]
    told: list[tuple[float, float]] = []
    assert isinstance(SOLVER, Streams)
    stretches = list(SOLVER.stream(problem, duration, progress=lambda *done: told.append(done)))
    whole = SOLVER.simulate(problem, duration, errors=False)
    assert len(stretches) >= 3
    assert (stretches[0].start, stretches[-1].end) == (0.0, duration)
    assert all(a.end == b.start for a, b in pairwise(stretches))
    assert told == [(stretch.end, duration) for stretch in stretches]
    complete = [(c.stop, c.start, c.end, c.impulse, c.peak_force) for c in whole.contacts if not c.open_end]
    assert len(complete) > 20
    assert np.allclose(chained(stretches)[:20], complete[:20], rtol=1e-9)  # beyond, chaos may part roundings
    first = stretches[0]
    t = np.linspace(first.start, min(first.end, complete[10][2]), 50)
    size = np.abs(whole.displacement([1.0, 2.5], t)).max()
    assert np.allclose(first.displacement([1.0, 2.5], t), whole.displacement([1.0, 2.5], t), atol=1e-9 * size)


def test_a_stretch_keeps_few_pieces_however_long_the_motion() -> None:
    problem, _ = recorded()
    sizes = [len(stretch.field.pieces) for stretch, _ in zip(SOLVER.stream(problem, 10.0), range(3), strict=False)]
    assert max(sizes) < 5000


def test_a_duration_beyond_the_record_is_refused_at_once() -> None:
    problem, _ = recorded()
    with pytest.raises(InputError, match="duration"):
        SOLVER.stream(problem, 11.0)
