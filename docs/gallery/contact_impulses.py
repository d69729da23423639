"""From rest to steady: the impulse of every single contact of the paper's joint at 515 rad/s.

Blow by blow the impulses grow to the impulse per cycle of the steady state.  Newton's method on the period map finds
the steady state without waiting for it; the march from rest shows that the motion settles there.
"""

import math

import analytic
from lapjoint import figures, paper_joint

joint = paper_joint(angular_frequency=515.0)
T, tip = 2 * math.pi / 515.0, joint.stop_names.index("P4")
history = analytic.Solver().simulate(joint, 20 * T, errors=False)
for period in (1, 5, 10, 20):
    print(f"P4 in period {period}: {history.impulses((period - 1) * T, period * T)[tip]:.0f} N s")
print(f"P4, steady: {analytic.Solver().steady_state(joint).impulses[tip]:.0f} N s")
figures.save(figures.plot_contact_impulses(history), __file__.replace(".py", ".png"))
