"""The case `dragged-masses`: both solvers give the closed form, which obeys the equations, and mistakes are noticed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from validation.cases import dragged_masses
from validation.references.dragged_cantilever import DraggedCantilever
from validation.verdict import Verdict

BEAM = dragged_masses.BEAMS["near resonance"]


def test_both_solvers_give_the_closed_form() -> None:
    assert dragged_masses.run("quick", lambda _: None).verdict is Verdict.AGREE


def test_the_closed_form_obeys_the_equations_of_the_beam_and_of_its_mass() -> None:
    t, w = np.array([0.0, 0.02]), BEAM.omega
    quarter = t + np.pi / 2 / w  # where a sine is at its cosine
    base = BEAM.amplitude * np.sin(w * t)
    for x, EI, m in ((0.2, BEAM.stiffness[0], BEAM.inertia[0]), (0.8, BEAM.stiffness[1], BEAM.inertia[1])):
        at = np.array([x])
        z, z4, rate = BEAM.evaluate(at, t), BEAM.evaluate(at, t, 4), w * BEAM.evaluate(at, quarter)
        assert EI * z4 == pytest.approx(m * w**2 * (z + base) - BEAM.drag * rate, rel=1e-10)
    tip = np.array([sum(BEAM.lengths)])
    z, slope, bent, shear = (BEAM.evaluate(tip, t, dx) for dx in range(4))
    assert BEAM.stiffness[1] * bent == pytest.approx(w**2 * BEAM.rotary * slope, rel=1e-9)
    assert BEAM.stiffness[1] * shear == pytest.approx(-(w**2) * BEAM.mass * (z + base), rel=1e-9)
    for dx in (0, 1):
        assert BEAM.evaluate(np.zeros(1), t, dx) == pytest.approx(np.zeros((1, 2)), abs=1e-15)
    step = BEAM.lengths[0] * (1 + 1e-12 * np.array([-1, 1]))
    for dx in range(4):
        left, right = BEAM.evaluate(step, t, dx) * (np.array(BEAM.stiffness)[:, None] if dx > 1 else 1.0)
        assert left == pytest.approx(right, rel=1e-8)


def test_damping_that_is_a_hundredth_off_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def wrong(beam: DraggedCantilever) -> object:
        return right(replace(beam, drag=1.01 * beam.drag))

    right = dragged_masses.problem_of
    monkeypatch.setattr(dragged_masses, "problem_of", wrong)
    assert dragged_masses.run("quick", lambda _: None).verdict is Verdict.DISAGREE
