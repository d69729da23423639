"""The kinds of excitation: harmonic motion of the base, and constant or harmonic loads at points.

Each says of which waves it consists; `lapjoint.problem.forces` makes one list of all of them, which solvers read.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from lapjoint.problem.schema import Finite, FloatArray, NonNegative, Part, Positive


@dataclass(frozen=True)
class Wave:
    """amplitude sin(angular_frequency t + phase)."""

    amplitude: float
    """m of a base motion, N of a load."""
    angular_frequency: float
    """rad/s."""
    phase: float
    """rad."""


class BaseMotion(Part):
    """Harmonic motion of the base, y(t) = amplitude sin(angular_frequency t + phase)."""

    amplitude: NonNegative
    """Y, m."""
    angular_frequency: Positive
    """omega, rad/s."""
    phase: Finite = 0.0
    """Phase, rad."""

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which y(t) consists."""
        return (Wave(self.amplitude, self.angular_frequency, self.phase),)

    def at(self, t: FloatArray, derivative: int = 0) -> FloatArray:
        """y(t), or a derivative of it.

        Parameters
        ----------
        t : FloatArray, shape (m,)
            Times, s.
        derivative : int
            Which t-derivative, 0 to 2.

        Returns
        -------
        FloatArray, shape (m,)
            m, m/s or m/s2.
        """
        return _sum_of(self.waves, t, derivative)


class StepLoad(Part):
    """A constant transverse force at a point, from t = 0 on."""

    kind: Literal["step"] = "step"
    x: NonNegative
    """Position, m, within the beam."""
    force: Finite
    """Force, N, positive upwards."""

    @property
    def constant(self) -> float:
        """The part that is constant, N."""
        return self.force

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which the rest consists: none."""
        return ()


class SineLoad(Part):
    """A transverse force at a point, force sin(angular_frequency t + phase), from t = 0 on."""

    kind: Literal["sine"] = "sine"
    x: NonNegative
    """Position, m, within the beam."""
    force: Finite
    """Amplitude, N, positive upwards."""
    angular_frequency: Positive
    """Angular frequency, rad/s."""
    phase: Finite = 0.0
    """Phase, rad."""

    @property
    def constant(self) -> float:
        """The part that is constant, N: none."""
        return 0.0

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which the rest consists."""
        return (Wave(self.force, self.angular_frequency, self.phase),)


PointLoad = Annotated[StepLoad | SineLoad, Field(discriminator="kind")]


def _sum_of(waves: tuple[Wave, ...], t: FloatArray, derivative: int) -> FloatArray:
    """The sum of waves at times ``(m,)``, or a derivative of it."""
    total = np.zeros(np.shape(t))
    for wave in waves:
        angle = wave.angular_frequency * t + wave.phase
        turned = (np.sin(angle), np.cos(angle), -np.sin(angle))[derivative]
        total += wave.amplitude * wave.angular_frequency**derivative * turned
    return total
