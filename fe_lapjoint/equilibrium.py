r"""Static equilibrium by cubic beam elements: a quadratic program for the stops, and one linear system for all else.

A mesh with a node wherever anything acts gives the exact displacements and slopes of its nodes, whatever the loads are
between them, since the beam's deflection under a force at a node is a cubic in each element.  More nodes change nothing
but rounding, so the mesh has no others.  Within an element the deflection is the cubic, and q s^2 (1 - s)^2 h^4 / 24 EI
besides, which a constant load q adds at s = x / h.

With B u = sigma the curvatures at two points an element, weighted so that sigma^2 / 2 is the bending energy, N u the
displacements and slopes at the springs, lambda the forces that the springs take, and g the gaps of stops that press,

    sigma - B u = 0,    B^T sigma + N^T lambda = f,    N u - lambda / k = g.

A fixed support has 1 / k = 0, and a soft spring loses no digits, as no stiffness is added to another.  Unlike B^T B the
system squares no condition number, and an element of length h costs digits as 1 / h only.  Its answer is refined once;
the errors are the bound |A^-1| (|b - A x| + gamma (|A| |x| + |b|)) by Skeel, with gamma some roundings.

Which stops press is a quadratic program.  A proximal term, springs of stiffness kappa that hold the ends where the last
step had them, makes it strictly convex; in the forces of the stops it is a problem of least squares with forces of at
least 0, which scipy's `nnls` solves.  The stops that it finds are those of the equilibrium if the system above presses
each of them and reaches no other.  If not, the step is repeated from where it ended with a tenth of kappa, which
converges for any convex problem that has a solution.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import cholesky, lu_factor, lu_solve, solve_triangular
from scipy.optimize import nnls

from fe_lapjoint.element_shape import ElementShape
from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.equilibrium import (
    Equilibrium,
    EquilibriumErrors,
    RestingStart,
    breaks_of,
    nothing_holds,
    nothing_resists,
)
from lapjoint.errors import InputError, SolverError
from lapjoint.problem import AtEquilibrium, FloatArray, Problem
from lapjoint.problem.initial import InitialShape
from lapjoint.problem.problem import require_one_beam, resting

_ROUNDINGS = 10 * float(np.finfo(float).eps)
"""Relative error of an entry of the system, and of a residual: an entry takes some ten operations, a row has some ten
entries."""
_HELD = 1e-13
"""Springs that resist a rigid motion of unit size by less than this do not resist it."""
_PARALLEL = 1e-9
"""Largest difference of 1 and the product of two unit vectors that count as one direction."""
_UNDRIVEN = 1e-12
"""Work of the loads on a rigid motion, divided by the sum of their moduli, that is rounding."""
_STEPS = 20
"""Most proximal steps; after them kappa is 1e-19 EI / L^3, less than the softest support."""


def equilibrium(problem: Problem) -> Equilibrium:
    """The static equilibrium of a problem; an InputError if there is none."""
    require_one_beam(problem, "equilibria are computed")
    joint = _Joint(problem)
    joint.check_resisted()
    found = _pressed(joint)
    (contacts, errors), supports = found.stop_forces, [found.support_forces(order) for order in range(2)]
    kept = contacts > errors
    shape = joint.shape(found)
    return Equilibrium(
        problem=problem,
        solver=f"FE (static, {joint.assembly.nodes.size - 1} elements)",
        state=ContactState(tuple(np.flatnonzero(kept).tolist())),
        contact_forces=np.where(kept, contacts, 0.0),
        support_forces=supports[0][0],
        support_moments=supports[1][0],
        shape=shape,
        errors=EquilibriumErrors(
            *joint.field_errors(found, shape),
            contact_forces=errors,
            support_forces=supports[0][1],
            support_moments=supports[1][1],
        ),
        error_source="bound of the rounding errors of the linear system",
        other_equilibria=_other_equilibria(found),
    )


def start_of(problem: Problem) -> InitialShape | RestingStart:
    """The initial state of a problem as functions of x: as it is given, or the equilibrium of this solver."""
    return _resting(problem) if isinstance(problem.initial, AtEquilibrium) else problem.start


@lru_cache(maxsize=8)
def _resting(problem: Problem) -> RestingStart:
    """The start of a motion in equilibrium."""
    return RestingStart(equilibrium(problem))


class _Joint:
    """The beam on a mesh without supports, its loads, and its springs as rows, in units of L and EI."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.L, self.EI = problem, problem.line.length, problem.line.EI
        self.assembly = Assembly(resting(replace(problem.structure, supports=())), np.array(breaks_of(problem)))
        self.B = self.assembly.curvature * math.sqrt(self.L**3 / self.EI)
        loads = [force.force * self.assembly.load(force.shape) for force in problem.forces.constant]
        none = np.zeros(self.B.shape[1])
        self.f = sum(loads, none) * self.L**2 / self.EI
        self.size_of_f = sum((np.abs(load) for load in loads), none) * self.L**2 / self.EI
        self.sign = np.array([stop.sign for stop in problem.structure.stops], dtype=float)
        self.gap = np.array([stop.gap for stop in problem.structure.stops], dtype=float) / self.L
        self.stops = self.sign[:, None] * self.assembly.stop_rows
        self.k = np.array([stop.stiffness for stop in problem.structure.stops], dtype=float) * self.L**3 / self.EI
        held = list(self._supports())
        self.held = [place for place, _, _ in held]
        """The support and the derivative, 0 or 1, of each spring that always acts."""
        self.rows = np.array([row for _, row, _ in held]).reshape(len(held), none.size)
        self.stiffness = np.array([k for _, _, k in held], dtype=float)

    def _supports(self) -> Iterator[tuple[tuple[int, int], FloatArray, float]]:
        """Support and derivative, row and stiffness in units of the beam, of each spring of the supports."""
        for i, support in enumerate(self.problem.structure.supports):
            if support.translational:
                yield (i, 0), self.assembly.reading(support.x), support.translational * self.L**3 / self.EI
            if support.torsional:
                yield (i, 1), self.assembly.reading(support.x, 1), support.torsional * self.L / self.EI

    @cached_property
    def rigid(self) -> FloatArray:
        """Translation by L, and rotation by 1 about the root, as columns, shape ``(n, 2)``."""
        nodes = self.assembly.nodes
        return np.column_stack([np.tile([1.0, 0.0], nodes.size), np.column_stack([nodes / self.L, nodes**0]).ravel()])

    def unresisted(self, pressing: tuple[int, ...] = ()) -> FloatArray:
        """Rigid motions, as rows of translation over L and rotation, that supports and stops leave: ``(0 to 2, 2)``."""
        rows = np.vstack([self.rows, self.stops[list(pressing)]]) @ self.rigid
        _, size, directions = np.linalg.svd(np.vstack([rows, np.zeros((2, 2))]))
        return np.asarray(directions[size <= _HELD])

    def check_resisted(self) -> None:
        """Raise an InputError if the loads drive a rigid motion that supports and stops do not resist.

        The work of the loads on the rigid motions that supports leave must be that of stops which push: a problem of
        least squares, whose residual is such a motion.
        """
        free = self.unresisted()
        if not free.shape[0]:
            return
        motions = self.rigid @ free.T
        work = motions.T @ self.f
        size = float(np.abs(motions).T @ self.size_of_f @ np.ones(free.shape[0]))
        push = (self.stops @ motions).T
        left = work - push @ nnls(push, work)[0] if push.size else work
        if float(np.abs(left).max()) > _UNDRIVEN * size:
            shift, turn = left @ free
            raise InputError(nothing_resists(shift * self.L, turn, self.L))

    def shape(self, found: _Solution) -> ElementShape:
        """The deflection, with moments from sigma, and shear forces as sums of all forces from the root on."""
        nodes, u = self.assembly.nodes, found.u.reshape(-1, 2)
        moment, (acting, _) = self._to_ends @ self._moments(found.sigma), self._acting(found)
        along = np.concatenate([[0.0], np.cumsum(self._q * np.diff(nodes))[:-1]])
        shear = np.cumsum(acting)[:-1] + along
        return ElementShape(nodes, u[:, 0] * self.L, u[:, 1].copy(), moment, shear, self._EI, self._q)

    def _acting(self, found: _Solution) -> tuple[FloatArray, FloatArray]:
        """The force at each node, N, and a bound of its error, ``(e + 1,)`` each."""
        total, error = np.zeros(self.assembly.nodes.size), np.zeros(self.assembly.nodes.size)
        for load in self.problem.forces.constant:
            for x, force in load.shape.points:
                total[self.assembly.node(x)] += force * load.force
                error[self.assembly.node(x)] += _ROUNDINGS * abs(force * load.force)
        (held, doubts), (pressed, others) = found.support_forces(0), found.stop_forces
        places = [
            *(support.x for support in self.problem.structure.supports),
            *(stop.x for stop in self.problem.structure.stops),
        ]
        forces = zip(places, [*held, *(-self.sign * pressed)], [*doubts, *others], strict=True)
        for x, force, doubt in forces:
            total[self.assembly.node(x)] += force
            error[self.assembly.node(x)] += doubt
        return total, error

    def _moments(self, sigma: FloatArray) -> FloatArray:
        """Moments at the two points of each element, N m, ``(2, e)``, from sigma, ``(2 e,)``."""
        h = np.diff(self.assembly.nodes)
        unit = math.sqrt(self.EI / self.L) * np.sqrt(self._EI / (h / 2))
        return sigma.reshape(-1, 2).T * unit

    @cached_property
    def _to_ends(self) -> FloatArray:
        """From values of a straight line at Gauss' two points to those at the ends, shape ``(2, 2)``."""
        r = math.sqrt(3)
        return np.array([[1 + r, 1 - r], [1 - r, 1 + r]]) / 2

    @cached_property
    def _middle(self) -> FloatArray:
        return (self.assembly.nodes[:-1] + self.assembly.nodes[1:]) / 2

    @cached_property
    def _EI(self) -> FloatArray:
        return self.problem.line.EI_at(self._middle)

    @cached_property
    def _q(self) -> FloatArray:
        """The constant load of each element, N/m, ``(e,)``."""
        found = np.zeros(self._middle.size)
        for load in self.problem.forces.constant:
            for start, end, force in load.shape.pieces:
                found[(self._middle > start) & (self._middle < end)] += force * load.force
        return found

    def field_errors(self, found: _Solution, shape: ElementShape) -> tuple[float, float, float, float]:
        """Errors of z, m, z', M, N m, and V, N, along the beam, from those of the nodes and of the moments.

        Along an element z' errs by as much as at its start, and by the integral of the error of the curvature; z by
        that of z', integrated.
        """
        h, (z, slope) = np.diff(self.assembly.nodes), found.error_of_u.reshape(-1, 2).T
        acting, doubt = self._acting(found)
        moment = (np.abs(self._to_ends) @ self._moments(found.error_of_sigma)).max(axis=0)
        own = np.abs(self._q) * h**2 / 12 + np.abs(shape.moment).max(axis=0)
        moment = moment + _ROUNDINGS * own
        of_slope = slope[:-1] + h * moment / self._EI
        of_z = z[:-1] * self.L + h * of_slope
        size = np.abs(shape.z).max() + float((h * np.abs(shape.slope[:-1])).max())
        straight = (np.abs(shape.z[1:]) + np.abs(shape.z[:-1])) / h + np.abs(shape.slope[1:]) + np.abs(shape.slope[:-1])
        return (
            float(of_z.max() + _ROUNDINGS * size),
            float((of_slope + _ROUNDINGS * straight).max()),
            float(moment.max()),
            float(doubt.sum() + _ROUNDINGS * (np.abs(acting).sum() + np.abs(self._q) @ h)),
        )


