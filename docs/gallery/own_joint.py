"""A joint of one's own: a steel pipe on an elastic flange, with play in its hanger and a stop at its tail.

The problem is stated in SI units; parts that are left out do not act.  Both solvers find, and certify, that the motion
repeats only after two periods of the engine.
"""

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Material, ModalDamping, Problem, Stop, Support, Tube, figures

pipe = Problem(
    title="Pipe with play in its hanger",
    beam=Beam(
        length=1.8,
        material=Material(youngs_modulus=1.93e11, density=8000.0),
        section=Tube(outer_diameter=0.050, inner_diameter=0.046),
    ),
    supports=(Support(x=0.0, translational=4e6, torsional=6e3), Support(x=1.8, translational=5e3)),
    stops=(
        Stop(name="hanger, below", x=1.2, side="bottom", gap=0.5e-3, stiffness=8e5),
        Stop(name="hanger, above", x=1.2, side="top", gap=1.0e-3, stiffness=8e5),
        Stop(name="tail", x=1.8, side="top", gap=1.5e-3, stiffness=2e5),
    ),
    damping=ModalDamping(ratio=(0.02, 0.03, 0.05)),  # of the first, the second, and all higher modes
    base_motion=BaseMotion(amplitude=1e-3, angular_frequency=160.0),
)
one, other = (solver.steady_state(pipe) for solver in (analytic.Solver(), fe_lapjoint.Solver()))
for found in (one, other):
    print(
        found.outcome.value,
        f"Repeats after {found.period_multiple} periods;",
        "impulses",
        found.impulses.round(4),
        "N s",
    )
apart = np.max(np.abs(one.impulses - other.impulses)) / np.max(np.abs(one.impulses))
print("The solvers agree" if apart < 1e-4 else "The solvers disagree", f"to {apart:.0e} of the largest impulse.")
figures.save(figures.plot_motion(one.history), __file__.replace(".py", ".png"))
