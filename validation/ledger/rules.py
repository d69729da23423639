"""From computed numbers to rulings: one rule for each kind of claim, in words and as a function of nothing but numbers.

No ruling is a constant.  What the rules share:

- a printed number is confirmed if both solvers' numbers round to it, or lie within what reading a curve leaves;
- it is a misprint if it is off by no more than a slip of the pen, or contradicts the paper's own arithmetic;
- a claim is overturned if both solvers, converged, say otherwise;
- where the solvers do not say one thing, it cannot be decided.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum

Numbers = Mapping[str, float]


class Ruling(Enum):
    """Ruling on a claim."""

    CONFIRMED = "confirmed"
    MISPRINT = "misprint"
    OVERTURNED = "overturned"
    UNDECIDABLE = "not decidable from the text"


@dataclass(frozen=True)
class Rule:
    """How a ruling follows from numbers."""

    words: str
    judge: Callable[[Numbers], Ruling]
    """Takes the numbers of the claim by name."""


SLIP = 2.0  # Largest error of a misprinted number, in units of its last digit; a larger error overturns the number
READING = 3.0  # Error of frequencies that the text gives as whole offsets from peaks read off a curve, rad/s
SAME_PEAK = 0.01
"""Relative error of a peak frequency read off a curve whose peaks are 50 to 400 rad/s wide at half height."""
PAST_AXIS = 1.05  # Largest value of a drawn curve over the end of its axis
ENOUGH_TRAVEL = 1e-6  # Largest travel within the interval of an event, over a gap
SAME_AMPLITUDE = 1e-3  # Largest difference over the integrated amplitude
STANDS_OUT = 2.0  # Least steepness of a jump over that of the converged curve, which has no jump
ALIKE = 0.05  # Largest relative difference of two solvers on one grid of frequencies that agree
BOUND = 0.01  # Largest excess over a stated bound, over the bound
EVEN = 1e-3  # Largest difference of the two tip stops' impulses over the larger impulse
OFTEN = 0.05  # Least share of the frequencies that is called often
IN_PHASE, AS_LARGE = 30.0, 0.3
"""Largest lag, degrees, and change of the amplitude over the base's, that count as a repetition of the excitation."""
MOST_OF = 0.75  # Least share of the printed frequencies that one density must give
NEARLY_ALL = 0.02  # Largest share of the curve that may be off where modes are said to be enough


def _both(numbers: Numbers, name: str) -> tuple[float, float]:
    return numbers[f"analytic {name}".strip()], numbers[f"fe {name}".strip()]


def _decided(here: bool, there: bool, yes: Ruling, no: Ruling) -> Ruling:
    """Ruling of both solvers; undecidable where they differ."""
    if here != there:
        return Ruling.UNDECIDABLE
    return yes if here else no


def rounded(numbers: Numbers) -> Ruling:
    """A printed number, with half a unit of its last digit."""
    off = [abs(value - numbers["printed"]) / numbers["half unit"] for value in _both(numbers, "")]
    if max(off) <= 1 + 1e-9:
        return Ruling.CONFIRMED
    if min(off) <= 1 + 1e-9:
        return Ruling.UNDECIDABLE
    return Ruling.MISPRINT if max(off) <= 2 * SLIP else Ruling.OVERTURNED


def _density(n: Numbers) -> Ruling:
    if n["fit printed"] >= MOST_OF * n["frequencies"]:
        return Ruling.CONFIRMED
    return Ruling.MISPRINT if n["fit other"] >= MOST_OF * n["frequencies"] else Ruling.UNDECIDABLE


def _near(n: Numbers) -> Ruling:
    a, b = (abs(value - n["printed"]) <= READING for value in _both(n, ""))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _counted(n: Numbers) -> Ruling:
    a, b = (value == n["printed"] for value in _both(n, ""))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.MISPRINT)


def _interval(n: Numbers) -> Ruling:
    return Ruling.CONFIRMED if n["largest spacing"] <= n["printed"] else Ruling.OVERTURNED


def _travel(n: Numbers) -> Ruling:
    a, b = (speed * n["printed"] <= ENOUGH_TRAVEL * n["gap"] for speed in _both(n, "speed"))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _equation_29(n: Numbers) -> Ruling:
    corrected, printed = (
        abs(n[name] - n["integrated"]) <= SAME_AMPLITUDE * n["integrated"] for name in ("corrected", "printed")
    )
    if printed:
        return Ruling.UNDECIDABLE if corrected else Ruling.CONFIRMED
    return Ruling.MISPRINT if corrected else Ruling.OVERTURNED


def _tolerance(n: Numbers) -> Ruling:
    if n["largest change"] == 0:
        return Ruling.UNDECIDABLE
    return Ruling.CONFIRMED if n["largest change"] <= n["printed"] else Ruling.OVERTURNED


def _peak(n: Numbers) -> Ruling:
    a, b = (abs(value - n["printed"]) <= SAME_PEAK * n["printed"] for value in _both(n, ""))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _offset(n: Numbers) -> Ruling:
    a, b = (value * n["printed"] > 0 and abs(value - n["printed"]) <= SAME_PEAK * n["peak"] for value in _both(n, ""))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _arithmetic(n: Numbers) -> Ruling:
    fits = abs(n["by arithmetic"] - n["printed"]) <= n["half unit"] * (1 + 1e-9)
    return Ruling.CONFIRMED if fits else Ruling.MISPRINT


