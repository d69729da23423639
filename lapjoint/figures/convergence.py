"""Convergence figures: relative error over resolution, and the observed order of convergence."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from lapjoint.answers.observed_order import ROUNDING, fitted_order
from lapjoint.errors import InputError
from lapjoint.figures.style import COLUMN_WIDTH, GREY, MARKERS, THIN, entitle, new_axes, style
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Answer = TypeVar("Answer")


@style()
def plot_convergence(
    answers: Mapping[int, Answer],
    axes: Axes | None = None,
    *,
    quantity: Callable[[Answer], float] | None = None,
    reference: float | None = None,
    order: float | None = None,
    label: str | None = None,
    floor: float = ROUNDING,
) -> Axes:
    """Draw the relative error over resolution on logarithmic axes, with the observed order in the legend.

    The order of convergence is the slope of the least-squares line through the logarithms of the drawn points whose
    error is above `floor`.  Without a `reference`, errors are differences from the finest resolution.  The observed
    order is then too high, because the last of these differences are smaller than the true errors.

    Parameters
    ----------
    answers : mapping
        From resolution, a number of elements or modes, to an answer: a number, or any object that `quantity` reduces
        to one.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.  Each further study on the same axes has another colour and marker.
    quantity : callable, optional
        From an answer to the number whose convergence is drawn; needed if the answers are not numbers.
    reference : float, optional
        The true value; by default the value of the finest resolution, which is then not drawn.
    order : float, optional
        Order of convergence of a thin reference line through the coarsest point.
    label : str, optional
        Name of the study in the legend.
    floor : float
        Relative errors up to this size count as rounding, and are left out of the fit.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on.

    Raises
    ------
    InputError
        If there are fewer than two points to draw, a resolution is not positive, an answer is not a finite number, or
        the reference is zero.
    """
    if len(answers) < 2 + (reference is None):
        raise InputError(
            f"answers: there are {len(answers)}; two or more are needed, and one more where reference is None"
        )
    resolutions, values = _numbers(answers, quantity)
    against = f"against {resolutions[-1]:g}" if reference is None else ""
    if reference is None:
        reference, resolutions, values = float(values[-1]), resolutions[:-1], values[:-1]
    if not math.isfinite(reference) or reference == 0:
        raise InputError(f"reference = {reference}: must be finite and not zero, for the errors are relative to it")
    error = np.abs(values / reference - 1.0)
    observed = fitted_order(resolutions, error, floor)
    fitted = f"order {observed:.2f}" if math.isfinite(observed) else ""
    name = ", ".join(part for part in (label, against, fitted) if part)
    axes = new_axes(COLUMN_WIDTH, 2.8) if axes is None else axes
    earlier = sum(line.get_marker() in MARKERS for line in axes.lines)
    axes.loglog(resolutions, np.where(error > 0, error, np.nan), marker=MARKERS[earlier % len(MARKERS)], label=name)
    if order is not None:
        _draw_slope(axes, resolutions, error, order)
    _set_ticks(axes)
    axes.set_xlabel("number of elements or modes N")
    axes.set_ylabel("relative error [-]")
    entitle(axes)
    return axes


def _numbers(
    answers: Mapping[int, Answer], quantity: Callable[[Answer], float] | None
) -> tuple[FloatArray, FloatArray]:
    """Resolutions, ascending, and the number for each resolution, each (n,)."""
    for resolution in answers:
        if not 0 < resolution < math.inf:
            raise InputError(f"answers: resolution {resolution} must be positive and finite")
    resolutions = sorted(answers)
    values = [_number(resolution, answers[resolution], quantity) for resolution in resolutions]
    return np.array(resolutions, dtype=float), np.array(values)


def _number(resolution: float, answer: Answer, quantity: Callable[[Answer], float] | None) -> float:
    given = answer if quantity is None else quantity(answer)
    if not isinstance(given, int | float | np.number):
        raise InputError(f"quantity: must say which number to take from a {type(given).__name__}, as a callable")
    if not math.isfinite(value := float(given)):
        raise InputError(f"answers: the number at resolution {resolution} is {value}; it must be finite")
    return value


def _draw_slope(axes: Axes, resolutions: FloatArray, error: FloatArray, order: float) -> None:
    """Draw a thin line of slope -`order` from the coarsest point with an error, unless the axes have one of this
    order."""
    label = f"reference, order {order:g}"
    if label in {str(line.get_label()) for line in axes.lines} or not np.any(error > 0):
        return
    first = int(np.flatnonzero(error > 0)[0])
    line = error[first] * (resolutions[first:] / resolutions[first]) ** -order
    axes.loglog(resolutions[first:], line, color=GREY, linewidth=THIN, linestyle=(0, (4, 3)), zorder=1, label=label)


def _set_ticks(axes: Axes) -> None:
    """Set ticks at the drawn resolutions, as plain numbers, as far as there is room."""
    from matplotlib.ticker import NullLocator

    drawn = sorted({float(x) for line in axes.lines for x in np.asarray(line.get_xdata(), dtype=float)})
    room = math.log(drawn[-1] / drawn[0]) / 12
    kept = drawn[:1]
    for resolution in drawn[1:]:
        if math.log(resolution / kept[-1]) >= room:
            kept.append(resolution)
    axes.set_xticks(kept, [f"{resolution:g}" for resolution in kept])
    axes.xaxis.set_minor_locator(NullLocator())
