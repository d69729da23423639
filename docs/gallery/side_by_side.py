"""Both solvers side by side in one scene, at the time when the stops push hardest, and how far apart they are.

`lapjoint.scene.export_motion` takes the same dictionary, and writes the scene for ParaView.
"""

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.scene import Look, save_picture

# Amplitude and gap are a tenth of the paper's: the same motion to scale.
joint = paper_joint(angular_frequency=820.0, base_amplitude=6e-3, gap=1e-4)
exact, fe = (solver.steady_state(joint).history for solver in (analytic.Solver(), fe_lapjoint.Solver()))
save_picture({"analytic": exact, "fe": fe}, __file__.replace(".py", ".png"), look=Look("velocity", size=(1000, 460)))

x, t = np.linspace(0.0, 2.5, 101), np.linspace(0.0, min(exact.end, fe.end), 401)
apart = np.abs(exact.displacement(x, t) - fe.displacement(x, t)).max()
print(f"Apart by {1e3 * apart:.3f} mm at most, of {1e3 * np.abs(exact.displacement(x, t)).max():.0f} mm.")
