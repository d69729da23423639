"""Integrals of products of modes along the beam, against mpmath on random beams with steps, masses and springs."""

from __future__ import annotations

import mpmath as mp
import numpy as np
import pytest

from analytic.modes.beam_functions import BeamFunctions
from analytic.modes.normal_modes import exact_modes
from analytic.modes.overlaps import overlaps
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.problem import FloatArray, Mass
from tests.helpers.random_joints import random_beam

MODES = 20
DIGITS = 30
POINTS = 24  # of Gauss in a panel over which the exponents of a product grow by at most `WIDE`
WIDE = 4.0


def gauss_points() -> list[tuple[mp.mpf, mp.mpf]]:
    """Points and weights on -1 to 1 in `DIGITS` digits, refined from numpy's by Newton's method."""
    found = []
    for start in np.polynomial.legendre.leggauss(POINTS)[0]:
        x = mp.mpf(float(start))
        for _ in range(3):
            before, now = mp.mpf(1), x
            for n in range(2, POINTS + 1):
                before, now = now, ((2 * n - 1) * x * now - (n - 1) * before) / n
            slope = POINTS * (x * now - before) / (x * x - 1)
            x -= now / slope
        found.append((x, 2 / ((1 - x * x) * slope**2)))
    return found


def value(f: BeamFunctions, i: int, s: int, x: mp.mpf) -> mp.mpf:
    """A function at a place of span `s`, in mpmath."""
    x0, x1 = mp.mpf(float(f.nodes[s])), mp.mpf(float(f.nodes[s + 1]))
    total = mp.mpf(0)
    for mu, c, right in zip(f.mu[i, s], f.c[i, s], f.right, strict=True):
        if c:
            total += mp.re(mp.mpmathify(complex(c)) * mp.exp(mp.mpmathify(complex(mu)) * (x - (x1 if right else x0))))
    local = (x - x0) / mp.mpf(float(f.nodes[-1]))
    for power, p in enumerate(f.p[i, s]):
        if p:
            total += mp.mpf(float(p)) * local**power
    return total


def exact(f: BeamFunctions, i: int, g: BeamFunctions, j: int, points: list[tuple[mp.mpf, mp.mpf]]) -> mp.mpf:
    """The integral of a product, in mpmath."""
    total = mp.mpf(0)
    for s in range(f.nodes.size - 1):
        x0, x1 = mp.mpf(float(f.nodes[s])), mp.mpf(float(f.nodes[s + 1]))
        fast = max(float(np.abs(it.mu[k, s]).max(initial=0.0)) for it, k in ((f, i), (g, j)))
        panels = int(mp.ceil(2 * fast * (x1 - x0) / WIDE)) or 1
        half = (x1 - x0) / panels / 2
        for panel in range(panels):
            middle = x0 + (2 * panel + 1) * half
            for x, weight in points:
                at = middle + half * x
                total += weight * half * value(f, i, s, at) * value(g, j, s, at)
    return total


def families(seed: int) -> tuple[BeamFunctions, BeamFunctions]:
    """Modes of a random beam without contact, and with its stop, which is soft, so that frequencies nearly coincide."""
    problem = random_beam(np.random.default_rng(seed))
    soft = problem.beam.EI / problem.beam.length**3 * 10 ** np.random.default_rng([seed, 1]).uniform(-9, 0)
    stop = problem.stops[0].model_copy(update={"stiffness": float(soft)})
    problem = problem.replace(stops=(stop,))
    one, other = (exact_modes(problem, state, MODES).shapes for state in (FREE, ContactState((0,))))
    nodes = np.union1d(one.nodes, other.nodes)
    return one.on(nodes), other.on(nodes)


def check(seed: int, pairs: int) -> None:
    """Compare pairs, one of which is a mode and the same mode with the stop."""
    f, g = families(seed)
    rng = np.random.default_rng([seed, 2])
    whole = ((0.0, float(f.nodes[-1]), 1.0),)
    found: FloatArray = overlaps(f, g, whole)
    size = np.sqrt(np.outer(np.diag(overlaps(f, f, whole)), np.diag(overlaps(g, g, whole))))
    with mp.workdps(DIGITS):
        points = gauss_points()
        for pair in range(pairs):
            i = int(rng.integers(8))
            j = i if pair == 0 else int(rng.integers(8))
            assert abs(float(found[i, j] - exact(f, i, g, j, points))) < 1e-11 * size[i, j]


def test_products_against_mpmath() -> None:
    check(1, 2)


@pytest.mark.slow
def test_products_of_two_hundred_beams_against_mpmath() -> None:
    for seed in range(2, 202):
        check(seed, 2)


def test_products_of_all_modes_against_gauss_points() -> None:
    for seed in range(3):
        f, g = families(seed)
        x, weights = panels_of(f)
        one, other, middle, L = f(x), g(x), float(f.nodes[f.nodes.size // 2]), float(f.nodes[-1])
        pieces = ((0.0, middle, 0.7), (middle, L, 3.0)) if seed else ((0.0, L, 1.0),)
        C = np.where(x < middle, pieces[0][2], pieces[-1][2])
        found, by_points = overlaps(f, g, pieces), (one * C * weights) @ other.T
        size = np.sqrt(np.outer((one**2) @ weights, (other**2) @ weights))
        assert np.abs((found - by_points) / size).max() < 1e-11


def panels_of(f: BeamFunctions) -> tuple[FloatArray, FloatArray]:
    """Gauss points, m, and weights in panels in which no function turns by more than `WIDE`."""
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    x, w = [], []
    for s in range(f.nodes.size - 1):
        a, b = f.nodes[s], f.nodes[s + 1]
        edges = np.linspace(a, b, int(np.ceil(np.abs(f.mu[:, s]).max() * (b - a) / WIDE)) + 1)
        half = np.diff(edges)[:, None] / 2
        x.append((edges[:-1, None] + half * (1 + nodes)).ravel())
        w.append((half * weights).ravel())
    return np.concatenate(x), np.concatenate(w)


def test_modes_with_the_mass_of_the_beam_alone_are_what_lumped_masses_leave() -> None:
    """On a uniform beam m times these integrals and the products at the masses are the unit matrix."""
    problem = random_beam(np.random.default_rng(7))
    beam = problem.beam.model_copy(update={"segments": (), "bending_stiffness": 1.0, "mass_per_length": 2.0})
    L = beam.length
    masses = (Mass(x=0.6 * L, mass=3.0 * L, rotary_inertia=0.2 * L**3), Mass(x=L, mass=0.5 * L))
    problem = problem.replace(beam=beam, masses=masses)
    shapes = exact_modes(problem, FREE, MODES).shapes
    whole = overlaps(shapes, shapes, ((0.0, L, 2.0),))
    for mass in problem.masses:
        for derivative, size in enumerate((mass.mass, mass.rotary_inertia)):
            here = shapes(np.array([mass.x]), derivative)
            whole += size * here @ here.T
    assert whole == pytest.approx(np.eye(MODES), abs=1e-10)
