"""States are made as they are met, so that their number is no limit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import CLAMP, UNIT

import fe_lapjoint
from lapjoint import BaseMotion, InputError, ModalDamping, Problem, Stop, contact_states


def test_sixteen_stops_of_65536_states_run() -> None:
    places = np.linspace(0.3, 1.0, 8)
    stops = tuple(Stop(x=float(x), side=s, gap=1e-4 * x, stiffness=200.0) for x in places for s in ("top", "bottom"))
    problem = Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=stops,
        damping=ModalDamping(ratio=0.1),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=8.0),
    )
    with pytest.raises(InputError, match="contact states"):
        contact_states(problem)
    solver = fe_lapjoint.Solver(elements=16, max_periods=400)
    history = solver.simulate(problem, 3 * 2 * math.pi / 8.0)
    assert {contact.stop for contact in history.contacts} == set(range(16))
    period_map = solver.period_map(problem)
    period_map.march(period_map.initial(), 8)
    met = len(period_map.model._systems)
    assert 8 < met < 400, "some of 65 536"
