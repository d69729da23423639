"""Chaos in the paper's joint, with its own damping of 8 %: leave nothing but the bottom stop at the tip, at 200 rad/s.

Nothing repeats, and nearby motions part at the rate of the largest Lyapunov exponent.  No two solvers can follow one
chaotic motion for long.  But their Poincaré sections trace one strange attractor, with one exponent.
"""

import math

import analytic
import fe_lapjoint
from lapjoint import figures, paper_joint

# Amplitude and gap are a tenth of the paper's: the same motion to scale, without its huge deflections.
joint = paper_joint(angular_frequency=200.0, base_amplitude=6e-3, gap=1e-4)
joint = joint.replace(stops=joint.stops[:1])
T = 2 * math.pi / 200.0

axes = figures.new_axes(7.0, 3.8)
for solver, periods in ((analytic.Solver(), 4000), (fe_lapjoint.Solver(elements=16), 500)):
    found = solver.steady_state(joint, errors=False)
    assert found.exponent is not None
    print(found.outcome.value, f"Exponent {found.exponent.value:.2f} ± {found.exponent.standard_error:.2f} 1/s")
    march = solver.simulate(joint, periods * T, errors=False)
    figures.plot_poincare_section(march, axes, label=f"{solver.name}, {periods} periods")
axes.set(xlim=(0, 50), ylim=(-5.5, -2))  # without the start, which is at rest
figures.save(axes, __file__.replace(".py", ".png"))
