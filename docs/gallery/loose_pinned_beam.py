"""A loosely pinned beam: both pins have clearance in their bores, so that the ends rattle where they should be held.

Soft springs centre the bar; a stop above and one below each end stand for the bore, and the right bore is worn half as
much again as the left one.  The ends fly, bounce and are caught; once caught, the bar bends between them as if pinned.
"""

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Circle, ContactState, Material, ModalDamping, Problem, Stop, Support, figures

BORES = (("left", 0.0, 0.2e-3), ("right", 1.0, 0.3e-3))  # name, x [m], clearance to each side [m]
bar = Problem(
    title="Bar between two loose pins",
    beam=Beam(length=1.0, material=Material(youngs_modulus=2.05e11, density=7850.0), section=Circle(diameter=0.02)),
    supports=tuple(Support(x=x, translational=2e3) for _, x, _ in BORES),
    stops=tuple(
        Stop(name=f"{name}, {side}", x=x, side=side, gap=gap, stiffness=5e6)
        for name, x, gap in BORES
        for side in ("bottom", "top")
    ),
    damping=ModalDamping(ratio=0.05),
    base_motion=BaseMotion(amplitude=1e-3, angular_frequency=200.0),
)
one, other = (solver.steady_state(bar) for solver in (analytic.Solver(), fe_lapjoint.Solver()))
for found in (one, other):
    print(found.outcome.value, "Impulses", found.impulses.round(4), "N s")
apart = np.max(np.abs(one.impulses - other.impulses)) / np.max(np.abs(one.impulses))
print(f"The solvers differ by {apart:.0e} of the largest impulse.")
caught = analytic.Solver().modes(bar, ContactState((0, 2)), 1).angular_frequencies[0]
print(f"Caught at both ends, the bar has its first natural frequency at {caught:.1f} rad/s.")
figures.save(figures.plot_motion(one.history), __file__.replace(".py", ".png"))
