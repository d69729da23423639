"""Sensitivity indices of functions whose variance is known, for both designs, and what has none."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from lapjoint import InputError, paper_joint, sensitivities
from lapjoint.problem import FloatArray
from lapjoint.problem.uncertain import Uniform
from lapjoint.sampling.design import DRAWN, SAMPLE, samples_of

JOINT = paper_joint().replace(
    uncertain=tuple(
        Uniform(name=name, paths=(f"stops.{i}.gap",), kind="uniform", low=-np.pi, high=np.pi)
        for i, name in enumerate("abc")
    )
)
V1, V2, V13 = 0.5 * (1 + np.pi**4 / 50) ** 2, 49 / 8, 8 * np.pi**8 / 22500
FIRST = np.array([V1, V2, 0.0]) / (V1 + V2 + V13)
TOTAL = np.array([V1 + V13, V2, V13]) / (V1 + V2 + V13)


def ishigami(x: FloatArray) -> FloatArray:
    """sin a + 7 sin^2 b + 0.1 c^4 sin a (Ishigami and Homma, 1990), whose indices have closed forms."""
    return np.asarray(np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0]) + 20.0)


def sampled(number: int, design: str, values: FloatArray | None = None) -> xr.Dataset:
    """A file of samples with the variable ``force_peak``."""
    samples = samples_of(JOINT, number, design)  # type: ignore[arg-type]
    drawn = np.array(samples.values)
    coordinates = {DRAWN + name: (SAMPLE, drawn[:, i]) for i, name in enumerate("abc")}
    coordinates |= {"sample_set": (SAMPLE, list(samples.sets)), "sample_matrix": (SAMPLE, list(samples.matrices))}
    answer = ishigami(drawn) if values is None else values
    return xr.Dataset({"force_peak": (SAMPLE, answer, {"units": "N"})}, coords=coordinates)


def near(found: xr.Dataset, kind: str, truth: FloatArray) -> bool:
    error = found[f"force_peak_{kind}_error"].values
    return bool(np.all(np.abs(found[f"force_peak_{kind}"].values - truth) <= 2 * error) and np.all(error < 0.2))


def test_indices_are_those_of_the_closed_form() -> None:
    both = sensitivities(sampled(256, "saltelli"))
    assert near(both, "first_order", FIRST)
    assert near(both, "total", TOTAL)
    first = sensitivities(sampled(512, "sobol"), ["force"])
    assert near(first, "first_order", FIRST)
    assert "force_peak_total" not in first


def test_a_block_with_a_lost_sample_is_left_out() -> None:
    whole = sampled(256, "saltelli")
    lost = whole.copy(deep=True)
    lost.force_peak.values[7] = np.nan
    assert near(sensitivities(lost), "total", TOTAL)
    assert not sensitivities(lost).identical(sensitivities(whole))


def test_few_samples_and_constant_answers_have_no_indices() -> None:
    assert np.isnan(sensitivities(sampled(32, "sobol")).force_peak_first_order).all()
    assert np.isnan(sensitivities(sampled(64, "sobol", np.ones(64))).force_peak_first_order).all()


def test_without_salib_its_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, "SALib", None)
    with pytest.raises(InputError, match=r"pip install 'lapjoint\[sensitivity\]'"):
        sensitivities(sampled(64, "sobol"))
