"""Random systems of two to four beams, and their natural frequencies by counting; nothing of a solver.

Exact members between nodes have the textbook dynamic stiffness, whose entries are power series where the member is
short compared with its waves.  What infinite springs forbid is taken out by a basis of all that they allow.
Frequencies below omega are counted by Wittrick and Williams: the negative eigenvalues of the stiffness, and the clamped
frequencies of the members.  In double precision the count errs by 1e-16 (EI / m l^4) / omega^2 or so, with the length l
of the shortest member, which a link beside a step makes as short as it likes; it only brackets roots.  What is compared
with a solver comes from fifty digits.
"""

from __future__ import annotations

import math
from itertools import pairwise, product

import mpmath as mp
import numpy as np
import numpy.typing as npt

from lapjoint import ContactState, Problem, StepLoad, Stop, Support
from lapjoint.problem import BeamSegment, Link, Mass, NamedBeam
from lapjoint.problem.static_loads import Gravity, UniformLoad

Array = npt.NDArray[np.float64]
_SERIES = 1.5
"""Largest s = beta l of a member whose entries are summed as power series."""
_TERMS = 12
"""Terms of the series: the next is below 1e-25 of the sum."""


def _members(s: float) -> tuple[float, ...]:
    """1 - cos cosh, and sin cosh + cos sinh, sin sinh, sin + sinh, cosh - cos, sin cosh - cos sinh, sinh - sin, of s,
    each divided by the first power of s in it: s^4, s, s^2, s, s^2, s^3, s^3."""
    if s > _SERIES:
        c, sn, ch, sh = math.cos(s), math.sin(s), math.cosh(s), math.sinh(s)
        return (
            (1 - c * ch) / s**4, (sn * ch + c * sh) / s, sn * sh / s**2, (sn + sh) / s,
            (ch - c) / s**2, (sn * ch - c * sh) / s**3, (sh - sn) / s**3,
        )  # fmt: skip
    u, n = s**4, range(_TERMS)
    return (
        -sum((-4.0) ** (k + 1) * u**k / math.factorial(4 * k + 4) for k in n),
        sum(2 * (-4.0) ** k * u**k / math.factorial(4 * k + 1) for k in n),
        sum(2 * (-4.0) ** k * u**k / math.factorial(4 * k + 2) for k in n),
        sum(2 * u**k / math.factorial(4 * k + 1) for k in n),
        sum(2 * u**k / math.factorial(4 * k + 2) for k in n),
        sum(4 * (-4.0) ** k * u**k / math.factorial(4 * k + 3) for k in n),
        sum(2 * u**k / math.factorial(4 * k + 3) for k in n),
    )


def allowed_by(rows: Array) -> Array:
    """A basis, as columns, of the displacements that rows of 0, 1 and -1 set to zero, without rounding: each row gives
    one displacement, or the difference of two, and elimination keeps that."""
    rows, pivots = rows.copy(), []
    for r in range(rows.shape[0]):
        here = np.flatnonzero(rows[r])
        if here.size:
            rows[r] /= rows[r, here[0]]
            pivots.append((r, int(here[0])))
            for other in range(rows.shape[0]):
                if other != r:
                    rows[other] -= rows[other, here[0]] * rows[r]
    held = [column for _, column in pivots]
    free = [column for column in range(rows.shape[1]) if column not in held]
    basis = np.zeros((rows.shape[1], len(free)))
    basis[free, np.arange(len(free))] = 1.0
    for r, column in pivots:
        basis[column] = -rows[r, free]
    return basis


