"""Random damped joints, to look for false certificates on: by a seed, the same on every machine.

Every beam has EI = m = L = 1 and a base that moves by 1e-3, from rest; nothing else sets a scale.  Problems of even
index are cantilevers with one stop at the tip, those of odd index joints with one to four stops anywhere:

- cantilevers: excited at 1.3 to 6 times their lowest frequency, gap 0.4 to 1.6 of the tip's amplitude without contact,
  stiffness 3 to 1000, one modal ratio of 0.005 to 0.02;
- joints: one or two supports, fixed or springs; stops on either side, or as twins of equal place, gap and stiffness on
  both; excited at 0.5 to 6 times the lowest frequency, gaps 0.3 to 1.6 of the amplitude at the stop without contact,
  stiffness 3 to 1000; one modal ratio, one per mode, or viscous damping, each ratio 1e-3 to 0.1.

Frequencies, gaps, stiffnesses of stops in cantilevers' range and of springs, and ratios that span more than a decade
are drawn evenly by their logarithm, the rest evenly.  `stiffened_joint` gives them stops of up to 1e6,
`lasting_joint` viscous damping besides, `harmonic_joint` a base, and some of them a load, of several harmonics, of odd
multiples only in every third; `stepped_joint` is at rest but for a step load;
`recorded_joint` records of the base and of loads in place of the sine, `randomly_driven_joint` a random motion.
Steps, masses, static loads, preload, stops fixed in space and damped ones: `random_joints.real_joint`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

import analytic
from lapjoint import (
    FREE,
    BaseMotion,
    Beam,
    HarmonicsBaseMotion,
    HarmonicsLoad,
    ModalDamping,
    NoDamping,
    Problem,
    SineLoad,
    StepLoad,
    Stop,
    Support,
)
from lapjoint.problem import (
    BaseHarmonic,
    FloatArray,
    LoadHarmonic,
    RandomBaseMotion,
    RecordBaseMotion,
    RecordLoad,
    ViscousDamping,
)

BASE = 1e-3  # m, amplitude of the base
BEAM = Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0)
RECORDED_PERIODS = 6  # of the sine that a record takes the place of
HARMONIC_PERIODS = 4  # of the fundamental, that a motion under harmonics is marched for
_MODES = 12  # of the sum that gives the amplitude without contact: excitation is below the fourth or fifth
_POINTS = 2001  # of the quadrature over the beam
_MOVES = 0.05  # of the largest amplitude along the beam: a stop where it moves by less is placed elsewhere


@dataclass(frozen=True)
class Response:
    """The motion of a beam without contact, as a sum over its modes."""

    omega: FloatArray
    """Angular frequencies, rad/s, shape ``(modes,)``."""
    shapes: FloatArray
    """Mass-normalised shapes on a grid of `_POINTS` along the beam, shape ``(modes, points)``."""
    ratios: FloatArray
    """Damping ratios, shape ``(modes,)``."""
    participation: FloatArray
    """Integrals of the shapes over all mass, shape ``(modes,)``."""

    @property
    def decay_time(self) -> float:
        """1 / min(zeta_i omega_i), s."""
        return float(1 / np.min(self.ratios * self.omega))

    def amplitude(self, frequency: float) -> FloatArray:
        """Amplitude along the beam at an angular frequency of the base, m, shape ``(points,)``."""
        force = BASE * frequency**2 * self.participation
        q = force / (self.omega**2 - frequency**2 + 2j * self.ratios * self.omega * frequency)
        return np.abs(q @ self.shapes)


def response_of(problem: Problem) -> Response:
    """The modes of a beam of length 1 without its stops, and their damping."""
    modes = analytic.Solver().modes(problem.replace(stops=()), FREE, _MODES)
    omega, x = np.asarray(modes.angular_frequencies), np.linspace(0.0, 1.0, _POINTS)
    shapes = np.asarray(modes.shapes(x), dtype=float)
    damping = problem.damping
    if isinstance(damping, ModalDamping):
        ratios = damping.ratios(omega.size)
    else:
        assert isinstance(damping, ViscousDamping)
        ratios = damping.coefficient / (2 * omega)
    inertia = problem.structure.inertia
    participation = np.trapezoid(problem.line.inertia_at(x) * shapes, x, axis=1)
    for place, mass in inertia.points:
        participation = participation + mass * np.asarray(modes.shapes(np.array([place])), dtype=float)[:, 0]
    return Response(omega, shapes, ratios, participation)


def joints(seed: int, count: int) -> Iterator[Problem]:
    """The first `count` problems of a seed; each depends on the seed and its index alone."""
    return (joint(seed, index) for index in range(count))


def joint(seed: int, index: int) -> Problem:
    """One problem of a seed: a cantilever with a stop at its tip if the index is even, else any joint."""
    rng = np.random.default_rng((seed, index))
    problem = random_joint(rng) if index % 2 else random_cantilever(rng)
    return problem.replace(title=f"seed {seed}, index {index}: {problem.title}")


def stiffened_joint(seed: int, index: int) -> Problem:
    """The same problem with stops of any stiffness from 3 to 1e6, drawn evenly by its logarithm; twins stay twins."""
    problem, rng = joint(seed, index), np.random.default_rng((seed, index, 1))
    drawn = {place: between(rng, 3.0, 1e6) for place in dict.fromkeys((stop.x, stop.gap) for stop in problem.stops)}
    stops = (stop.model_copy(update={"stiffness": drawn[stop.x, stop.gap]}) for stop in problem.stops)
    return problem.replace(stops=tuple(stops))


def lasting_joint(seed: int, index: int) -> Problem:
    """The problem of `stiffened_joint` with viscous damping, and every second one with a step load.

    Every mode's free motion then lasts as long as the first one's, of a ratio of 1e-3 to 0.1.  The load has up to a
    fifth of the base's force, of either sign.
    """
    problem, rng = stiffened_joint(seed, index), np.random.default_rng((seed, index, 4))
    base = problem.base_motion
    assert isinstance(base, BaseMotion)
    lowest = float(analytic.Solver().modes(problem.replace(stops=()), FREE, 1).angular_frequencies[0])
    damping = ViscousDamping(coefficient=2 * lowest * between(rng, 1e-3, 0.1))
    force = BASE * base.angular_frequency**2 * rng.uniform(-0.2, 0.2)
    loads = (StepLoad(x=rng.uniform(0.2, 1.0), force=force),) * (index // 2 % 2)
    return problem.replace(title=f"{problem.title}, viscous{', step' * len(loads)}", damping=damping, point_loads=loads)


def stepped_joint(seed: int, index: int) -> Problem:
    """A cantilever or a pinned beam that a step load presses against one stop, of a stiffness from 10 to 1e6.

    The gap is up to half of 0.5 to 3 times the deflection that the same load has at the tip, or at midspan.
    """
    rng = np.random.default_rng((seed, index, 5))
    cantilever, force = bool(rng.random() < 0.5), 0.05
    low, high, deflection = (0.3, 1.0, force / 3) if cantilever else (0.2, 0.8, force / 48)
    fixed = Support(x=0.0, translational=math.inf, torsional=math.inf if cantilever else 0.0)
    stop = Stop(
        x=rng.uniform(low, high),
        side="top",
        gap=deflection * rng.uniform(0.5, 3.0) * rng.uniform(0.0, 0.5),
        stiffness=between(rng, 10.0, 1e6),
    )
    return Problem(
        title=f"seed {seed}, index {index}: {'cantilever' if cantilever else 'pinned'}, step load",
        beam=BEAM,
        supports=(fixed,) if cantilever else (fixed, Support(x=1.0, translational=math.inf, torsional=0.0)),
        stops=(stop,),
        damping=ModalDamping(ratio=between(rng, 1e-3, 0.1)),
        point_loads=(StepLoad(x=rng.uniform(low, high), force=force),),
    )


def with_harmonics(problem: Problem, rng: np.random.Generator, step: int = 1) -> Problem:
    """A problem whose base moves by up to four harmonics, `step` apart; its own sine is the first, second or third.

    The other harmonics have 0.05 to 0.5 of its acceleration.
    """
    sine = problem.base_motion
    assert isinstance(sine, BaseMotion)
    main = int(rng.choice([1, 1, 3] if step == 2 else [1, 1, 2, 3]))
    others = rng.permutation([n for n in range(1, 9, step) if n != main])[: int(rng.integers(1, 4))]
    sizes = {main: 1.0} | {int(n): between(rng, 0.05, 0.5) for n in others}
    harmonics = tuple(
        BaseHarmonic(multiple=n, amplitude=BASE * size * (main / n) ** 2, phase=rng.uniform(-3.0, 3.0))
        for n, size in sizes.items()
    )
    base = HarmonicsBaseMotion(angular_frequency=sine.angular_frequency / main, harmonics=harmonics)
    return problem.replace(title=f"{problem.title}, harmonics {sorted(sizes)}", base_motion=base)


def harmonic_joint(seed: int, index: int) -> Problem:
    """The problem of `joint` moved by harmonics, of odd multiples only in every third.

    In one problem of four a load of the same harmonics acts somewhere, too, of up to a third of the base's force.
    """
    rng = np.random.default_rng((seed, index, 2))
    problem = with_harmonics(joint(seed, index), rng, 2 if index % 3 == 0 else 1)
    base = problem.base_motion
    assert isinstance(base, HarmonicsBaseMotion)
    if rng.random() >= 0.25:
        return problem
    size, omega = rng.uniform(0.1, 0.33), base.angular_frequency
    harmonics = tuple(
        LoadHarmonic(
            multiple=it.multiple, force=size * it.amplitude * (it.multiple * omega) ** 2, phase=rng.uniform(-3.0, 3.0)
        )
        for it in base.harmonics
    )
    load = HarmonicsLoad(x=rng.uniform(0.2, 1.0), angular_frequency=omega, harmonics=harmonics)
    return problem.replace(title=f"{problem.title}, load", point_loads=(load,))


def recorded_joint(seed: int, index: int) -> tuple[Problem, float]:
    """The problem of `joint` under a record of the base, and a time of some periods of its own sine, s.

    The record is twice the sine with noise, at 0.2 to 200 knots a period, even or uneven.  One joint in four is free to
    turn or to drift; three in five are damped otherwise, up to ratios of 5, by a viscous coefficient, or not at all.
    Some have a second record as a load, a constant load, or a sine that is no multiple of the joint's frequency.
    """
    problem, rng = joint(seed, index), np.random.default_rng((seed, index, 3))
    sine = problem.base_motion
    assert isinstance(sine, BaseMotion)
    omega, damping = sine.angular_frequency, int(rng.integers(0, 5))
    if index % 4 == 1:
        problem = problem.replace(supports=() if rng.random() < 0.5 else (Support(x=0.0, translational=math.inf),))
    if damping == 0:
        ratios = tuple(between(rng, 1e-2, 5.0) for _ in range(int(rng.integers(1, 4))))
        problem = problem.replace(damping=ModalDamping(ratio=ratios))
    elif damping == 1:
        problem = problem.replace(damping=ViscousDamping(coefficient=between(rng, 0.1, 300.0)))
    elif damping == 2:
        problem = problem.replace(damping=NoDamping())
    duration = RECORDED_PERIODS * 2 * math.pi / omega
    count = max(4, int(RECORDED_PERIODS * between(rng, 0.2, 200.0)))
    spans = np.ones(count) if rng.random() < 0.5 else 10.0 ** rng.uniform(-2.0, 0.0, size=count)
    t = np.append(0.0, np.cumsum(spans)) * (duration / spans.sum())
    size = 2 * BASE * omega**2
    noise = rng.standard_normal(t.size) * float(rng.choice([0.1, 0.5, 1.0]))
    record = RecordBaseMotion(quantity="acceleration", times=t, values=size * (np.sin(omega * t) + noise))
    loads: list[SineLoad | RecordLoad | StepLoad] = []
    if rng.random() < 0.4:
        loads.append(
            SineLoad(x=rng.uniform(0.2, 1.0), force=0.3 * size, angular_frequency=omega * rng.uniform(0.3, 3.0))
        )
    if rng.random() < 0.4:
        times = np.linspace(0.0, duration, int(rng.integers(3, 200)))
        force = 0.3 * size * rng.standard_normal(times.size)
        loads.append(RecordLoad(x=rng.uniform(0.2, 1.0), times=times, values=force))
    if rng.random() < 0.3:
        loads.append(StepLoad(x=rng.uniform(0.2, 1.0), force=0.2 * size * rng.standard_normal()))
    title = f"{problem.title}, record of {t.size}, {len(loads)} loads"
    problem = problem.replace(title=title, base_motion=record, point_loads=tuple(loads))
    assert problem.forces.ramps is not None
    return problem, min(duration, float(t[-1]))


def randomly_driven_joint(seed: int, index: int) -> tuple[Problem, float]:
    """The same problem under a random acceleration of the base around the sine's frequency; and some periods, s."""
    problem, rng = joint(seed, index), np.random.default_rng((seed, index, 4))
    sine = problem.base_motion
    assert isinstance(sine, BaseMotion)
    frequency, size = sine.angular_frequency / (2 * math.pi), BASE * sine.angular_frequency**2
    low, high = frequency * rng.uniform(0.2, 0.8), frequency * rng.uniform(1.5, 4.0)
    density = size**2 / (high - low)
    base = RandomBaseMotion(psd=[[low, density], [high, density]], seed=int(rng.integers(0, 10**6)))
    return problem.replace(title=f"{problem.title}, random", base_motion=base), RECORDED_PERIODS / frequency


