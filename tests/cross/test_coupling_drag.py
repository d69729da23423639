"""Viscous damping beside masses and steps: complex frequencies by the dynamic stiffness, and both solvers together."""

from __future__ import annotations

import math
from itertools import pairwise

import mpmath as mp
import numpy as np
import pytest
from damped_stops import model_of
from random_joints import dragged_cantilever

import analytic
import fe_lapjoint
from analytic.march.joint import Joint
from lapjoint import Problem
from lapjoint.answers.contact_state import FREE
from lapjoint.problem import FloatArray


def cantilever(coefficient: float, mass: float = 0.6, rotary: float = 0.02) -> Problem:
    """A uniform cantilever of EI = m = L = 1 with a mass at its tip."""
    return Problem.model_validate(
        {
            "beam": {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},
            "supports": [{"x": 0.0, "translational": math.inf, "torsional": math.inf}],
            "masses": [{"x": 1.0, "mass": mass, "rotary_inertia": rotary}],
            "stops": [],
            "damping": {"kind": "viscous", "coefficient": coefficient},
            "initial": {"kind": "polynomial", "displacement": [0, 0, 0.03, -0.01], "velocity": [0, 0, 0.1]},
        }
    )


def determinant(problem: Problem, s: mp.mpc) -> mp.mpc:
    """The determinant of the dynamic stiffness at the tip for motions exp(s t): EI z'''' = -(m s^2 + C s) z."""
    (mass,), C = problem.masses, mp.mpf(problem.damping.coefficient)  # type: ignore[union-attr]
    b = (-(s * s + C * s)) ** mp.mpf(0.25)
    c, sn, ch, sh = mp.cos(b), mp.sin(b), mp.cosh(b), mp.sinh(b)
    d = 1 - c * ch
    K = b**3 * (sn * ch + c * sh) / d + mp.mpf(mass.mass) * s * s
    turn = b * (sn * ch - c * sh) / d + mp.mpf(mass.rotary_inertia) * s * s
    return K * turn - (b * b * sn * sh / d) ** 2


def exact_roots(problem: Problem, near: FloatArray) -> list[complex]:
    """Roots in thirty digits, from values near them; each must stay near."""
    found = []
    with mp.workdps(30):
        for start in near:
            guess = mp.mpc(complex(start))
            starts = guess, guess * (1 + 1e-6j), guess * (1 - 1e-6)
            root = mp.findroot(lambda s: determinant(problem, s), starts, solver="muller")
            found.append(complex(root))
    return found


def roots_by_modes(problem: Problem, count: int) -> FloatArray:
    """The slowest roots of the analytic solver, 1/s, those with an imaginary part by the upper one."""
    it = Joint(problem, count, count).coupled(FREE)
    assert it is not None
    return _slowest(it.roots[it.roots.imag >= 0])


def roots_by_elements(problem: Problem, elements: int) -> FloatArray:
    """The same of the finite element solver."""
    return _slowest(model_of(problem, elements).system(FREE).free.rates)  # type: ignore[attr-defined]


def _slowest(roots: FloatArray) -> FloatArray:
    return np.asarray(roots[np.argsort(np.abs(roots))][:3])


@pytest.mark.parametrize("coefficient", [0.5, 3.0, 20.0])
def test_complex_frequencies_converge_to_those_of_the_dynamic_stiffness(coefficient: float) -> None:
    problem = cantilever(coefficient)
    exact = exact_roots(problem, roots_by_modes(problem, 40))
    for roots, counts, order in ((roots_by_modes, (5, 10, 20), 3.0), (roots_by_elements, (4, 8, 16), 3.5)):
        errors = [float(np.abs((roots(problem, n) - exact) / np.abs(exact)).max()) for n in counts]
        assert errors[-1] < 1e-4
        for coarse, fine in pairwise(errors):
            assert fine < coarse / 2**order + 1e-11


def test_a_free_decay_is_the_sum_of_the_complex_modes() -> None:
    """When the faster modes have died out, three complex modes are left: values of their sum satisfy its recurrence."""
    problem, step = cantilever(3.0), 0.05
    turns = np.exp(step * np.array(exact_roots(problem, roots_by_modes(problem, 40))))
    recurrence = np.poly(np.concatenate([turns, turns.conj()])).real
    for solver in (analytic.Solver(n_modes=20), fe_lapjoint.Solver(elements=24)):
        z = solver.simulate(problem, 16.0, errors=False).displacement(1.0, 15.0 + step * np.arange(7))[0]
        assert abs(recurrence @ z[::-1]) < 1e-6 * np.abs(recurrence).sum() * np.abs(z).max()
        assert abs(np.poly(turns).real @ z[:4]) > 1e-3 * np.abs(z).max()  # which not everything does


def test_both_solvers_agree_on_the_contacts_of_a_joint() -> None:
    problem = dragged_cantilever(np.random.default_rng(5))
    problem = problem.replace(stops=tuple(stop.model_copy(update={"damping": 0.0}) for stop in problem.stops))
    one, other = (
        solver.simulate(problem, 0.8, errors=False).contacts
        for solver in (analytic.Solver(n_modes=20), fe_lapjoint.Solver(elements=16))
    )
    assert len(one) >= 1
    for a, b in zip(one, other, strict=True):
        assert (a.stop, a.open_end) == (b.stop, b.open_end)
        assert a.start == pytest.approx(b.start, abs=1e-4)
        assert a.impulse == pytest.approx(b.impulse, rel=1e-3)  # ten times what both truncations come to
