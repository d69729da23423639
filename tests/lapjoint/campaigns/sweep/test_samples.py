"""A sweep with samples: each sample is the sweep of its own problem, resumed and chained like any other."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from small_joints import LOW, cantilever

from lapjoint import FREQUENCY, Axis, InputError, Problem, sweep
from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.journal import journal_path
from lapjoint.campaigns.sweep.job import SweepJob
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.errors import Interrupted
from lapjoint.problem.uncertain import Lognormal, Uniform
from lapjoint.sampling.design import samples_of

JOINT = cantilever(
    uncertain=(
        Uniform(name="gap", paths=("stops.*.gap",), kind="uniform", low=4e-4, high=1e-3),
        Lognormal(name="k", paths=("stops.0.stiffness",), apply="factor", kind="lognormal", mean=1.0, deviation=0.1),
    )
)
AXES = (Axis(FREQUENCY, (5.0, 4.0)),)
FEW = {"options": {"n_modes": 2}}


def swept(problem: Problem = JOINT, **given: object) -> xr.Dataset:
    return sweep(problem, AXES, **(FEW | given))  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return swept(samples=16, sample_seed=3, summary=["displacement_peak"])


def test_each_sample_is_the_sweep_of_its_problem(found: xr.Dataset) -> None:
    samples = samples_of(JOINT, 16, seed=3)
    assert found.outcome.dims == ("sample", "angular_frequency")
    np.testing.assert_array_equal(np.stack([found.drawn_gap, found.drawn_k], axis=-1), samples.values)
    assert found.drawn_gap.units == "m"
    assert found.drawn_k.units == "1"
    for i in (0, 7):
        alone = swept(samples.problem(JOINT, i), summary=["displacement_peak"])
        for name in ("impulse", "outcome", "residual", "displacement_peak", "contact_count"):
            np.testing.assert_array_equal(found[name].isel(sample=i), alone[name])
    assert (found.contact_count > 0).any()
    assert (found.contact_count == 0).any()


def test_a_chain_follows_each_sample_by_itself() -> None:
    spec = Plan(Grid(JOINT, AXES, samples_of(JOINT, 16)), start="up")
    assert list(spec.chains())[:2] == [(1, 0), (3, 2)]
    assert sorted(cell for chain in spec.chains() for cell in chain) == list(range(32))


def test_samples_need_no_axis_and_then_have_none_to_follow() -> None:
    spec = Plan(Grid(JOINT, (), samples_of(JOINT, 16)))
    assert spec.shape == (16,)
    spec.check()
    assert spec.grid.problem_at(5) == samples_of(JOINT, 16).problem(JOINT, 5)
    with pytest.raises(InputError, match="follows the motion along an axis, and there is none"):
        Plan(Grid(JOINT, (), samples_of(JOINT, 16)), start="down")


def test_an_interrupted_sweep_resumes_to_the_same_file(
    found: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, answered = tmp_path / "samples.nc", SweepJob.answer

    def once(job: SweepJob, cell: int, *given: object) -> object:
        if cell == 20:
            raise KeyboardInterrupt
        return answered(job, cell, *given)  # type: ignore[arg-type]

    monkeypatch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
    given = {"samples": 16, "sample_seed": 3, "summary": ["displacement_peak"], "out": out}
    with monkeypatch.context() as patch:
        patch.setattr(SweepJob, "answer", once)
        with pytest.raises(Interrupted, match="20 of 32 points are kept"):
            swept(**given)
    with pytest.raises(InputError, match=r"differs in samples"):
        swept(**(given | {"sample_seed": 4}))
    assert swept(**given).identical(found)
    assert not journal_path(out).exists()


def test_an_axis_that_samples_move_is_refused() -> None:
    with pytest.raises(InputError, match=r"axis stops\.\*\.gap: sets stops\.0\.gap, of which samples of gap are"):
        sweep(JOINT, [Axis("stops.*.gap", (1e-3,))], samples=16)


def test_a_sample_that_is_refused_at_a_point_is_named() -> None:
    grid = Grid(JOINT, (Axis("base_motion.amplitude", (LOW, -1.0)),), samples_of(JOINT, 16))
    with pytest.raises(InputError, match=r"sample 0 \(gap = .*, k = .*\), base_motion\.amplitude = -1: .*at least 0"):
        grid.check()


def test_all_samples_of_a_large_grid_are_checked_before_any_work() -> None:
    lengths = Uniform(name="L", paths=("beam.length",), kind="uniform", low=1.0, high=2.0)
    place = Uniform(name="x", paths=("stops.0.x",), kind="uniform", low=0.5, high=1.0)
    both = cantilever(uncertain=(place, lengths))
    Plan(Grid(both, (Axis(FREQUENCY, np.linspace(1, 2, 400)),), samples_of(both, 16))).check()
    off = cantilever(
        beam=cantilever().beam.model_copy(update={"length": 1.5}),
        uncertain=(
            Uniform(name="x", paths=("stops.0.x",), kind="uniform", low=0.9, high=1.4),
            Uniform(name="L", paths=("beam.length",), kind="uniform", low=1.1, high=1.6),
        ),
    )
    with pytest.raises(InputError, match=r"sample \d+ \(x = .*, L = .*: lies outside the beam"):
        Plan(Grid(off, (Axis(FREQUENCY, np.linspace(1, 2, 400)),), samples_of(off, 16))).check()
