"""Numbers beyond double precision, or beyond what double precision holds beside the beam's own, are refused by name."""

from __future__ import annotations

import math
from typing import Any

import pytest

from lapjoint import (
    BaseMotion,
    Beam,
    InputError,
    ModalDamping,
    PolynomialShape,
    Problem,
    RecordBaseMotion,
    StepLoad,
    Stop,
    Support,
    ViscousDamping,
)

BEAM = Beam(length=1.0, bending_stiffness=450.0, mass_per_length=2.4)
WAVE = [math.sin(0.3 * i) for i in range(60)]


def record(**changes: Any) -> RecordBaseMotion:
    return RecordBaseMotion(**{"quantity": "acceleration", "values": WAVE, "rate": 500.0} | changes)


def pins(*places: float) -> tuple[Support, ...]:
    return tuple(Support(x=x, translational=math.inf) for x in places)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "ratio": ({"damping": ModalDamping(ratio=1e150)}, r"damping.ratio = 1e\+150: must be at most 1e\+07"),
    "ratios": ({"damping": ModalDamping(ratio=(0.1, 1e160))}, r"damping.ratio\[1\] = 1e\+160: must be at most"),
    "coefficient": ({"damping": ViscousDamping(coefficient=1e200)}, r"damping.coefficient = 1e\+200: must be at most"),
    "fast record": ({"base_motion": record(rate=1e120)}, r"base_motion.rate = 1e\+120: the samples come to 1e-120 s"),
    "slow record": ({"base_motion": record(rate=1e-308)}, r"base_motion.rate = 1e-308: .* and inf s in all; allowed"),
    "times": ({"base_motion": record(rate=None, times=[1e-120 * i for i in range(60)])}, "base_motion.times: the sam"),
    "swift record": (
        {"base_motion": record(quantity="displacement", rate=1e60)},
        "base_motion: the largest acceleration of the base comes to",
    ),
    "frequency": ({"base_motion": BaseMotion(amplitude=1.0, angular_frequency=1e-60)}, "must be between 1e-100 and"),
    "amplitude": ({"base_motion": BaseMotion(amplitude=1e101, angular_frequency=1.0)}, r"amplitude = 1e\+101: must be"),
    "acceleration": (
        {"base_motion": BaseMotion(amplitude=1e99, angular_frequency=1e3)},
        "the acceleration comes to 1e",
    ),
    "phase": ({"base_motion": BaseMotion(amplitude=1.0, angular_frequency=1.0, phase=1e150)}, r"phase = 1e\+150: allo"),
    "force": ({"point_loads": (StepLoad(x=1.0, force=-1e150),)}, r"point_loads\[0\].force = -1e\+150: must be at most"),
    "gap": ({"stops": (Stop(x=1.0, side="top", gap=1e150, stiffness=1e4),)}, r"stops\[0\].gap = 1e\+150: must be at"),
    "start": ({"initial": PolynomialShape(displacement=(0.0, 1e300))}, "initial.displacement: the largest value comes"),
    "at the root": ({"supports": pins(0.0, 5e-324)}, r"supports\[1\].x = 4.94066e-324: must be 0, or more than 1e-12"),
    "one pin or two": ({"supports": pins(0.5, 0.5 + 1e-14)}, r"supports\[1\].x = .*: lies 1e-14 m from supports\[0\]"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_numbers_beyond_double_precision_are_refused_by_name(name: str) -> None:
    parts, message = REFUSED[name]
    with pytest.raises(InputError, match=message):
        Problem(beam=BEAM, **parts)


def test_numbers_that_vanish_beside_all_else_are_allowed() -> None:
    least = 5e-324
    Problem(
        beam=BEAM,
        supports=(),
        stops=(Stop(x=0.5, side="top", gap=least, stiffness=1.0),),
        damping=ModalDamping(ratio=least),
        base_motion=BaseMotion(amplitude=least, angular_frequency=1.0, phase=least),
        initial=PolynomialShape(displacement=(0.0,), velocity=(least,)),
    )
