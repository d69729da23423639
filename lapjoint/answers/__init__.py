"""Answers of either solver: contact states, modes, motions with their contacts, and steady states.

This package has the types of answers, time series of motions, and the writing of contacts and series to files.  Each
solver computes displacements, events and impulses by its own code, because the comparison of the solvers cannot reveal
a mistake in shared code.
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
