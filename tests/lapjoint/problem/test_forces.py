"""The flat list of forces is what base motion and point loads amount to, by arithmetic."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.problem import (
    BaseHarmonic,
    BaseMotion,
    Beam,
    HarmonicsBaseMotion,
    HarmonicsLoad,
    LoadHarmonic,
    PointLoad,
    Problem,
    SineLoad,
    StepLoad,
)
from lapjoint.problem.forces import ConstantForce, HarmonicForce
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.ramps import RampBlocks, RecordedForce

BEAM = Beam(length=2.0, bending_stiffness=3.0, mass_per_length=1.25)
INERTIA = LoadShape(pieces=((0.0, 2.0, 1.25),))
TIMES = np.linspace(0.0, 2.0, 9)


def test_a_moving_base_acts_by_the_inertia_of_the_beam() -> None:
    base = BaseMotion(amplitude=2e-3, angular_frequency=7.0, phase=0.4)
    (force,) = Problem(beam=BEAM, base_motion=base).forces.every
    assert force.shape == INERTIA
    acceleration = 2e-3 * 49 * np.sin(7 * TIMES + 0.4)
    assert np.allclose(force.at(TIMES), acceleration, rtol=1e-12)
    assert np.allclose(-base.at(TIMES, 2), acceleration, rtol=1e-12)


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
    assert forces.constant == (ConstantForce(LoadShape.at(1.0), 4.0),)
    assert forces.harmonic == (
        HarmonicForce(INERTIA, 0.0, 70.0, 0.0, of_base=True),
        HarmonicForce(LoadShape.at(0.5), -3.0, 11.0, 1.0),
    )
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
    first = RecordedForce(INERTIA, np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, -2.0]))
    second = RecordedForce(LoadShape.at(0.5), np.array([0.0, 1.0 + 1e-12, 2.0, 4.0]), np.array([5.0, 5.0, 7.0, 9.0]))
    ramps = RampBlocks((first, second)).block_at(0.0)
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
    ramps = RampBlocks((RecordedForce(INERTIA, even, even),)).block_at(0.0)
    assert abs(ramps.spacing - 1e-3) < 1e-18
    uneven = RampBlocks((RecordedForce(INERTIA, even**1.5, even),)).block_at(0.0)
    assert not np.any(np.abs(np.diff(uneven.time)[1:] - uneven.spacing) < 1e-12)


def harmonics(omega: float, *multiples: int, amplitude: float = 1e-3) -> HarmonicsBaseMotion:
    """A base that moves by some harmonics of one size."""
    return HarmonicsBaseMotion(
        angular_frequency=omega,
        harmonics=tuple(BaseHarmonic(multiple=n, amplitude=amplitude, phase=0.1 * n) for n in multiples),
    )


def test_harmonics_of_the_base_act_by_their_own_accelerations() -> None:
    problem = Problem(beam=BEAM, base_motion=harmonics(2.0, 1, 5))
    acceleration = 1e-3 * (4 * np.sin(2 * TIMES + 0.1) + 100 * np.sin(10 * TIMES + 0.5))
    assert np.allclose(sum(force.at(TIMES) for force in problem.forces.every), acceleration, rtol=1e-12)
    assert problem.base_motion is not None
    assert np.allclose(-problem.base_motion.at(TIMES, 2), acceleration, rtol=1e-12)
    assert problem.forces.fundamental == 2.0
    assert problem.forces.fastest == 10.0


def test_harmonics_of_a_load_act_at_its_place() -> None:
    load = HarmonicsLoad(
        x=0.5,
        angular_frequency=3.0,
        harmonics=(LoadHarmonic(multiple=4, force=-2.0, phase=0.3), LoadHarmonic(multiple=1, force=0.0)),
    )
    forces = Problem(beam=BEAM, point_loads=(load,)).forces
    assert forces.harmonic == (
        HarmonicForce(LoadShape.at(0.5), -2.0, 12.0, 0.3),
        HarmonicForce(LoadShape.at(0.5), 0.0, 3.0, 0.0),
    )
    assert forces.fundamental == 3.0


def test_one_harmonic_is_a_sine_to_the_last_bit() -> None:
    sine = BaseMotion(amplitude=1e-3, angular_frequency=7.3, phase=0.1)
    one = harmonics(7.3, 1)
    assert one.waves == sine.waves
    assert Problem(beam=BEAM, base_motion=one).forces == Problem(beam=BEAM, base_motion=sine).forces


def test_the_fundamental_is_the_lowest_frequency_that_a_part_states() -> None:
    def of(base: HarmonicsBaseMotion, *omegas: float) -> float | None:
        loads = tuple(SineLoad(x=0.5, force=1.0, angular_frequency=omega) for omega in omegas)
        return Problem(beam=BEAM, base_motion=base, point_loads=loads).excitation_frequency

    assert of(harmonics(60.0, 2, 3)) == 60.0  # it is stated, though nothing moves at it
    assert of(harmonics(60.0, 1, 2), 180.0) == 60.0
    assert of(harmonics(60.0, 1, 2), 30.0) == 30.0
    assert of(harmonics(60.0, 1, 2), 90.0) is None
    assert of(harmonics(30.0, 2, 4), 90.0) == 30.0  # who means that states the lower one
    assert of(harmonics(60.0, 1, amplitude=0.0), 90.0) == 90.0
    assert of(harmonics(0.1, 1, 3), 0.1 * 7) == 0.1


def test_forces_change_sign_in_half_a_period_by_odd_multiples_alone() -> None:
    def change_sign(base: HarmonicsBaseMotion | None, *loads: PointLoad) -> bool:
        forces = Problem(beam=BEAM, base_motion=base, point_loads=loads).forces
        half = TIMES + math.pi / (forces.fundamental or 1.0)
        now, then = (sum(force.at(t) for force in forces.every) for t in (TIMES, half))
        assert np.allclose(now, -np.asarray(then), atol=1e-12) == forces.change_sign or forces.fundamental is None
        return forces.change_sign

    def load(omega: float) -> SineLoad:
        return SineLoad(x=0.5, force=0.01, angular_frequency=omega, phase=0.2)

    assert change_sign(harmonics(2.0, 1, 3, 7))
    assert not change_sign(harmonics(2.0, 1, 2))
    assert not change_sign(harmonics(2.0, 4))
    assert change_sign(harmonics(2.0, 1), load(6.0))
    assert not change_sign(harmonics(2.0, 1), load(1.0))
    assert not change_sign(harmonics(2.0, 1), load(4.0))
    assert not change_sign(harmonics(2.0, 1), StepLoad(x=0.5, force=1.0))
    assert not change_sign(None)
    silent = HarmonicsBaseMotion(
        angular_frequency=2.0,
        harmonics=(BaseHarmonic(multiple=1, amplitude=1.0), BaseHarmonic(multiple=2, amplitude=0.0)),
    )
    assert change_sign(silent)
