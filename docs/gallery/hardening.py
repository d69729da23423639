"""A hardening resonance: a cantilever between two stops, its base shaken with ever higher frequency.

Once it reaches the stops it is stiffer, so its resonance leans over, and folds back.  Between the folds two stable
motions exist, with an unstable one (dashed) between them: which one a sweep sees depends on where it comes from.
"""

from math import inf

import numpy as np

from lapjoint import FREQUENCY, Axis, BaseMotion, Beam, Problem, Stop, Support, ViscousDamping, branch, figures, sweep

# Everything is scaled: without its stops the cantilever has its lowest resonance at 3.5 rad/s.
joint = Problem(
    beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
    supports=(Support(x=0.0, translational=inf, torsional=inf),),
    stops=tuple(Stop(x=1.0, side=side, gap=1e-3, stiffness=6.0, name=side) for side in ("top", "bottom")),
    damping=ViscousDamping(coefficient=0.4),
    base_motion=BaseMotion(amplitude=1.4e-4, angular_frequency=3.0),
)
modes = {"n_modes": 4}
axes = figures.new_axes(7.0, 3.4)
for start, marker in (("up", "^"), ("down", "v")):
    curve = sweep(joint, [Axis(FREQUENCY, np.linspace(2.8, 5.4, 14))], start=start, options=modes)
    axes.plot(
        curve.angular_frequency, curve.impulse.isel(stop=0), marker, color="0.6", markersize=4, label=f"a sweep {start}"
    )
found = branch(joint, FREQUENCY, 2.8, 5.4, options=modes, errors=False)
figures.plot_branches(found, axes)

names = found.bifurcation_kind.flag_meanings.split()
for number, kind in enumerate(found.bifurcation_kind.values):
    print(f"{names[kind]} at {float(found.bifurcation_value[number]):.3f} rad/s")
figures.save(axes, __file__.replace(".py", ".png"))
