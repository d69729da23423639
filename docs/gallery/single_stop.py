"""Mapping in time, Table 5 of the paper: state 1, impact, state 2, rebound, state 1 again.

With one stop below the tip, as in the table, there are two states, each a linear beam with modes of its own.  At impact
and rebound the motion passes from one set of modes to the other; displacement and velocity must not jump (36), (41).
Elements keep them.  Modes do so in the limit: the velocity that few modes leave out falls with their cube.
"""

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import History, figures, paper_joint

# Amplitude and gap are a tenth of the paper's: the same motion to scale, without its huge deflections.
joint = paper_joint(angular_frequency=60.0, base_amplitude=6e-3, gap=1e-4)
joint = joint.replace(title="One stop below the tip", stops=joint.stops[:1])
L = joint.beam.length


def jumps(history: History, T: float) -> list[str]:
    """Largest jumps of displacement and velocity over the beam at a switch, relative to the largest value."""
    x, all_times = np.linspace(0.0, L, 101), np.linspace(history.start, history.end, 1000)
    just = [np.nextafter(T, 0.0), np.nextafter(T, 1.0)]
    motions = (history.displacement, history.velocity)
    found = [np.ptp(motion(x, just), axis=1).max() / np.abs(motion(x, all_times)).max() for motion in motions]
    return [f"{jump:.0e}" if jump > 1e-12 else "< 1e-12" for jump in found]


for solver in (*(analytic.Solver(n_modes=n) for n in (30, 60, 120)), fe_lapjoint.Solver()):
    history = solver.steady_state(joint).history
    contact = history.contacts[0]
    print(f"{solver.name}: z and z_t jump by", " and ".join(jumps(history, contact.start)), "at impact")

t = np.linspace(contact.start - 2e-3, contact.end + 2e-3, 400)
panels = figures.new_panels(3, 1, 7.0, 4.6, sharex=True, height_ratios=(1, 2, 2))
figures.plot_contact_states(history, panels[0])
panels[1].plot(t, 1e3 * history.displacement(L, t)[0])
panels[2].plot(t, history.velocity(L, t)[0])
panels[0].set(xlabel="", xlim=(t[0], t[-1]))
panels[1].set_ylabel("tip z [mm]")
panels[2].set(ylabel="tip z$_t$ [m/s]", xlabel="time t [s]")
for axes in panels:
    axes.axvline(contact.start, color="0.5", lw=0.8)
    axes.axvline(contact.end, color="0.5", lw=0.8)
figures.save(panels, __file__.replace(".py", ".png"))
