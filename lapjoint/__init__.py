"""The shared ground: what is solved, what an answer is, and all that needs only answers.  Knows neither solver."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from lapjoint.answers import (
        FREE,
        Contact,
        ContactState,
        Exponent,
        History,
        Modes,
        Outcome,
        SectionPoint,
        SteadyState,
        contact_states,
        paper_state_number,
    )
    from lapjoint.errors import InputError
    from lapjoint.problem import (
        AtRest,
        BaseMotion,
        Beam,
        Circle,
        Material,
        ModalDamping,
        NoDamping,
        PolynomialShape,
        Problem,
        Rectangle,
        SampledShape,
        SineLoad,
        StepLoad,
        Stop,
        Support,
        Tube,
        ViscousDamping,
        initial_from_functions,
        paper_joint,
        read_problem,
        sdnl104,
        write_problem,
    )

__all__ = [
    "FREE",
    "AtRest",
    "BaseMotion",
    "Beam",
    "Circle",
    "Contact",
    "ContactState",
    "Exponent",
    "History",
    "InputError",
    "Material",
    "ModalDamping",
    "Modes",
    "NoDamping",
    "Outcome",
    "PolynomialShape",
    "Problem",
    "Rectangle",
    "SampledShape",
    "SectionPoint",
    "SineLoad",
    "SteadyState",
    "StepLoad",
    "Stop",
    "Support",
    "Tube",
    "ViscousDamping",
    "contact_states",
    "initial_from_functions",
    "paper_joint",
    "paper_state_number",
    "read_problem",
    "sdnl104",
    "write_problem",
]
_HOMES = ("lapjoint.errors", "lapjoint.answers", "lapjoint.problem")
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
