"""The motion of a joint, state by state: from a section point to where it is some time later.

`loads` and `oscillator` hold the forces and the answer of one mode to them, `modal_state` a contact state in modal
form, `tables` its flat view, `known_states` the states that problems of one structure have met, and `joint` the states
of one problem.  `motion` holds where a march is; `terms`, `gap_function`, `step_bound`, `segment`, `deepest`,
`switching`, `compiled` and `carried` are the compiled march, from the inside out, of which `ramps` and `ramp_segment`
are the part for sampled loads.
`arcs` follows a motion with a given contact sequence, whatever the gaps do, with `mean_rates` for its equations.
`coordinates` says where a motion is; `march`, `periods`, `tangent`, `growth` and `gap_view` are what Python calls;
`field` and `contacts` make a History of it, with `energies` lost in damped stops; `initial_state` gives states to start
from.
"""

from analytic.march.coordinates import Coordinates
from analytic.march.gap_view import gap_view
from analytic.march.growth import Growth, march_linearised, measure_growth
from analytic.march.joint import Joint
from analytic.march.march import March, Segment, march
from analytic.march.periods import Periods, march_periods

__all__ = [
    "Coordinates",
    "Growth",
    "Joint",
    "March",
    "Periods",
    "Segment",
    "gap_view",
    "march",
    "march_linearised",
    "march_periods",
    "measure_growth",
]
