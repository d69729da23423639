"""Many answers, by many workers, kept in a journal and given as a dataset: steady states over a grid of problems, where
many starts end, and statistics of long motions.

>>> from lapjoint import FREQUENCY, Axis, paper_joint, sweep
>>> curve = sweep(paper_joint(), [Axis(FREQUENCY, range(400, 600, 10))], workers=2, out="curve.nc")  # doctest: +SKIP
>>> curve.impulse.sel(stop="P4")  # doctest: +SKIP
"""

from lapjoint.campaigns.grid import FREQUENCY, Axis
from lapjoint.campaigns.public import basins, branch, confirm, statistics, sweep
from lapjoint.campaigns.running import Running

__all__ = ["FREQUENCY", "Axis", "Running", "basins", "branch", "confirm", "statistics", "sweep"]
