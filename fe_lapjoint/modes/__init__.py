"""Mesh, assembly by Hermite elements, and the natural frequencies and mode shapes of each contact state.

`mesh` places the nodes, `assembly` has the matrices and loads, `eigenmodes` the frequencies and modes of the mesh, and
`shapes` gives them as functions of position.
"""
