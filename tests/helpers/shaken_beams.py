"""Random systems of two and three beams on a shaken base, by a seed, the same on every machine.

Every third has three beams, the others two.  Beams are 0.7 to 1.4 m long, with EI and m of 0.3 to 3, some of two
segments, some with a mass.  They are clamped at one end, pinned at both ends, or on springs; the base drives them with
shares of -1 to 1.  Neighbours are joined by a link in some, and meet at one or two stops; some have a stop against the
base or space.  Some stops press the straight beams, some are damped.  Damping is one ratio, one per mode, or viscous,
0.01 to 0.1 at the lowest mode.  The base moves by 1e-3 at 0.5 to 2 times one of the three lowest frequencies; gaps are
0.3 to 1.5 of the amplitude that the gap sees without contact.
"""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

import analytic
from lapjoint import FREE, BaseMotion, ModalDamping, Problem, Stop, Support, ViscousDamping
from lapjoint.problem import BeamSegment, FloatArray, Gravity, Link, Mass, NamedBeam
from tests.helpers.population import BASE, between
from validation.references.panels import gauss_panels

PERIODS = 4  # of the base, that a motion from rest is marched for
_MODES = 12  # of the sum that gives the amplitude without contact
_SEEN = 0.02  # of the largest amplitude of all gaps: one that sees less gets a gap of that
_FIXED = math.inf


def shaken_beams(seed: int, index: int) -> Problem:
    """One system of a seed."""
    rng = np.random.default_rng((seed, index, 49))
    names = ("a", "b", "c")[: 3 if index % 3 == 0 else 2]
    beams = tuple(_beam(rng, name, i) for i, name in enumerate(names))
    links = tuple(link for one, other in pairwise(beams) for link in _links(rng, one, other))
    bare = Problem(beams=beams, links=links, damping=ModalDamping(ratio=0.0))
    omega = np.asarray(analytic.Solver().modes(bare, FREE, _MODES).angular_frequencies)
    problem = bare.replace(damping=_damping(rng, float(omega[0]), bare.line.m))
    if rng.random() < 0.25:
        problem = problem.replace(gravity=Gravity(acceleration=rng.normal() * BASE * float(omega[0]) ** 2))
    frequency = float(omega[int(rng.integers(0, 3))]) * between(rng, 0.5, 2.0)
    stops = [stop for one, other in pairwise(beams) for stop in _between(rng, one, other)]
    if rng.random() < 0.4:
        beam = beams[int(rng.integers(len(beams)))]
        side, fixed = rng.choice(["top", "bottom"]), "space" if rng.random() < 0.3 else "base"
        stops.append(Stop(x=_place(rng, beam), side=side, gap=1.0, stiffness=_stiffness(rng), fixed_to=fixed))
    problem = problem.replace(
        base_motion=BaseMotion(amplitude=BASE, angular_frequency=frequency),
        stops=tuple(_damped(rng, it) for it in stops),
    )
    sizes = np.abs(_seen(problem, frequency))
    sizes = np.maximum(sizes, _SEEN * sizes.max())
    gaps = [float(size * rng.uniform(0.3, 1.5)) * (-0.3 if rng.random() < 0.1 else 1) for size in sizes]
    stops = [stop.model_copy(update={"gap": gap}) for stop, gap in zip(problem.stops, gaps, strict=True)]
    return problem.replace(stops=tuple(stops), title=f"seed {seed}, index {index}: {len(beams)} beams")


def shaken_march(seed: int, index: int) -> tuple[Problem, float]:
    """The same problem, and some periods of its base, s."""
    problem = shaken_beams(seed, index)
    return problem, PERIODS * problem.require_excitation_period("test")


def decay_time(problem: Problem) -> float:
    """1 / min(zeta_i omega_i) of the free system, s; under viscous damping by its largest inertia per length."""
    omega = np.asarray(analytic.Solver().modes(problem.replace(stops=()), FREE, _MODES).angular_frequencies)
    if isinstance(problem.damping, ModalDamping):
        return float(1 / np.min(problem.damping.ratios(omega.size) * omega))
    assert isinstance(problem.damping, ViscousDamping)
    lumped = sum(mass.mass for mass in problem.structure.masses) / min(beam.length for beam in problem.line.beams)
    return 2 * (max(piece.inertia for piece in problem.line.pieces) + lumped) / problem.damping.coefficient


