"""What drives the beam: harmonic motion of its base, and constant or harmonic loads at points."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lapjoint.problem.schema import Finite, NonNegative, Part, Positive


class BaseMotion(Part):
    """Harmonic motion of the base, y(t) = amplitude sin(angular_frequency t + phase)."""

    amplitude: NonNegative
    """Y, m."""
    angular_frequency: Positive
    """omega, rad/s."""
    phase: Finite = 0.0
    """Phase, rad."""


class StepLoad(Part):
    """A constant transverse force at a point, from t = 0 on."""

    kind: Literal["step"] = "step"
    x: NonNegative
    """Position, m, within the beam."""
    force: Finite
    """Force, N, positive upwards."""


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


PointLoad = Annotated[StepLoad | SineLoad, Field(discriminator="kind")]
