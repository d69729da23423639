"""Records on trial: the case agrees, and tells of what would be wrong in both solvers alike."""

from __future__ import annotations

import numpy as np
import pytest

from validation.cases import records as case
from validation.references.pinned_beam import PinnedBeam, accelerations


def test_a_constant_record_bends_the_beam_as_the_textbooks_say() -> None:
    text = f'{case.BEAM}[[point_loads]]\nkind = "record"\nx = 0.8\nrate = 0.01\nvalues = [42.0, 42.0]\n'
    beam, EI = PinnedBeam.from_toml(text), 2.1e11 * 0.04 * 0.012**3 / 12
    assert beam.evaluate(0.8, 99.0) == pytest.approx(42.0 * 1.6**3 / (48 * EI), rel=1e-9)
    assert abs(beam.evaluate(0.8, 99.0, dt=1)) < 1e-12
    assert beam.evaluate(0.8, 0.0) == pytest.approx(0.0, abs=1e-9)  # what 600 sines leave of 3 mm


def test_the_witness_starts_from_rest_and_its_velocity_is_the_rate_of_its_displacement() -> None:
    beam, h = PinnedBeam.from_toml(case.shaken()), 1e-6
    assert abs(beam.evaluate(0.9, 0.0)) + abs(beam.evaluate(0.9, 0.0, dt=1)) < 1e-9
    slope = (beam.evaluate(0.9, 0.0302 + h) - beam.evaluate(0.9, 0.0302 - h)) / (2 * h)
    assert beam.evaluate(0.9, 0.0302, dt=1) == pytest.approx(slope, rel=1e-5)


def test_knots_of_a_recorded_velocity_make_its_samples_again() -> None:
    time, values = np.linspace(0.0, 1.0, 12), case.noise(4, 12, 1.0)
    knots, a = accelerations("velocity", time, values)
    again = [values[0] + case.integral(knots, a, t, 1) for t in time.tolist()]
    np.testing.assert_allclose(again, values, rtol=0, atol=1e-12)
