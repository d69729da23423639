"""A cascade of flips that ends in chaos: a bar on a pin, shaken beside one stiff stop.

At each flip a motion loses its stability to a motion of twice its period.  The flips come ever faster, and behind the
last flip nothing repeats.  Each dot is the peak force of one impact of a long march; lines are the certified motions.
"""

import math

import numpy as np

import analytic
from lapjoint import FREQUENCY, BaseMotion, Beam, ModalDamping, Problem, Stop, Support, branch, figures

bar = Problem(
    beam=Beam(length=1.5, bending_stiffness=2.5e5, mass_per_length=4.0),
    supports=(Support(x=0.0, translational=math.inf, torsional=450.0),),
    stops=(Stop(x=1.2, side="top", gap=1e-3, stiffness=6e3),),
    damping=ModalDamping(ratio=0.02),
    base_motion=BaseMotion(amplitude=2e-3, angular_frequency=24.0, phase=0.3),
)


def main(marches: int = 81, multiple: int = 16) -> None:
    solver, first, last = analytic.Solver(n_modes=1), 24.0, 26.4

    axes, point = figures.new_axes(7.0, 3.6), None
    for omega in np.linspace(first, last, marches).tolist():
        moved = BaseMotion(amplitude=2e-3, angular_frequency=omega, phase=0.3)
        march = solver.period_map(bar.replace(base_motion=moved))
        begins = march.march(march.initial(), 2000).end if point is None else march.adopted(point)  # half periods
        point = march.march(begins, 120).end
        force = [contact.peak_force for contact in march.history(point, 30).contacts]
        axes.plot([omega] * len(force), force, ".", color="0.35", markersize=0.9)
    found = branch(bar, FREQUENCY, first, last, options={"n_modes": 1}, errors=False, max_period_multiple=multiple)
    figures.plot_branches(found, axes, ordinate="peak_force")

    names = found.bifurcation_kind.flag_meanings.split()
    for number, kind in enumerate(found.bifurcation_kind.values):
        if names[kind] == "flip":
            of = int(found.period_multiple[found.bifurcation_point[number]])
            print(f"{of} to {2 * of} periods at {float(found.bifurcation_value[number]):.4f} rad/s")
    figures.save(axes, __file__.replace(".py", ".png"))


if __name__ == "__main__":
    main()
