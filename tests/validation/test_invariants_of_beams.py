"""Energy and momentum of several beams, from a motion alone: right motions pass, and wrong ones do not."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

import analytic
from lapjoint import History, Problem, Stop, Support
from lapjoint.problem import Link, Mass, NamedBeam
from validation.invariants import energy_balance, witness
from validation.momentum import momentum_balance
from validation.verdict import Verdict

NAMES = "upper", "lower"
TOLERANCE = 2e-5
SOFT = (Support(x=0.0, translational=40.0), Support(x=0.8, translational=60.0, torsional=0.5))
STOPS = (
    Stop(name="near", between=("upper:0.4", "lower:0.1"), gap=0.002, stiffness=300.0),
    Stop(name="far", between=("upper:0.9", "lower:0.6"), gap=-0.002, stiffness=200.0),
)
LINK = Link(between=("upper:0.7", "lower:0.35"), translational=30.0, torsional=0.2)  # at 0.7 m and 0.65 m


def pair(**others: object) -> Problem:
    """A free beam on a soft link to another on soft supports, which strike each other; the link is a little aslant."""
    masses = (Mass(x=0.8, mass=0.3, rotary_inertia=0.001),)
    beams = (
        NamedBeam(name="upper", length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        NamedBeam(
            name="lower",
            origin=0.3,
            length=0.8,
            bending_stiffness=2.0,
            mass_per_length=1.5,
            masses=masses,
            supports=SOFT,
            base_share=-1.0,
        ),
    )
    parts = {"kind": "beams", "beams": [{"beam": "upper", "velocity": [-0.05, -0.02]}]}
    given = {"beams": beams, "stops": STOPS, "links": (LINK,), "damping": {"kind": "none"}, "initial": parts}
    return Problem(**given | {"base_motion": {"amplitude": 0.002, "angular_frequency": 5.0}} | others)


@pytest.fixture(scope="module")
def motion() -> History:
    return analytic.Solver(n_modes=16).simulate(pair(), 0.4, errors=False)


def judged(history: History) -> dict[str, Verdict]:
    return {item.name.removeprefix("it: "): item.verdict for item in witness(history, TOLERANCE, "it")}


def test_energy_and_momentum_of_each_beam_balance(motion: History) -> None:
    found = judged(motion)
    assert len(motion.contacts) > 2
    momenta = {f"{kind} of {name} unaccounted for" for kind in ("momentum", "angular momentum") for name in NAMES}
    assert momenta | {"energy unaccounted for"} <= set(found)
    assert set(found.values()) == {Verdict.AGREE}


def test_an_impulse_a_thousandth_too_large_disturbs_the_momentum_of_each_beam(motion: History) -> None:
    wrong = replace(motion, contacts=tuple(replace(it, impulse=1.001 * it.impulse) for it in motion.contacts))
    assert all(item.verdict is Verdict.DISAGREE for item in momentum_balance(wrong, TOLERANCE))


@pytest.mark.thorough
@pytest.mark.parametrize("change", [{"translational": 33.0}, {"torsional": 0.3}])
def test_energy_in_links_counts(motion: History, change: dict[str, float]) -> None:
    other = motion.problem.replace(links=(LINK.model_copy(update=change),))
    assert energy_balance(replace(motion, problem=other), TOLERANCE).verdict is Verdict.DISAGREE


@pytest.mark.thorough
def test_an_aslant_rigid_link_leaves_the_angular_momentum_out() -> None:
    for place, count in (("lower:0.4", 2), ("lower:0.35", 1)):
        links = (Link(between=("upper:0.7", place), translational=math.inf),)
        history = analytic.Solver(n_modes=16).simulate(pair(links=links, stops=()), 0.5, errors=False)
        found = momentum_balance(history, TOLERANCE)
        assert len(found) == count
        assert all(item.verdict is Verdict.AGREE for item in found)
