"""What numba compiles for most tests, shared between two workers that begin with cold caches.

Each finds on the disk what the other has compiled; without this both would compile the same functions, side by side.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

import analytic
import fe_lapjoint
from analytic.march import Joint, gap_view, march, march_linearised
from analytic.march.initial_state import started
from lapjoint import paper_joint
from lapjoint.problem import RecordBaseMotion

_MODES = 2  # what is compiled does not depend on them
_SHORT = 1e-3  # s; nor on this


def march_and_records() -> None:
    """The analytic march with a log, along a sine and along a record, and the view of what it logged."""
    joint = Joint(paper_joint(), _MODES, _MODES)
    gap_view(march(joint, started(joint), 0.0, _SHORT, depth=True))
    record = RecordBaseMotion(quantity="acceleration", values=(0.0, 1.0, 0.0), rate=2 / _SHORT)
    shaken = paper_joint().replace(base_motion=record)
    analytic.Solver(n_modes=_MODES).simulate(shaken, _SHORT, errors=False)


def periods_and_orbits() -> None:
    """The analytic march over periods, the finite elements' sums, and the inner loops of the search for orbits."""
    fe_lapjoint.Solver(elements=4).steady_state(paper_joint(angular_frequency=60.0), errors=False)
    joint = Joint(paper_joint(), _MODES, _MODES)
    march_linearised(joint, started(joint), _SHORT, np.eye(2 * _MODES))


SHARES: dict[str, Callable[[], None]] = {"gw0": march_and_records, "gw1": periods_and_orbits}
"""What each worker of pytest-xdist begins with, by its name."""