class ExactBeams:
    """The dynamic stiffness of a problem's beams, with their links, and the stops of a contact state as springs."""

    def __init__(self, problem: Problem, state: ContactState) -> None:
        at: dict[tuple[str, float], int] = {}
        self.members: list[tuple[int, float, float, float]] = []
        springs: list[tuple[dict[int, float], float]] = []

        def place(text: str) -> tuple[str, float]:
            name, x = text.split(":")
            return name, float(x)

        stops = [problem.stops[k] for k in state.closed]
        shared = [place(text) for it in (*problem.links, *stops) if it.between for text in it.between]
        shared += [place(stop.x) for stop in stops if isinstance(stop.x, str)]
        for beam in problem.beams:
            own = {0.0, beam.length, *(it.x for it in (*beam.supports, *beam.masses)), *(p.end for p in beam.pieces)}
            x = sorted(own | {x for name, x in shared if name == beam.name})
            at |= {(beam.name, it): len(at) + i for i, it in enumerate(x)}
            for a, b in pairwise(x):
                piece = next(p for p in beam.pieces if p.start <= a and b <= p.end)
                self.members.append((2 * at[beam.name, a], b - a, piece.EI, piece.inertia))
        self.mass = np.zeros(2 * len(at))
        for beam in problem.beams:
            for support in beam.supports:
                i = 2 * at[beam.name, support.x]
                springs += [({i: 1.0}, support.translational), ({i + 1: 1.0}, support.torsional)]
            for mass in beam.masses:
                i = 2 * at[beam.name, mass.x]
                self.mass[i : i + 2] += mass.mass, mass.rotary_inertia
        for link in problem.links:
            one, other = (2 * at[place(text)] for text in link.between)
            springs += [({one: -1.0, other: 1.0}, link.translational)]
            springs += [({one + 1: -1.0, other + 1: 1.0}, link.torsional)]
        for stop in stops:
            ends = stop.between or (stop.x,)
            springs.append(
                ({2 * at[place(text)]: sign for text, sign in zip(ends, (1.0, -1.0), strict=False)}, stop.stiffness)
            )
        rows = np.zeros((len(springs), self.mass.size))
        for r, (row, _) in enumerate(springs):
            rows[r, list(row)] = list(row.values())
        k = np.array([stiffness for _, stiffness in springs])
        finite = np.isfinite(k)
        self.springs = rows[finite].T @ (k[finite, None] * rows[finite])
        self.each = [(list(row.items()), k) for row, k in springs if 0 < k < math.inf]
        self.allowed = allowed_by(rows[~finite])

    def count(self, omega: float) -> int:
        """Number of frequencies below `omega`, rad/s."""
        K, found = self.springs - np.diag(omega**2 * self.mass), 0
        for i, length, EI, m in self.members:
            beta = math.sqrt(omega) * (m / EI) ** 0.25
            s = beta * length
            d, a, b, e, f, g, h = _members(s)
            own = np.array(
                [[a, b * length, -e, f * length], [0, g * length**2, -f * length, h * length**2],
                 [0, 0, a, -b * length], [0, 0, 0, g * length**2]]
            )  # fmt: skip
            K[i : i + 4, i : i + 4] += EI / length**3 / d * (own + np.triu(own, 1).T)
            number = int(s / math.pi)
            found += 0 if number == 0 else number - 1 + int((d > 0) == (number % 2 == 0))
        reduced = self.allowed.T @ K @ self.allowed
        scale = 1 / np.sqrt(np.abs(np.diag(reduced)))
        return found + int(np.count_nonzero(np.linalg.eigvalsh(reduced * np.outer(scale, scale)) < 0))

    def exact_count(self, omega: float | mp.mpf) -> int:
        """The `count` in fifty digits."""
        return self._counted(omega)[0]

    def _counted(self, omega: float | mp.mpf) -> tuple[int, mp.mpf]:
        """The `count` in fifty digits, and a determinant, without poles, whose roots are the frequencies."""
        with mp.workdps(50):
            w, found, size = mp.mpf(omega), 0, mp.mpf(1)
            ways = [[(p, int(row[p])) for p in np.flatnonzero(row).tolist()] for row in self.allowed]
            R: list[dict[int, mp.mpf]] = [{} for _ in range(self.allowed.shape[1])]

            def add(i: int, j: int, value: mp.mpf) -> None:
                for (p, one), (q, other) in product(ways[i], ways[j]):
                    R[p][q] = R[p].get(q, mp.mpf(0)) + one * other * value

            for i, mass in enumerate(self.mass.tolist()):
                add(i, i, -(w**2) * mass)
            for ends, k in self.each:  # a soft spring beside a stiff one keeps its digits
                for (i, one), (j, other) in product(ends, repeat=2):
                    add(i, j, mp.mpf(k) * one * other)
            for i, *numbers in self.members:
                length, EI, m = map(mp.mpf, numbers)
                beta = mp.sqrt(w) * mp.root(m / EI, 4)
                s = beta * length
                c, sn, ch, sh = mp.cos(s), mp.sin(s), mp.cosh(s), mp.sinh(s)
                d, sums, ends = 1 - c * ch, sn * ch + c * sh, beta * (sn + sh)
                less, far, near = (sn * ch - c * sh) / beta, (sh - sn) / beta, sn * sh
                own = (
                    (beta * sums, near, -ends, ch - c), (near, less, c - ch, far),
                    (-ends, c - ch, beta * sums, -near), (ch - c, far, -near, less),
                )  # fmt: skip
                for a, b in product(range(4), repeat=2):
                    add(i + a, i + b, EI * beta**2 / d * own[a][b])
                number = int(mp.floor(s / mp.pi))
                found += 0 if number == 0 else number - 1 + int((d > 0) == (number % 2 == 0))
                size *= d
            for i, row in enumerate(R):  # elimination without pivoting: fifty digits are enough
                found += int(row[i] < 0)
                size *= row[i]
                for p in [p for p in row if p > i]:
                    factor = row[p] / row[i]
                    for q in [q for q in row if q > i]:
                        R[p][q] = R[p].get(q, mp.mpf(0)) - factor * row[q]
            return found, size

    def frequencies(self, count: int, zero: int) -> list[float]:
        """The lowest `count` angular frequencies, rad/s, of which the first `zero` are those of rigid-body modes, to
        1e-12."""
        _, length, EI, m = max(self.members, key=lambda it: it[1])
        high = math.sqrt(EI / m) / length**2
        while self.count(high) < count:
            high *= 2
        return [0.0] * zero + [self._root(number, high) for number in range(zero + 1, count + 1)]

    def _root(self, number: int, high: float) -> float:
        """The frequency with a number, from 1: bracketed by counts, then by the sign of the determinant."""
        low = high / 2
        while self.count(low) >= number:
            low, high = low / 2, low
        while high - low > 1e-4 * high:
            middle = (low + high) / 2
            low, high = (low, middle) if self.count(middle) >= number else (middle, high)
        low, high, width = mp.mpf(low), mp.mpf(high), mp.mpf(high - low)
        while (below := self._counted(low))[0] >= number:
            low, width = low - width, 2 * width
        while (above := self._counted(high))[0] < number:
            high, width = high + width, 2 * width
        while high - low > 1e-12 * high:
            middle = (low + high) / 2
            if (below[0], above[0]) == (number - 1, number):  # alone: a secant, and beside it the other side
                secant = low - below[1] * (high - low) / (above[1] - below[1])
                width = max(high * mp.mpf(2e-13), (high - low) / 100)
                middle = secant + width if secant - low < high - secant else secant - width
            now = self._counted(middle)
            low, below, high, above = (low, below, middle, now) if now[0] >= number else (middle, now, high, above)
        return float((low + high) / 2)


