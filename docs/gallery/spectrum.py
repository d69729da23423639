"""What impacts do to a spectrum: they turn one frequency into a comb.

With all four stops the paper's joint is its own mirror image, and so is its motion at 150 rad/s: only odd multiples of
the excitation occur.  With the top stops alone the motion repeats after two periods, and the comb has every multiple of
half the excitation frequency.
"""

import analytic
from lapjoint import figures, paper_joint

# Amplitude and gap are a tenth of the paper's: the same motion to scale, without its huge deflections.
joint = paper_joint(angular_frequency=150.0, base_amplitude=6e-3, gap=1e-4)
cases = (joint.replace(title="Four stops"), joint.replace(title="Top stops only", stops=joint.stops[2:]))
panels = figures.new_panels(2, 1, 7.0, 4.6, sharex=True)
for axes, problem in zip(panels, cases, strict=True):
    found = analytic.Solver().steady_state(problem)
    mirrored = "symmetric" if found.symmetric else "not symmetric"
    print(f"{problem.title}: period multiple {found.period_multiple}, {mirrored}")
    figures.plot_spectrum(found.history, axes)
panels[0].set_xlabel("")
figures.save(panels, __file__.replace(".py", ".png"))
