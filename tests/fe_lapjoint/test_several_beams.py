"""Several beams by the FE solver: mirror images, limits, section points, and what collisions conserve."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fe_lapjoint import Solver
from lapjoint import BaseMotion, ModalDamping, Problem, Stop, Support
from lapjoint.problem import BeamsStart, BeamStart, FloatArray, Link, NamedBeam

CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
DRIVE = {"damping": ModalDamping(ratio=0.03), "base_motion": BaseMotion(amplitude=0.01, angular_frequency=5.0)}


def beam(name: str, *supports: Support, EI: float = 1.0, m: float = 1.0, **other: float) -> NamedBeam:
    """A beam of 1 m."""
    return NamedBeam(
        name=name,
        length=1.0,
        bending_stiffness=EI,
        mass_per_length=m,
        supports=supports,
        base_share=other.get("y", 1.0),
    )


def test_mirror_images_that_meet_are_a_beam_that_meets_a_wall() -> None:
    wall = Problem(
        beam={"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},  # type: ignore[arg-type]
        supports=(CLAMP,),
        stops=(Stop(x=0.8, side="top", gap=0.004, stiffness=300.0, fixed_to="space"),),
        **DRIVE,  # type: ignore[arg-type]
    )
    both = Problem(
        beams=(beam("image", CLAMP, y=-1.0), beam("own", CLAMP)),
        stops=(Stop(between=("image:0.8", "own:0.8"), gap=0.008, stiffness=150.0),),
        **DRIVE,  # type: ignore[arg-type]
    )
    one, two = (Solver(elements=8).simulate(problem, 6.0, errors=False) for problem in (wall, both))
    assert len(one.contacts) >= 3
    for a, b in zip(one.contacts, two.contacts, strict=True):
        assert b.start == pytest.approx(a.start, abs=1e-8)
        assert b.impulse == pytest.approx(a.impulse, rel=1e-6)
    t = np.linspace(0.0, 6.0, 101)
    own, image = (two.displacement(both.position(f"{name}:0.8"), t)[0] for name in ("own", "image"))
    assert own == pytest.approx(one.displacement(0.8, t)[0], abs=1e-7)
    assert image == pytest.approx(-own, abs=1e-7)


def test_a_second_beam_that_is_very_stiff_is_a_stop_at_rest() -> None:
    alone = Problem(
        beam={"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},  # type: ignore[arg-type]
        supports=(CLAMP,),
        stops=(Stop(x=1.0, side="top", gap=0.004, stiffness=300.0),),
        **DRIVE,  # type: ignore[arg-type]
    )
    both = Problem(
        beams=(beam("anvil", CLAMP, EI=1e7), beam("own", CLAMP)),
        stops=(Stop(between=("anvil:1", "own:1"), gap=0.004, stiffness=300.0),),
        **DRIVE,  # type: ignore[arg-type]
    )
    one, two = (Solver(elements=6).simulate(problem, 3.0, errors=False).contacts for problem in (alone, both))
    assert len(one) >= 2
    for a, b in zip(one, two, strict=True):
        assert b.start == pytest.approx(a.start, abs=1e-4)  # the anvil yields by 1e-5 of the spring
        assert b.impulse == pytest.approx(a.impulse, rel=1e-3)


def test_beams_apart_are_two_problems() -> None:
    stops = [("a:1", 0.003, 200.0), ("b:0.7", 0.002, 90.0)]
    both = Problem(
        beams=(beam("a", CLAMP), beam("b", CLAMP, EI=1.7)),
        stops=tuple(Stop(x=x, side="top", gap=gap, stiffness=k) for x, gap, k in stops),
        **DRIVE,  # type: ignore[arg-type]
    )
    found = Solver(elements=6).simulate(both, 4.0, errors=False).contacts
    for k, (x, gap, stiffness) in enumerate(stops):
        alone = Problem(
            beam={"length": 1.0, "bending_stiffness": (1.0, 1.7)[k], "mass_per_length": 1.0},  # type: ignore[arg-type]
            supports=(CLAMP,),
            stops=(Stop(x=float(x.split(":")[1]), side="top", gap=gap, stiffness=stiffness),),
            damping=ModalDamping(ratio=0.0),
            base_motion=DRIVE["base_motion"],  # type: ignore[arg-type]
        )
        own = Solver(elements=6).simulate(alone.replace(damping=DRIVE["damping"]), 4.0, errors=False).contacts
        here = [c for c in found if c.stop == k]
        assert len(own) >= 2
        for a, b in zip(own, here, strict=True):
            assert b.start == pytest.approx(a.start, abs=1e-8)
            assert b.impulse == pytest.approx(a.impulse, rel=1e-6)


def on_beams(problem: Problem) -> tuple[FloatArray, FloatArray]:
    """Gauss points along all beams, m, and their weights times the mass per length, kg.

    Panels end where elements do, so that sums are exact.
    """
    nodes, weights = np.polynomial.legendre.leggauss(8)
    x, w = [], []
    for start, one in zip(problem.line.starts, problem.line.beams, strict=True):
        edges = start + np.linspace(0.0, one.length, 11)
        half = np.diff(edges)[:, None] / 2
        x.append((edges[:-1, None] + half * (1 + nodes)).ravel())
        w.append((half * weights).ravel() * one.m)
    return np.concatenate(x), np.concatenate(w)


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 30))])
def test_free_beams_that_collide_conserve_momentum_and_energy(seed: int) -> None:
    rng = np.random.default_rng(seed)
    (a, b), v = rng.integers(1, 11, 2) / 10, float(rng.uniform(0.1, 0.5))
    problem = Problem(
        beams=(beam("upper", EI=float(rng.uniform(1, 5))), beam("lower", m=float(rng.uniform(0.5, 2)))),
        stops=(Stop(between=(f"upper:{a}", f"lower:{b}"), gap=0.01, stiffness=float(10 ** rng.uniform(2, 4))),),
        initial=BeamsStart(beams=(BeamStart(beam="lower", velocity=(v, float(rng.normal() * v))),)),
    )
    motion, (x, w) = Solver(elements=10).simulate(problem, 0.5, errors=False), on_beams(problem)
    t = np.linspace(0.0, 0.5, 41)
    speed, curved = motion.velocity(x, t), motion.evaluate(x, t, 2)
    EI = problem.line.EI_at(x) * w / problem.line.inertia_at(x)
    pressed = np.maximum(motion.penetration(t)[0], 0.0)
    momentum, energy = w @ speed, (w @ speed**2 + EI @ curved**2 + problem.stops[0].stiffness * pressed**2) / 2
    assert motion.contacts
    assert momentum == pytest.approx(np.full(t.size, momentum[0]), rel=1e-9)
    assert energy == pytest.approx(np.full(t.size, energy[0]), rel=1e-9)
    upper = problem.line.own(x, 0)
    given = (w[upper] @ speed[upper])[-1]
    whole = sum(c.impulse for c in motion.contacts)
    assert given == pytest.approx(whole, rel=1e-6, abs=1e-12)


def test_a_section_point_with_rigid_links_is_adopted_by_another_mesh_and_by_other_links() -> None:
    """Both sides of a weld move alike on every mesh, also where the weld is a spring instead."""
    weld = Link(between=("a:0.7", "b:0.4"), translational=math.inf, torsional=math.inf)
    welded = Problem(beams=(beam("a", CLAMP), beam("b")), links=(weld,), **DRIVE)  # type: ignore[arg-type]
    sprung = welded.replace(links=(weld.model_copy(update={"translational": 1e3, "torsional": 10.0}),))
    coarse = Solver(elements=5).period_map(welded)
    point = coarse.march(coarse.initial(), 3).end
    x = np.array([welded.position(place) for place in ("a:0.7", "b:0.4", "b:1")])
    z = coarse.history(point, 1).displacement(x, 0.0)[:, 0]
    assert z[0] == pytest.approx(z[1], rel=1e-12)
    moved = coarse.moved(coarse.initial(), coarse.difference(point, coarse.initial()))
    for elements, problem, start in ((5, welded, moved), (7, welded, point), (5, sprung, point), (7, sprung, moved)):
        finer = Solver(elements=elements).period_map(problem)
        assert finer.history(finer.adopted(start), 1).displacement(x, 0.0)[:, 0] == pytest.approx(z, rel=1e-9)
