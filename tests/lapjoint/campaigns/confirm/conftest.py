"""Branches of a cantilever with one stop: a graze and two folds, with their errors."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns import branch


@pytest.fixture(scope="session")
def branches() -> xr.Dataset:
    """The dataset, which no test changes."""
    joint = Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0),),
        damping=ViscousDamping(coefficient=0.8),
        base_motion=BaseMotion(amplitude=3e-4, angular_frequency=5.0),
    )
    return branch(joint, "base_motion.amplitude", 3e-4, 4e-4, options={"n_modes": 8})
