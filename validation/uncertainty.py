"""Numerical uncertainty from refinement: observed order, Richardson extrapolation, grid convergence index.

The error is estimated by Richardson's extrapolation with the observed order p.  The estimate is more reliable the
nearer p is to the order of the method.  The factor of safety is from T. Xing and F. Stern, "Factors of safety for
Richardson extrapolation", J. Fluids Eng. 132 (2010) 061403, calibrated for 95 % coverage.  With P = p / p_method it is

    2.45 - 0.85 P  for P <= 1,    16.4 P - 14.8  for P > 1

The framework is that of ASME V&V 20.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lapjoint.problem import FloatArray
from validation.verdict import ErrorSource, Estimate

SAFETY_WITHOUT_ORDER = 3.0
"""Factor of safety without a confirmed order: two levels only, no monotone convergence, or an unexpected order."""
FLOOR = 1e-12
"""Relative change of a value below which rounding hides convergence."""


@dataclass(frozen=True)
class Refined:
    """What was refined in a solver, and the finest level."""

    source: ErrorSource
    what: str
    """The finest level, for the report."""


def elements(finest: int) -> Refined:
    """The refinement of a mesh, up to a number of elements.

    Parameters
    ----------
    finest : int
        Number of elements of the finest mesh.

    Returns
    -------
    Refined
        An argument of `refined_estimate`.
    """
    return Refined(ErrorSource.MESH, f"{finest} elements")


def observed_order(coarse: float, medium: float, fine: float, ratio: float) -> float:
    """Order p of v(h) = v0 + C h^p from three values at h, h / ratio, h / ratio^2; NaN if not monotone.

    Parameters
    ----------
    coarse, medium, fine : float
        The three values, in one unit.
    ratio : float
        Refinement from one to the next, above 1.

    Returns
    -------
    float
        The order.
    """
    first, second = coarse - medium, medium - fine
    if first * second <= 0:
        return math.nan
    return math.log(first / second) / math.log(ratio)


def extrapolated(medium: float, fine: float, ratio: float, order: float) -> float:
    """Richardson's extrapolation of two values to h = 0.

    Parameters
    ----------
    medium, fine : float
        The two values, in one unit.
    ratio : float
        Refinement from one to the other, above 1.
    order : float
        Order of convergence.

    Returns
    -------
    float
        The value at h = 0, in the same unit.
    """
    return fine + (fine - medium) / float(ratio**order - 1)


def factor_of_safety(P: float) -> float:
    """Factor on the extrapolated error; 1.6 if the observed order is the order of the method.

    Parameters
    ----------
    P : float
        Observed order, divided by the order of the method.

    Returns
    -------
    float
        The factor, without unit.
    """
    return 2.45 - 0.85 * P if P <= 1 else 16.4 * P - 14.8


def refined_estimate(
    values: Sequence[float],
    ratio: float,
    expected_order: float,
    refined: Refined,
    floor: float = FLOOR,
    floor_source: ErrorSource = ErrorSource.ROUNDING,
) -> Estimate:
    """The finest of two or three values at refinement `ratio`, and its uncertainty.

    Parameters
    ----------
    values : sequence of float
        Two or three values, from coarse to fine, in one unit.
    ratio : float
        Refinement from one value to the next.
    expected_order : float
        Order of the method in theory or as observed elsewhere; used unless three values show less.
    refined : Refined
        What was refined, for the report and the uncertainty budget.
    floor : float
        Relative accuracy below which values cannot be distinguished.
    floor_source : ErrorSource
        The reason for this limit, for the uncertainty budget.

    Returns
    -------
    Estimate
        The finest value, with its expanded uncertainty (95 %) and the contributions to it.

    Raises
    ------
    ValueError
        Unless there are two or three values.
    """
    if len(values) not in (2, 3):
        raise ValueError(f"two or three values are needed, not {len(values)}")
    medium, fine = values[-2], values[-1]
    smallest = floor * abs(fine)

    def estimate(error: float, how: str) -> Estimate:
        parts = ((refined.source, error), (floor_source, smallest))
        return Estimate(fine, error + smallest, f"{refined.what}, {how}", parts=parts)

    if len(values) == 2:
        error = abs(fine - medium) / (ratio**expected_order - 1)
        return estimate(SAFETY_WITHOUT_ORDER * error, f"two refinements, order {expected_order:g} assumed")
    if max(abs(values[0] - medium), abs(medium - fine)) <= smallest:
        return estimate(0.0, f"converged to the floor of {floor:g}")
    order = observed_order(values[0], medium, fine, ratio)
    if math.isnan(order) or order < expected_order - 1 or order > expected_order + 1:
        # The order is not confirmed: the largest of the changes is extrapolated at first order.
        error = max(abs(values[0] - medium) / (ratio**expected_order - 1), abs(medium - fine)) / (ratio - 1)
        shown = "none" if math.isnan(order) else f"{order:.2f}"
        return estimate(SAFETY_WITHOUT_ORDER * error, f"observed order {shown}, not asymptotic")
    error = abs(fine - medium) / (ratio**order - 1)
    return estimate(factor_of_safety(order / expected_order) * error, f"observed order {order:.2f}")


def refined_vector(
    values: FloatArray,
    ratio: float,
    expected_order: float,
    refined: Refined,
    floor: float = FLOOR,
    floor_source: ErrorSource = ErrorSource.ROUNDING,
) -> tuple[Estimate, ...]:
    """Several numbers of one solution, with one uncertainty for all of them.

    The numbers of one motion have errors of similar size.  The observed order of a single number can be high by chance;
    the order of their norm is more reliable.  The norm of the changes is therefore extrapolated, and its error is taken
    for every number.

    Parameters
    ----------
    values : FloatArray, shape (3, n)
        The numbers at three levels, from coarse to fine, in one unit.
    ratio : float
        Refinement from one level to the next.
    expected_order : float
        Order of the method in theory or as observed elsewhere; used unless the values show a lower order.
    refined : Refined
        What was refined, for the report and the uncertainty budget.
    floor : float
        Relative accuracy below which values cannot be distinguished.
    floor_source : ErrorSource
        What limits that accuracy, for the uncertainty budget.

    Returns
    -------
    tuple of Estimate
        The n finest values, all with one uncertainty.
    """
    changes = [float(np.abs(b - a).max(initial=0.0)) for a, b in itertools.pairwise(values)]
    size = float(np.abs(values[-1]).max(initial=0.0))
    # Three numbers with these changes, rising to the largest number.
    norm = refined_estimate(
        [size - changes[1] - changes[0], size - changes[1], size], ratio, expected_order, refined, floor, floor_source
    )
    return tuple(replace(norm, value=float(value)) for value in values[-1])