@dataclass(frozen=True)
class _Solution:
    """The answer of the linear system with a set of stops as springs, in units of L and EI."""

    joint: _Joint
    pressing: tuple[int, ...]
    values: FloatArray
    errors: FloatArray
    """`values` holds sigma, u and lambda, ``(2 e + n + s,)``; `errors` bounds their errors."""
    depth: FloatArray
    """How far each stop is pressed beyond its gap, ``(P,)``; below 0 where it is not reached."""
    error_of_depth: FloatArray
    """The error of `depth`, ``(P,)``."""

    @property
    def sigma(self) -> FloatArray:
        """Weighted curvatures, ``(2 e,)``."""
        return self.values[: self.joint.B.shape[0]]

    @property
    def error_of_sigma(self) -> FloatArray:
        """The errors of `sigma`, ``(2 e,)``."""
        return self.errors[: self.joint.B.shape[0]]

    @property
    def u(self) -> FloatArray:
        """Displacements and slopes of the nodes, ``(n,)``."""
        return self.values[self.joint.B.shape[0] : sum(self.joint.B.shape)]

    @property
    def error_of_u(self) -> FloatArray:
        """The errors of `u`, ``(n,)``."""
        return self.errors[self.joint.B.shape[0] : sum(self.joint.B.shape)]

    def _springs(self, values: FloatArray) -> FloatArray:
        """The part of the springs, ``(s,)``, supports first."""
        return values[sum(self.joint.B.shape) :]

    @property
    def stop_forces(self) -> tuple[FloatArray, FloatArray]:
        """The force of each stop, N, and its error, ``(P,)`` each; 0 of those that do not press."""
        unit, first = self.joint.EI / self.joint.L**2, len(self.joint.held)
        found, errors = np.zeros(self.joint.k.size), np.zeros(self.joint.k.size)
        for row, j in enumerate(self.pressing, start=first):
            found[j] = self._springs(self.values)[row] * unit
            errors[j] = self._springs(self.errors)[row] * unit
        return found, errors

    def support_forces(self, derivative: int) -> tuple[FloatArray, FloatArray]:
        """The forces, N, or couples, N m, of the supports on the beam, and their errors, ``(supports,)`` each."""
        unit = self.joint.EI / self.joint.L ** (2 - derivative)
        found, errors = (
            np.zeros(len(self.joint.problem.structure.supports)),
            np.zeros(len(self.joint.problem.structure.supports)),
        )
        for row, (support, order) in enumerate(self.joint.held):
            if order == derivative:
                found[support] = -self._springs(self.values)[row] * unit
                errors[support] = self._springs(self.errors)[row] * unit
        return found, errors

    @property
    def others(self) -> list[int]:
        """The stops that do not act as springs."""
        return [j for j in range(self.joint.k.size) if j not in self.pressing]

    @property
    def touching(self) -> list[int]:
        """The stops that act as springs, and whose force is not above its error."""
        forces, errors = self.stop_forces
        return [j for j in self.pressing if forces[j] <= errors[j]]

    @property
    def holds(self) -> bool:
        """Whether the stops that act as springs press, no other is reached, and no motion left out is driven, within
        the errors."""
        first = len(self.joint.held) + len(self.pressing)
        doubt = self._springs(self.errors)[first:] + _UNDRIVEN * self.joint.size_of_f.sum()
        driven = np.abs(self._springs(self.values)[first:]) > doubt
        reached = (self.depth > self.error_of_depth)[self.others]
        return not (self.touching or reached.any() or driven.any())


