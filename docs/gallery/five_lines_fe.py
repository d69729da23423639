"""The same five lines with the finite elements, which share nothing with the analytic solver but the problem.

The paper's joint at 515 rad/s again, its tip as a phase portrait.  A closed loop is a periodic motion.  The tip crosses
its gap of 2 mm in a moment; for the rest of the cycle it is in a stop, and presses it in by nearly 30 mm.
"""

import fe_lapjoint
from lapjoint import figures, paper_joint

found = fe_lapjoint.Solver().steady_state(paper_joint(angular_frequency=515.0))
print(found.outcome.value, found.impulses.round(1))
figures.save(figures.plot_phase_portrait(found.history), __file__.replace(".py", ".png"))
