"""The modes of a beam with any of its stops closed.

`characteristic_equation` finds and counts the natural frequencies, `boundary_conditions` has the conditions (13) as a
matrix, `beam_functions` the functions of x that the beam equation allows, `normal_modes` the modes, and
`static_residual` the quasi-static response of the modes left out.
"""
