"""The shared ground: what is solved, and what an answer is.  Knows neither solver."""

from lapjoint.contact import FREE, ContactState, contact_states, paper_state_number
from lapjoint.errors import InputError
from lapjoint.files import read_problem, write_problem
from lapjoint.presets import paper_joint, sdnl104
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
)
from lapjoint.solution import Contact, History, Modes
from lapjoint.steady import Exponent, Outcome, SectionPoint, SteadyState

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
