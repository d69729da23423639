"""The shared ground: what is solved, what an answer is, and all that needs only answers.  Knows neither solver.

The names here are those that a user types; whoever writes a solver finds the others in `lapjoint.problem`,
`lapjoint.answers` and `lapjoint.orbits`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lapjoint.answers import (
        FREE,
        ContactState,
        History,
        Outcome,
        SteadyState,
        contact_states,
        paper_state_number,
        time_series,
        write_series,
    )
    from lapjoint.campaigns import FREQUENCY, Axis, basins, branch, confirm, statistics, sweep
    from lapjoint.errors import InputError, SolverError
    from lapjoint.problem import (
        AtEquilibrium,
        BaseMotion,
        Beam,
        BeamSegment,
        Circle,
        Gravity,
        HarmonicsBaseMotion,
        HarmonicsLoad,
        Mass,
        Material,
        ModalDamping,
        NoDamping,
        PolynomialShape,
        Problem,
        RandomBaseMotion,
        RandomLoad,
        RecordBaseMotion,
        RecordLoad,
        Rectangle,
        SampledShape,
        SineLoad,
        StepLoad,
        Stop,
        Support,
        Tube,
        UniformLoad,
        ViscousDamping,
        initial_from_functions,
        paper_joint,
        read_problem,
        sdnl104,
        write_problem,
    )
    from lapjoint.sampling import bands, sensitivities
    from lapjoint.solver import make_solver, solver_names
    from lapjoint.summaries import summarise

__all__ = [
    "FREE",
    "FREQUENCY",
    "AtEquilibrium",
    "Axis",
    "BaseMotion",
    "Beam",
    "BeamSegment",
    "Circle",
    "ContactState",
    "Gravity",
    "HarmonicsBaseMotion",
    "HarmonicsLoad",
    "History",
    "InputError",
    "Mass",
    "Material",
    "ModalDamping",
    "NoDamping",
    "Outcome",
    "PolynomialShape",
    "Problem",
    "RandomBaseMotion",
    "RandomLoad",
    "RecordBaseMotion",
    "RecordLoad",
    "Rectangle",
    "SampledShape",
    "SineLoad",
    "SolverError",
    "SteadyState",
    "StepLoad",
    "Stop",
    "Support",
    "Tube",
    "UniformLoad",
    "ViscousDamping",
    "bands",
    "basins",
    "branch",
    "confirm",
    "contact_states",
    "initial_from_functions",
    "make_solver",
    "paper_joint",
    "paper_state_number",
    "read_problem",
    "sdnl104",
    "sensitivities",
    "solver_names",
    "statistics",
    "summarise",
    "sweep",
    "time_series",
    "write_problem",
    "write_series",
]
_HOMES = (
    "lapjoint.errors",
    "lapjoint.answers",
    "lapjoint.problem",
    "lapjoint.solver",
    "lapjoint.campaigns",
    "lapjoint.summaries",
    "lapjoint.sampling",
)
"""Where the names above are defined, in the order in which they are looked for."""


def __getattr__(name: str) -> Any:
    """A name of `__all__`, imported when first asked for: ``lapjoint --help`` needs none of them."""
    if name in __all__:
        for home in map(import_module, _HOMES):
            if hasattr(home, name):
                globals()[name] = getattr(home, name)
                return globals()[name]
    raise AttributeError(f"module 'lapjoint' has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
