"""Recorded excitation: the motion of the base, or a force at a point, from a file or from arrays.

Times count from the first sample.  A force is linear between samples; `lapjoint.problem.recorded_motion` interpolates
the motion of a base.
"""

from __future__ import annotations

import warnings
from functools import cached_property
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, ValidationInfo, model_validator

from lapjoint.errors import RecordWarning
from lapjoint.problem.messages import shown
from lapjoint.problem.places import Place
from lapjoint.problem.record_advice import advice
from lapjoint.problem.record_files import Columns, UnreadableError, read_columns
from lapjoint.problem.record_uff import is_uff, read_function
from lapjoint.problem.record_units import TIME_UNITS, UNITS, check_stated
from lapjoint.problem.recorded_motion import RecordedMotion, motion_through
from lapjoint.problem.samples import Samples, Source
from lapjoint.problem.schema import FloatArray, IntArray, Part, Positive, Whole

ORDER = {"displacement": 0, "velocity": 1, "acceleration": 2}
"""Order of the time derivative of the displacement that a quantity is."""
LARGEST = {"acceleration": 2e6, "velocity": 5e3, "displacement": 5e2, "force": 1e9}
"""A thousand times what the largest shakers reach, 200 g, 5 m/s, 0.5 m and 1 MN, in SI units: larger samples raise a
hint that the unit may be wrong."""
HOLE = 1.5
"""Step between samples, over the median step, above which samples are missing: a longer step is nearer to two steps
than to one."""
EVEN = 0.9
"""Least fraction of steps between 0.5 and 1.5 medians at which a record counts as evenly sampled, and longer steps as
holes: a record with more than a tenth of other steps has times of its own."""


class Reading(Part):
    """Where the samples of a record are read, and how."""

    file: str | None = None
    """CSV or UFF file, relative to the folder of the problem file; or else values."""
    dataset: Annotated[Whole | str | None, Field(union_mode="left_to_right")] = None
    """Data set 58 of a UFF file, by its number among these from 1 or its name; only one needs no key."""
    column: Annotated[Whole | str | None, Field(union_mode="left_to_right")] = None
    """Column of the values by its number from 1 or its name; the first that is not the time by default."""
    time_column: Annotated[Whole | str | None, Field(union_mode="left_to_right")] = None
    """Column of the times by its number from 1 or its name; or else rate."""
    skip: Annotated[Whole, Field(ge=0)] = 0
    """Lines of the file to leave out before names of columns and samples."""
    delimiter: Literal[",", ";", "\t", " "] | None = None
    """What stands between columns: comma, semicolon, tab or space; found out by default."""
    decimal: Literal[".", ","] = "."
    """What begins the fraction of a number of the file: a point or a comma."""
    encoding: str = "utf-8"
    """Encoding of the file, e.g. cp1252 or utf-16; a byte order mark may be there."""
    comment: Annotated[str, Field(min_length=1)] = "#"
    """Text at the beginning of lines to leave out."""


