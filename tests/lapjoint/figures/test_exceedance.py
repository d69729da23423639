"""Rates of exceedance are drawn as the dataset has them, of stops that were touched."""

from __future__ import annotations

import numpy as np
import pytest
from noisy import bar

from lapjoint import InputError
from lapjoint.figures import plot_exceedance
from lapjoint.summaries.measure import measure, sums_of
from lapjoint.summaries.quantities import selection
from lapjoint.summaries.table import table


def test_each_stop_that_was_touched_has_a_line() -> None:
    problem, solver = bar(3)
    what = measure(selection(problem, quantities=["displacement"]), solver, 470.0)  # type: ignore[arg-type]
    found = table(what, sums_of(what, solver, problem))  # type: ignore[arg-type]
    axes = plot_exceedance(found, quantity="peak_force")
    assert [line.get_label() for line in axes.lines] == ["near", "far"]
    rate = found.peak_force_exceedance.values[0]
    assert np.array_equal(axes.lines[0].get_ydata(), rate[rate > 0])
    with pytest.raises(InputError, match="quantity = 'weight': allowed are impulse, peak_force"):
        plot_exceedance(found, quantity="weight")
    with pytest.raises(InputError, match="nothing was touched"):
        plot_exceedance(found.assign(impulse_count=0 * found.impulse_count))
