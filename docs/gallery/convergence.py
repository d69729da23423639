"""Are the elements, or the modes, enough?  The impulse of the top stop at the tip, at 515 rad/s.

Twice the elements leave a sixteenth of the error: order four, as cubic elements must.  The error of the modes falls
much faster.  Both are errors against 96 modes, to whose value elements converge, which know nothing of modes.
"""

import analytic
import fe_lapjoint
from lapjoint import figures, paper_joint

joint = paper_joint(angular_frequency=515.0)


def tip_impulse(solver: analytic.Solver | fe_lapjoint.Solver) -> float:
    """Impulse of P4 in a cycle, N s."""
    return float(solver.steady_state(joint).impulses[2])


by_elements = {n: tip_impulse(fe_lapjoint.Solver(elements=n)) for n in (12, 16, 24, 32, 48)}
by_modes = {n: tip_impulse(analytic.Solver(n_modes=n)) for n in (8, 12, 16, 24, 32)}
exact = tip_impulse(analytic.Solver(n_modes=96))
print(f"48 elements {by_elements[48]:.3f}, 32 modes {by_modes[32]:.3f}, 96 modes {exact:.3f} N s")
axes = figures.plot_convergence(by_elements, reference=exact, order=4, label="elements")
figures.plot_convergence(by_modes, axes, reference=exact, label="modes")
figures.save(axes, __file__.replace(".py", ".png"))