def _ratio(n: Numbers) -> Ruling:
    a, b = (abs(value - n["printed"]) <= n["half unit"] * (1 + 1e-9) for value in _both(n, ""))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _axis(n: Numbers) -> Ruling:
    a, b = (value <= PAST_AXIS * n["printed"] for value in _both(n, ""))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _silent(n: Numbers) -> Ruling:
    a, b = (value == 0 for value in _both(n, "struck"))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _step(n: Numbers) -> Ruling:
    a, b = _both(n, "steepest")
    if abs(a - b) > ALIKE * max(a, b):
        return Ruling.UNDECIDABLE
    return Ruling.OVERTURNED if n["published steepest"] > STANDS_OUT * max(a, b) else Ruling.CONFIRMED


def _settles(n: Numbers) -> Ruling:
    settled = (value == n["frequencies"] for value in _both(n, "stable"))
    a, b = (one and not changes for one, changes in zip(settled, _both(n, "changes"), strict=True))
    if not a and not b and max(_both(n, "stable")) > 0:
        return Ruling.UNDECIDABLE
    return _decided(a, b, Ruling.OVERTURNED, Ruling.CONFIRMED)


def _bound(n: Numbers) -> Ruling:
    a, b = (value <= (1 + BOUND) * n["printed"] for value in _both(n, ""))
    return _decided(a, b, Ruling.CONFIRMED, Ruling.OVERTURNED)


def _even(n: Numbers) -> Ruling:
    even = (value < EVEN for value in _both(n, "asymmetry"))
    a, b = (one and not broken for one, broken in zip(even, _both(n, "broken"), strict=True))
    return _decided(a, b, Ruling.OVERTURNED, Ruling.CONFIRMED)


def _often(n: Numbers) -> Ruling:
    a, b = (value < OFTEN for value in _both(n, "share"))
    return _decided(a, b, Ruling.OVERTURNED, Ruling.CONFIRMED)


def _repeats(n: Numbers) -> Ruling:
    def repeated(solver: str) -> bool:
        return all(
            abs(n[f"{solver} lag {place}"] - 180.0) < IN_PHASE and abs(n[f"{solver} gain {place}"] - 1) < AS_LARGE
            for place in ("middle", "tip")
        )

    return _decided(repeated("analytic"), repeated("fe"), Ruling.CONFIRMED, Ruling.OVERTURNED)


def _enough(n: Numbers) -> Ruling:
    return Ruling.CONFIRMED if n["share off"] <= NEARLY_ALL else Ruling.OVERTURNED


RULES = {
    "table 4": Rule("both round to it: confirmed; off by two units of the last digit: misprint", rounded),
    "density": Rule(f"the density that gives {MOST_OF:.0%} of Table 4 is the one that was used", _density),
    "quoted frequency": Rule(f"both within {READING:g} rad/s, as it is a peak less a whole offset", _near),
    "sixth": Rule("frequencies are counted by both solvers", _counted),
    "tip ratio": Rule("both round to it: confirmed; off by two units of the last digit: misprint", rounded),
    "frequency interval": Rule("no interval is narrower than neighbouring numbers of double precision", _interval),
    "event interval": Rule(f"enough if the fastest impact travels {ENOUGH_TRAVEL:g} of the gap within it", _travel),
    "equation 29": Rule(f"what direct integration gives, to {SAME_AMPLITUDE:.1%}", _equation_29),
    "tolerance": Rule("the largest change by more modes; not decidable where there is no such motion", _tolerance),
    "peak": Rule(f"both have it within {SAME_PEAK:.0%} of its frequency", _peak),
    "offset": Rule(f"both have it on the same side, within {SAME_PEAK:.0%} of the peak's frequency", _offset),
    "offset in percent": Rule("the paper's own numbers, divided", _arithmetic),
    "peak ratio": Rule("both round to it", _ratio),
    "axis": Rule(f"both curves stay within {PAST_AXIS:g} of it", _axis),
    "low frequencies": Rule("neither curve has an impulse there", _silent),
    "step": Rule(f"a jump is the published scheme's alone if {STANDS_OUT:g} times as steep as the converged", _step),
    "aperiodic": Rule(
        "both find stable motions of one period at all frequencies, and no bifurcation between, or at none", _settles
    ),
    "bound": Rule(f"both within {BOUND:.0%} of it, or below", _bound),
    "window": Rule(f"both have both sides alike to {EVEN:g}, and no symmetry breaks between", _even),
    "asymmetric often": Rule(f"at {OFTEN:.0%} of the frequencies from 230 rad/s on", _often),
    "phase lag": Rule(f"within {IN_PHASE:g} degrees of pi, and {AS_LARGE:.0%} of the base's amplitude", _repeats),
    "enough modes": Rule(f"no more than {NEARLY_ALL:.0%} of the curve off by 1 % of the largest impulse", _enough),
}
"""Rules by kind of claim, the first part of its key."""


def rule_of(key: str) -> Rule:
    """The rule of a claim."""
    return RULES[key.partition("/")[0]]
