"""The scheme as the paper has it: `solver` says what it is and what is assumed where the paper is silent.

It is marched by `analytic.march` with a switch rule of its own; `joint` and `march` prepare for that, `settle` and
`steady` have the paper's stopping rule, `loss` measures the part of a motion that its few modes cannot carry.
"""
