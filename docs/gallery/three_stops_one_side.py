"""Three stops on one side: which is struck first?

With equal gaps the tip meets its stop first, and the contacts run inwards.  With gaps that grow towards the tip, which
moves most, they run outwards.  Either way the middle stop takes the largest impulse.
"""

import math

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Material, ModalDamping, Problem, Rectangle, Stop, Support, figures


def cantilever(title: str, *gaps: float) -> Problem:
    """An aluminium cantilever below stops at 0.4, 0.7 and 1 m."""
    return Problem(
        title=title,
        beam=Beam(
            length=1.0,
            material=Material(youngs_modulus=70e9, density=2700.0),
            section=Rectangle(breadth=0.04, height=0.01),
        ),
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        stops=tuple(
            Stop(name=f"{x:g} m", x=x, side="top", gap=gap, stiffness=2e5)
            for x, gap in zip((0.4, 0.7, 1.0), gaps, strict=True)
        ),
        damping=ModalDamping(ratio=0.08),
        base_motion=BaseMotion(amplitude=2e-3, angular_frequency=70.0),
    )


cases = (
    cantilever("Equal gaps", 5e-4, 5e-4, 5e-4),
    cantilever("Gaps that grow towards the tip", 1e-4, 5e-4, 1.5e-3),
)
panels = figures.new_panels(2, 1, 7.0, 4.4)
for axes, problem in zip(panels, cases, strict=True):
    for solver in (analytic.Solver(), fe_lapjoint.Solver()):
        found = solver.steady_state(problem)
        order = ", ".join(problem.stop_names[contact.stop] for contact in found.history.contacts)
        print(f"{problem.title}: {order}; impulses {found.impulses.round(4)} N s")
    figures.plot_contact_states(found.history, axes)
    first = found.history.contacts[0].start
    axes.set_xlim(first - 1e-3, first + 7e-3)
figures.save(panels, __file__.replace(".py", ".png"))
