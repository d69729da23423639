"""The plan of ``lapjoint basins`` from its options."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from lapjoint import Problem
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.grid import MOST_POINTS, Axis
from lapjoint.cli.arguments import refuse
from lapjoint.errors import InputError
from lapjoint.problem.plane import Plane

Ranges = tuple[tuple[float, float], tuple[float, float]]


def plan_from(
    problem: Problem,
    solver: str,
    options: dict[str, Any],
    *,
    plane: str | None,
    grid: str | None,
    ranges: str | None,
    energy: float | None,
    starts: int | None,
    seed: int | None,
    over: str | None,
    first: float | None,
    last: float | None,
    values: int | None,
    effort: int | None,
) -> BasinPlan:
    """The plan of the options; a combination of options that has no meaning is refused."""
    if plane is None and energy is None:
        raise InputError('basins: no starts are chosen; give --plane "z(X),v(X)", or --energy J for random ones')
    if plane is not None:
        refuse("is of random starts, and --plane gives a grid", energy=energy, starts=starts, seed=seed)
    else:
        refuse("is of a grid, and --energy gives random starts", grid=grid, range=ranges)
    given: dict[str, Any] = {"starts": starts, "seed": seed, "effort": effort}
    if grid is not None:
        given["shape"] = shape_from(grid)
    return BasinPlan(
        problem,
        solver,
        options,
        plane=None if plane is None else Plane.from_text(plane),
        ranges=None if ranges is None else ranges_from(ranges),
        energy=energy,
        over=axis_over(over, first, last, values),
        **{name: value for name, value in given.items() if value is not None},
    )


def shape_from(text: str) -> tuple[int, int]:
    """The two numbers of values of a text such as ``400x400``."""
    first, x, second = text.lower().partition("x")
    if not (x and first.isdecimal() and second.isdecimal() and int(first) and int(second)):
        raise InputError(f"--grid {text}: must be two numbers of values, as in 40x40")
    return int(first), int(second)


def ranges_from(text: str) -> Ranges:
    """The ranges of two coordinates of a text such as ``-0.1:0.1,-20:20``."""
    try:
        first, second = text.split(",")
        (a, b), (c, d) = ([float(number) for number in part.split(":")] for part in (first, second))
    except ValueError:
        raise InputError(f"--range {text}: must be FROM:TO,FROM:TO, as in -0.1:0.1,-20:20") from None
    return (a, b), (c, d)


def axis_over(path: str | None, first: float | None, last: float | None, values: int | None) -> Axis | None:
    """The axis of ``--over PATH --from FIRST --to LAST --values VALUES``."""
    if path is None:
        refuse("is of the values of --over PATH", **{"from": first, "to": last, "values": values})
        return None
    if first is None or last is None or values is None:
        missing = [name for name, given in (("from", first), ("to", last), ("values", values)) if given is None]
        raise InputError(f"--{missing[0]}: is missing; --over {path} needs --from, --to and --values")
    if not 1 <= values <= MOST_POINTS or not math.isfinite(last - first):
        raise InputError(f"--over {path}: must have finite ends, and from 1 to {MOST_POINTS} values")
    whole = f"base_motion.{path}" if path in ("angular_frequency", "frequency") else path
    return Axis(whole, tuple(np.linspace(first, last, values).tolist()))
