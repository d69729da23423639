"""A machine designer's joint: a turned arm with a clevis at its end, on a pad, between the jaws of a fork.

The drawing has steps, a mass, gravity, an interference and two gaps.  Both solvers say how the joint rests, at which
frequencies it swings, and what its stops take while the machine shakes it at 50 Hz.
"""

import math

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    BeamSegment,
    Circle,
    Gravity,
    Mass,
    Material,
    ModalDamping,
    Problem,
    Stop,
    Support,
    figures,
)

FORK = {"x": 0.9, "gap": 0.25e-3, "stiffness": 3e6}

arm = Problem(
    title="Turned arm with a clevis",
    beam=Beam(
        length=0.9,
        material=Material(youngs_modulus=2.1e11, density=7850.0),
        segments=(
            BeamSegment(to=0.3, section=Circle(diameter=0.036)),
            BeamSegment(to=0.9, section=Circle(diameter=0.028)),
        ),
    ),
    masses=(Mass(name="clevis", x=0.9, mass=1.2, rotary_inertia=8e-4),),
    supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
    stops=(
        Stop(name="pad", x=0.6, side="bottom", gap=-0.1e-3, stiffness=2e6),  # an interference of 0.1 mm
        Stop(name="jaw, top", side="top", **FORK),
        Stop(name="jaw, bottom", side="bottom", **FORK),
    ),
    damping=ModalDamping(ratio=0.02),
    gravity=Gravity(acceleration=-9.81),
    base_motion=BaseMotion(amplitude=0.6e-3, angular_frequency=2 * math.pi * 50),
)
rests, steadies = [], []
for solver in (analytic.Solver(), fe_lapjoint.Solver()):
    rest, steady = solver.equilibrium(arm), solver.steady_state(arm)
    pad, root, stress = rest.contact_forces[0], rest.support_forces[0], rest.largest_stress()
    print(solver.name)
    print(f"  At rest the pad presses with {pad:.4f} N; pad and root carry {pad + root:.4f} N;", end=" ")
    print(f"stress up to {abs(stress.value) / 1e6:.4f} MPa")
    hertz = [solver.modes(arm, state).angular_frequencies[0] / (2 * math.pi) for state in (FREE, rest.state)]
    print(f"  Lowest frequency: {hertz[0]:.4f} Hz in the air, {hertz[1]:.4f} Hz on the pad")
    print(f"  {steady.outcome.value}")
    for name, impulse, error in zip(arm.stop_names, steady.impulses, steady.impulse_errors, strict=True):
        print(f"  {name:<12} {impulse:8.5f} N s, {'error below 1e-6' if error < 1e-6 else f'+- {error:.0e}'}")
    steadies.append(steady)
one, other = steadies
apart, allowed = np.abs(one.impulses - other.impulses), np.hypot(one.impulse_errors, other.impulse_errors)
print("The solvers agree within their errors." if np.all(apart <= allowed) else f"The solvers disagree: {apart} N s.")

above, below = figures.new_panels(2, 1, 7.0, 5.6)
figures.plot_joint(arm, above)
t = np.linspace(one.history.start, one.history.end, 61)
below.plot(t, 1e3 * other.history.displacement(np.array([0.6, 0.9]), t).T, "k.", markersize=3, label=["FE", "_FE"])
figures.plot_motion(one.history, below, samples=300, label="analytic")
figures.save(above, __file__.replace(".py", ".svg"))
