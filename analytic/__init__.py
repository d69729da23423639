"""Exact separation of variables, state by state, with closed-form motion between impacts.

import analytic
from lapjoint import paper_joint

print(analytic.Solver().steady_state(paper_joint(angular_frequency=515.0)).impulses)
"""

from analytic.published.solver import PublishedScheme
from analytic.solver import Solver

__all__ = ["PublishedScheme", "Solver"]
