"""Pairs of beams with damped links, and their linear motion by splines and scipy's expm; nothing of a solver."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import scipy.linalg
from scipy.interpolate import BSpline

from lapjoint.problem import (
    BaseMotion,
    FloatArray,
    Link,
    Mass,
    ModalDamping,
    NamedBeam,
    NoDamping,
    Problem,
    Stop,
    Support,
    ViscousDamping,
)
from lapjoint.problem.beam import BeamSegment


def damped_pair(rng: np.random.Generator, *, strike: bool = True) -> Problem:
    """Two random cantilevers on a shaken base with one or two damped links, most with viscous damping of their own.

    With `strike` they may strike each other, and one of them a stop.
    """

    def number(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    clamp, beams = Support(x=0.0, translational=math.inf, torsional=math.inf), []
    for name in ("upper", "lower"):
        sizes = {"bending_stiffness": number(0.5, 3), "mass_per_length": number(0.5, 2)}
        halves = (
            BeamSegment(to=0.5, **sizes),
            BeamSegment(to=1.0, bending_stiffness=1.0, mass_per_length=number(0.5, 2)),
        )
        beams.append(
            NamedBeam(
                name=name,
                length=1.0,
                **({"segments": halves} if rng.random() < 0.3 else sizes),
                supports=(clamp,),
                masses=(Mass(x=1.0, mass=number(0.1, 1), rotary_inertia=0.02),) if rng.random() < 0.4 else (),
                viscous_damping=number(0.1, 2) if rng.random() < 0.6 else 0.0,
                base_share=float(rng.choice([1.0, -1.0, 0.5])),
            )
        )
    links = tuple(
        Link(
            between=(f"upper:{place}", f"lower:{place}"),
            translational=number(1, 20) if rng.random() < 0.7 else 0.0,
            torsional=number(0, 2),
            damping=10 ** number(-1.5, 1),
            torsional_damping=10 ** number(-2, 0) if rng.random() < 0.6 else 0.0,
        )
        for place in rng.uniform(0.3, 1.0, int(rng.integers(1, 3))).tolist()
    )
    stops = [Stop(between=(f"upper:{number(0.5, 1)}", f"lower:{number(0.5, 1)}"), gap=0.01, stiffness=number(50, 300))]
    if rng.random() < 0.5:
        damping = number(0.5, 3) if rng.random() < 0.5 else 0.0
        stops.append(Stop(x="upper:0.9", side="top", gap=0.012, stiffness=number(50, 300), damping=damping))
    kinds = ModalDamping(ratio=number(0.02, 0.08)), ViscousDamping(coefficient=number(0.1, 1)), NoDamping()
    return Problem(
        beams=tuple(beams),
        stops=tuple(stops) if strike else (),
        links=links,
        damping=kinds[int(rng.integers(3))],
        base_motion=BaseMotion(amplitude=number(0.01, 0.03), angular_frequency=number(2, 9)),
    )


class Splines:
    """The mass, damping and stiffness matrices, ``(n, n)``, of beams in splines that their clamps allow.

    Every beam has splines of degree five of its own, with a slope but no curvature in common at links and steps.
    Springs, dampers and masses read them at points, integrals are by Gauss points.  Modal damping is that of the modes
    of these matrices.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem, self.splines = problem, [_splines_of(problem, beam) for beam in problem.beams]
        n = sum(it.c.shape[1] - 2 for it in self.splines)
        self.M, self.C, self.K, self.base = np.zeros((n, n)), np.zeros((n, n)), np.zeros((n, n)), np.zeros(n)
        everywhere = problem.damping.coefficient if isinstance(problem.damping, ViscousDamping) else 0.0
        for beam in problem.beams:
            knots = np.unique(self.splines[problem.beams.index(beam)].t)
            for start, end in pairwise(knots.tolist()):
                piece = next(it for it in beam.pieces if start < it.end)
                nodes, weights = np.polynomial.legendre.leggauss(7)
                half = (end - start) / 2
                x, w = start + half * (1 + nodes), half * weights
                z, bent = self.row(beam.name, x), self.row(beam.name, x, 2)
                self.M += (piece.inertia * w * z.T) @ z
                self.C += ((everywhere + beam.viscous_damping) * w * z.T) @ z
                self.K += (piece.EI * w * bent.T) @ bent
                self.base += beam.base_share * piece.inertia * (w @ z)
            for it in beam.masses:
                for derivative, size in enumerate((it.mass, it.rotary_inertia)):
                    row = self.row(beam.name, np.array([it.x]), derivative)
                    self.M += size * row.T @ row
                self.base += beam.base_share * it.mass * self.at(f"{beam.name}:{it.x}")
            for support in beam.supports:
                assert math.isinf(support.translational)
                assert math.isinf(support.torsional)
        for link in problem.links:
            for d, (k, c) in enumerate(((link.translational, link.damping), (link.torsional, link.torsional_damping))):
                row = self.at(link.between[1], d) - self.at(link.between[0], d)
                self.K, self.C = self.K + k * np.outer(row, row), self.C + c * np.outer(row, row)
        if isinstance(problem.damping, ModalDamping):
            square, modes = scipy.linalg.eigh(self.K, self.M)
            rates = 2 * problem.damping.ratios(n) * np.sqrt(square)
            self.C += self.M @ (modes * rates) @ modes.T @ self.M

    def row(self, name: str, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Values or derivatives of all splines at positions on a beam, m, ``(k, n)``."""
        i, parts = [it.name for it in self.problem.beams].index(name), []
        for j, one in enumerate(self.splines):
            wide = one.derivative(derivative) if derivative else one
            parts.append((wide(x) if i == j else np.zeros((x.size, one.c.shape[1])))[:, 2:])
        return np.concatenate(parts, axis=1)

    def at(self, place: float | str, derivative: int = 0) -> FloatArray:
        """What a place reads of all splines, ``(n,)``."""
        name, x = str(place).split(":")
        return np.asarray(self.row(name, np.array([float(x)]), derivative)[0])

    def from_rest(self, place: str, t: float) -> float:
        """Displacement, m, of a place at a time, s, of the motion from rest under the motion of the base."""
        base, n = self.problem.base_motion, self.base.size
        assert isinstance(base, BaseMotion)
        w = base.angular_frequency
        push = np.linalg.solve(self.M, self.base * base.amplitude * w**2)
        A = np.zeros((2 * n + 2, 2 * n + 2))
        A[:n, n : 2 * n] = np.eye(n)
        A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n] = (-np.linalg.solve(self.M, it) for it in (self.K, self.C))
        A[n : 2 * n, 2 * n] = push  # the last two are sin and cos of the base's angle
        A[2 * n, 2 * n + 1], A[2 * n + 1, 2 * n] = w, -w
        start = np.zeros(2 * n + 2)
        start[2 * n :] = math.sin(base.phase), math.cos(base.phase)
        return float(self.at(place) @ (scipy.linalg.expm(A * t) @ start)[:n])

    def under_ramps(self, place: str, loaded: str, times: FloatArray, values: FloatArray) -> float:
        """Displacement, m, of a place at the last time of a record, s, of a force, N, that is linear between them."""
        n, h = self.base.size, float(times[1] - times[0])
        A = np.zeros((2 * n + 2, 2 * n + 2))
        A[:n, n : 2 * n] = np.eye(n)
        A[n : 2 * n, :n], A[n : 2 * n, n : 2 * n] = (-np.linalg.solve(self.M, it) for it in (self.K, self.C))
        A[n : 2 * n, 2 * n] = np.linalg.solve(self.M, self.at(loaded))  # of the force; the last one is its rate
        A[2 * n, 2 * n + 1] = 1.0
        step, y = scipy.linalg.expm(A * h), np.zeros(2 * n + 2)
        for one, other in pairwise(values.tolist()):
            y[2 * n :] = one, (other - one) / h
            y = step @ y
        return float(self.at(place) @ y[:n])


def _splines_of(problem: Problem, beam: NamedBeam) -> BSpline:
    """All splines of a beam; the first two are what its clamp forbids."""
    places = [str(it).split(":") for link in problem.links for it in link.between]
    kinks = {float(x) for name, x in places if name == beam.name} | {piece.end for piece in beam.pieces}
    inside = sorted(x for x in kinks if 0 < x < beam.length)
    plain = [x for a, b in pairwise([0.0, *inside, beam.length]) for x in np.linspace(a, b, 4)[1:-1].tolist()]
    knots = np.sort([*[0.0] * 6, *plain, *np.repeat(inside, 4).tolist(), *[beam.length] * 6])
    return BSpline(knots, np.eye(len(knots) - 6), 5)