def driven_joint(seed: int, index: int) -> tuple[Problem, float]:
    """A joint under harmonics, a record or a random motion, which goes by the index, and a duration, s."""
    if index % 3 == 0:
        problem = harmonic_joint(seed, index)
        return problem, HARMONIC_PERIODS * problem.require_excitation_period("test")
    return (recorded_joint, randomly_driven_joint)[index % 3 - 1](seed, index)


def _as_it_is(problem: Problem) -> Problem:
    """A uniform beam that carries nothing."""
    return problem


Dress = Callable[[Problem], Problem]
"""What gives a uniform beam without loads its steps and masses."""


def random_cantilever(rng: np.random.Generator, dress: Dress = _as_it_is) -> Problem:
    """A cantilever with one stop at its tip."""
    bare = dress(
        Problem(
            title="cantilever",
            beam=BEAM,
            supports=(_FIXED,),
            damping=ModalDamping(ratio=rng.uniform(0.005, 0.02)),
            base_motion=None,
        )
    )
    response = response_of(bare)
    frequency = rng.uniform(1.3, 6.0) * float(response.omega[0])
    gap = rng.uniform(0.4, 1.6) * float(response.amplitude(frequency)[-1])
    stop = Stop(x=1.0, side="top", gap=gap, stiffness=between(rng, 3.0, 1000.0))
    return bare.replace(base_motion=_base(frequency), stops=(stop,))


