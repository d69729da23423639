"""Answers of either solver: contact states, modes, motions with their contacts, and steady states.

This room holds the types of answers, time series of motions, and the writing of contacts and series to files.  How
displacements, events and impulses are found is each solver's own work, so that a shared mistake cannot hide from the
comparison of the solvers.
"""

from lapjoint.answers.contact_state import FREE, ContactState, contact_states, paper_state_number
from lapjoint.answers.equilibrium import Equilibrium, EquilibriumErrors, Extreme, StaticShape
from lapjoint.answers.history import Contact, Field, History
from lapjoint.answers.modes import Modes, ModeShapes
from lapjoint.answers.series import time_series, write_series
from lapjoint.answers.steady_state import Exponent, Outcome, SectionPoint, SteadyState

__all__ = [
    "FREE",
    "Contact",
    "ContactState",
    "Equilibrium",
    "EquilibriumErrors",
    "Exponent",
    "Extreme",
    "Field",
    "History",
    "ModeShapes",
    "Modes",
    "Outcome",
    "SectionPoint",
    "StaticShape",
    "SteadyState",
    "contact_states",
    "paper_state_number",
    "time_series",
    "write_series",
]
