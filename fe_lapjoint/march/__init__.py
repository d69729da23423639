"""From an initial state through time: the flow between switches, the switches, the field, and how deviations travel."""
