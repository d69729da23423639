"""The modes of a beam with any of its stops closed, and how many of them are enough.

`characteristic_equation` finds and counts the natural frequencies, `boundary_conditions` has the conditions (13) as a
matrix, `beam_functions` the functions of x that the beam equation allows, `normal_modes` the modes, `static_residual`
what the modes left out would carry, and `mode_count` how many are enough.
"""
