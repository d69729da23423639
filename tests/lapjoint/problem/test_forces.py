"""The flat list of forces is what base motion and point loads amount to, by arithmetic."""

from __future__ import annotations

import numpy as np

from lapjoint.problem import BaseMotion, Beam, Problem, SineLoad, StepLoad
from lapjoint.problem.forces import ConstantForce, Forces, HarmonicForce, SampledForce

BEAM = Beam(length=2.0, bending_stiffness=3.0, mass_per_length=1.25)
TIMES = np.linspace(0.0, 2.0, 9)


def test_a_moving_base_acts_by_the_inertia_of_the_beam() -> None:
    base = BaseMotion(amplitude=2e-3, angular_frequency=7.0, phase=0.4)
    (force,) = Problem(beam=BEAM, base_motion=base).forces.every
    assert force.x is None
    inertia = 1.25 * 2e-3 * 49 * np.sin(7 * TIMES + 0.4)
    assert np.allclose(force.at(TIMES), inertia, rtol=1e-12)
    assert np.allclose(-1.25 * base.at(TIMES, 2), inertia, rtol=1e-12)


def test_the_base_moves_as_its_derivatives_say() -> None:
    base, h = BaseMotion(amplitude=2e-3, angular_frequency=7.0, phase=0.4), 1e-6
    for derivative in (0, 1):
        slope = (base.at(TIMES + h, derivative) - base.at(TIMES - h, derivative)) / (2 * h)
        assert np.allclose(base.at(TIMES, derivative + 1), slope, atol=1e-8 * 2e-3 * 7.0**3)


def test_loads_at_points_come_after_the_base_and_empty_constants_not_at_all() -> None:
    loads = (
        SineLoad(x=0.5, force=-3.0, angular_frequency=11.0, phase=1.0),
        StepLoad(x=1.0, force=4.0),
        StepLoad(x=1.5, force=0.0),
    )
    base = BaseMotion(amplitude=0.0, angular_frequency=70.0)
    forces = Problem(beam=BEAM, base_motion=base, point_loads=loads).forces
    assert forces.constant == (ConstantForce(1.0, 4.0),)
    assert forces.harmonic == (HarmonicForce(None, 0.0, 70.0, 0.0), HarmonicForce(0.5, -3.0, 11.0, 1.0))
    assert np.array_equal(forces.constant[0].at(TIMES), np.full(9, 4.0))
    assert np.allclose(forces.harmonic[1].at(TIMES), -3.0 * np.sin(11 * TIMES + 1), rtol=1e-12)


def test_the_fastest_force_is_one_that_has_a_size() -> None:
    load = SineLoad(x=0.5, force=0.0, angular_frequency=11.0)
    base = BaseMotion(amplitude=1e-3, angular_frequency=3.0)
    assert Problem(beam=BEAM).forces.fastest == 0.0
    assert Problem(beam=BEAM, base_motion=base, point_loads=(load,)).forces.fastest == 3.0
    louder = load.model_copy(update={"force": 1.0})
    assert Problem(beam=BEAM, base_motion=base, point_loads=(louder,)).forces.fastest == 11.0


def test_sampled_forces_are_linear_between_the_knots_of_all() -> None:
    first = SampledForce(None, np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, -2.0]))
    second = SampledForce(0.5, np.array([0.0, 1.0 + 1e-12, 2.0, 4.0]), np.array([5.0, 5.0, 7.0, 9.0]))
    ramps = Forces((), (), (first, second)).ramps
    assert ramps is not None
    assert ramps.time.tolist() == [0.0, 1.0, 2.0, 3.0]  # up to where the first of them ends
    t = np.array([0.25, 1.0, 1.5, 2.75])
    force, slope = ramps.at(t)
    assert np.allclose(force, np.stack([first.at(t), second.at(t)], axis=1), rtol=1e-11)
    assert np.allclose(slope, [[2.0, 0.0], [-2.0, 2.0], [-2.0, 2.0], [-2.0, 1.0]], atol=1e-10)
    assert ramps.until(1.0) == 2.0
    assert ramps.until(3.0) == np.inf
    assert ramps.spacing == 1.0


def test_knots_that_are_uneven_have_no_spacing_of_their_own() -> None:
    even = np.arange(1001) / 1000.0
    assert SampledForce(None, even, even).x is None
    ramps = Forces((), (), (SampledForce(None, even, even),)).ramps
    assert ramps is not None
    assert abs(ramps.spacing - 1e-3) < 1e-18
    uneven = Forces((), (), (SampledForce(None, even**1.5, even),)).ramps
    assert uneven is not None
    assert not np.any(np.abs(np.diff(uneven.time)[1:] - uneven.spacing) < 1e-12)
