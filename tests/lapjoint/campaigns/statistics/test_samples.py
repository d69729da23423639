"""Statistics with samples: each sample is the statistics of its own problem and noise, resumed like any others."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from command_line import assert_refused, run, run_well
from own_reports import STEEL
from small_joints import SHAKEN

from lapjoint import Beam, InputError, Problem, Rectangle, bands, statistics, write_problem
from lapjoint.campaigns.statistics import job
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.errors import Interrupted, SolverError
from lapjoint.problem.random_motion import RandomBaseMotion
from lapjoint.problem.uncertain import Uniform
from lapjoint.sampling.design import Kind, samples_of
from lapjoint.solver import Solver
from lapjoint.summaries.measure import Measure
from lapjoint.summaries.sums import Sums

LOOSE = SHAKEN.replace(
    uncertain=(
        Uniform(name="gap", paths=("stops.*.gap",), kind="uniform", low=5e-5, high=2e-4),
        Uniform(name="k", paths=("stops.0.stiffness",), apply="factor", kind="uniform", low=0.8, high=1.2),
    )
)
GIVEN: dict[str, Any] = {"duration": 1.0, "options": {"n_modes": 2}, "settle": 0.2, "samples": 16}


def shaken(**given: Any) -> xr.Dataset:
    return statistics(LOOSE, **(GIVEN | given))


@pytest.fixture(scope="module")
def found() -> xr.Dataset:
    return shaken(seeds=2, at=[1.0, 0.5])


def seed_of(problem: Problem) -> int:
    assert isinstance(problem.base_motion, RandomBaseMotion)
    return problem.base_motion.seed


def test_each_sample_is_the_statistics_of_its_problem_with_noise_of_its_own(found: xr.Dataset) -> None:
    samples = samples_of(LOOSE, 16)
    np.testing.assert_array_equal(np.stack([found.drawn_gap, found.drawn_k], axis=-1), samples.values)
    assert found.displacement_rms.dims == ("sample", "x")
    np.testing.assert_array_equal(found.x, [1.0, 0.5])
    for i in (0, 7):
        own = samples.problem(LOOSE, i).with_seeds(lambda seed, i=i: seed + 2 * 2 * i)
        alone = statistics(own, **(GIVEN | {"samples": None, "seeds": 2, "at": [1.0, 0.5]}))
        for name in ("displacement_rms", "displacement_peak", "moment_maximum", "displacement_rms_interval"):
            np.testing.assert_array_equal(found[name].isel(sample=i), alone[name].sel(x=[1.0, 0.5]))
        for name in ("force_peak", "contact_rate", "contact_rate_interval", "impact_speed_largest", "input_power"):
            np.testing.assert_array_equal(found[name].isel(sample=i), alone[name])
    assert not found.failed.any()


def test_without_places_the_largest_along_the_beam_is_kept_also_where_lengths_differ() -> None:
    beam = Beam(length=1.2, section=Rectangle(breadth=0.05, height=0.02), material=STEEL)
    lengths = Uniform(name="L", paths=("beam.length",), kind="uniform", low=1.1, high=1.3)
    problem = SHAKEN.replace(beam=beam, uncertain=(lengths,))
    kept = statistics(problem, **GIVEN)
    assert kept.stress_peak.dims == ("sample",)
    assert len(np.unique(kept.drawn_L)) == 16
    own = samples_of(problem, 16).problem(problem, 3).with_seeds(lambda seed: seed + 6)
    alone = statistics(own, **(GIVEN | {"samples": None}))
    at = int(alone.stress_rms.values.argmax())
    for name in ("stress_rms", "stress_rms_interval"):
        np.testing.assert_array_equal(kept[name][3], alone[name][at])
    assert float(kept.stress_rms_x[3]) == float(alone.x[at])


@pytest.mark.parametrize(("design", "same"), [("sobol", {0}), ("saltelli", {0, 1, 2})])
def test_points_of_a_block_share_their_noise_but_for_the_last_one(design: Kind, same: set[int]) -> None:
    plan = Realisations(LOOSE, 1.0, 3, samples=samples_of(LOOSE, 16, design))
    seeds = np.array([seed_of(plan.realisation(cell)) for cell in range(plan.size)]).reshape(16, -1, 3)
    assert plan.size == seeds.size
    for block in seeds:
        assert len({tuple(block[i]) for i in same}) == 1
        others = [i for i in range(len(block)) if i not in same]
        assert all(not set(block[i]) & set(block[0]) for i in others)
    assert len(np.unique(seeds)) == 16 * 3 * (1 if design == "sobol" else 2)


def test_an_interrupted_campaign_resumes_to_the_same_file(
    found: xr.Dataset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out, answered = tmp_path / "stats.nc", job.solve_realisation

    def once(spec: Realisations, cell: int, *given: Any) -> Any:
        if cell == 20:
            raise KeyboardInterrupt
        return answered(spec, cell, *given)

    given = {"seeds": 2, "at": [1.0, 0.5], "out": out}
    with monkeypatch.context() as patch:
        patch.setattr(job, "solve_realisation", once)
        patch.setattr("lapjoint.campaigns.batch.BATCH_SECONDS", 0.0)
        with pytest.raises(Interrupted, match="20 of 32 realisations are kept"):
            shaken(**given)
    with pytest.raises(InputError, match="differs in samples"):
        shaken(**(given | {"sample_seed": 4}))
    assert shaken(**given).identical(found)


def test_a_sample_with_a_realisation_that_failed_has_no_values_and_widens_the_bands(
    found: xr.Dataset, monkeypatch: pytest.MonkeyPatch
) -> None:
    summed = job.sums_of

    def sometimes(what: Measure, solver: Solver, problem: Problem, *rest: Any) -> Sums:
        if seed_of(problem) == 2 * 2 * 5 + 1:
            raise SolverError("gave up")
        return summed(what, solver, problem, *rest)

    monkeypatch.setattr(job, "sums_of", sometimes)
    lost = shaken(seeds=2, at=[1.0, 0.5])
    np.testing.assert_array_equal(lost.failed, np.arange(16) == 5)
    np.testing.assert_array_equal(np.isnan(lost.force_peak[:, 0]), np.arange(16) == 5)
    assert lost.attrs["failed"] == 1
    whole, less = (bands(one, {"force": 1e3}) for one in (found, lost))
    assert (less.attrs["failed"], less.attrs["points"]) == (1, 16)
    assert less.force_peak_exceedance_interval[0, 1] > whole.force_peak_exceedance_interval[0, 1]
    monkeypatch.setattr(job, "sums_of", lambda *given: (_ for _ in ()).throw(SolverError("gave up")))
    with pytest.raises(SolverError, match="no sample came to its end: gave up"):
        shaken()


def test_bands_show_what_the_intervals_of_the_samples_change(found: xr.Dataset) -> None:
    shown = bands(found, {"displacement_rms": float(found.displacement_rms.median())})
    ends = found.displacement_rms_interval
    for i in (0, 1):
        expected = np.quantile(np.clip(ends[..., i], 0.0, None), 0.5, axis=0, method="inverted_cdf")
        np.testing.assert_array_equal(shown.displacement_rms_quantile_numerical[1, :, i], expected)
    assert (shown.displacement_rms_exceedance_numerical[:, 0] <= shown.displacement_rms_exceedance).all()
    turned = found.impulse_rate_interval.copy(data=-found.impulse_rate_interval.values[..., ::-1])
    signed = found.assign(impulse_rate=-found.impulse_rate, impulse_rate_interval=turned)
    for name in ("impulse_rate_quantile", "impulse_rate_quantile_numerical"):
        np.testing.assert_array_equal(bands(signed)[name], bands(found)[name])


def test_a_problem_that_some_sample_does_not_allow_is_refused_before_any_work() -> None:
    damped = Uniform(name="z", paths=("damping.ratio",), kind="uniform", low=1e-5, high=0.1)
    with pytest.raises(InputError, match=r"sample \d+ \(z = .*\): duration = 3: must be longer than the"):
        statistics(SHAKEN.replace(uncertain=(damped,)), duration=3.0, samples=64)
    with pytest.raises(InputError, match="nothing in this problem is uncertain"):
        statistics(SHAKEN, **GIVEN)


def test_the_commands_compute_show_and_draw_them(tmp_path: Path) -> None:
    problem, out = tmp_path / "loose.toml", tmp_path / "stats.nc"
    write_problem(LOOSE, problem)
    few = ("statistics", problem, "--duration", "0.6", "--settle", "0.2", "--n-modes", "2", "--samples", "16")
    assert_refused(run(*few), "--out: is missing; with --samples the answer is a file", lines=1)
    said = run_well(*few, "--out", out, "--workers", "1")
    assert "samples of 0.6 s\nThe first 0.2 to 0.2 s of each are left out" in said
    assert "holds these statistics already" in run_well(*few, "--out", out)
    figure = tmp_path / "beyond.png"
    shown = run_well("uncertainty", out, "--limit", "force=1", "--figure", figure)
    assert "stop 1 P(> 1)" in shown
    assert "range by intervals" in shown
    assert all(len(line) <= 80 for line in shown.replace(str(tmp_path), "").splitlines())
    assert figure.stat().st_size > 0
    assert "contact_rate [s-1]" in run_well("uncertainty", out)
    assert_refused(run("uncertainty", out, "--variable", "stress"), "--quantity of statistics adds more", lines=1)
    assert_refused(run("plot", out), f"`lapjoint uncertainty {out} --figure` draws them", lines=1)
