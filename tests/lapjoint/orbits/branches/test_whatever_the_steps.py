"""What is found along a curve hardly depends on its steps: pairs that undo each other within a step are found, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import pytest
from galerkin_arcs import GalerkinResolution, before_first_graze, towards_graze

from lapjoint.orbits.branches.bifurcations import Bifurcation
from lapjoint.orbits.branches.tracing import Limits, one_way

SEED, COUNT = 48, 60
FEW = (2, 4, 5, 6)
"""Those that are followed in seconds; the first two take half a minute."""
ALIKE = 1e-6
"""Distance of the parameter over its value up to which two bifurcations are one."""
SHARE = 0.9
"""Least share of the bifurcations by short steps that the program's own steps find."""


@dataclass(frozen=True)
class Range:
    """A range of one resolution."""

    one: GalerkinResolution

    @property
    def low(self) -> float:
        """Its lower end."""
        return self.one.low

    @property
    def high(self) -> float:
        """Its upper end."""
        return self.one.high

    def resolution(self, value: float) -> GalerkinResolution:
        """The resolution anywhere."""
        return self.one


def found(index: int, shorter: float) -> list[tuple[str, float]]:
    """Bifurcations of a random joint, by steps that are shorter than the program's own."""
    _, resolution, free = before_first_graze(SEED, index, 2.0)
    own = resolution.options
    resolution.options = replace(own, turning=own.turning / shorter, largest_step=own.largest_step / shorter)
    way = one_way(Range(resolution), towards_graze(resolution, free), Limits(600))  # type: ignore[arg-type]
    return [(one.what.kind, one.what.point.value) for one in way.found if isinstance(one.what, Bifurcation)]


@pytest.mark.parametrize(
    "indices",
    [
        pytest.param(FEW, id="few", marks=pytest.mark.thorough),
        pytest.param([i for i in range(COUNT) if i not in FEW], id="others", marks=pytest.mark.slow),
    ],
)
def test_curves_have_what_short_steps_find(indices: Sequence[int]) -> None:
    there = total = 0
    for index in indices:
        own, fine = found(index, 1.0), found(index, 4.0)
        total += len(fine)
        there += sum(
            any(kind == other and abs(value - at) <= ALIKE * abs(at) for other, value in own) for kind, at in fine
        )
    assert total > len(indices)
    assert there >= SHARE * total
