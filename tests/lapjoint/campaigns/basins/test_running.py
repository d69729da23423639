"""Basins: the same answer whoever works and however often it is interrupted, and a file that says what it holds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from killing import killed_at_work
from scipy.stats import binomtest
from toy import bar

from lapjoint import Axis, InputError, ModalDamping, basins
from lapjoint.campaigns.basins.job import BasinJob
from lapjoint.campaigns.basins.motions import wilson
from lapjoint.campaigns.basins.spec import CHUNK, BasinPlan
from lapjoint.campaigns.journal import Journal

MIRROR = bar(0.55, (0.4, 20.0), (-0.4, 20.0), ratio=0.05)
"""A bar between two equal stops, with motions of one period and of three."""
TWO: dict[str, Any] = {"options": {"n_modes": 2}}
RANDOM: dict[str, Any] = {"energy": 20.0, "starts": 2 * CHUNK + 9, **TWO}
PLANE: dict[str, Any] = {"plane": "z(0.5),v(1.0)", "grid": (9, 11), "ranges": ((-3.0, 3.0), (-2.0, 2.0)), **TWO}


def test_shares_are_those_of_the_starts() -> None:
    found = basins(MIRROR, **RANDOM)
    assert set(found.period_multiple.values) == {1, 3}
    for i in range(found.sizes["motion"]):
        count = int((found.motion == i).sum())
        assert int(found["count"][i]) == count
        assert float(found.fraction[i]) == count / RANDOM["starts"]
        interval = binomtest(count, RANDOM["starts"]).proportion_ci(0.95, "wilson")
        assert (float(found.fraction_low[i]), float(found.fraction_high[i])) == pytest.approx(tuple(interval))
    assert int(found["count"].sum() + found.unbound_count.sum()) == RANDOM["starts"]
    assert np.isfinite(found.impulse_error).all()
    assert (found.impulse_error > 0).all()
    assert list(found["count"].values) == sorted(found["count"].values, reverse=True)


@pytest.mark.parametrize(("count", "total"), [(0, 50), (50, 50), (1, 7), (333, 1000)])
def test_intervals_are_those_of_wilson(count: int, total: int) -> None:
    assert wilson(count, total) == pytest.approx(tuple(binomtest(count, total).proportion_ci(0.95, "wilson")))


SCRIPT = """
import sys
sys.path.insert(0, sys.argv[2])
from test_running import MIRROR, TWO
from lapjoint import basins
if __name__ == "__main__":
    basins(MIRROR, energy=20.0, starts=6400, out=sys.argv[1], workers=2, **TWO)
"""


@pytest.mark.thorough
def test_a_killed_process_loses_no_more_than_its_last_batches(tmp_path: Path) -> None:
    out = tmp_path / "basins.nc"
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    killed_at_work([str(script), str(out), str(Path(__file__).parent)], out, 3)
    plan = BasinPlan(MIRROR, options=TWO["options"], energy=20.0, starts=6400)
    kept = Journal(BasinJob(plan), out)
    assert len(kept.points) >= 2
    kept.close()


def test_along_a_number_motions_belong_to_branches(tmp_path: Path) -> None:
    over = Axis("base_motion.angular_frequency", (0.57, 0.53, 0.55))
    found = basins(MIRROR, energy=20.0, starts=20, over=over, **TWO)
    assert found.motion.shape == (3, 20)
    single = basins(MIRROR, energy=20.0, starts=20, **TWO)
    here = found.sel(angular_frequency=0.55)
    assert set(here.period_multiple.values) == set(single.period_multiple.values)
    for value in range(3):
        one = found.isel(angular_frequency=value)
        there = one.period_multiple.values > 0
        assert len(set(one.branch.values[there])) == there.sum()  # a motion of one problem is on one branch
    multiples: dict[int, set[int]] = {}
    for branch, multiple in zip(found.branch.values.ravel(), found.period_multiple.values.ravel(), strict=True):
        if branch >= 0:
            multiples.setdefault(int(branch), set()).add(int(multiple))
    assert all(len(those) == 1 for those in multiples.values())
    assert len(multiples) < (found.branch.values >= 0).sum()  # some branch goes on


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"energy": None}, "give a plane of starts, or the energy of random ones"),
        ({"plane": "z(0.5),v(0.5)"}, "and not both"),
        ({"energy": -1.0}, "energy = -1.0: must be positive and finite, in J"),
        ({"starts": 0}, "starts = 0: must be an integer from 1"),
        ({"effort": 0}, "effort = 0: must be an integer from 1"),
        ({"starts": 20_000_000}, "starts = 20000000: must be an integer from 1"),
        ({"solver": "analytic-published", "options": {}}, "lacks period_map of .*, which basins need"),
        ({"solver": "nobody"}, "is not installed"),
    ],
)
def test_what_cannot_be_done_is_refused_at_once(changed: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        basins(MIRROR, **{"energy": 20.0, "starts": 3, **TWO, **changed})


def test_numbers_of_a_chunk_are_what_json_holds() -> None:
    import json

    job = BasinJob(BasinPlan(MIRROR, options=TWO["options"], energy=20.0, starts=5))
    chunk, _ = job.answer(0, job.spec.check(), None)
    assert job.point(json.loads(json.dumps(vars(chunk)))) == chunk


def test_starts_whose_process_died_have_failed() -> None:
    job = BasinJob(BasinPlan(MIRROR, options=TWO["options"], energy=20.0, starts=5))
    scouts, _ = job.answer(0, job.spec.check(), None)
    found = job.dataset({0: scouts, 1: job.point({"message": "it died"})})
    assert found.motion.values.tolist() == [-1] * 5
    assert found.unbound_fraction.values.tolist() == [0.0, 0.0, 0.0, 1.0]
    assert set(found.failure_message.values) == {"it died"}


def test_starts_that_all_end_in_no_motion_are_told_as_such(tmp_path: Path) -> None:
    slow = MIRROR.replace(damping=ModalDamping(ratio=1e-5))
    found = basins(slow, energy=20.0, starts=4, effort=1, out=tmp_path / "basins.nc", **TWO)
    assert found.motion.values.tolist() == [-1] * 4
    assert found.impulse.shape == found.impulse_error.shape == (0, len(MIRROR.stops))
    assert float(found.unbound_fraction.sum()) == 1.0


def test_a_beam_without_stops_has_one_motion_in_which_all_starts_end() -> None:
    found = basins(MIRROR.replace(stops=()), energy=20.0, starts=4, **TWO)
    assert found.motion.values.tolist() == [0] * 4
    assert found.impulse.shape == (1, 0)
