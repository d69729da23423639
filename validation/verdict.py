"""Numbers with their uncertainty and origin, and the verdict on a pair of numbers.

The difference of two numbers is judged as in ASME V&V 20: it is compared with the combined numerical uncertainty of
both, ``U = sqrt(u_a^2 + u_b^2)`` with expanded uncertainties, not with a percentage chosen by hand.  A requirement may
also set a largest difference, so that a large uncertainty cannot hide a large difference.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum


class Kind(Enum):
    """Origins of a number."""

    COMPUTED = "computed here"
    ANALYTICAL = "analytical"
    PUBLISHED = "published"
    OTHER_CODE = "other code"
    CROSS_METHOD = "cross-method"
    REGRESSION = "regression"


class ErrorSource(Enum):
    """Sources of uncertainty of a computed number."""

    MESH = "mesh"
    MODES = "modes"
    REFINEMENT = "refinement"
    STIFFNESS = "stiffness of a nearly rigid beam"
    ROUNDING = "rounding"
    EVENT_TIMES = "event times"
    ORBIT = "Newton's residual, event times"
    FINITE_TIME = "finite time"
    STATED = "stated as a whole"


def source_name(source: ErrorSource | Kind) -> str:
    """Name of a source of uncertainty for tables: an error source, or the kind of a reference.

    Parameters
    ----------
    source : ErrorSource or Kind
        The source.

    Returns
    -------
    str
        Its name.
    """
    return f"reference: {source.value}" if isinstance(source, Kind) else source.value


class Verdict(Enum):
    """Verdicts on a comparison."""

    AGREE = "agree"
    DISAGREE = "disagree"
    EXPLAINED = "explained"


@dataclass(frozen=True)
class Estimate:
    """A number with its expanded uncertainty, and how both were obtained."""

    value: float
    uncertainty: float
    how: str
    kind: Kind = Kind.COMPUTED
    parts: tuple[tuple[ErrorSource, float], ...] = ()
    """Contributions whose sum is the uncertainty; empty if the uncertainty is not broken down."""

    @property
    def contributions(self) -> tuple[tuple[ErrorSource | Kind, float], ...]:
        """The contributions; an uncertainty that is not broken down is one contribution, named by the kind of the
        number."""
        whole = ErrorSource.STATED if self.kind is Kind.COMPUTED else self.kind
        return self.parts or ((whole, self.uncertainty),)


@dataclass(frozen=True)
class Check:
    """A comparison of two numbers for one quantity."""

    name: str
    unit: str
    a: Estimate
    b: Estimate
    cap: float | None = None
    """Largest relative difference that a requirement allows, in addition to the uncertainty; None without a
    requirement."""
    explanation: str = ""
    """The known reason for a difference of the two numbers; a disagreement with an explanation is no failure."""

    @property
    def difference(self) -> float:
        """The difference a - b, in `unit`."""
        return self.a.value - self.b.value

    @property
    def allowed(self) -> float:
        """Combined expanded uncertainty, in `unit`."""
        return math.hypot(self.a.uncertainty, self.b.uncertainty)

    @property
    def relative(self) -> float:
        """Magnitude of the difference, divided by the larger of the two magnitudes; 0 if both numbers are 0."""
        size = max(abs(self.a.value), abs(self.b.value))
        return abs(self.difference) / size if size else 0.0

    @property
    def verdict(self) -> Verdict:
        """Agree if the difference is within both the uncertainty and the cap; otherwise explained or disagree."""
        within = abs(self.difference) <= self.allowed
        if within and (self.cap is None or self.relative <= self.cap):
            return Verdict.AGREE
        return Verdict.EXPLAINED if self.explanation else Verdict.DISAGREE

    @property
    def used(self) -> float:
        """Magnitude of the difference, divided by the allowed difference; infinite if no difference is allowed and
        there is one."""
        if self.difference == 0:
            return 0.0
        return abs(self.difference) / self.allowed if self.allowed else math.inf

    @property
    def reference(self) -> Kind:
        """Kind of the number that was not computed here; if both were computed here, one method checks the other."""
        given = [e.kind for e in (self.b, self.a) if e.kind is not Kind.COMPUTED]
        return given[0] if given else Kind.CROSS_METHOD

    @property
    def line(self) -> str:
        """The comparison as a line of text."""
        cap = "" if self.cap is None else f", largest relative difference {self.cap:g}"
        text = (
            f"{self.name}: {self.a.value:.9g} against {self.b.value:.9g} {self.unit}, difference "
            f"{self.difference:.2g}, allowed {self.allowed:.2g}{cap}"
        )
        return f"{text}. {self.explanation}" if self.explanation else text


@dataclass(frozen=True)
class Criterion:
    """A number that must lie within limits, for example an observed order, or the residual of an invariant."""

    name: str
    unit: str
    value: float
    low: float
    high: float
    reason: str
    """The reason for the limits."""

    @property
    def verdict(self) -> Verdict:
        """Agree if the value lies within the limits, which NaN never does; else disagree."""
        return Verdict.AGREE if self.low <= self.value <= self.high else Verdict.DISAGREE

    @property
    def line(self) -> str:
        """The criterion as a line of text."""
        return f"{self.name}: {self.value:.3g}, allowed {self.low:g} to {self.high:g} ({self.reason})"
