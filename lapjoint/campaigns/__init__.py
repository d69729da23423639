"""Many answers, by many workers, kept in a journal and given as a dataset: steady states over a grid of problems, where
many starts end, and statistics of long motions.

>>> from lapjoint import FREQUENCY, Axis, paper_joint, sweep
>>> curve = sweep(paper_joint(), [Axis(FREQUENCY, range(400, 600, 10))], workers=2, out="curve.nc")  # doctest: +SKIP
>>> curve.impulse.sel(stop_name="P4")  # doctest: +SKIP
"""

from lapjoint.campaigns.basins.running import basins, solve_basins
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.branches.running import branch
from lapjoint.campaigns.confirm.running import confirm
from lapjoint.campaigns.grid import FREQUENCY, Axis, Grid
from lapjoint.campaigns.running import stored
from lapjoint.campaigns.statistics.running import statistics
from lapjoint.campaigns.sweep.running import run, solve, sweep
from lapjoint.campaigns.sweep.spec import Plan

__all__ = [
    "FREQUENCY",
    "Axis",
    "BasinPlan",
    "Grid",
    "Plan",
    "basins",
    "branch",
    "confirm",
    "run",
    "solve",
    "solve_basins",
    "statistics",
    "stored",
    "sweep",
]