class Record(Reading):
    """Samples over time, from a CSV file or from arrays."""

    waves: ClassVar[tuple[()]] = ()
    """Sinusoidal components of the record: none."""
    values: Samples | None = None
    """The samples, where there is no file."""
    times: Samples | None = None
    """Their times, where there is no file; or else rate."""
    rate: Positive | None = None
    """Samples per second, where there are no times."""
    unit: str | None = None
    """Unit of the samples, e.g. g, mm/s, um, kN; SI by default."""
    time_unit: str = "s"
    """Unit of the times: s, ms, us or min."""
    holes: Literal["refuse", "bridge"] = "refuse"
    """Whether holes, steps above 1.5 medians of an evenly sampled record, are refused or bridged by the usual
    interpolation."""
    remove: Literal["nothing", "offset", "drift"] = "nothing"
    """What to take out of the samples: their mean over time (offset), or the straight line nearest to them (drift)."""
    sha256: str | None = None
    """Digest of the samples of a file: if it is given, a file with another digest is refused."""

    @property
    def _measured(self) -> str:
        """The quantity of the samples, a key of `UNITS`."""
        raise NotImplementedError

    @model_validator(mode="before")
    @classmethod
    def _with_samples_of_the_file(cls, data: Any, info: ValidationInfo) -> Any:
        """The tables with samples and digest of their file added; the file is read unless the tables hold its
        samples."""
        if not isinstance(data, dict) or not isinstance(data.get("file"), str):
            return data
        try:
            how = Reading.model_validate({key: data[key] for key in Reading.model_fields if key in data})
            times = it if isinstance(it := data.get("times"), Samples | None) else Samples(it)
        except ValueError:
            return data  # the validation of the fields says what is wrong
        values = data.get("values")
        own = values.source if isinstance(values, Samples) else None
        if (values is not None and own is None) or how.delimiter == how.decimal:
            return data  # refused below
        fields = {name: getattr(how, name) for name in Reading.model_fields}
        source = Source((info.context or {}).get("folder", ".") if own is None else own.folder, **fields)
        if own != source or not isinstance(values, Samples):
            values, times, _ = _read(source)
        found, stated = _digest(values, times), data.get("sha256") if own in (None, source) else None
        if stated not in (None, found):
            raise ValueError(f"sha256 = {shown(stated)}: {shown(how.file)} has changed: its samples now have {found}")
        return data | {"values": values, "times": times, "sha256": found}

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.file is None and self.values is not None and self.values.source is not None:
            raise ValueError("file: is missing; its samples are there without it")
        if self.file is not None and self.values is not None and self.values.source is None:
            raise ValueError("file, values: give one of them")
        if self.file is not None and self.delimiter == self.decimal:
            raise ValueError('delimiter = ",": is the decimal mark, too')
        if self.values is None:
            raise ValueError("file: is missing; allowed are the path of a CSV or UFF file, or values in its place")
        self._check_units()
        self._check_times(self.values)
        size = float(np.max(np.abs(self.values.array))) * self._factor
        if not np.isfinite(size * size):
            raise ValueError(f"values: the largest is {size:g}, and its square must be finite")
        if size > LARGEST[self._measured]:
            base = next(iter(UNITS[self._measured]))
            warnings.warn(
                f"record of {self._measured}: its largest sample is {size:.3g} {base}, a thousand times what shakers "
                f"reach; is unit = {shown(self.unit or base)} right?",
                RecordWarning,
                stacklevel=2,
            )
        return self

    def _check_units(self) -> None:
        allowed = UNITS[self._measured]
        if self.unit is not None and self.unit not in allowed:
            raise ValueError(
                f"unit = {shown(self.unit)}: is no unit of {self._measured}; allowed: {', '.join(allowed)}"
            )
        if self.time_unit not in TIME_UNITS:
            raise ValueError(f"time_unit = {shown(self.time_unit)}: allowed: {', '.join(TIME_UNITS)}")
        assert self.values is not None
        check_stated(self.values.stated, "unit", self.unit or next(iter(allowed)), self._measured, allowed)
        if self.times is not None:
            check_stated(self.times.stated, "time_unit", self.time_unit, "time", TIME_UNITS)

    def _check_times(self, values: Samples) -> None:
        in_file = values.source is not None and self.times is not None and self.time_column is None
        timed = "times" if self.file is None or in_file else "time_column"
        if self.rate is not None and in_file:
            raise ValueError("rate: the file has the times; leave it out")
        if (self.times is None) == (self.rate is None):
            raise ValueError(f"rate, {timed}: give one of them")
        if len(values) < 2:
            there = "is 1 sample" if len(values) else "are no samples"
            raise ValueError(f"values: there {there}; at least 2 are needed")
        if not np.all(np.isfinite(values.array)):
            first = int(np.flatnonzero(~np.isfinite(values.array))[0])
            raise ValueError(f"values[{first}] = {values.array[first]:g}: must be a finite number")
        if self.times is None:
            return
        t = self.times.array
        if t.size != values.array.size:
            raise ValueError(f"times: there are {t.size}, and {values.array.size} values")
        if not np.all(np.isfinite(t)):
            raise ValueError(f"times[{int(np.flatnonzero(~np.isfinite(t))[0])}]: must be a finite number")
        bad = np.flatnonzero(np.diff(t) <= 0)
        if bad.size:
            i = int(bad[0])
            what = "is there twice" if t[i + 1] == t[i] else f"comes after {t[i]:.12g}"
            raise ValueError(f"{timed}: {t[i + 1]:.12g} {what} ({self._place(i + 1)}); times must ascend")
        if self.holes == "refuse" and self._bridged.size:
            i, step = int(self._bridged[0]), np.diff(self.time)
            raise ValueError(
                f"{timed}: {self._place(i + 1)} is at {t[i + 1]:.12g} {self.time_unit}, {step[i]:.6g} s after the "
                f"sample before, and their median step is {np.median(step):.6g} s ({_holes(self._bridged.size)}); "
                'holes = "bridge" takes them'
            )

    @property
    def _factor(self) -> float:
        allowed = UNITS[self._measured]
        return allowed[self.unit or next(iter(allowed))]

    @property
    def si_values(self) -> FloatArray:
        """The samples in SI units, shape ``(n,)``."""
        assert self.values is not None
        return np.asarray(self.values.array * self._factor)

    @property
    def time(self) -> FloatArray:
        """When the samples are, s from the first one, shape ``(n,)``."""
        assert self.values is not None
        if self.times is None:
            assert self.rate is not None
            return np.arange(len(self.values)) / self.rate
        return np.asarray((self.times.array - self.times.array[0]) * TIME_UNITS[self.time_unit])

    @property
    def _bridged(self) -> IntArray:
        """First samples of the steps that are too long in an evenly sampled record, shape ``(holes,)``."""
        if self.times is None:
            return np.zeros(0, dtype=np.int64)
        steps = np.diff(self.times.array) / np.median(np.diff(self.times.array))
        even = np.mean(np.abs(steps - 1) <= HOLE - 1) >= EVEN
        return np.flatnonzero(steps > HOLE) if even else np.zeros(0, dtype=np.int64)

    @property
    def _bridges(self) -> str:
        """A remark on bridged holes; empty if there are none."""
        if not self._bridged.size:
            return ""
        steps = np.diff(self.time)[self._bridged]
        longest = int(np.argmax(steps))
        return (
            f"; {_holes(steps.size)} bridged as from sample to sample, the longest from "
            f"{self.time[self._bridged[longest]]:.6g} s on for {steps[longest]:.6g} s"
        )

    @property
    def duration(self) -> float:
        """From the first sample to the last, s."""
        return float(self.time[-1])

    @property
    def digest(self) -> str:
        """SHA-256 of the samples, and of their times if they have some."""
        assert self.values is not None
        return _digest(self.values, self.times)

    def _place(self, sample: int) -> str:
        """Place of the sample with an index, for messages: its line in the file, if there is one, else its number."""
        source = None if self.values is None else self.values.source
        lines = () if source is None else _read(source).lines
        return f"sample {sample + 1}" if not len(lines) else f"line {lines[sample]}"


