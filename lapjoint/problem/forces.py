"""Everything that drives the beam, as flat lists of forces: solvers need not know the kinds of excitation."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.problem.excitation import MOST_MULTIPLE, AnyBaseMotion, PointLoad
from lapjoint.problem.ramps import RampBlocks, RandomForce, RecordedForce, SampledForce
from lapjoint.problem.random_motion import RandomBaseMotion, RandomLoad
from lapjoint.problem.records import RecordBaseMotion, RecordLoad
from lapjoint.problem.schema import FloatArray

_WHOLE = 1e-12
"""Relative distance of a quotient of frequencies from a whole number, below which it is rounding."""


@dataclass(frozen=True)
class ConstantForce:
    """A force at a point, from t = 0 on."""

    x: float
    """Position, m."""
    force: float
    """N, positive upwards."""

    def at(self, t: FloatArray) -> FloatArray:
        """The force at times `t`, s, shape (m,), in N."""
        return np.full(np.shape(t), self.force)


@dataclass(frozen=True)
class HarmonicForce:
    """A force amplitude sin(angular_frequency t + phase), at a point or uniform along the beam."""

    x: float | None
    """Position, m; None for the inertia of the moving base, which is uniform along the beam."""
    amplitude: float
    """N at a point, N/m along the beam; positive upwards."""
    angular_frequency: float
    """rad/s."""
    phase: float
    """rad."""

    def at(self, t: FloatArray) -> FloatArray:
        """The force at times `t`, s, shape (m,), in N at a point, or N/m along the beam."""
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

    @property
    def every(self) -> tuple[ConstantForce | HarmonicForce | SampledForce, ...]:
        """The constant ones, the harmonic ones, and the sampled ones."""
        return (*self.constant, *self.harmonic, *self.sampled)

    @cached_property
    def ramps(self) -> RampBlocks | None:
        """The sampled forces at the knots of all of them; None if there are no sampled forces."""
        return RampBlocks(self.sampled) if self.sampled else None

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


def inertial_load(mass_per_length: float, amplitude: float, angular_frequency: float) -> float:
    """m Y omega^2, N/m: amplitude of the force on each part of a beam, relative to a base that moves as a sine."""
    return mass_per_length * amplitude * angular_frequency**2


def forces_of(
    mass_per_length: float, base: AnyBaseMotion | None, loads: Iterable[PointLoad], fundamental: float | None
) -> Forces:
    """The forces by which a moving base and point loads drive the beam: relative to a base y(t) its parts feel -m y''.

    All periodic parts are whole multiples of the angular frequency `fundamental`, rad/s; None where there is none.
    """
    constant, harmonic = [], []
    sampled: list[SampledForce] = []
    if isinstance(base, RecordBaseMotion):
        sampled.append(RecordedForce(None, base.motion.time, -mass_per_length * base.motion.acceleration))
    if isinstance(base, RandomBaseMotion):
        sampled.append(RandomForce(None, base.realisation, -mass_per_length))
    for wave in () if base is None else base.waves:
        inertia = inertial_load(mass_per_length, wave.amplitude, wave.angular_frequency)
        harmonic.append(HarmonicForce(None, inertia, wave.angular_frequency, wave.phase))
    for i, load in enumerate(loads):
        if load.constant:
            constant.append(ConstantForce(load.x, load.constant))
        if isinstance(load, RecordLoad):
            sampled.append(RecordedForce(load.x, load.time, load.force))
        if isinstance(load, RandomLoad):
            sampled.append(RandomForce(load.x, load.realisation(i), 1.0))
        harmonic += [HarmonicForce(load.x, w.amplitude, w.angular_frequency, w.phase) for w in load.waves]
    return Forces(tuple(constant), tuple(harmonic), None if sampled else fundamental, tuple(sampled))
