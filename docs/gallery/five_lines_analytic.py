"""Five lines from a problem to a picture, with the analytic solver.

The paper's joint at its first peak, 515 rad/s: the motion that remains, certified periodic, and the impulse that
each of the four stops takes in a cycle.
"""

import analytic
from lapjoint import figures, paper_joint

found = analytic.Solver().steady_state(paper_joint(angular_frequency=515.0))
print(found.outcome.value, found.impulses.round(1))
figures.save(figures.plot_motion(found.history), __file__.replace(".py", ".png"))
