"""Numerical uncertainty from refinement: observed order, Richardson extrapolation, grid convergence index.

After P. J. Roache, "Perspective: a method for uniform reporting of grid refinement studies", J. Fluids Eng. 116
(1994) 405-413, and ASME V&V 20.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.quantity import Estimate

SAFETY = 1.25
"""Factor on the extrapolated error when three refinements show an order within a half of what is expected."""
SAFETY_WITHOUT_ORDER = 3.0
"""Factor when the order is not shown: two refinements only, no monotone convergence, or an unexpected order."""
FLOOR = 1e-12
"""Relative round-off floor: smaller changes say nothing about convergence."""


def observed_order(coarse: float, medium: float, fine: float, ratio: float) -> float:
    """Order p of v(h) = v0 + C h^p from three values at h, h / ratio, h / ratio^2; NaN if not monotone."""
    first, second = coarse - medium, medium - fine
    if first * second <= 0:
        return math.nan
    return math.log(first / second) / math.log(ratio)


def extrapolated(medium: float, fine: float, ratio: float, order: float) -> float:
    """Richardson's extrapolation of two values to h = 0."""
    return fine + (fine - medium) / float(ratio**order - 1)


def refined_estimate(
    values: Sequence[float], ratio: float, expected_order: float, what: str, floor: float = FLOOR
) -> Estimate:
    """The finest of two or three values at refinement `ratio`, with the grid convergence index as uncertainty.

    Parameters
    ----------
    values : sequence of float
        From coarse to fine, two or three.
    ratio : float
        Refinement from one to the next.
    expected_order : float
        Order of the method in theory or as observed elsewhere; used unless three values show less.
    what : str
        What was refined, for the report.
    floor : float
        Relative accuracy below which values cannot be distinguished.

    Raises
    ------
    ValueError
        Unless there are two or three values.
    """
    if len(values) not in (2, 3):
        raise ValueError(f"two or three values are needed, not {len(values)}")
    medium, fine = values[-2], values[-1]
    smallest = floor * abs(fine)
    if len(values) == 2:
        error = abs(fine - medium) / (ratio**expected_order - 1)
        how = f"{what}, two refinements, order {expected_order:g} assumed"
        return Estimate(fine, SAFETY_WITHOUT_ORDER * error + smallest, how)
    if max(abs(values[0] - medium), abs(medium - fine)) <= smallest:
        return Estimate(fine, smallest, f"{what}, converged to the floor of {floor:g}")
    order = observed_order(values[0], medium, fine, ratio)
    if math.isnan(order) or order < expected_order - 1 or order > expected_order + 1:
        # The worst of the changes, at first order: no asymptotic range is shown.
        error = max(abs(values[0] - medium) / (ratio**expected_order - 1), abs(medium - fine)) / (ratio - 1)
        shown = "none" if math.isnan(order) else f"{order:.2f}"
        return Estimate(
            fine, SAFETY_WITHOUT_ORDER * error + smallest, f"{what}, observed order {shown}, not asymptotic"
        )
    used = min(order, expected_order)
    error = abs(fine - medium) / (ratio**used - 1)
    return Estimate(fine, SAFETY * error + smallest, f"{what}, observed order {order:.2f}")
