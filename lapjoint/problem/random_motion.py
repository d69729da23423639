"""Random excitation: a stationary Gaussian acceleration of the base, or force at a point, with a given density.

The realisation depends on the density, the rate and the seed alone (`lapjoint.problem.realisation`).  The default rate
comes from the density, and not from the highest mode of a solver: two solvers, or two resolutions of one, then see the
same forces, and differ by their own errors only.
"""

from __future__ import annotations

import warnings
from functools import cached_property
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from lapjoint.errors import ExcitationWarning
from lapjoint.problem.density import Density
from lapjoint.problem.messages import shown
from lapjoint.problem.places import Place
from lapjoint.problem.realisation import MOST_TAPS, Realisation, edge
from lapjoint.problem.record_units import UNITS
from lapjoint.problem.records import LARGEST
from lapjoint.problem.schema import FloatArray, Part, Positive, Whole

SAMPLES_A_PERIOD = 8.0
"""Default number of samples per period of the highest frequency.  Straight lines between samples take off 10 % of the
density there, which the filter corrects, and add (1/7)^4 = 4e-4 of it at 7 times the highest frequency."""
FEWEST_A_PERIOD = 2.5
"""Least number of samples per period of the highest frequency: with fewer, straight lines between samples add too much
density near the band."""
_MOST_ADDED = 0.01
"""Largest fraction of the density that straight lines may add beyond the band without a warning."""
_BLUNT = 0.5
"""Largest width of the lower edge, divided by the lowest frequency, without a warning."""


def _squares(quantity: str) -> dict[str, float]:
    """SI units in each unit of a density, by its name; the first is the default."""
    named = {(f"({unit})2" if "/" in unit else f"{unit}2"): factor for unit, factor in UNITS[quantity].items()}
    return {f"{name}/Hz": factor**2 for name, factor in named.items()}


DENSITIES = {quantity: _squares(quantity) for quantity in ("acceleration", "force")}
"""SI units in each allowed unit of a density; the first is the default."""


