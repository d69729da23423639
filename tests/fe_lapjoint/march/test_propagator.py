"""The exact flow of the finite element model obeys the equation of motion."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from beams import CLAMP
from scipy.integrate import fixed_quad

from fe_lapjoint.march.propagator import Flow
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    ModalDamping,
    NoDamping,
    Problem,
    SineLoad,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
)

BEAM = Beam(length=2.0, bending_stiffness=1e5, mass_per_length=10.0)
SHAKEN = Problem(
    beam=BEAM,
    supports=(CLAMP,),
    stops=(
        Stop(x=2.0, side="top", gap=2e-3, stiffness=1e5),
        Stop(x=1.0, side="bottom", gap=1e-3, stiffness=1e6),
    ),
    damping=ModalDamping(ratio=0.05),
    base_motion=BaseMotion(amplitude=0.02, angular_frequency=35.0),
    point_loads=(StepLoad(x=0.7, force=-3.0), SineLoad(x=1.1, force=5.0, angular_frequency=88.0)),
)
DAMPINGS = {
    "modal": ModalDamping(ratio=0.05),
    "overdamped": ModalDamping(ratio=(3.0, 1.0, 0.1)),
    "viscous": ViscousDamping(coefficient=40.0),
    "none": NoDamping(),
}


@pytest.mark.parametrize("name", DAMPINGS)
@pytest.mark.parametrize("supports", [(CLAMP,), (Support(x=0.0, translational=math.inf),), ()])
def test_flow_rates_and_integrals_satisfy_the_equation_of_motion(name: str, supports: tuple[Support, ...]) -> None:
    problem = SHAKEN.replace(damping=DAMPINGS[name], supports=supports)
    system = build_system(Assembly(problem, mesh_nodes(problem, 4, None)), FREE)
    rng, n = np.random.default_rng(0), system.omega.size
    flow = Flow(system, 0.3, rng.normal(size=n) * 1e-3, rng.normal(size=n) * 1e-2)
    t = np.array([0.3, 0.31, 0.4])
    y = np.concatenate([flow(t), flow(t, 1)])
    rates = np.array([system.rates(s, y[:, i]) for i, s in enumerate(t)]).T
    np.testing.assert_allclose(np.concatenate([flow(t, 1), flow(t, 2)]), rates, atol=1e-9 * np.abs(rates).max())
    np.testing.assert_allclose(y[:, 0], np.concatenate([flow.q, flow.v]), atol=1e-12)
    np.testing.assert_allclose(flow.at_stops(t, 1), system.stops @ flow(t, 1), atol=1e-12)
    edges = np.linspace(0.3, 0.32, 101)  # resolve the highest of these modes, with 20 points in each piece
    area = sum(fixed_quad(flow, a, b, n=20)[0] for a, b in pairwise(edges))
    np.testing.assert_allclose(flow.integral(0.32), area, atol=1e-9 * np.abs(area).max())