class RecordBaseMotion(Record):
    """Recorded motion of the base: acceleration, velocity or displacement over time."""

    kind: Literal["record"] = "record"
    quantity: Literal["acceleration", "velocity", "displacement"]
    """What the samples are."""

    @property
    def _measured(self) -> str:
        return self.quantity

    @cached_property
    def motion(self) -> RecordedMotion:
        """The motion of the base, with a continuous acceleration that is linear between knots."""
        found = self._as_recorded
        if self.remove == "nothing":
            return found
        value, slope = found.line(ORDER[self.quantity])
        return found.without(ORDER[self.quantity], value, slope if self.remove == "drift" else 0.0)

    @cached_property
    def _as_recorded(self) -> RecordedMotion:
        assert self.values is not None
        return motion_through(self.time, self.values.array * self._factor, ORDER[self.quantity])

    def at(self, t: FloatArray, derivative: int = 0) -> FloatArray:
        """y(t), or a derivative of it.

        Parameters
        ----------
        t : FloatArray, shape (m,)
            Times, s, within the record.
        derivative : int
            Which t-derivative, 0 to 2.

        Returns
        -------
        FloatArray, shape (m,)
            m, m/s or m/s2.
        """
        return self.motion.at(t, derivative)

    @property
    def remark(self) -> str:
        """The offset and the drift of the record, in a line."""
        unit = next(iter(UNITS[self.quantity]))
        offset, slope = self._as_recorded.line(ORDER[self.quantity])
        end = np.array([self.motion.time[-1]])
        y, v = (float(self.motion.at(end, n)[0]) for n in (0, 1))
        return (
            f"record of {self.quantity}, {self.duration:g} s: mean {offset:.3g} {unit}, trend {slope:.3g} {unit}/s, "
            f"removed: {self.remove}; the base ends at {y:.3g} m with {v:.3g} m/s"
            f"{self._bridges}"
        )


class RecordLoad(Record):
    """A recorded transverse force at a point."""

    constant: ClassVar[float] = 0.0
    """The constant part, N."""
    kind: Literal["record"] = "record"
    x: Place
    """Position, m, within the beam; of several beams a place, as ``upper:0.3``."""

    @property
    def _measured(self) -> str:
        return "force"

    @property
    def force(self) -> FloatArray:
        """The force at the samples, N, positive upwards, shape ``(n,)``."""
        assert self.values is not None
        f = np.asarray(self.values.array * self._factor)
        if self.remove == "nothing":
            return f
        line = RecordedMotion(self.time, f, (0.0, 0.0)).line(2)
        value, slope = line if self.remove == "drift" else (line[0], 0.0)
        return np.asarray(f - value - slope * (self.time - self.duration / 2))

    @property
    def remark(self) -> str:
        """The offset and the drift of the record, in a line."""
        assert self.values is not None
        offset, slope = RecordedMotion(self.time, self.values.array * self._factor, (0.0, 0.0)).line(2)
        return (
            f"record of force, {self.duration:g} s: mean {offset:.3g} N, trend {slope:.3g} N/s, removed: {self.remove}"
            f"{self._bridges}"
        )


def _read(source: Source) -> Columns:
    """The columns of a file of either kind."""
    if is_uff(source):
        return read_function(source)
    if source.dataset is not None:
        raise ValueError(f"dataset = {shown(source.dataset)}: {shown(source.file)} is no UFF file; column chooses one")
    try:
        return read_columns(source)
    except UnreadableError as error:
        raise ValueError(f"{error}{advice(source) or error.otherwise}") from None


def _digest(values: Samples, times: Samples | None) -> str:
    """SHA-256 of samples, and of their times if they have some."""
    return values.digest if times is None else Samples(np.concatenate([values.array, times.array])).digest


def _holes(number: int) -> str:
    return f"{number} hole" + "s" * (number > 1)
