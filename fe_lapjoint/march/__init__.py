"""From an initial state through time: the flow between switches, the switches, the field, and how deviations travel.

A switch is a change of contact state: one or more stops close or open.  `initial` gives the initial state, `model` a
problem on its mesh, `system` one contact state of it.  `propagator` is the exact flow, alone and as a stepper for
`solve_ivp`; `gaps` has the gap functions of a motion, `events` the switches.  `march` goes from switch to switch,
`tangent` carries deviations along, `field` makes a History of the march.
"""