class _System:
    """The linear system of a joint with some stops as springs, and perhaps with proximal springs at its ends.

    Proximal springs have the stiffness kappa, in units of the beam.  Without them, rigid motions that nothing resists
    are left out.
    """

    def __init__(self, joint: _Joint, pressing: tuple[int, ...], kappa: float = 0.0) -> None:
        self.joint, self.pressing = joint, pressing
        free = np.zeros((0, 2)) if kappa else joint.unresisted(pressing)
        tips = joint.assembly.shapes(np.array([0.0, joint.L]), 0)[: 2 if kappa else 0]
        N = np.vstack([joint.rows, joint.stops[list(pressing)], tips, free @ joint.rigid.T])
        stiff = joint.stiffness, joint.k[list(pressing)], np.full(len(tips), kappa), np.full(len(free), math.inf)
        k = np.concatenate(stiff)
        self.scale = np.minimum(1.0, k)
        (gauss, n), s = joint.B.shape, k.size
        A = np.zeros((gauss + n + s, gauss + n + s))
        A[:gauss, :gauss], A[:gauss, gauss : gauss + n] = np.eye(gauss), -joint.B
        A[gauss : gauss + n, :gauss], A[gauss : gauss + n, gauss + n :] = joint.B.T, N.T
        A[gauss + n :, gauss : gauss + n] = self.scale[:, None] * N
        A[gauss + n :, gauss + n :] = -np.diag(self.scale / k)
        self.A, self.largest = A, np.abs(A).max(axis=1)
        self.factors = lu_factor(A / self.largest[:, None])

    def solve(self, loads: FloatArray, gaps: FloatArray) -> FloatArray:
        """(sigma, u, lambda) for loads, ``(n, ...)``, and gaps of the springs that act, ``(s, ...)``."""
        x = self._once(self.right_hand(loads, gaps))
        return np.asarray(x + self._once(self.right_hand(loads, gaps) - self.A @ x))

    def right_hand(self, loads: FloatArray, gaps: FloatArray) -> FloatArray:
        """The right-hand side for loads, ``(n, ...)``, and gaps, ``(s, ...)``."""
        zero = np.zeros((self.joint.B.shape[0], *loads.shape[1:]))
        return np.concatenate([zero, loads, (self.scale * gaps.T).T])

    def _once(self, b: FloatArray) -> FloatArray:
        return np.asarray(lu_solve(self.factors, (b.T / self.largest).T))

    def gaps(self, ends: FloatArray) -> FloatArray:
        """The gaps of the springs that act: of the stops their own, of the proximal springs `ends`, over L, else 0."""
        first, last = len(self.joint.held), len(self.joint.held) + len(self.pressing)
        found = np.zeros(self.scale.size)
        found[first:last] = self.joint.gap[list(self.pressing)]
        found[last : last + ends.size] = ends
        return found

    def solution(self, ends: FloatArray) -> _Solution:
        """The answer under the loads of the joint, with bounds of its errors."""
        joint, gaps, gauss = self.joint, self.gaps(ends), self.joint.B.shape[0]
        x = self.solve(joint.f, gaps)
        doubt = _ROUNDINGS * (np.abs(self.A) @ np.abs(x) + self.right_hand(joint.size_of_f, np.abs(gaps)))
        doubt += np.abs(self.right_hand(joint.f, gaps) - self.A @ x)
        inverse = self._once(np.eye(x.size))
        u = slice(gauss, sum(joint.B.shape))
        own = _ROUNDINGS * (np.abs(joint.stops) @ np.abs(x[u]) + np.abs(joint.gap))
        error = np.abs(joint.stops @ inverse[u]) @ doubt + own
        return _Solution(joint, self.pressing, x, np.abs(inverse) @ doubt, joint.stops @ x[u] - joint.gap, error)


