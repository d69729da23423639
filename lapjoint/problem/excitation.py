"""The kinds of excitation: periodic, recorded or random motion of the base, and such loads, or constant ones, at
points.

Each kind gives its waves or samples; `lapjoint.problem.forces` makes one list of all of them, which solvers read.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, TypeVar

import numpy as np
from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, model_validator

from lapjoint.problem.messages import shown
from lapjoint.problem.places import Place
from lapjoint.problem.random_motion import RandomBaseMotion, RandomLoad
from lapjoint.problem.records import RecordBaseMotion, RecordLoad
from lapjoint.problem.schema import Finite, FloatArray, NonNegative, Part, Positive, Whole
from lapjoint.problem.slips import number_meant

MOST_MULTIPLE = 10_000
"""Largest multiple of a fundamental: a march over one period takes at least as many steps."""


@dataclass(frozen=True)
class Wave:
    """amplitude sin(angular_frequency t + phase)."""

    amplitude: float
    """m of a base motion, N of a load."""
    angular_frequency: float
    """rad/s."""
    phase: float
    """rad."""


Multiple = Annotated[Whole, Field(ge=1, le=MOST_MULTIPLE)]


class BaseHarmonic(Part):
    """One harmonic of the base, amplitude sin(multiple angular_frequency t + phase)."""

    multiple: Multiple
    """Whole number of times the fundamental."""
    amplitude: NonNegative
    """Amplitude, m."""
    phase: Finite = 0.0
    """Phase, rad."""


class LoadHarmonic(Part):
    """One harmonic of a load, force sin(multiple angular_frequency t + phase)."""

    multiple: Multiple
    """Whole number of times the fundamental."""
    force: Finite
    """Amplitude, N, positive upwards."""
    phase: Finite = 0.0
    """Phase, rad."""


Harmonic = TypeVar("Harmonic", BaseHarmonic, LoadHarmonic)


def _each_multiple_once(harmonics: tuple[Harmonic, ...]) -> tuple[Harmonic, ...]:
    if not harmonics:
        raise ValueError("must have at least one harmonic")
    given = Counter(one.multiple for one in harmonics)
    repeated = [f"multiple {multiple} is given {count} times" for multiple, count in given.items() if count > 1]
    if repeated:
        raise ValueError(f"{', '.join(repeated)}; each must be there once")
    return harmonics


_AtLeastOne = Field(json_schema_extra={"minItems": 1})  # a min_length would count only the valid ones
_EachOnce = AfterValidator(_each_multiple_once)


def _either(schema: dict[str, Any]) -> None:
    """Allow a frequency in Hz beside the angular frequency in a JSON Schema; one of them must be there."""
    hertz = {"type": "number", "exclusiveMinimum": 0, "title": "Frequency"}
    schema["properties"]["frequency"] = hertz | {"description": "Frequency, Hz, in place of angular_frequency."}
    schema["required"].remove("angular_frequency")
    schema["oneOf"] = [{"required": ["angular_frequency"]}, {"required": ["frequency"]}]


class _Periodic(Part):
    """A part with an angular frequency, which a file may give in Hz by the key ``frequency``."""

    model_config = ConfigDict(json_schema_extra=_either)

    @model_validator(mode="before")
    @classmethod
    def _in_radians(cls, data: Any) -> Any:
        """The tables with the angular frequency, rad/s, in place of a frequency, Hz."""
        if not isinstance(data, Mapping) or "frequency" not in data:
            return data
        if "angular_frequency" in data:
            raise ValueError("frequency, angular_frequency: give one of them, in Hz or in rad/s")
        hertz = data["frequency"]
        if isinstance(hertz, bool | str) or not isinstance(hertz, int | float):
            meant = number_meant(hertz) if isinstance(hertz, str) else ""
            raise ValueError(f"frequency = {shown(hertz)}: must be a number{meant}")
        if not 0 < hertz < math.inf:
            raise ValueError(f"frequency = {shown(hertz)}: must be greater than 0 and finite, in Hz")
        kept = {key: value for key, value in data.items() if key != "frequency"}
        return kept | {"angular_frequency": 2 * math.pi * hertz}


class _PeriodicBaseMotion(_Periodic):
    """A motion of the base that consists of waves."""

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which y(t) consists."""
        raise NotImplementedError

    def at(self, t: FloatArray, derivative: int = 0) -> FloatArray:
        """y at times `t`, s, shape (m,), or its `derivative`-th t-derivative, 0 to 2: m, m/s or m/s2."""
        total = np.zeros(np.shape(t))
        for wave in self.waves:
            angle = wave.angular_frequency * t + wave.phase
            turned = (np.sin(angle), np.cos(angle), -np.sin(angle))[derivative]
            total += wave.amplitude * wave.angular_frequency**derivative * turned
        return total


