"""Scenes of several beams: a block a beam, and the base's motion added as far as it acts along each beam's z."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from pathlib import Path

import meshio
import numpy as np
import pytest
from numpy.typing import NDArray

from lapjoint import FREE, BaseMotion, History, Mass, Problem, Stop, Support
from lapjoint.problem import NamedBeam
from lapjoint.problem.presets import lap_joint
from lapjoint.scene import export_motion
from lapjoint.scene.scene import Scene, motion_scene

SHARES = {"upper": 1.0, "lower plate": -0.5}
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
TIMES = np.array([0.0, 0.1, 0.3])
Y = 0.02 * np.sin(5.0 * TIMES)


def still(problem: Problem) -> History:
    """Beams that do not move, on a base that does."""

    def nothing(x: NDArray[np.float64], t: NDArray[np.float64], dx: int = 0, dt: int = 0) -> NDArray[np.float64]:
        return np.zeros((x.size, t.size))

    return History(problem, "by hand", 0.0, 0.5, np.zeros(0), (FREE,), (), nothing)


@pytest.fixture
def scene() -> Scene:
    beams = [
        NamedBeam(
            name=name,
            length=1.0,
            bending_stiffness=1.0,
            mass_per_length=1.0,
            supports=(CLAMP,),
            masses=(Mass(x=1.0, mass=1.0),),
            base_share=share,
        )
        for name, share in SHARES.items()
    ]
    stops = (
        Stop(between=("upper:0.5", "lower plate:0.5"), gap=0.01, stiffness=1e3),
        Stop(x="lower plate:1.0", side="bottom", gap=0.01, stiffness=1e3),
        Stop(x="lower plate:1.0", side="bottom", gap=0.01, stiffness=1e3, fixed_to="space"),
    )
    base = BaseMotion(amplitude=0.02, angular_frequency=5.0)
    return motion_scene(still(Problem(beams=beams, stops=stops, base_motion=base)), points=5)


def test_each_beam_is_a_block_and_moves_with_its_share_of_the_base(scene: Scene) -> None:
    block = scene.block(TIMES)
    found = {name: values.point for (name, _), values in zip(scene.parts, block.values, strict=True)}
    assert list(found) == ["beam_upper", "beam_lower_plate", "masses", "stops", "gaps", "base"]
    for name, share in zip(("beam_upper", "beam_lower_plate"), SHARES.values(), strict=True):
        moved = found[name]["displacement_absolute"]
        assert moved.shape == (3, 5, 3)
        assert moved[:, :, 2] == pytest.approx(np.outer(share * Y, np.ones(5)), abs=1e-16)
        assert found[name]["velocity_absolute"][:, 0, 2] == pytest.approx(share * 0.1 * np.cos(5.0 * TIMES))
    cubes = found["masses"]["displacement_absolute"][:, [0, 8], 2]
    assert cubes == pytest.approx(np.outer(Y, list(SHARES.values())), abs=1e-16)


def test_springs_end_where_they_are_held(scene: Scene) -> None:
    """Of a stop between beams on the first, of others on the base of their beam, or in space."""
    block = scene.block(TIMES)
    feet = next(values for (name, _), values in zip(scene.parts, block.values, strict=True) if name == "stops")
    moved = feet.point["displacement_absolute"][:, 1::2, 2]
    assert moved[:, 0] == pytest.approx(Y, abs=1e-16)
    assert moved[:, 1] - moved[0, 1] == pytest.approx(-0.5 * Y, abs=1e-16)
    assert moved[:, 2] - moved[0, 2] == pytest.approx(0.0 * Y, abs=1e-16)


def test_files_of_the_lap_joint_have_a_grid_for_each_plate(tmp_path: Path) -> None:
    path = export_motion(still(lap_joint()), tmp_path, frames=2, points=5)
    names = [entry.attrib["name"] for entry in ET.parse(path).iter("DataSet") if entry.attrib["timestep"] == "0.0"]
    assert names == ["beam_upper", "beam_lower", "solid_upper", "solid_lower", "stops", "gaps", "base"]
    first, second = (meshio.read(tmp_path / "motion" / f"beam_{name}_000000.vtu") for name in ("upper", "lower"))
    assert first.points[:, 0].max() == pytest.approx(0.3)
    assert second.points[:, 0].min() == pytest.approx(0.24)
    export_motion(still(lap_joint()), tmp_path, frames=2, points=5, format="xdmf")
    assert (tmp_path / "motion_solid_lower.xdmf").is_file()
    export_motion(still(lap_joint()), tmp_path, frames=2, points=5, format="xdmf")
    assert len(list(tmp_path.glob("*.xdmf"))) == 7
