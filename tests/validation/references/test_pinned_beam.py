"""The sum over sines obeys the differential equation, and the case that it judges catches what was not seen before."""

from __future__ import annotations

import math

import pytest

from validation.cases import pinned_beam
from validation.references.pinned_beam import PinnedBeam


def test_the_sum_obeys_the_equation_of_motion_once_the_transient_is_gone() -> None:
    beam, t, h, k = PinnedBeam.from_toml(pinned_beam.RINGING), 30.0, 1e-4, 1e-3
    m, C, x = 7850 * 0.04 * 0.012, 13.0, 0.7
    z = [beam.evaluate(x, t + i * h) for i in (-1, 0, 1)]
    z_tt, z_t = (z[0] - 2 * z[1] + z[2]) / h**2, (z[2] - z[0]) / (2 * h)
    bending = (beam.shear(x + k, t) - beam.shear(x - k, t)) / (2 * k)
    load = m * (2e-3 * 120.0**2 * math.sin(120.0 * t + 0.4) + 3e-4 * 240.0**2 * math.sin(240.0 * t - 0.9))
    assert bending + m * z_tt + C * z_t == pytest.approx(load, rel=1e-3)


def test_the_static_part_is_the_deflection_of_the_textbooks() -> None:
    text = pinned_beam.LOADED.split("[base_motion]")[0] + '[[point_loads]]\nkind = "step"\nx = 0.8\nforce = 42.0'
    beam, EI, late = PinnedBeam.from_toml(text), 2.1e11 * 0.04 * 0.012**3 / 12, 100.0
    assert beam.evaluate(0.8, late) == pytest.approx(42.0 * 1.6**3 / (48 * EI), rel=1e-9)
    assert beam.moment(0.8, late) == pytest.approx(-42.0 * 1.6 / 4, rel=1e-9)
    assert [beam.shear(x, late) for x in (0.3, 1.3)] == pytest.approx([-21.0, 21.0], rel=1e-9)


def test_initial_shapes_are_those_of_the_file() -> None:
    beam = PinnedBeam.from_toml(pinned_beam.RINGING)
    assert beam.evaluate(0.6, 0.0) == pytest.approx(1.8478e-3, rel=1e-6)
    assert beam.evaluate(1.2, 0.0, dt=1) == pytest.approx(0.1, rel=1e-4)