def random_joint(rng: np.random.Generator, dress: Dress = _as_it_is) -> Problem:
    """A joint with one to four stops anywhere; viscous damping that would couple its modes is a modal ratio instead."""
    supports, kind = _supports(rng)
    undamped = dress(Problem(title=kind, beam=BEAM, supports=supports, damping=ModalDamping(ratio=0.0)))
    lowest = float(analytic.Solver().modes(undamped, FREE, 1).angular_frequencies[0])
    damping = _damping(rng, lowest)
    if isinstance(damping, ViscousDamping) and (undamped.masses or len(undamped.beam.pieces) > 1):
        damping = ModalDamping(ratio=damping.coefficient / (2 * lowest))
    bare = undamped.replace(damping=damping)
    response = response_of(bare)
    frequency = rng.uniform(0.5, 6.0) * float(response.omega[0])
    twins = rng.random() < 0.4
    amplitude = response.amplitude(frequency)
    stops: list[Stop] = []
    for _ in range(int(rng.integers(1, 3)) if twins else int(rng.integers(1, 5))):
        here = _place(rng, amplitude)
        gap = rng.uniform(0.3, 1.6) * float(amplitude[here])
        side = "top" if rng.random() < 0.5 else "bottom"
        one = Stop(x=here / (_POINTS - 1), side=side, gap=gap, stiffness=between(rng, 3.0, 1000.0))
        stops.append(one)
        if twins:
            stops.append(one.model_copy(update={"side": "bottom" if side == "top" else "top"}))
    title = f"{kind}, {len(stops)} stops{', twins' if twins else ''}, {bare.damping.kind}"
    return bare.replace(title=title, base_motion=_base(frequency), stops=tuple(stops))


