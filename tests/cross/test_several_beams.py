"""Motions of several beams by both solvers: first contacts and steady states agree within their stated errors."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, ModalDamping, Problem, Stop, Support
from lapjoint.problem import Link, Mass, NamedBeam
from lapjoint.problem.presets import lap_joint

SOLVERS = analytic.Solver(), fe_lapjoint.Solver()
CONTACTS = 4  # first contacts of a motion that are compared
MARGIN = 3.0  # times the stated errors: they are to cover 19 of 20
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)


def pair(seed: int) -> Problem:
    """Two random cantilevers on a shaken base that may strike each other, some with a mass, a link or a stop."""
    rng = np.random.default_rng((49, seed))

    def number(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    beams = []
    for name in ("upper", "lower"):
        masses = (Mass(x=1.0, mass=number(0.1, 1)),) if rng.random() < 0.4 else ()
        beams.append(
            NamedBeam(
                name=name,
                length=1.0,
                bending_stiffness=number(0.5, 3),
                mass_per_length=number(0.5, 2),
                supports=(CLAMP,),
                masses=masses,
                base_share=float(rng.choice([1.0, -1.0, 0.5])),
            )
        )
    stops = [Stop(between=(f"upper:{number(0.5, 1)}", f"lower:{number(0.5, 1)}"), gap=0.01, stiffness=number(50, 300))]
    if rng.random() < 0.5:
        stops.append(Stop(x=f"upper:{number(0.5, 1)}", side="top", gap=0.012, stiffness=number(50, 300)))
    place = number(0.2, 0.6)
    links = (Link(between=(f"upper:{place}", f"lower:{place}"), translational=number(1, 20), torsional=number(0, 2)),)
    return Problem(
        beams=tuple(beams),
        stops=tuple(stops),
        links=links if rng.random() < 0.5 else (),
        damping=ModalDamping(ratio=number(0.02, 0.08)),
        base_motion=BaseMotion(amplitude=number(0.01, 0.03), angular_frequency=number(2, 9)),
    )


def far(problem: Problem, duration: float) -> list[float]:
    """Distances of the first contacts' starts and impulses, over what the stated errors allow."""
    one, other = (solver.simulate(problem, duration).contacts[:CONTACTS] for solver in SOLVERS)
    found: list[float] = []
    for a, b in zip(one, other, strict=False):
        if a.stop != b.stop:
            break
        for what in ("start", "impulse"):
            errors = [getattr(c, f"{what}_error") for c in (a, b)]
            found.append(abs(getattr(a, what) - getattr(b, what)) / (MARGIN * sum(errors) + 1e-9))
    return found


def test_first_contacts_of_a_few_pairs() -> None:
    found = [each for seed in range(1, 3) for each in far(pair(seed), 4.0)]
    assert len(found) >= 8
    assert max(found) <= 1


@pytest.mark.slow
def test_first_contacts_of_many_pairs() -> None:
    found = [each for seed in range(3, 64) for each in far(pair(seed), 4.0)]
    assert len(found) >= 200
    assert sum(each > 1 for each in found) <= 0.05 * len(found)


def test_first_contacts_of_the_lap_joint() -> None:
    found = far(lap_joint(), 0.03)
    assert len(found) == 2 * CONTACTS
    assert max(found) <= 1


def steady(problem: Problem) -> bool | None:
    """Whether both solvers find one periodic motion, with impulses within the stated errors; None if one finds none."""
    one, other = (solver.steady_state(problem) for solver in SOLVERS)
    if not one.period_multiple or one.period_multiple != other.period_multiple:
        return None
    allowed = MARGIN * (one.impulse_errors + other.impulse_errors) + 1e-9
    return bool((np.abs(one.impulses - other.impulses) <= allowed).all())


def test_a_steady_state_of_a_pair() -> None:
    assert steady(pair(1)) is not False


@pytest.mark.slow
def test_steady_states_of_many_pairs() -> None:
    found = [steady(pair(seed)) for seed in range(2, 32)]
    assert sum(one is not None for one in found) >= 10
    assert sum(one is False for one in found) <= 0.05 * len(found) + 1
