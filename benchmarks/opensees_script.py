"""The joint in OpenSeesPy: elasticBeamColumn with consistent mass, gap springs, mass-proportional damping, Newmark."""

from __future__ import annotations

import math

import numpy as np

from lapjoint import Problem, ViscousDamping

FAR = 1e3  # m: where the gap springs' law ends


def opensees_impulses(problem: Problem, elements: int, duration: float, dt: float) -> np.ndarray:
    """Impulse of each stop over the first `duration` seconds, N s, shape ``(stops,)``."""
    import openseespy.opensees as ops

    beam, base = problem.beam, problem.base_motion
    assert base is not None
    assert isinstance(problem.damping, ViscousDamping)
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for i in range(elements + 1):
        ops.node(i, beam.length * i / elements, 0.0)
    ops.fix(0, 1, 1, 1)
    ops.geomTransf("Linear", 1)
    for e in range(elements):
        ops.element("elasticBeamColumn", e, e, e + 1, 1.0, beam.EI, 1.0, 1, "-mass", beam.m, "-cMass")
    stops = [round(stop.x / beam.length * elements) for stop in problem.stops]
    for k, (stop, node) in enumerate(zip(problem.stops, stops, strict=True)):
        far, force = stop.sign * FAR, stop.sign * stop.stiffness * (FAR - stop.gap)
        law = sorted([(-far, 0.0), (stop.sign * stop.gap, 0.0), (far, force)])
        ops.uniaxialMaterial("ElasticMultiLinear", k, "-strain", *[e for e, _ in law], "-stress", *[s for _, s in law])
        ops.node(1000 + k, beam.length * node / elements, 0.0)
        ops.fix(1000 + k, 1, 1, 1)
        ops.element("zeroLength", 1000 + k, 1000 + k, node, "-mat", k, "-dir", 2)
    ops.rayleigh(problem.damping.coefficient / beam.m, 0.0, 0.0, 0.0)
    ops.timeSeries("Trig", 1, 0.0, 1e9, 2 * math.pi / base.angular_frequency)
    ops.pattern("Plain", 1, 1)
    ops.eleLoad("-ele", *range(elements), "-type", "-beamUniform", beam.m * base.amplitude * base.angular_frequency**2)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12, 20)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    impulses = np.zeros(len(stops))
    for _ in range(round(duration / dt)):
        if ops.analyze(1, dt) != 0:
            raise RuntimeError("OpenSees does not converge")
        for k, (stop, node) in enumerate(zip(problem.stops, stops, strict=True)):
            depth = max(stop.sign * ops.nodeDisp(node, 2) - stop.gap, 0.0)
            impulses[k] += stop.sign * stop.stiffness * depth * dt
    ops.wipe()
    return impulses
