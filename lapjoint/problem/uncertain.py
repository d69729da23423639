"""Uncertain numbers of a problem: each is a random variable that moves one field, or several together.

The variables are independent of each other.  A campaign with samples draws their values; all other answers are those of
the problem as it stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, ValidationError, model_validator

from lapjoint.errors import InputError
from lapjoint.problem.messages import explain, shown
from lapjoint.problem.override import assign, path_keys, targets
from lapjoint.problem.schema import Finite, FloatArray, Part, Positive
from lapjoint.problem.tables import copied, tables_of

if TYPE_CHECKING:
    from pydantic import BaseModel

OUTERMOST = 2.0**-31
"""Probability below the smallest value that is ever drawn, and above the largest one: half of the resolution of the
Sobol points, of 30 bits.  Of a normal distribution these values lie 6.1 deviations from the mean."""


class UncertainNumber(Part):
    """A random variable, and the fields that it moves; each kind below has a distribution."""

    name: str
    """Name of the variable: a word of letters, digits and _."""
    paths: Annotated[tuple[str, ...], Field(min_length=1)]
    """The fields that it moves, as --set names them: ["stops.*.gap"]."""
    apply: Literal["value", "factor"] = "value"
    """"value": the fields take the drawn value; "factor": each field is its number in the file times the drawn one."""

    @model_validator(mode="after")
    def _named(self) -> Self:
        if not self.name.isidentifier():
            raise ValueError(f"name = {shown(self.name)}: must be a word of letters, digits and _")
        for i, path in enumerate(self.paths):
            if not path_keys(path):
                raise ValueError(f"paths[{i}] = {shown(path)}: must be the path of a number, as stops.*.gap")
        return self

    def quantiles(self, probability: FloatArray) -> FloatArray:
        """The values below which the variable lies with given probabilities.

        Parameters
        ----------
        probability : FloatArray
            Probabilities between 0 and 1, any shape.

        Returns
        -------
        FloatArray
            The values, of the same shape; in the SI unit of the fields, or factors.
        """
        raise NotImplementedError


class Normal(UncertainNumber):
    """A normal distribution, cut off at `low` and `high` where they are given."""

    kind: Literal["normal"]
    mean: Finite
    """Mean, before anything is cut off."""
    deviation: Positive
    """Standard deviation, before anything is cut off."""
    low: Finite | None = None
    """Smallest value; none, if not given."""
    high: Finite | None = None
    """Largest value; none, if not given."""

    @model_validator(mode="after")
    def _around_the_mean(self) -> Self:
        for name, sign in (("low", 1), ("high", -1)):
            end = getattr(self, name)
            if end is not None and not sign * end < sign * self.mean:
                side = "below" if sign > 0 else "above"
                raise ValueError(f"{name} = {end:g}: must be {side} the mean, {self.mean:g}")
        return self

    def quantiles(self, probability: FloatArray) -> FloatArray:
        """See `UncertainNumber.quantiles`."""
        from scipy.special import ndtr, ndtri

        low = 0.0 if self.low is None else ndtr((self.low - self.mean) / self.deviation)
        high = 1.0 if self.high is None else ndtr((self.high - self.mean) / self.deviation)
        values = self.mean + self.deviation * ndtri(low + probability * (high - low))
        return np.asarray(np.clip(values, self.low, self.high))


class Lognormal(UncertainNumber):
    """A variable above 0 whose logarithm is normal."""

    kind: Literal["lognormal"]
    mean: Positive
    """Mean of the variable itself."""
    deviation: Positive
    """Standard deviation of the variable itself."""

    def quantiles(self, probability: FloatArray) -> FloatArray:
        """See `UncertainNumber.quantiles`."""
        from scipy.special import ndtri

        square = np.log1p((self.deviation / self.mean) ** 2)
        return np.asarray(self.mean * np.exp(np.sqrt(square) * ndtri(probability) - square / 2))


class Uniform(UncertainNumber):
    """All values between two are equally likely."""

    kind: Literal["uniform"]
    low: Finite
    """Smallest value."""
    high: Finite
    """Largest value."""

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"high = {self.high:g}: must be above low, {self.low:g}")
        return self

    def quantiles(self, probability: FloatArray) -> FloatArray:
        """See `UncertainNumber.quantiles`."""
        return self.low + probability * (self.high - self.low)


class Triangular(UncertainNumber):
    """The density rises linearly from `low` to `mode`, and falls linearly to `high`."""

    kind: Literal["triangular"]
    low: Finite
    """Smallest value."""
    mode: Finite
    """Likeliest value."""
    high: Finite
    """Largest value."""

    @model_validator(mode="after")
    def _ascending(self) -> Self:
        if not self.low < self.high:
            raise ValueError(f"high = {self.high:g}: must be above low, {self.low:g}")
        if not self.low <= self.mode <= self.high:
            raise ValueError(f"mode = {self.mode:g}: must be from low, {self.low:g}, to high, {self.high:g}")
        return self

    def quantiles(self, probability: FloatArray) -> FloatArray:
        """See `UncertainNumber.quantiles`."""
        width, left, right = self.high - self.low, self.mode - self.low, self.high - self.mode
        rising = self.low + np.sqrt(probability * width * left)
        falling = self.high - np.sqrt((1 - probability) * width * right)
        return np.where(probability * width < left, rising, falling)


class Listed(UncertainNumber):
    """One of several values, each with the same probability."""

    kind: Literal["list"]
    values: Annotated[tuple[Finite, ...], Field(min_length=2)]
    """The values."""

    def quantiles(self, probability: FloatArray) -> FloatArray:
        """See `UncertainNumber.quantiles`; the values are taken in ascending order."""
        places = np.asarray(probability) * len(self.values)
        return np.asarray(np.sort(self.values)[np.minimum(places.astype(int), len(self.values) - 1)])


Uncertain = Annotated[Normal | Lognormal | Uniform | Triangular | Listed, Field(discriminator="kind")]


def with_drawn(
    tables: dict[str, Any], uncertain: Sequence[UncertainNumber], drawn: Sequence[float], source: str = "uncertain"
) -> dict[str, Any]:
    """A copy of the tables of a problem in which each variable has its drawn value; messages begin with `source`."""
    changed: dict[str, Any] = copied(tables)
    for one, number in zip(uncertain, drawn, strict=True):
        for path in one.paths:
            for place, there in targets(tables, path, source):
                assign(changed, place, number * there if one.apply == "factor" else number, source)
    return changed


def uncertain_faults(problem: BaseModel, uncertain: Sequence[UncertainNumber]) -> Iterator[str]:
    """A line for each uncertain number of a problem, valid otherwise, that moves no field, or one that another moves,
    or can be drawn as a value with which the problem is refused."""
    tables = tables_of(problem)
    tables.pop("uncertain", None)
    names: set[str] = set()
    moved: dict[str, str] = {}
    for i, one in enumerate(uncertain):
        if one.name in names:
            yield f"uncertain[{i}].name = {shown(one.name)}: is there twice"
        names.add(one.name)
        faults = [*_of_paths(f"uncertain[{i}]", one, tables, moved)]
        yield from faults or _of_ends(f"uncertain[{i}]", one, tables, type(problem))


def _of_paths(here: str, one: UncertainNumber, tables: dict[str, Any], moved: dict[str, str]) -> Iterator[str]:
    """A line for each path that leads nowhere, or to a field that is moved already or has no number to multiply;
    `moved` has the variable of each field so far."""
    for j, path in enumerate(one.paths):
        source = f"{here}.paths[{j}] = {shown(path)}"
        try:
            found = targets(tables, path, source)
            for place, _ in found:
                assign(copied(tables), place, 0.0, source)
        except InputError as error:
            yield str(error)
            continue
        if not found:
            yield f"{source}: leads to nothing; the problem has no such part"
        for place, there in found:
            if place in moved:
                yield f"{source}: {place} is moved by {moved[place]} already; a field has one uncertain number"
                break
            moved[place] = one.name
            if one.apply == "factor" and not _is_scaled(there):
                text = "is not given" if there is None else f"is {shown(there)}"
                yield f'{source}: {place} {text}; apply = "factor" needs a finite number there other than 0'
                break


def _is_scaled(there: Any) -> bool:
    return isinstance(there, int | float) and not isinstance(there, bool) and bool(np.isfinite(there)) and there != 0


def _of_ends(here: str, one: UncertainNumber, tables: dict[str, Any], model: type[BaseModel]) -> Iterator[str]:
    """A line if the problem is refused with the smallest or the largest value that can be drawn."""
    for end in one.quantiles(np.array([OUTERMOST, 1 - OUTERMOST])).tolist():
        changed = with_drawn(tables, [one], [end])
        try:
            model.model_validate(changed)
        except ValidationError as error:
            fault = explain(error, changed, model).split("\n")[0]
            if error.errors()[0]["type"] == "extra_forbidden":
                yield f"{here}.paths: {fault}"
            else:
                cut = isinstance(one, Normal) and (one.low is None or one.high is None)
                advice = "; low and high cut a normal distribution off" if cut else ""
                yield f"{here}: {one.name} can be drawn as {end:.4g}, and is refused then: {fault}{advice}"
            return
