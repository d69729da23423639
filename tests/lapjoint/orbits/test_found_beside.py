"""Bifurcations in hairpins beside a graze are found by finer selves of the solver that have the graze elsewhere.

The motions are those of a file of `lapjoint branch` for the paper's joint with a quarter of its damping: at a graze,
and beside it by the coarsest self, where no finer one has a bifurcation.  The witness is the curve of a finer self,
followed from its own motion at the graze.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from finer_curve import FINER, both_ways, family, unconfirmed

from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches import by_another_solver
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.run import Limits

HAIRPINS = json.loads((Path(__file__).parent / "hairpins.json").read_text(encoding="utf-8"))
VERY_CLOSE = json.loads((Path(__file__).parent / "very_close_to_a_graze.json").read_text(encoding="utf-8"))
AROUND = Limits(most=80, length=2e-3)  # within which the hairpins turn
AIM = 1e-5  # error over the frequency


@pytest.mark.parametrize(
    ("hairpin", "which"), [(i, k) for i, one in enumerate(HAIRPINS) for k in range(len(one["bifurcations"]))]
)
def test_a_bifurcation_in_a_hairpin_is_found_from_the_graze_beside_it(hairpin: int, which: int) -> None:
    graze = motion_from(HAIRPINS[hairpin]["beside_a_graze"])
    said: dict[str, Any] = HAIRPINS[hairpin]["bifurcations"][which]
    own = family()
    found = by_another(unconfirmed(own, said["kind"], motion_from(said["motion"])), own, FINER - 1)
    truth = [one.value for way in both_ways(graze, AROUND) for one in way if one.kind == said["kind"]]
    assert truth
    assert found is not None
    assert min(abs(found.value - value) for value in truth) <= found.error <= AIM * found.value


@pytest.mark.parametrize("which", range(len(VERY_CLOSE)))
def test_one_that_is_very_close_to_a_graze_is_looked_for_from_there_first(
    which: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Along the curve it takes thrice as long, and by finite elements most of a minute."""
    asked = list[object]()
    monkeypatch.setattr(by_another_solver._Search, "_along", lambda search: asked.append(search))
    own, said = family(), VERY_CLOSE[which]
    found = by_another(unconfirmed(own, said["kind"], motion_from(said["motion"])), own, FINER - 1)
    assert not asked
    assert found is not None
    assert found.error <= AIM * found.value
