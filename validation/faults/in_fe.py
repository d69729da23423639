"""Faults of the finite element solver."""

from __future__ import annotations

from validation.faults.fault import Fault

FE = (
    Fault(
        "fe-mass",
        "a factor",
        "fe_lapjoint.modes.assembly",
        "The mass matrix is a thousandth too large.",
        old="+= beam.m * h * m *",
        new="+= 1.001 * beam.m * h * m *",
    ),
    Fault(
        "fe-base-load",
        "a factor",
        "fe_lapjoint.march.system",
        "The inertia load of the moving base is a thousandth too large.",
        old="acceleration = base.amplitude * base",
        new="acceleration = 1.001 * base.amplitude * base",
    ),
    Fault(
        "fe-torsion-soft",
        "a factor",
        "fe_lapjoint.modes.assembly",
        "Torsional springs of supports are 1 % too soft.",
        old="support.torsional / L**2",
        new="0.99 * support.torsional / L**2",
    ),
    Fault(
        "fe-shear",
        "a sign",
        "fe_lapjoint.modes.assembly",
        "Shear forces have the wrong sign.",
        old="values = _hermite(s, derivative) / h**derivative",
        new="values = _hermite(s, derivative) / h**derivative * (-1.0 if derivative == 3 else 1.0)",
    ),
    Fault(
        "fe-moment-sign",
        "a sign",
        "fe_lapjoint.march.field",
        "Bending moments have the wrong sign.",
        old="rows = self.model.assembly.shapes(x, dx)",
        new="rows = self.model.assembly.shapes(x, dx) * (-1.0 if dx == 2 else 1.0)",
    ),
    Fault(
        "fe-shapes-off-by-one",
        "off by one",
        "fe_lapjoint.answers",
        "Each frequency is listed with the shape of the next mode.",
        old="ElementShapes(assembly, vectors[:, :count])",
        new="ElementShapes(assembly, vectors[:, 1 : count + 1])",
    ),
    Fault(
        "fe-phase-ignored",
        "an input ignored",
        "fe_lapjoint.march.system",
        "The base begins to move at phase zero, whatever its own.",
        old="phase.append(base.phase)",
        new="phase.append(0.0)",
    ),
    Fault(
        "fe-sine-phase-ignored",
        "an input ignored",
        "fe_lapjoint.march.system",
        "Sine loads begin at phase zero, whatever their own.",
        old="[load.phase for load in sines]",
        new="[0.0 for load in sines]",
    ),
    Fault(
        "fe-one-ratio-for-all",
        "an input ignored",
        "fe_lapjoint.march.system",
        "The first of several damping ratios holds for all modes.",
        old="return damping.ratios(omega.size) * omega",
        new="return damping.ratios(1) * omega",
    ),
    Fault(
        "fe-viscous-twice",
        "a factor",
        "fe_lapjoint.march.system",
        "Viscous damping is twice as strong.",
        old="np.full(omega.size, coefficient / (2 * assembly",
        new="np.full(omega.size, coefficient / (1 * assembly",
    ),
    Fault(
        "fe-rigid-body",
        "a factor",
        "fe_lapjoint.march.system",
        "A rigid-body mode moves a thousandth too far under a constant force.",
        old="np.where(rigid & ~drag, self.constant, 0.0)",
        new="np.where(rigid & ~drag, 1.001 * self.constant, 0.0)",
    ),
    Fault(
        "fe-overdamped",
        "a factor",
        "fe_lapjoint.march.propagator",
        "The slow rate of an overdamped mode is a thousandth off.",
        old="return omega**2 / np.where(a + s",
        new="return 1.001 * omega**2 / np.where(a + s",
    ),
    Fault(
        "fe-gap",
        "a factor",
        "fe_lapjoint.march.model",
        "Gaps are a thousandth too wide.",
        old="self.gap = np.array([stop.gap for",
        new="self.gap = np.array([1.001 * stop.gap for",
    ),
    Fault(
        "fe-way-back",
        "a stale cache",
        "fe_lapjoint.march.model",
        "The map from one contact state to another is kept for the way back, too.",
        old=(
            "matrix = self._maps.get((old, new))\n"
            "        if matrix is None:\n"
            "            matrix = self._maps[old, new] = "
        ),
        new=(
            "key = (min(old, new), max(old, new))\n"
            "        matrix = self._maps.get(key)\n"
            "        if matrix is None:\n"
            "            matrix = self._maps[key] = "
        ),
    ),
    Fault(
        "fe-initial-slope",
        "an input ignored",
        "fe_lapjoint.march.initial",
        "The initial shape is interpolated without its slopes.",
        old="L * shape(assembly.nodes, 1)",
        new="0.0 * shape(assembly.nodes, 1)",
    ),
    Fault(
        "fe-events-at-samples",
        "an event dropped",
        "fe_lapjoint.march.events",
        "A contact between two samples of the motion is not seen.",
        old="gaps.curvature[:, None] * (-(width**2) / 8)",
        new="gaps.curvature[:, None] * 0.0",
    ),
    Fault(
        "fe-contact-counted-twice",
        "counted twice",
        "fe_lapjoint.march.field",
        "Of a contact that goes on from one period to the next, the part before counts twice.",
        old="impulse=before.impulse + contact.impulse",
        new="impulse=2 * before.impulse + contact.impulse",
    ),
    Fault(
        "fe-peak-force",
        "a factor",
        "fe_lapjoint.march.march",
        "Peak forces are 1 % too small.",
        old="peak_force=stiffness * max(",
        new="peak_force=0.99 * stiffness * max(",
    ),
    Fault(
        "fe-penetration",
        "a factor",
        "fe_lapjoint.march.march",
        "Impulses are a thousandth too large.",
        old="impulse=float(model.sign[k]) * stiffness",
        new="impulse=1.001 * float(model.sign[k]) * stiffness",
    ),
    Fault(
        "fe-saltation-sign",
        "a sign",
        "fe_lapjoint.march.tangent",
        "A deviation shifts a switch the wrong way.",
        old="delay = -(row @",
        new="delay = (row @",
    ),
    Fault(
        "fe-saltation-0.9",
        "a factor",
        "fe_lapjoint.march.tangent",
        "A deviation shifts a switch by nine tenths of what it should.",
        old="delay = -(row @",
        new="delay = -0.9 * (row @",
    ),
    Fault(
        "fe-saltation-first-stop",
        "off by one",
        "fe_lapjoint.march.tangent",
        "The switches of the first stop leave deviations as they are, but for the change of modes.",
        old="delay = -(row @",
        new="delay = -(k > 0) * (row @",
    ),
)
