"""Bifurcations of random joints: the finite element solver confirms each that the analytic solver states."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pytest
from branch_witness import drawn

from lapjoint import branch, confirm
from lapjoint.campaigns.branch_dataset import KINDS
from lapjoint.campaigns.confirm_dataset import VERDICTS
from lapjoint.cli.confirm_printing import disagreement_text

SEED, FEW, MANY = 77, (3, 6, 16, 20, 22), range(60)  # the few are quick, and have a bifurcation each

COARSE, FINE = 8, 16  # elements; of a self that confirms at first, and where that one cannot tell
AGREES = VERDICTS.index("agrees")


def judge(indices: Iterable[int]) -> int:
    """Number of bifurcations on which both solvers agree; fails where one of them is not confirmed."""
    agreed = 0
    for index in indices:
        one = drawn(SEED, index)
        found = branch(one.problem, one.path, one.low, one.high, options={"n_modes": 8}, max_points=200, effort=200)
        if (found.bifurcation_kind.values == KINDS.index("unresolved")).all():
            continue
        confirmed = confirm(found, options={"elements": COARSE})
        assert not (confirmed.verdict.values == VERDICTS.index("apart")).any(), index
        if (confirmed.verdict.values != AGREES).any():  # beside a graze, few elements may find no motion, or no error
            confirmed = confirm(found, options={"elements": FINE})
        faults = np.flatnonzero(confirmed.verdict.values != AGREES)
        assert not faults.size, [f"{index}: {disagreement_text(confirmed, int(j))}" for j in faults]
        assert (confirmed.other_value.values != confirmed.value.values).all()
        agreed += confirmed.sizes["bifurcation"]
    return agreed


def test_both_solvers_agree_on_the_bifurcations_of_a_few_random_joints() -> None:
    assert judge(FEW) >= len(FEW)


@pytest.mark.thorough
def test_both_solvers_agree_on_the_bifurcations_of_random_joints() -> None:
    assert judge(MANY) >= len(MANY)
