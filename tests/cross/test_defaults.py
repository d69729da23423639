"""What may be left out when a solver is asked."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import FREE, paper_joint


@pytest.mark.parametrize("solver", [analytic.Solver(), fe_lapjoint.Solver()], ids=["analytic", "fe"])
def test_modes_need_no_more_than_the_problem(solver: analytic.Solver | fe_lapjoint.Solver) -> None:
    found = solver.modes(paper_joint())
    assert (found.state, found.angular_frequencies.size) == (FREE, 6)
    again = solver.modes(paper_joint(), FREE, 6)
    np.testing.assert_array_equal(found.angular_frequencies, again.angular_frequencies)
