"""Branches of periodic motions of any solver: curves of motions, stable or not, while a number of the problem changes.

`family` has the period maps over the number, `corrector` leads from a guess to the curve; `continuation` goes along it,
and across grazes by `grazing`, which `passings` sees come by the extrema of `gap_extrema` (inner loops in
`compiled_extrema`).  `bifurcations` are
found between neighbours, `value_errors` states their errors, and `switching` gives what springs from them.  `tracing`
puts a branch together from a motion; `seeds` finds such motions, and tells new ones from known ones.
"""
