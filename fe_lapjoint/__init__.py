"""Hermite beam elements, penalty contact springs, event-driven time stepping: exact, or on `scipy`'s `solve_ivp`.

import fe_lapjoint
from lapjoint import paper_joint

print(fe_lapjoint.Solver().steady_state(paper_joint(angular_frequency=515.0)).impulses)
"""

from fe_lapjoint.propagator import ExactPropagator
from fe_lapjoint.solver import Solver

__all__ = ["ExactPropagator", "Solver"]
