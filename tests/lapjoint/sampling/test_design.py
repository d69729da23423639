"""The samples: where they lie, that they are the same again, and which problem each is."""

from __future__ import annotations

import numpy as np
import pytest

from lapjoint import InputError, paper_joint
from lapjoint.problem.files import problem_tables
from lapjoint.problem.uncertain import Lognormal, Normal, Uniform
from lapjoint.sampling.design import SETS, samples_of

JOINT = paper_joint().replace(
    uncertain=(
        Normal(name="gap", paths=("stops.*.gap",), kind="normal", mean=1e-3, deviation=1e-4),
        Lognormal(
            name="k",
            paths=("stops.P2.stiffness", "stops.P4.stiffness"),
            apply="factor",
            kind="lognormal",
            mean=1,
            deviation=0.2,
        ),
        Uniform(name="ratio", paths=("damping.ratio",), kind="uniform", low=0.02, high=0.1),
    )
)


def test_each_set_has_one_sample_in_each_slice_of_equal_probability() -> None:
    samples = samples_of(JOINT, 64)
    values, sets = np.array(samples.values), np.array(samples.sets)
    for k in range(SETS):
        ratio = (values[sets == k, 2] - 0.02) / 0.08
        assert sorted((ratio * 8).astype(int)) == list(range(8))
    assert len(np.unique(values[:, 0])) == 64


def test_the_same_seed_gives_the_same_samples_and_another_one_others() -> None:
    assert samples_of(JOINT, 64) == samples_of(JOINT, 64)
    assert samples_of(JOINT, 64).values != samples_of(JOINT, 64, seed=1).values


def test_a_block_of_saltelli_exchanges_one_variable_at_a_time() -> None:
    samples = samples_of(JOINT, 16, "saltelli")
    blocks = np.array(samples.values).reshape(16, 5, 3)
    for i in range(3):
        mixed = blocks[:, 0].copy()
        mixed[:, i] = blocks[:, 4, i]
        np.testing.assert_array_equal(blocks[:, 1 + i], mixed)
    assert samples.matrices[:5] == (0, 1, 2, 3, 4)


def test_the_problem_of_a_sample_has_its_values_and_nothing_uncertain() -> None:
    samples = samples_of(JOINT, 16)
    gap, k, ratio = samples.values[5]
    found = samples.problem(JOINT, 5)
    assert found.uncertain == ()
    assert [stop.gap for stop in found.stops] == [gap] * 4
    given = JOINT.stops[0].stiffness
    assert [stop.stiffness for stop in found.stops] == [given * k, given, given * k, given]
    assert problem_tables(found)["damping"]["ratio"] == ratio


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"number": 100}, r"samples = 100: must be 8 times a power of two: 16, 32, 64, \.\.\."),
        ({"number": 8}, "samples = 8: must be"),
        ({"number": 0}, "samples = 0: must be"),
        ({"number": 24}, "samples = 24: must be"),
        ({"number": 64, "design": "monte"}, "design = 'monte': allowed: sobol, saltelli"),
        ({"number": 64, "seed": -1}, "sample seed = -1: must be an integer from 0"),
    ],
)
def test_what_is_no_design_is_refused(given: dict[str, int], message: str) -> None:
    with pytest.raises(InputError, match=message):
        samples_of(JOINT, **given)  # type: ignore[arg-type]


def test_a_problem_without_uncertain_numbers_has_no_samples() -> None:
    with pytest.raises(InputError, match="nothing in this problem is uncertain"):
        samples_of(paper_joint(), 64)
