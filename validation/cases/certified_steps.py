"""Are the steps of the analytic march as long as its bound allows, and never longer?

Between two switches the march takes steps within which no stop can switch: up to just below the first root of

    h + h' t + h'' t^2 / 2 + B t^3 / 6,

where h is the gap function and B a bound on its third derivative.  Longer steps could miss contacts; shorter steps
would only cost time.  The steps of random cubics, many of which nearly touch zero before they rise through it, are
compared with numpy's roots.  The sums over modes and harmonics that are the coefficients of the cubic, and their
propagation in time, are compared with numpy's exponentials.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

from analytic.march.gap_function import add_terms, at_position
from analytic.march.step_bound import crosses, first_root_of_bound
from analytic.march.terms import SERIES, turn_briefly, turn_exactly
from lapjoint.problem import FloatArray
from validation.case import CaseResult, Level, Say, table
from validation.verdict import Criterion

CUBICS = 4000
LONGEST = 10.0  # Requested step, s; about two thirds of the cubics have their root within it
BELOW = 1e-3  # Largest distance of a step's end below the root, divided by the root
CLOSE = 1e-8
"""Largest distance of a step's end below the root, divided by the root, if the gap function rises steadily to the
root."""
STEADILY = 0.3  # Largest change of the rate up to the root of a cubic that rises steadily, divided by the rate
TOUCHING = 1e-4  # Distance of the first maximum from zero, divided by the rise to it, of cubics that nearly touch zero
ROUNDED = 1e-9  # Relative rounding of numpy's roots, within which the sign of a cubic is unknown
TERMS, HARMONICS, PLACES = 12, 3, 2
SUMMED = 1e-13  # Relative rounding of some tens of operations
SHORTLY = 1e-3  # Time, s, after which a gap function should be above zero; half a root is 0.01 to 10 s


def cubics() -> FloatArray:
    """Random coefficients h, h', h'', B, shape (CUBICS, 4), with h below zero and B above; half of the cubics touch
    zero."""
    rng = np.random.default_rng(17)
    h = -(10.0 ** rng.uniform(-6, 1, CUBICS))
    found = np.stack([h, rng.standard_normal(CUBICS), 3 * rng.standard_normal(CUBICS), rng.uniform(0.1, 5, CUBICS)], 1)
    for one in found[::2]:
        at = first_maximum(one)
        if at > 0:
            top = value(one, at) - one[0]
            one[0] = -top * (1 + TOUCHING * rng.choice([-1.0, 1.0]))
    return np.asarray(found[found[:, 0] < 0])


def value(cubic: FloatArray, t: float) -> float:
    """h + h' t + h'' t^2 / 2 + B t^3 / 6."""
    return float(cubic[0] + t * (cubic[1] + t * (cubic[2] / 2 + t * cubic[3] / 6)))


def first_maximum(cubic: FloatArray) -> float:
    """Time of the cubic's maximum after the start, s; 0 if it has none."""
    times = np.roots([cubic[3] / 2, cubic[2], cubic[1]])
    real = np.sort(times[np.abs(times.imag) == 0].real)
    return float(real[0]) if real.size == 2 and real[0] > 0 else 0.0


def first_root(cubic: FloatArray) -> float:
    """The first time at which the cubic rises through zero, s."""
    times = np.roots([cubic[3] / 6, cubic[2] / 2, cubic[1], cubic[0]])
    return float(min(t.real for t in times if abs(t.imag) <= ROUNDED * abs(t) and t.real > 0))


def hardly_bends(cubic: FloatArray, until: float) -> bool:
    """Whether the cubic rises to a root at a rate that hardly changes, as it does close to a switch."""
    _, rate, bend, bound = cubic
    return bool((abs(bend) + bound * until) * until <= STEADILY * rate)


def steps(drawn: FloatArray) -> Iterator[Criterion]:
    """Steps against the roots."""
    roots = np.array([first_root(one) for one in drawn])
    found = np.array([first_root_of_bound(h, h1, h2, b3, LONGEST) for h, h1, h2, b3 in drawn.tolist()])
    inside = roots < LONGEST * (1 - ROUNDED)
    share = found[inside] / roots[inside]
    reason = "no step is longer than its bound allows"
    yield Criterion("longest step over the first root", "1", float(share.max()), 1 - CLOSE, 1 + ROUNDED, reason)
    reason = "none is much shorter"
    yield Criterion("shortest step over the first root", "1", float(share.min()), 1 - BELOW, 1.0, reason)
    near = np.array([hardly_bends(one, root) for one, root in zip(drawn[inside], roots[inside], strict=True)])
    reason = "close to a switch the last step ends at it"
    yield Criterion("the same where the cubic rises steadily", "1", float(share[near].min()), 1 - CLOSE, 1.0, reason)
    reason = "no root before: the whole time"
    least = float((found[~inside] / LONGEST).min())
    yield Criterion("shortest step over the whole time, where no root is within it", "1", least, 1 - BELOW, 1.0, reason)