_NO_ENDS = np.zeros(0)


def _pressed(joint: _Joint) -> _Solution:
    """The equilibrium, by proximal steps; see the module's head.  Stops that only touch are left out."""
    ends, kappa = np.zeros(2), 1.0
    for _ in range(_STEPS):
        ends, pressing = _step(joint, kappa, ends)
        found = _straightest(_System(joint, pressing).solution(_NO_ENDS))
        while found.touching:
            pressing = tuple(j for j in found.pressing if j not in found.touching)
            found = _straightest(_System(joint, pressing).solution(_NO_ENDS))
        if found.holds:
            return found
        kappa /= 10
    raise SolverError("equilibrium: rounding hides which stops press; the stops, or the loads, are too unequal in size")


def _step(joint: _Joint, kappa: float, ends: FloatArray) -> tuple[FloatArray, tuple[int, ...]]:
    """One proximal step from displacements of the ends, over L, ``(2,)``: their new ones, and the pressing stops.

    With reach r of the unstopped beam and flexibility C of the beam and the stops, the forces F >= 0 of the stops make
    F C F / 2 - (r - gap) F least.
    """
    loose = _System(joint, (), kappa)
    u = slice(joint.B.shape[0], sum(joint.B.shape))
    reach = joint.stops @ loose.solve(joint.f, loose.gaps(ends))[u] - joint.gap
    pressing: tuple[int, ...] = ()
    if joint.k.size:
        bent = loose.solve(joint.stops.T, np.zeros((loose.scale.size, joint.k.size)))[u]
        flexibility = joint.stops @ bent + np.diag(1 / joint.k)
        scale = 1 / np.sqrt(np.diag(flexibility))
        factor = cholesky((flexibility + flexibility.T) / 2 * np.outer(scale, scale), lower=True)
        forces, _ = nnls(factor.T, solve_triangular(factor, scale * reach, lower=True))
        pressing = tuple(np.flatnonzero(forces).tolist())
    pressed = _System(joint, pressing, kappa)
    z = pressed.solve(joint.f, pressed.gaps(ends))[u]
    return joint.assembly.shapes(np.array([0.0, joint.L]), 0) @ z, pressing


