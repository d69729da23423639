"""Figure 4 of the paper as one curve: every motion of one excitation period, stable or not, from 40 to 5000 rad/s.

A sweep gives points.  A branch gives the curve between them, and says where a motion loses its stability, folds back,
or begins to touch a stop.  All these bifurcations lie below 130 rad/s, a range that is drawn again beside the whole.
"""

from lapjoint import FREQUENCY, branch, figures, paper_joint

found = branch(paper_joint(), FREQUENCY, 40.0, 5000.0, errors=False)
least, largest = float(found.bifurcation_value.min()), float(found.bifurcation_value.max())
quiet = bool(found.stable.values[found.angular_frequency.values > 130.0].all())
print(f"bifurcations between {least:.1f} and {largest:.1f} rad/s; all stable above 130 rad/s: {quiet}")
whole, low = figures.new_panels(1, 2, 6.4, 2.6)
figures.plot_branches(found, whole)
figures.plot_branches(found, low)
low.set(xlim=(40.0, 130.0), ylim=(-3000.0, 3000.0))
figures.save((whole, low), __file__.replace(".py", ".png"))
