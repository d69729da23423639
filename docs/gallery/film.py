"""A film of one steady cycle at 515 rad/s, the paper's joint by finite elements, drawn without a display.

The displacements are drawn at true scale: the stiff springs give way by far more than the gaps of 1 mm.
"""

import numpy as np

import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.scene import Look, save_film

joint = paper_joint(angular_frequency=515.0)
found = fe_lapjoint.Solver().steady_state(joint)
save_film(found.history, __file__.replace(".py", ".gif"), frames=48, look=Look(size=(760, 340)))

x, t = np.linspace(0.0, 2.5, 101), np.linspace(found.history.start, found.history.end, 401)
assert joint.beam.material is not None
stress = joint.beam.material.youngs_modulus * 0.025 * np.abs(found.history.evaluate(x, t, dx=2)).max()
print(f"{found.outcome.value} Bending stress up to {stress / 1e9:.1f} GPa")