def crossings(drawn: FloatArray) -> Iterator[Criterion]:
    """Whether a gap function is certain to be above zero, against the cubic with the opposite bound."""
    right, above = 0, 0
    for one in drawn:
        t = 0.5 * first_root(one)
        lower = value(np.array([*one[:3], -one[3]]), t + SHORTLY)
        h, h1, h2, b3 = one.tolist()
        right += crosses(h, h1, h2, b3, t, SHORTLY) == (lower > 0)
        above += lower > 0
    yield Criterion("crossings judged as the lower bound has them", "1", right, len(drawn), len(drawn), "each of them")
    yield Criterion("of these, crossings that are sure", "1", above, 1, len(drawn) - 1, "both kinds are drawn")


def sums() -> Iterator[Criterion]:
    """Displacement, two derivatives and the bound on the third, of random terms and harmonics."""
    rng = np.random.default_rng(23)
    weight, omega, s = rng.standard_normal(TERMS), rng.uniform(1, 9, HARMONICS), 0.7
    root = -rng.uniform(0, 5, TERMS) + 1j * rng.uniform(0, 9, TERMS)
    term, forced = complex_normal(rng, TERMS), complex_normal(rng, (PLACES, HARMONICS))
    theta, drift = np.exp(1j * rng.uniform(0, 6, HARMONICS)), rng.standard_normal((PLACES, 3))
    found = np.array(add_terms(weight, term, root, np.abs(root) ** 3, 0, TERMS))
    exact = np.array([float((weight * term * root**d).real.sum()) for d in range(3)])
    yield equal("terms: displacement, velocity, acceleration", found[:3], exact)
    yield equal("terms: bound on the third derivative", found[3:4], np.abs(weight * term * root**3).sum(keepdims=True))
    yield equal("terms: bound on the displacement", found[4:], np.abs(weight * term).sum(keepdims=True))
    out = np.empty((PLACES, 4))
    for place in range(PLACES):
        at_position(place, forced, omega, s, theta, drift, out)
    moved = drift @ np.array([[1, 0, 0], [s, 1, 0], [s**2, 2 * s, 2]])
    exact = np.stack([(forced * theta * (1j * omega) ** d).imag.sum(axis=1) for d in range(3)], axis=1) + moved
    yield equal("harmonics: displacement, velocity, acceleration", out[:, :3], exact)
    yield equal("harmonics: bound on the third derivative", out[:, 3], np.abs(forced * omega**3).sum(axis=1))
    fastest = float(np.abs(root).max())
    for name, tau in (("briefly", 0.9 * SERIES / fastest), ("for long", 3.0 / fastest)):
        for how in ("a series", "exponentials"):
            moving, turning = term.copy(), theta.copy()
            if how == "a series":
                turn_briefly(root, omega, TERMS, fastest, tau, moving, turning)
            else:
                turn_exactly(root, omega, TERMS, tau, moving, turning)
            exact = np.concatenate([term * np.exp(root * tau), theta * np.exp(1j * omega * tau)])
            yield equal(f"moved on {name} by {how}", np.concatenate([moving, turning]), exact)


def complex_normal(rng: np.random.Generator, shape: int | tuple[int, ...]) -> npt.NDArray[np.complex128]:
    """Complex numbers at random."""
    return np.asarray(rng.standard_normal(shape) + 1j * rng.standard_normal(shape))


def equal(name: str, found: npt.NDArray[Any], exact: npt.NDArray[Any]) -> Criterion:
    """Largest difference of two arrays, divided by the largest number of the second."""
    apart = float(np.abs(found - exact).max() / np.abs(exact).max())
    return Criterion(f"{name}, largest difference", "1", apart, 0.0, SUMMED, "rounding")


def run(level: Level, say: Say) -> CaseResult:
    """All cubics."""
    drawn = cubics()
    criteria = (*steps(drawn), *crossings(drawn), *sums())
    say(f"{len(drawn)} cubics")
    return CaseResult(
        "certified-steps",
        "Steps that no contact escapes",
        "The analytic march goes on in steps that end just below the first root of a cubic, which bounds the gap "
        "function from above. Thousands of cubics are drawn at random, half of which all but touch zero before they "
        "rise through it. Each step is compared with the roots by numpy: none may be longer, and few are shorter. "
        "The sums that make the cubic, and what moves them on, are compared with exponentials.",
        criteria=criteria,
        tables=(
            table(
                "Steps", ("quantity", "found", "least", "most"), [(c.name, c.value, c.low, c.high) for c in criteria]
            ),
        ),
    )
