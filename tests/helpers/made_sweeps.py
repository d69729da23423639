"""Datasets of sweeps whose motions are made up, so that what a figure or a table says of them is known."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from lapjoint import FREQUENCY, Axis, Beam, Problem, Stop
from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.table import sweep_dataset
from lapjoint.problem import BaseMotion, FloatArray


def joint(*names: str) -> Problem:
    """A beam with a stop of each name, the first at the bottom."""
    stops = tuple(
        Stop(name=name, x=0.5 + 0.1 * i, side="top" if i else "bottom", gap=1e-3, stiffness=1e4)
        for i, name in enumerate(names)
    )
    beam = Beam(length=1.5, bending_stiffness=1e3, mass_per_length=4.0)
    return Problem(beam=beam, stops=stops, base_motion=BaseMotion(amplitude=1e-3, angular_frequency=10.0))


def made_sweep(
    x: FloatArray,
    impulses: Sequence[FloatArray],
    multiples: Sequence[int] | None = None,
    names: Sequence[str] = ("pad", "wall"),
    path: str = FREQUENCY,
) -> xr.Dataset:
    """A sweep over `x` with the impulses of each stop, (n,) each; a multiple of 0 is aperiodic, of -1 undecided."""
    plan = Plan(Grid(joint(*names[: len(impulses)]), (Axis(path, tuple(np.asarray(x).tolist())),)))
    kinds = [1] * len(x) if multiples is None else list(multiples)
    outcome = {0: "APERIODIC", -1: "UNDECIDED"}
    points = {
        i: Point(
            outcome=outcome.get(kinds[i], "PERIODIC"),
            period_multiple=max(kinds[i], 0),
            impulses=tuple(float(impulse[i]) for impulse in impulses),
        )
        for i in range(len(x))
    }
    return sweep_dataset(plan, points)
