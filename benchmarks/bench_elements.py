"""The cost of a period of the paper's joint by finite elements, and of its derivative, against the size of the mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.period_map import Linearised


def settled(elements: int) -> tuple[PeriodMap, SectionPoint]:
    """A period with some twenty switches, lightly damped."""
    map_ = fe_lapjoint.Solver(elements=elements).period_map(paper_joint(angular_frequency=102.0, damping_ratio=0.02))
    return map_, map_.march(map_.initial(), 200).end


@in_one_thread
def linearised(map_: Any, point: SectionPoint) -> Linearised:
    found: Linearised = map_.linearised(point, 2)
    return found


@in_one_thread
def derivative(map_: Any, point: SectionPoint) -> None:
    assert np.isfinite(linearised(map_, point).multipliers).all()


@pytest.mark.parametrize("elements", [20, 40, 61, 91, 137])
@pytest.mark.benchmark(group="a period at 102 rad/s, finite elements")
def bench_period(benchmark: Any, elements: int) -> None:
    benchmark(linearised, *settled(elements))


@pytest.mark.parametrize("elements", [20, 40, 61, 91, 137])
@pytest.mark.benchmark(group="a period at 102 rad/s, its derivative, and its multipliers, finite elements")
def bench_derivative(benchmark: Any, elements: int) -> None:
    benchmark(derivative, *settled(elements))
