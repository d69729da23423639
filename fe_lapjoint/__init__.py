"""Hermite beam elements, penalty contact springs, event-driven time stepping: exact, or on `scipy`'s `solve_ivp`.

import fe_lapjoint
from lapjoint import paper_joint

print(fe_lapjoint.Solver().steady_state(paper_joint(angular_frequency=515.0)).impulses)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fe_lapjoint.solver import Solver

if TYPE_CHECKING:
    from fe_lapjoint.march.exact_propagator import ExactPropagator

__all__ = ["ExactPropagator", "Solver"]


def __getattr__(name: str) -> Any:
    if name == "ExactPropagator":  # imported when asked for: it brings scipy along
        from fe_lapjoint.march.exact_propagator import ExactPropagator

        return ExactPropagator
    raise AttributeError(f"module 'fe_lapjoint' has no attribute {name!r}")