def _beam(rng: np.random.Generator, name: str, number: int) -> NamedBeam:
    L, kind = float(rng.uniform(0.7, 1.4)), rng.choice(["left", "right", "pinned", "springs"], p=[0.35, 0.35, 0.2, 0.1])
    pieces: dict[str, object] = {"bending_stiffness": between(rng, 0.3, 3.0), "mass_per_length": between(rng, 0.3, 3.0)}
    if rng.random() < 0.3:
        ends = float(L * rng.uniform(0.2, 0.8)), L
        pieces = {
            "segments": tuple(
                BeamSegment(to=to, bending_stiffness=between(rng, 0.3, 3.0), mass_per_length=between(rng, 0.3, 3.0))
                for to in ends
            )
        }
    supports = {
        "left": (Support(x=0.0, translational=_FIXED, torsional=_FIXED),),
        "right": (Support(x=L, translational=_FIXED, torsional=_FIXED),),
        "pinned": tuple(Support(x=x, translational=_FIXED) for x in (0.0, L)),
        "springs": tuple(Support(x=x, translational=between(rng, 1.0, 100.0)) for x in (0.0, L)),
    }[str(kind)]
    masses = ()
    if rng.random() < 0.3:
        mass = between(rng, 0.03, 1.0)
        turning = mass * between(rng, 1e-3, 0.03) if rng.random() < 0.5 else 0.0
        masses = (Mass(x=float(L * rng.uniform(0.2, 0.9)), mass=mass, rotary_inertia=turning),)
    share = 1.0 if number == 0 else float(rng.choice([1.0, 1.0, 0.5, 0.0, -1.0]))
    return NamedBeam(name=name, length=L, supports=supports, masses=masses, base_share=share, **pieces)


def _place(rng: np.random.Generator, beam: NamedBeam) -> str:
    """A place on a beam: an end that moves, or anywhere within."""
    fixed = {support.x for support in beam.supports if math.isinf(support.translational)}
    ends = [x for x in (0.0, beam.length) if x not in fixed]
    x = float(rng.choice(ends)) if ends and rng.random() < 0.4 else float(beam.length * rng.uniform(0.15, 0.85))
    return f"{beam.name}:{x!r}"


def _links(rng: np.random.Generator, one: NamedBeam, other: NamedBeam) -> tuple[Link, ...]:
    if rng.random() < 0.6:
        return ()
    translational = float(rng.choice([_FIXED, between(rng, 1.0, 100.0)], p=[0.3, 0.7]))
    torsional = float(rng.choice([0.0, _FIXED, between(rng, 0.1, 10.0)], p=[0.5, 0.2, 0.3]))
    return (Link(between=(_place(rng, one), _place(rng, other)), translational=translational, torsional=torsional),)


def _between(rng: np.random.Generator, one: NamedBeam, other: NamedBeam) -> list[Stop]:
    pairs = [(one, other), (other, one)][: 1 + int(rng.random() < 0.5)]
    return [
        Stop(between=(_place(rng, upper), _place(rng, lower)), gap=1.0, stiffness=_stiffness(rng))
        for upper, lower in pairs
    ]


def _stiffness(rng: np.random.Generator) -> float:
    return between(rng, 3.0, 1000.0)


def _damped(rng: np.random.Generator, stop: Stop) -> Stop:
    """One stop of four is damped, and one of three of these may pull."""
    c, may_pull = between(rng, 0.01, 3.0) * math.sqrt(stop.stiffness), bool(rng.random() < 0.3)
    return stop.model_copy(update={"damping": c, "may_pull": may_pull}) if rng.random() < 0.25 else stop


def _damping(rng: np.random.Generator, lowest: float, m: float) -> ModalDamping | ViscousDamping:
    ratio, kind = between(rng, 0.01, 0.1), rng.random()
    if kind < 0.2:
        return ViscousDamping(coefficient=2 * ratio * lowest * m)
    return ModalDamping(ratio=ratio if kind < 0.7 else tuple(between(rng, 0.01, 0.1) for _ in range(3)))


def _seen(problem: Problem, frequency: float) -> FloatArray:
    """Amplitude of what each gap sees without contact, under modal damping of one in thirty, m, ``(stops,)``."""
    structure = problem.structure
    modes = analytic.Solver().modes(problem.replace(stops=(), damping=ModalDamping(ratio=0.0)), FREE, _MODES)
    omega, shape = np.asarray(modes.angular_frequencies), structure.inertia
    drive = np.zeros(omega.size)
    for x, mass in shape.points:
        drive = drive + mass * np.asarray(modes.shapes(np.array([x])))[:, 0]
    for start, end, per_length in shape.pieces:
        x, w = gauss_panels(np.linspace(start, end, 20), 8)
        drive = drive + per_length * np.asarray(modes.shapes(x)) @ w
    q = BASE * frequency**2 * drive / (omega**2 - frequency**2 + 2j * omega * frequency / 30)
    every = [
        stop.base_share * BASE
        + sum(factor * (q @ np.asarray(modes.shapes(np.array([x])))[:, 0]) for x, factor in stop.reading)
        for stop in structure.stops
    ]
    return np.array(every)
