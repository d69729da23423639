"""Branches of periodic motions of any solver: curves of motions, stable or not, while a number of the problem changes.

`family` has the period maps over the number, `corrector` leads from a guess to the curve by `newton_steps`;
`continuation` goes along it, to a `run`, and across grazes by `grazing`, which `passings` sees come by the extrema of
`gap_extrema` (inner loops in `compiled_extrema`); `jumping` finds the motion beyond what cannot be followed, and
`bridging` goes past where the curve is lost.  `bifurcations` are found between neighbours, and put into a list by
`listing`.  `value_errors` states their errors: `found_again` has a finer solver find one from the motion there, by
Newton's method in `critical_search` or `extremum_search`; of two that it has at one motion `coinciding` doubts
one.  What is in doubt after that `resolving` has it follow, and what is in doubt still `by_another_solver` looks for by
pairs of ever finer solvers, from that motion or by `found_along` along their own curves.  `switching` gives what
springs from a bifurcation.  `tracing` puts a branch together from a motion; `seeds` finds such motions, and tells new
ones from known ones.
"""