class BaseMotion(_PeriodicBaseMotion):
    """Harmonic motion of the base, y(t) = amplitude sin(angular_frequency t + phase)."""

    kind: Literal["sine"] = "sine"
    amplitude: NonNegative
    """Y, m."""
    angular_frequency: Positive
    """omega, rad/s; or else frequency, Hz."""
    phase: Finite = 0.0
    """Phase, rad."""

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which y(t) consists."""
        return (Wave(self.amplitude, self.angular_frequency, self.phase),)


class HarmonicsBaseMotion(_PeriodicBaseMotion):
    """Periodic motion of the base, y(t) = sum of amplitude sin(multiple angular_frequency t + phase)."""

    kind: Literal["harmonics"] = "harmonics"
    angular_frequency: Positive
    """omega of the fundamental, rad/s, or else frequency, Hz: the motion repeats after 2 pi / omega."""
    harmonics: Annotated[tuple[BaseHarmonic, ...], _AtLeastOne, _EachOnce]
    """Tables of multiple, amplitude and phase, each multiple once."""

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which y(t) consists."""
        return tuple(Wave(one.amplitude, one.multiple * self.angular_frequency, one.phase) for one in self.harmonics)


class StepLoad(Part):
    """A constant transverse force at a point, from t = 0 on."""

    waves: ClassVar[tuple[()]] = ()
    """The waves of which it consists: none."""
    kind: Literal["step"] = "step"
    x: Place
    """Position, m, within the beam; of several beams a place, as ``upper:0.3``."""
    force: Finite
    """Force, N, positive upwards."""

    @property
    def constant(self) -> float:
        """The constant part, N."""
        return self.force


class SineLoad(_Periodic):
    """A transverse force at a point, force sin(angular_frequency t + phase), from t = 0 on."""

    constant: ClassVar[float] = 0.0
    """The constant part, N."""
    kind: Literal["sine"] = "sine"
    x: Place
    """Position, m, within the beam; of several beams a place, as ``upper:0.3``."""
    force: Finite
    """Amplitude, N, positive upwards."""
    angular_frequency: Positive
    """Angular frequency, rad/s; or else frequency, Hz."""
    phase: Finite = 0.0
    """Phase, rad."""

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which it consists."""
        return (Wave(self.force, self.angular_frequency, self.phase),)


class HarmonicsLoad(_Periodic):
    """A transverse force at a point, sum of force sin(multiple angular_frequency t + phase), from t = 0 on."""

    constant: ClassVar[float] = 0.0
    """The constant part, N."""
    kind: Literal["harmonics"] = "harmonics"
    x: Place
    """Position, m, within the beam; of several beams a place, as ``upper:0.3``."""
    angular_frequency: Positive
    """omega of the fundamental, rad/s, or else frequency, Hz: the force repeats after 2 pi / omega."""
    harmonics: Annotated[tuple[LoadHarmonic, ...], _AtLeastOne, _EachOnce]
    """Tables of multiple, force and phase, each multiple once."""

    @property
    def waves(self) -> tuple[Wave, ...]:
        """The waves of which it consists."""
        return tuple(Wave(one.force, one.multiple * self.angular_frequency, one.phase) for one in self.harmonics)


def _sine_by_default(part: Any) -> Any:
    """A part as a file has it, with its kind, which is a sine by default."""
    return {"kind": "sine", **part} if isinstance(part, Mapping) and "kind" not in part else part


_Kinds = Field(discriminator="kind")
AnyBaseMotion = Annotated[
    BaseMotion | HarmonicsBaseMotion | RecordBaseMotion | RandomBaseMotion, _Kinds, BeforeValidator(_sine_by_default)
]
"""A base motion of any kind."""
PointLoad = Annotated[
    StepLoad | SineLoad | HarmonicsLoad | RecordLoad | RandomLoad, _Kinds, BeforeValidator(_sine_by_default)
]
"""A point load of any kind."""


class Excitation(Part):
    """All that drives a beam: a motion of its base, loads at points, or both."""

    base_motion: AnyBaseMotion | None = None
    """The motion of the base."""
    point_loads: tuple[PointLoad, ...] = ()
    """The loads."""


def begun_later(part: Any, time: float) -> Any:
    """A part of an excitation that counts t from a `time`, s, if it is periodic; else the part."""
    if isinstance(part, HarmonicsBaseMotion | HarmonicsLoad):
        moved = [_later_phase(one, one.multiple * part.angular_frequency * time) for one in part.harmonics]
        return part.model_copy(update={"harmonics": tuple(moved)})
    return _later_phase(part, part.angular_frequency * time) if isinstance(part, BaseMotion | SineLoad) else part


def _later_phase(part: Any, by: float) -> Any:
    """A part with a later phase, by `by` rad."""
    return part.model_copy(update={"phase": math.remainder(part.phase + by, 2 * math.pi)})
