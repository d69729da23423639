"""What drives the beam, as one flat list of forces: all that a solver has to know of the kinds of excitation."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from lapjoint.problem.excitation import BaseMotion, PointLoad
from lapjoint.problem.schema import FloatArray


@dataclass(frozen=True)
class ConstantForce:
    """A force at a point, from t = 0 on."""

    x: float
    """Position, m."""
    force: float
    """N, positive upwards."""

    def at(self, t: FloatArray) -> FloatArray:
        """The force at given times.

        Parameters
        ----------
        t : FloatArray, shape (m,)
            Times, s.

        Returns
        -------
        FloatArray, shape (m,)
            N.
        """
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
        """The force at given times.

        Parameters
        ----------
        t : FloatArray, shape (m,)
            Times, s.

        Returns
        -------
        FloatArray, shape (m,)
            N at a point, N/m along the beam.
        """
        return np.asarray(self.amplitude * np.sin(self.angular_frequency * t + self.phase))


@dataclass(frozen=True)
class Forces:
    """All forces of a problem but those of its supports and stops."""

    constant: tuple[ConstantForce, ...]
    harmonic: tuple[HarmonicForce, ...]
    """Those of the base first, then those of the point loads; some may have no size."""

    @property
    def every(self) -> tuple[ConstantForce | HarmonicForce, ...]:
        """The constant ones, then the harmonic ones."""
        return (*self.constant, *self.harmonic)

    @property
    def fastest(self) -> float:
        """The highest angular frequency of a harmonic force that has a size, rad/s; 0 where there is none."""
        return max((force.angular_frequency for force in self.harmonic if force.amplitude), default=0.0)


def forces_of(mass_per_length: float, base: BaseMotion | None, loads: Iterable[PointLoad]) -> Forces:
    """The forces by which a moving base and point loads drive the beam.

    Parameters
    ----------
    mass_per_length : float
        m of the beam, kg/m: relative to a base y(t) every part of it feels the force -m y''.
    base : BaseMotion or None
        The motion of the base.
    loads : iterable of PointLoad
        The point loads.

    Returns
    -------
    Forces
        Each wave of the base, and each constant and each wave of a point load.
    """
    constant, harmonic = [], []
    for wave in () if base is None else base.waves:
        inertia = mass_per_length * wave.amplitude * wave.angular_frequency**2
        harmonic.append(HarmonicForce(None, inertia, wave.angular_frequency, wave.phase))
    for load in loads:
        if load.constant:
            constant.append(ConstantForce(load.x, load.constant))
        harmonic += [HarmonicForce(load.x, w.amplitude, w.angular_frequency, w.phase) for w in load.waves]
    return Forces(tuple(constant), tuple(harmonic))