def random_beams(rng: np.random.Generator, *, ratio: float = 30.0, soft: float = -3.0) -> Problem:
    """Two to four beams with steps, masses, supports, links of any kind, and stops between each other and the base.

    Stiffness and mass per length differ from beam to beam by up to `ratio`; springs begin at 10^`soft` EI / L^3.
    """
    names = "abcd"[: int(rng.integers(2, 5))]
    beams = [_beam(rng, name, ratio, soft) for name in names]

    def place(beam: NamedBeam) -> str:
        x = rng.choice([0.0, beam.length, beam.length * rng.uniform(0.1, 0.9)])
        return f"{beam.name}:{float(x)!r}"

    def pair() -> list[NamedBeam]:
        return [beams[i] for i in rng.choice(len(beams), 2, replace=False)]

    def stiffness(one: NamedBeam, other: NamedBeam, power: int) -> float:
        unit = min(beam.EI / beam.length**power for beam in (one, other))
        return float(rng.choice([0.0, math.inf, unit * 10 ** rng.uniform(soft, 5)], p=[0.25, 0.25, 0.5]))

    links, stops = [], []
    for _ in range(int(rng.integers(0, 2 * len(beams)))):
        one, other = pair()
        between = place(one), place(other)
        links.append(Link(between=between, translational=stiffness(one, other, 3), torsional=stiffness(one, other, 1)))
    for i in range(int(rng.integers(0, 4))):
        one, other = pair()
        k, gap = float(one.EI / one.length**3 * 10 ** rng.uniform(-1, 4)), float(10 ** rng.uniform(-4, -2))
        if rng.random() < 0.7:
            stops.append(Stop(name=f"s{i}", between=(place(one), place(other)), gap=gap, stiffness=k))
        else:
            stops.append(Stop(name=f"s{i}", x=place(one), side="top", gap=gap, stiffness=k))
    return Problem(beams=tuple(beams), links=tuple(links), stops=tuple(stops))


def _beam(rng: np.random.Generator, name: str, ratio: float, soft: float) -> NamedBeam:
    L = float(rng.uniform(0.4, 2.0))
    step = float(L * rng.uniform(0.2, 0.8))
    sizes = 10 ** rng.uniform(0, math.log10(ratio), (2, 2))
    pieces: dict[str, object] = {"bending_stiffness": float(sizes[0, 0]), "mass_per_length": float(sizes[0, 1])}
    if rng.random() < 0.4:
        pieces = {
            "segments": tuple(
                BeamSegment(to=to, bending_stiffness=float(EI), mass_per_length=float(m))
                for to, (EI, m) in zip((step, L), sizes, strict=True)
            )
        }
    kind, EI = int(rng.integers(0, 5)), sizes[0, 0]
    supports: tuple[Support, ...] = ()
    if kind == 0:
        supports = (Support(x=0.0, translational=math.inf, torsional=math.inf),)
    elif kind == 1:
        supports = (Support(x=0.0, translational=math.inf), Support(x=L, translational=math.inf))
    elif kind == 2:
        supports = (Support(x=L, translational=float(EI / L**3 * 10 ** rng.uniform(soft, 4))),)
    elif kind == 3:
        supports = tuple(
            Support(x=x, translational=float(EI / L**3 * 10 ** rng.uniform(soft, 4)), torsional=float(EI / L * t))
            for x, t in ((0.0, 0.0), (step, 0.3))
        )
    masses = tuple(
        Mass(
            x=float(rng.choice([0.0, L, step])),
            mass=float(rng.uniform(0, 3)),
            rotary_inertia=float(rng.choice([0, 0.1])),
        )
        for _ in range(int(rng.integers(0, 3)))
    )
    return NamedBeam(name=name, length=L, supports=supports, masses=masses, **pieces)


