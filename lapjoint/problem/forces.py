"""Everything that drives the beam, as flat lists of forces: solvers need not know the kinds of excitation."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.problem.excitation import MOST_MULTIPLE, AnyBaseMotion, PointLoad
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.ramps import RampBlocks, RandomForce, RecordedForce, SampledForce
from lapjoint.problem.random_motion import RandomBaseMotion, RandomLoad
from lapjoint.problem.records import RecordBaseMotion, RecordLoad
from lapjoint.problem.schema import FloatArray
from lapjoint.problem.structure import Structure

_WHOLE = 1e-12
"""Relative distance of a quotient of frequencies from a whole number, below which it is rounding."""


@dataclass(frozen=True)
class ConstantForce:
    """A force that is there from t = 0 on: a step load, gravity or a uniform load."""

    shape: LoadShape
    """Where the force acts."""
    force: float
    """Size: N of a point load, N/m of a uniform load, m/s2 of gravity; positive upwards."""

    def at(self, t: FloatArray) -> FloatArray:
        """The size at times `t`, s, shape (m,)."""
        return np.full(np.shape(t), self.force)


@dataclass(frozen=True)
class HarmonicForce:
    """A force of the size amplitude sin(angular_frequency t + phase)."""

    shape: LoadShape
    """Where the force acts."""
    amplitude: float
    """N of a point load, m/s2 of the inertia of the moving base; positive upwards."""
    angular_frequency: float
    """rad/s."""
    phase: float
    """rad."""
    of_base: bool = False
    """Whether the force is the inertia of the moving base."""

    def at(self, t: FloatArray) -> FloatArray:
        """The size at times `t`, s, shape (m,)."""
        return np.asarray(self.amplitude * np.sin(self.angular_frequency * t + self.phase))


@dataclass(frozen=True)
class Forces:
    """All forces of a problem but those of its supports and stops."""

    constant: tuple[ConstantForce, ...]
    harmonic: tuple[HarmonicForce, ...]
    """Harmonic forces: first those of the base, then those of the point loads.  Amplitudes may be 0."""
    fundamental: float | None = None
    """Angular frequency, rad/s, of which all harmonic forces with an amplitude are whole multiples; None if there is
    none."""
    sampled: tuple[SampledForce, ...] = ()
    """Sampled forces: first those of the base, then those of the point loads."""
    seen: RecordBaseMotion | RandomBaseMotion | None = None
    """The recorded or random motion of the base, if stops fixed in space see it."""

    @property
    def every(self) -> tuple[ConstantForce | HarmonicForce | SampledForce, ...]:
        """The constant ones, the harmonic ones, and the sampled ones."""
        return (*self.constant, *self.harmonic, *self.sampled)

    @cached_property
    def ramps(self) -> RampBlocks | None:
        """The sampled forces at the knots of all of them; None if there are no sampled forces."""
        return RampBlocks(self.sampled, self.seen) if self.sampled else None

    @property
    def fastest(self) -> float:
        """The highest angular frequency of a harmonic force other than 0, rad/s; 0 if there is none."""
        return max((force.angular_frequency for force in self.harmonic if force.amplitude), default=0.0)

    @cached_property
    def usual_rate(self) -> float:
        """The largest `SampledForce.usual_rate`, 1/s; 0 if there are no sampled forces."""
        return max((force.usual_rate for force in self.sampled), default=0.0)

    @property
    def change_sign(self) -> bool:
        """Whether all forces change sign in half a period: no force is constant, and no harmonic is an even
        multiple."""
        omega = self.fundamental
        if omega is None or self.constant:
            return False
        return all(round(force.angular_frequency / omega) % 2 == 1 for force in self.harmonic if force.amplitude)


def common_fundamental(stated: Collection[float]) -> float | None:
    """The lowest of angular frequencies, rad/s, if all are its multiples up to `MOST_MULTIPLE`; else None."""
    lowest = min(stated, default=None)
    return lowest if lowest is not None and all(multiple_of(lowest, omega) for omega in stated) else None


def multiple_of(fundamental: float, omega: float) -> int:
    """Which whole multiple, up to `MOST_MULTIPLE`, the angular frequency `omega` is of `fundamental`; 0 if none."""
    quotient = omega / fundamental
    if not 0.5 < quotient < MOST_MULTIPLE + 0.5:
        return 0
    nearest = round(quotient)
    return nearest if abs(quotient - nearest) <= _WHOLE * nearest else 0


def base_acceleration(amplitude: float, angular_frequency: float) -> float:
    """Y omega^2, m/s2: amplitude of the force per mass on a beam, relative to a base that moves as a sine."""
    return amplitude * angular_frequency**2


def forces_of(
    structure: Structure,
    base: AnyBaseMotion | None,
    loads: Iterable[PointLoad],
    static: Iterable[ConstantForce],
    fundamental: float | None,
) -> Forces:
    """The forces by which a moving base, point loads and `static` loads drive the beam.

    Relative to a base y(t) all masses feel -y'' each.  All periodic parts are whole multiples of the angular frequency
    `fundamental`, rad/s; None where there is none.
    """
    constant, harmonic = list(static), []
    sampled: list[SampledForce] = []
    if isinstance(base, RecordBaseMotion):
        sampled.append(RecordedForce(structure.inertia, base.motion.time, -base.motion.acceleration))
    if isinstance(base, RandomBaseMotion):
        sampled.append(RandomForce(structure.inertia, base.realisation, -1.0))
    for wave in () if base is None else base.waves:
        acceleration = base_acceleration(wave.amplitude, wave.angular_frequency)
        harmonic.append(HarmonicForce(structure.inertia, acceleration, wave.angular_frequency, wave.phase, True))
    for i, load in enumerate(loads):
        place = LoadShape.at(structure.line.at(load.x))
        if load.constant:
            constant.append(ConstantForce(place, load.constant))
        if isinstance(load, RecordLoad):
            sampled.append(RecordedForce(place, load.time, load.force))
        if isinstance(load, RandomLoad):
            sampled.append(RandomForce(place, load.realisation(i), 1.0))
        harmonic += [HarmonicForce(place, w.amplitude, w.angular_frequency, w.phase) for w in load.waves]
    seen = base if isinstance(base, RecordBaseMotion | RandomBaseMotion) else None
    if not any(stop.in_space for stop in structure.stops):
        seen = None
    return Forces(tuple(constant), tuple(harmonic), None if sampled else fundamental, tuple(sampled), seen)