def _straightest(found: _Solution) -> _Solution:
    """The solution moved by the rigid motion, of those that nothing resists, that makes the integral of z^2 least.

    The gaps limit the motion: it is the least distance from inequalities, which C. L. Lawson and R. J. Hanson reduce to
    nonnegative least squares (Solving Least Squares Problems, chapter 23).
    """
    joint, free = found.joint, found.joint.unresisted(found.pressing)
    if not free.shape[0]:
        return found
    x, w = _quadrature(joint.assembly.nodes / joint.L)
    motions = free @ np.array([np.ones_like(x), x]) * np.sqrt(w)
    z = joint.shape(found)(x * joint.L) / joint.L * np.sqrt(w)
    triangle = np.linalg.qr(motions.T)[1]
    wanted = -np.linalg.lstsq(motions.T, z, rcond=None)[0]
    others = found.others
    push = joint.stops[others] @ joint.rigid @ free.T
    beyond = found.depth[others] + push @ wanted
    amount = wanted + np.linalg.solve(triangle, _least_distance(-np.linalg.solve(triangle.T, push.T).T, beyond))
    moved, values, errors = joint.rigid @ (amount @ free), found.values.copy(), found.errors.copy()
    depth, u = found.depth.copy(), slice(joint.B.shape[0], sum(joint.B.shape))
    depth[others] += push @ amount
    doubt = found.error_of_depth + _ROUNDINGS * np.abs(joint.stops) @ np.abs(moved)
    touching = depth[others] >= -doubt[others]
    lever = np.linalg.norm(np.linalg.pinv(push[touching]), 2) if touching.any() else 0.0
    values[u] += moved
    errors[u] += (found.error_of_u.max() + doubt.max(initial=0.0)) * (1 + lever) + _ROUNDINGS * np.abs(moved)
    return replace(found, values=values, errors=errors, depth=depth, error_of_depth=doubt * (1 + lever))


