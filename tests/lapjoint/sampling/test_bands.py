"""Bands and probabilities of a linear beam are those of its closed form; errors and missing answers are told."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from scipy import stats
from small_joints import cantilever

from lapjoint import FREQUENCY, Axis, InputError, bands, sweep
from lapjoint.problem.uncertain import Lognormal, Uniform

DEVIATION = 0.2
FACTOR = stats.lognorm(np.sqrt(np.log1p(DEVIATION**2)), 0, 1 / np.sqrt(1 + DEVIATION**2))
LINEAR = cantilever(
    uncertain=(
        Lognormal(
            name="amplitude",
            paths=("base_motion.amplitude",),
            apply="factor",
            kind="lognormal",
            mean=1.0,
            deviation=DEVIATION,
        ),
        Uniform(name="phase", paths=("base_motion.phase",), kind="uniform", low=0.0, high=3.0),
    )
)
"""The beam never reaches its stop below 2 rad/s, so all its motion is proportional to the base's amplitude."""
AXES = [Axis(FREQUENCY, (1.0, 2.0))]


@pytest.fixture(scope="module")
def linear() -> xr.Dataset:
    return sweep(
        LINEAR, AXES, samples=128, options={"n_modes": 2}, summary=["displacement_peak", "force_peak"], errors=True
    )


@pytest.fixture(scope="module")
def nominal() -> np.ndarray:
    """The largest displacement at the mean amplitude, m, at each frequency."""
    found = sweep(LINEAR, AXES, options={"n_modes": 2}, summary=["displacement_peak"])
    return np.asarray(found.displacement_peak.values)


def test_bands_of_a_linear_beam_hold_the_quantiles_of_its_amplitude(linear: xr.Dataset, nominal: np.ndarray) -> None:
    found = bands(linear, variables=["displacement"])
    truth = FACTOR.ppf([0.05, 0.5, 0.95])[:, None] * nominal
    ends = found.displacement_peak_quantile_interval.values
    assert ((ends[..., 0] <= truth) & (truth <= ends[..., 1])).all()
    np.testing.assert_allclose(found.displacement_peak_quantile, truth, rtol=0.05)
    largest = found.largest_displacement_peak_quantile_interval.values
    assert ((largest[:, 0] <= truth[:, 1]) & (truth[:, 1] <= largest[:, 1])).all()


def test_the_probability_of_exceedance_is_that_of_the_amplitude(linear: xr.Dataset, nominal: np.ndarray) -> None:
    limit = 1.1 * nominal[1]
    found = bands(linear, {"displacement": limit})
    assert float(found.displacement_peak_exceedance[0]) == 0.0
    for name in ("displacement_peak_exceedance", "largest_displacement_peak_exceedance"):
        low, high = np.atleast_2d(found[f"{name}_interval"].values)[-1]
        assert low <= FACTOR.sf(1.1) <= high
    assert found.displacement_peak_exceedance.limit == limit


def test_numerical_errors_move_quantiles_and_probabilities_by_no_more_than_all_values_together(
    linear: xr.Dataset,
) -> None:
    at, size = linear.displacement_peak, 0.3 * linear.displacement_peak
    moved = linear.assign(displacement_peak_error=size)
    limit = float(at.quantile(0.5))
    found = bands(moved, {"displacement": limit})
    for i, factor in enumerate((0.7, 1.3)):
        expected = found.displacement_peak_quantile * factor
        np.testing.assert_allclose(found.displacement_peak_quantile_numerical[..., i], expected)
        share = (at * factor > limit).mean("sample")
        np.testing.assert_allclose(found.displacement_peak_exceedance_numerical[..., i], share)
    unknown = bands(linear.assign(displacement_peak_error=np.inf * size), {"displacement": limit})
    np.testing.assert_array_equal(unknown.displacement_peak_exceedance_numerical, [[0, 1], [0, 1]])
    none = bands(linear.drop_vars("displacement_peak_error"), variables=["displacement"])
    assert "displacement_peak_quantile_numerical" not in none


def test_failed_samples_are_counted_and_widen_the_intervals(linear: xr.Dataset) -> None:
    lost = linear.copy(deep=True)
    for name in ("outcome", "displacement_peak"):
        lost[name].values[3:6, 1] = -1 if name == "outcome" else np.nan
    limit = float(linear.displacement_peak.max()) * 1.01
    whole, found = bands(linear, {"displacement": limit}), bands(lost, {"displacement": limit})
    assert (whole.attrs["failed"], found.attrs["failed"], found.attrs["points"]) == (0, 3, 256)
    assert float(found.displacement_peak_exceedance[1]) == 0.0
    low, high = found.displacement_peak_exceedance_interval.values[1]
    assert low == 0.0
    assert high > whole.displacement_peak_exceedance_interval.values[1, 1] + 2 / 128
    assert np.isfinite(found.largest_displacement_peak_quantile).all()
    assert found.largest_displacement_peak_quantile_interval.values[-1, 1] == np.inf


def test_impulses_of_a_stop_that_is_not_touched_are_zero_with_certainty(linear: xr.Dataset) -> None:
    found = bands(linear, {"impulse": 1.0, "force": 1.0})
    assert not found.impulse_quantile.any()
    assert not found.force_peak_exceedance.any()
    assert found.impulse_quantile.dims == ("probability", "angular_frequency", "stop")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"limits": {"stress": 1.0}}, r"variable 'stress': is not in this file, which has impulse, "),
        ({"limits": {"displacement": -1.0}}, r"limit displacement = -1.0: must be positive and finite"),
        ({"variables": ["outcome"]}, r"variable 'outcome': is not in this file"),
    ],
)
def test_what_the_file_lacks_is_said(linear: xr.Dataset, given: dict, message: str) -> None:
    with pytest.raises(InputError, match=message):
        bands(linear, **given)


def test_a_file_without_samples_or_with_several_starts_has_no_bands(linear: xr.Dataset) -> None:
    with pytest.raises(InputError, match="the file has no samples"):
        bands(linear.isel(sample=0, drop=True))
    with pytest.raises(InputError, match="several starts at each point"):
        bands(linear.expand_dims(start=2))