def stiff_joint(seed: int, index: int) -> Problem:
    """A joint of `random_joint` with stops of 1 to 1e7 EI / L^3, by a seed and an index."""
    rng = np.random.default_rng((seed, index))
    problem = random_joint(rng)
    stops = tuple(s.model_copy(update={"stiffness": between(rng, 1.0, 1e7)}) for s in problem.stops)
    return problem.replace(stops=stops, title=f"seed {seed}, index {index}: {problem.title}, stiff")


_FIXED = Support(x=0.0, translational=math.inf, torsional=math.inf)


def _base(frequency: float) -> BaseMotion:
    return BaseMotion(amplitude=BASE, angular_frequency=frequency)


def between(rng: np.random.Generator, least: float, most: float) -> float:
    """A number between two others, evenly by its logarithm."""
    return float(math.exp(rng.uniform(math.log(least), math.log(most))))


def _place(rng: np.random.Generator, amplitude: FloatArray) -> int:
    """A point of the grid, where the beam moves; one in three is the tip."""
    while True:
        here = _POINTS - 1 if rng.random() < 1 / 3 else int(rng.integers(_POINTS // 20, _POINTS))
        if amplitude[here] >= _MOVES * amplitude.max():
            return here


def _supports(rng: np.random.Generator) -> tuple[tuple[Support, ...], str]:
    """One or two supports, and what to call them; none leaves the beam free to drift."""
    kind = int(rng.integers(0, 6))
    far = rng.uniform(0.4, 1.0)
    translational, torsional = between(rng, 10.0, 1e4), between(rng, 1.0, 1e3)
    springs = Support(x=0.0, translational=translational, torsional=torsional)
    pinned = Support(x=0.0, translational=math.inf)
    beyond = Support(x=far, translational=between(rng, 10.0, 1e4))
    return (
        ((_FIXED,), "fixed"),
        ((springs,), "springs"),
        ((_FIXED, beyond), "fixed and a spring"),
        ((pinned, Support(x=far, translational=math.inf)), "two pins"),
        ((springs, beyond), "springs and a spring"),
        ((_FIXED, Support(x=1.0, torsional=torsional, translational=translational)), "fixed and springs"),
    )[kind]


def _damping(rng: np.random.Generator, lowest: float) -> ModalDamping | ViscousDamping:
    """One modal ratio, two to four for the lowest modes, or a viscous coefficient that damps the lowest mode so."""
    kind = int(rng.integers(0, 3))
    ratios = tuple(between(rng, 1e-3, 0.1) for _ in range(int(rng.integers(2, 5))))
    if kind == 0:
        return ModalDamping(ratio=ratios[0])
    return ModalDamping(ratio=ratios) if kind == 1 else ViscousDamping(coefficient=2 * ratios[0] * lowest)