def _ascending(psd: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    if len(psd) < 2:
        raise ValueError(f"there {'is 1 breakpoint' if psd else 'are no breakpoints'}; at least 2 are needed")
    for i, ((one, _), (other, _)) in enumerate(pairwise(psd), start=1):
        if other <= one:
            what = "is there twice" if other == one else f"comes after {one:.12g}"
            raise ValueError(f"{other:.12g} Hz {what} (breakpoint {i + 1}); frequencies must ascend")
    return psd


def _in_pairs(psd: Any) -> Any:
    for i, point in enumerate(psd if isinstance(psd, list | tuple) else ()):
        if not (isinstance(point, list | tuple) and len(point) == 2):
            raise ValueError(f"breakpoint {i + 1} is {shown(point)}; must be [frequency in Hz, density]")
    return psd


_AtLeastTwo = Field(json_schema_extra={"minItems": 2})
LARGEST_SEED = 2**63 - 1
"""Largest seed: whole numbers of TOML, JSON and NetCDF have 64 bits."""


class Random(Part):
    """A stationary Gaussian signal by its power spectral density."""

    waves: ClassVar[tuple[()]] = ()
    """The waves of which it consists: none."""
    psd: Annotated[
        tuple[tuple[Positive, Positive], ...], _AtLeastTwo, BeforeValidator(_in_pairs), AfterValidator(_ascending)
    ]
    """Breakpoints of the one-sided density, [frequency in Hz, density]: log-log between them, nothing outside."""
    unit: str | None = None
    """Unit of the density, e.g. g2/Hz, (mm/s2)2/Hz or kN2/Hz; SI by default."""
    rate: Positive | None = None
    """Samples per second, between which it is linear; by default 8 times the highest frequency."""
    seed: Annotated[Whole, Field(ge=0, le=LARGEST_SEED)] = 0
    """Which of all realisations it is; base and loads are independent of each other also with the same seed."""

    @property
    def _measured(self) -> Literal["acceleration", "force"]:
        """The quantity that has the density."""
        raise NotImplementedError

    @model_validator(mode="after")
    def _possible(self) -> Self:
        allowed = DENSITIES[self._measured]
        if self.unit is not None and self.unit not in allowed:
            raise ValueError(
                f"unit = {shown(self.unit)}: is no unit of a density of {self._measured}; allowed: {', '.join(allowed)}"
            )
        base, rms = next(iter(UNITS[self._measured])), self.rms
        if not (0 < rms * rms < np.inf and 0 < self.density.moment(2) < np.inf):
            raise ValueError(
                f"psd: comes to {rms:g} {base} RMS; its square, and that of its rate of change, must be finite"
            )
        self._check_rate()
        if rms > LARGEST[self._measured]:
            self._warn(
                f"comes to {rms:.3g} {base} RMS, a thousand times what shakers reach; is "
                f"unit = {shown(self.unit or next(iter(allowed)))} right?"
            )
        return self

    def _check_rate(self) -> None:
        """Refuse rates that are too low or too high for the density, and warn where the signal departs from it."""
        rate, top, lowest = self.samples_per_second, self.density.top, self.density.lowest
        if not np.isfinite(rate * MOST_TAPS):
            raise ValueError(f"rate = {rate:g}: is too large for a number")
        if rate < FEWEST_A_PERIOD * top:
            raise ValueError(
                f"rate = {rate:g}: must be at least {FEWEST_A_PERIOD:g} times the highest frequency of the psd, "
                f"{FEWEST_A_PERIOD * top:g} samples a second"
            )
        added = (top / (rate - top)) ** 4
        if added > _MOST_ADDED:
            self._warn(
                f"rate = {rate:g}: straight lines between samples add {added:.1%} of the density at {top:g} Hz at "
                f"{rate - top:g} Hz; {SAMPLES_A_PERIOD * top:g} samples a second add {(SAMPLES_A_PERIOD - 1) ** -4:.2%}"
            )
        smeared = edge(self.density, rate)
        if smeared > lowest:
            raise ValueError(
                f"psd: begins at {lowest:g} Hz, and a filter of {MOST_TAPS} taps at {rate:g} samples a second resolves "
                f"{smeared:.3g} Hz; raise the lowest frequency, or lower the rate or the highest frequency"
            )
        if smeared > _BLUNT * lowest:
            self._warn(f"psd: its lower edge, {lowest:g} Hz, smears over {smeared:.3g} Hz at {rate:g} samples a second")

    def _warn(self, text: str) -> None:
        warnings.warn(f"random {self._measured}: {text}", ExcitationWarning, stacklevel=3)

    @cached_property
    def density(self) -> Density:
        """The density, in the square of m/s2 or N over Hz."""
        factor = DENSITIES[self._measured][self.unit] if self.unit else 1.0
        return Density(tuple(f for f, _ in self.psd), tuple(s * factor for _, s in self.psd))

    @property
    def samples_per_second(self) -> float:
        """The rate that is given, or the default one, Hz."""
        return SAMPLES_A_PERIOD * self.density.top if self.rate is None else self.rate

    @property
    def rms(self) -> float:
        """Root mean square by the density, m/s2 or N."""
        return float(np.sqrt(self.density.moment(0)))

    def _realisation(self, part: int) -> Realisation:
        return Realisation(self.density, self.samples_per_second, self.seed, part)

    @property
    def _spectrum(self) -> str:
        """RMS, band, rate and seed, for remarks."""
        unit, density = next(iter(UNITS[self._measured])), self.density
        return (
            f"random {self._measured}: {self.rms:.4g} {unit} RMS from {density.lowest:g} to {density.top:g} Hz, "
            f"{self.samples_per_second:g} samples a second, seed {self.seed}"
        )


class RandomBaseMotion(Random):
    """Random motion of the base: an acceleration with a given density."""

    kind: Literal["random"] = "random"

    @property
    def _measured(self) -> Literal["acceleration", "force"]:
        return "acceleration"

    @cached_property
    def realisation(self) -> Realisation:
        """The acceleration, m/s2."""
        return self._realisation(0)

    def at(self, t: FloatArray, derivative: int = 0) -> FloatArray:
        """y(t), stationary as the acceleration is, or a t-derivative. See `RecordBaseMotion.at`."""
        return self.realisation.at(t, 2 - derivative)

    @property
    def remark(self) -> str:
        """Its RMS, band, rate, seed, and the RMS motion of the base, in a line."""
        velocity, displacement = (np.sqrt(self.density.moment(power)) for power in (-2, -4))
        return f"{self._spectrum}; the base moves by {displacement:.3g} m RMS with {velocity:.3g} m/s RMS"


class RandomLoad(Random):
    """A random transverse force at a point, with a given density."""

    constant: ClassVar[float] = 0.0
    """The constant part, N."""
    kind: Literal["random"] = "random"
    x: Place
    """Position, m, within the beam; of several beams a place, as ``upper:0.3``."""

    @property
    def _measured(self) -> Literal["acceleration", "force"]:
        return "force"

    def realisation(self, number: int) -> Realisation:
        """The force.

        Parameters
        ----------
        number : int
            Which of the point loads it is, from 0: with one seed all of them, and the base, are independent.

        Returns
        -------
        Realisation
            N, positive upwards.
        """
        return self._realisation(number + 1)

    @property
    def remark(self) -> str:
        """Its RMS, band, rate and seed, in a line."""
        return self._spectrum
