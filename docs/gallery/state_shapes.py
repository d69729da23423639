"""The nine contact states of the paper's joint, and the mode shapes of each.

Every set of closed stops makes a linear beam of its own (Table 1).  Neither gap nor side matters, so states 2 and 4
share their modes, so do 3 and 5, and so do 6 to 9.  The frequencies are those of Table 4 for hard contact.
"""

import analytic
from lapjoint import contact_states, figures, paper_joint, paper_state_number
from lapjoint.problem.presets import TABLE_4_DENSITY

joint = paper_joint(k_star=5000.0, density=TABLE_4_DENSITY)
solver = analytic.Solver()
modes = [solver.modes(joint, state, 3) for state in contact_states(joint)]
for each in modes:
    number = paper_state_number(joint, each.state)
    print(f"State {number}, {each.state.name(joint)}: {each.angular_frequencies.round(1)} rad/s")
figures.save(figures.plot_state_shapes(joint, modes), __file__.replace(".py", ".svg"))