def random_state(rng: np.random.Generator, problem: Problem) -> ContactState:
    """A contact state: each stop closed with even chance."""
    return ContactState(tuple(k for k in range(len(problem.stops)) if rng.random() < 0.5))


def equal_beams(rng: np.random.Generator) -> Problem:
    """Two to four beams that are equal, with links from 1e-6 to 1e12 EI / L^3, or infinite, between equal places: with
    near-degenerate and with coinciding frequencies."""
    first = _beam(rng, "a", 1.0001, -3.0)
    beams = tuple(
        NamedBeam.model_validate({**first.model_dump(), "name": name}) for name in "abcd"[: rng.integers(2, 5)]
    )
    L, links = first.length, []
    for _ in range(int(rng.integers(1, 5))):
        one, other = (beams[i].name for i in rng.choice(len(beams), 2, replace=False))
        x = float(rng.choice([0.0, L, L / 2, L * rng.uniform(0.1, 0.9)]))
        k = float(rng.choice([math.inf, 10 ** rng.uniform(-6, 12), 1e-6]))
        kt = float(rng.choice([0.0, 1e-6, k]))
        links.append(Link(between=(f"{one}:{x!r}", f"{other}:{x!r}"), translational=k, torsional=kt))
    return Problem(beams=beams, links=tuple(links))


def stiffer_links(rng: np.random.Generator, problem: Problem) -> Problem:
    """The links of a problem softer or stiffer by up to 1e7, half of them."""
    links = [
        link.model_copy(update={"translational": link.translational * 10 ** rng.uniform(-3, 7)})
        if rng.random() < 0.5
        else link
        for link in problem.links
    ]
    return problem.replace(links=tuple(links))


def resting_beams(rng: np.random.Generator) -> Problem:
    """A system of `random_beams` under static loads, with one to five stops, of which one in three presses straight
    beams; springs, links and stops may leave it loose."""
    bare = random_beams(rng)
    beams = [
        beam.model_copy(update={"gravity_share": float(rng.choice([1.0, -1.0, 0.5, 0.0])), "base_share": 1.0})
        for beam in bare.beams
    ]
    load = 10 ** rng.uniform(-1, 2)

    def place(beam: NamedBeam) -> float:
        return float(rng.choice([0.0, beam.length, beam.length * rng.uniform(0.1, 0.9)]))

    stops: list[Stop] = []
    for i in range(int(rng.integers(1, 6))):
        one, other = (beams[k] for k in rng.choice(len(beams), 2, replace=False))
        unit = one.EI / one.length**3
        gap = load / unit * 10 ** rng.uniform(-3, 0) * (-1 if rng.random() < 0.35 else 1)
        numbers = {"name": f"s{i}", "gap": float(gap), "stiffness": float(unit * 10 ** rng.uniform(-1, 9))}
        where = f"{one.name}:{place(one)!r}"
        if stops and rng.random() < 0.2:  # at a place that there is
            stops.append(stops[-1].model_copy(update=numbers))
        elif rng.random() < 0.6:
            stops.append(Stop(between=(where, f"{other.name}:{place(other)!r}"), **numbers))
        else:
            stops.append(Stop(x=where, side=("top", "bottom")[int(rng.integers(2))], **numbers))
    uniform, steps = [], []
    for beam in beams:
        if rng.random() < 0.5:
            a, b = sorted((place(beam), place(beam)))
            if b > a:
                force = float(load / beam.length * rng.normal())
                uniform.append(UniformLoad(beam=beam.name, start=a, to=b, force_per_length=force))
        if rng.random() < 0.4:
            steps.append(StepLoad(x=f"{beam.name}:{place(beam)!r}", force=float(load * rng.normal())))
    heaviest = max(beam.m * beam.length for beam in beams)
    gravity = Gravity(acceleration=float(rng.normal() * load / heaviest)) if rng.random() < 0.7 else None
    return bare.replace(
        beams=tuple(beams),
        stops=tuple(stops),
        gravity=gravity,
        uniform_loads=tuple(uniform),
        point_loads=tuple(steps),
    )