def _least_distance(G: FloatArray, h: FloatArray) -> FloatArray:
    """The shortest y, ``(d,)``, with G y >= h, for G of shape ``(c, d)``; one exists."""
    if not np.any(h > 0):
        return np.zeros(G.shape[1])
    size = float(np.abs(h).max())
    E = np.vstack([G.T, h / size])
    target = np.zeros(E.shape[0])
    target[-1] = 1.0
    r = E @ nnls(E, target)[0] - target
    return np.asarray(-r[:-1] / r[-1] * size)


def _quadrature(nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Positions and weights that integrate the square of a quartic in each element, ``(5 e,)`` each."""
    x, w = np.polynomial.legendre.leggauss(5)
    half = np.diff(nodes)[:, None] / 2
    return ((nodes[:-1, None] + half) + half * x).ravel(), (half * w).ravel()


def _other_equilibria(found: _Solution) -> str:
    """The sentence that rigid motions do not change the equilibrium, or nothing.

    The motions that the touching stops allow are a cone, whose edges are at right angles to the way towards a stop.
    """
    joint, free = found.joint, found.joint.unresisted(found.pressing)
    touching = [j for j in found.others if found.depth[j] >= -found.error_of_depth[j]]
    push, d = joint.stops[touching] @ joint.rigid @ free.T, free.shape[0]
    rays = [*np.eye(d), *(np.array([-row[1], row[0]]) / np.hypot(*row) for row in push if d == 2)]
    allowed = [ray for ray in (*rays, *(-ray for ray in rays)) if np.all(push @ ray <= _HELD)]
    if not allowed:
        return ""
    shift, turn = allowed[0] @ free
    along = [float(ray @ allowed[0]) for ray in allowed]
    others = any(abs(abs(product) - 1) > _PARALLEL for product in along)
    return nothing_holds(shift * joint.L, turn, joint.L, min(along) < 0, others)
