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
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np
from scipy.linalg import lu_factor, lu_solve
from scipy.optimize import nnls

from fe_lapjoint.element_shape import ElementShape
from fe_lapjoint.resting_joint import UNDRIVEN, RestingJoint
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.equilibrium import (
    Equilibrium,
    EquilibriumErrors,
    RestingStart,
    nothing_holds,
)
from lapjoint.errors import SolverError
from lapjoint.problem import AtEquilibrium, FloatArray, Problem
from lapjoint.problem.initial import InitialShape

_ROUNDINGS = 10 * float(np.finfo(float).eps)
"""Relative error of an entry of the system, and of a residual: an entry takes some ten operations, a row has some ten
entries."""
_PARALLEL = 1e-9
"""Largest difference of 1 and the product of two unit vectors that count as one direction; length of one that counts as
0, and of the way towards a stop of a motion of unit size that goes past it."""
_TO_ENDS = np.array([[1 + math.sqrt(3), 1 - math.sqrt(3)], [1 - math.sqrt(3), 1 + math.sqrt(3)]]) / 2
"""From values of a straight line at Gauss' two points of an element to those at its ends."""
_STEPS = 20
"""Most proximal steps; after them kappa is 1e-19 EI / L^3, less than the softest support."""


def equilibrium(problem: Problem) -> Equilibrium:
    """The static equilibrium of a problem; an InputError if there is none."""
    joint = RestingJoint(problem)
    joint.check_resisted()
    found = _pressed(joint)
    (contacts, errors), (forces, moments) = found.stop_forces, (found.held(order) for order in range(2))
    kept, supports = contacts > errors, len(problem.structure.supports)
    return Equilibrium(
        problem=problem,
        solver=f"FE (static, {joint.elements.size} elements)",
        state=ContactState(tuple(np.flatnonzero(kept).tolist())),
        contact_forces=np.where(kept, contacts, 0.0),
        support_forces=forces[0][:supports],
        support_moments=moments[0][:supports],
        link_forces=forces[0][supports:],
        link_moments=moments[0][supports:],
        shape=found.shape,
        errors=EquilibriumErrors(
            *found.field_errors(),
            contact_forces=errors,
            support_forces=forces[1][:supports],
            support_moments=moments[1][:supports],
            link_forces=forces[1][supports:],
            link_moments=moments[1][supports:],
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


@dataclass(frozen=True)
class _Solution:
    """The answer of the linear system with a set of stops as springs, in units of L and EI."""

    joint: RestingJoint
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

    def held(self, derivative: int) -> tuple[FloatArray, FloatArray]:
        """The forces, N, or couples, N m, of supports and links on what they read with +1, and their errors,
        ``(parts,)`` each."""
        unit, parts = self.joint.EI / self.joint.L ** (2 - derivative), len(self.joint.parts)
        found, errors = np.zeros(parts), np.zeros(parts)
        for row, (part, order) in enumerate(self.joint.held):
            if order == derivative:
                found[part] = -self._springs(self.values)[row] * unit
                errors[part] = self._springs(self.errors)[row] * unit
        return found, errors

    @cached_property
    def shape(self) -> ElementShape:
        """The deflection, with moments from sigma, and shear forces as sums of all forces from each left end on."""
        joint = self.joint
        nodes, u, line = joint.assembly.nodes, self.u.reshape(-1, 2), joint.problem.line
        (acting, _), moment, shear = self._acting, np.zeros((2, nodes.size - 1)), np.zeros(nodes.size - 1)
        moment[:, joint.elements] = _TO_ENDS @ self._moments(self.sigma)
        for start, end in zip(line.starts, line.ends, strict=True):
            own = slice(joint.assembly.node(start), joint.assembly.node(end))
            along = np.cumsum(joint.q[own] * np.diff(nodes)[own])
            shear[own] = np.cumsum(acting[own]) + np.concatenate([[0.0], along[:-1]])
        return ElementShape(nodes, u[:, 0] * joint.L, u[:, 1].copy(), moment, shear, joint.EI_of, joint.q)

    @cached_property
    def _acting(self) -> tuple[FloatArray, FloatArray]:
        """The force at each node, N, and a bound of its error, ``(e + 1,)`` each."""
        joint = self.joint
        total, error = np.zeros(joint.assembly.nodes.size), np.zeros(joint.assembly.nodes.size)
        for load in joint.problem.forces.constant:
            for x, force in load.shape.points:
                total[joint.assembly.node(x)] += force * load.force
                error[joint.assembly.node(x)] += _ROUNDINGS * abs(force * load.force)
        (held, doubts), (pressed, others) = self.held(0), self.stop_forces
        readings = [*joint.parts, *(stop.reading for stop in joint.problem.structure.stops)]
        forces = zip(readings, [*held, *(-joint.sign * pressed)], [*doubts, *others], strict=True)
        for reading, force, doubt in forces:
            for x, factor in reading:
                total[joint.assembly.node(x)] += factor * force
                error[joint.assembly.node(x)] += doubt
        return total, error

    def _moments(self, sigma: FloatArray) -> FloatArray:
        """Moments at the two points of each element, N m, ``(2, e)``, from sigma, ``(2 e,)``."""
        joint = self.joint
        h, EI = joint.assembly.element_lengths, joint.EI_of[joint.elements]
        unit = math.sqrt(joint.EI / joint.L) * np.sqrt(EI / (h / 2))
        return sigma.reshape(-1, 2).T * unit

    def field_errors(self) -> tuple[float, float, float, float]:
        """Errors of z, m, z', M, N m, and V, N, along the beam, from those of the nodes and of the moments.

        Along an element z' errs by as much as at its start, and by the integral of the error of the curvature; z by
        that of z', integrated.
        """
        joint, shape = self.joint, self.shape
        e, h, (z, slope) = joint.elements, joint.assembly.element_lengths, self.error_of_u.reshape(-1, 2).T
        acting, doubt = self._acting
        moment = (np.abs(_TO_ENDS) @ self._moments(self.error_of_sigma)).max(axis=0)
        own = np.abs(joint.q[e]) * h**2 / 12 + np.abs(shape.moment[:, e]).max(axis=0)
        moment = moment + _ROUNDINGS * own
        of_slope = slope[e] + h * moment / joint.EI_of[e]
        of_z = z[e] * joint.L + h * of_slope
        size = np.abs(shape.z).max() + float((h * np.abs(shape.slope[e])).max())
        straight = (
            (np.abs(shape.z[e + 1]) + np.abs(shape.z[e])) / h + np.abs(shape.slope[e + 1]) + np.abs(shape.slope[e])
        )
        return (
            float(of_z.max() + _ROUNDINGS * size),
            float((of_slope + _ROUNDINGS * straight).max()),
            float(moment.max()),
            float(doubt.sum() + _ROUNDINGS * (np.abs(acting).sum() + np.abs(joint.q[e]) @ h)),
        )

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
        doubt = self._springs(self.errors)[first:] + UNDRIVEN * self.joint.size_of_f.sum()
        driven = np.abs(self._springs(self.values)[first:]) > doubt
        reached = (self.depth > self.error_of_depth)[self.others]
        return not (self.touching or reached.any() or driven.any())


class _System:
    """The linear system of a joint with some stops as springs, and perhaps with proximal springs at its ends.

    Proximal springs at the ends of all beams have the stiffness kappa, in units of L and EI.  Without them, rigid
    motions that nothing resists are left out.
    """

    def __init__(self, joint: RestingJoint, pressing: tuple[int, ...], kappa: float = 0.0) -> None:
        self.joint, self.pressing = joint, pressing
        free = joint.unresisted(pressing)[: 0 if kappa else None]
        tips = joint.tips[: None if kappa else 0]
        N = np.vstack([joint.rows, joint.stops[list(pressing)], tips, free @ joint.rigid.T])
        stiff = joint.stiffness, joint.k[list(pressing)], np.full(len(tips), kappa), np.full(len(free), math.inf)
        k = np.concatenate(stiff)
        self.k, self.scale = k, np.minimum(1.0, k)
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


def _pressed(joint: RestingJoint) -> _Solution:
    """The equilibrium, by proximal steps; see the module's head.  Stops that only touch are left out."""
    ends, kappa = np.zeros(len(joint.tips)), 1.0
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


def _step(joint: RestingJoint, kappa: float, ends: FloatArray) -> tuple[FloatArray, tuple[int, ...]]:
    """One proximal step from displacements of the ends, over L, ``(2 beams,)``: their new ones, and the pressing stops.

    The forces F >= 0 of the stops make the complementary energy least, which is half of |A F - t|^2 but for a constant:
    rows of A are the weighted curvatures under unit forces of the stops, the forces of the springs over sqrt(k), and
    1 / sqrt(k) of the stops themselves; t has those of the loads, and -sqrt(k) gap of the stops.
    """
    loose = _System(joint, (), kappa)
    gauss, (first, last) = slice(joint.B.shape[0]), (joint.B.shape[0], sum(joint.B.shape))
    pressing: tuple[int, ...] = ()
    if joint.k.size:
        gaps, stiff = loose.gaps(ends), np.where(np.isinf(loose.k), 0.0, np.sqrt(loose.k))
        soft, bent = 1 / np.sqrt(loose.k), loose.solve(joint.stops.T, np.zeros((loose.k.size, joint.k.size)))
        free, own = loose.solve(joint.f, gaps), np.sqrt(joint.k)
        A = np.vstack([bent[gauss], soft[:, None] * bent[last:], np.diag(1 / own)])
        t = np.concatenate([free[gauss], soft * free[last:] + stiff * gaps, -own * joint.gap])
        forces, _ = nnls(A / np.linalg.norm(A, axis=0), t)
        pressing = tuple(np.flatnonzero(forces).tolist())
    pressed = _System(joint, pressing, kappa)
    z = pressed.solve(joint.f, pressed.gaps(ends))[first:last]
    return joint.tips @ z, pressing


def _straightest(found: _Solution) -> _Solution:
    """The solution moved by the rigid motion, of those that nothing resists, that makes the integral of z^2 least.

    The gaps limit the motion: it is the least distance from inequalities, which C. L. Lawson and R. J. Hanson reduce to
    nonnegative least squares (Solving Least Squares Problems, chapter 23).
    """
    joint, free = found.joint, found.joint.unresisted(found.pressing)
    if not free.shape[0]:
        return found
    x, w = joint.quadrature
    motions = free @ joint.rigid.T @ joint.assembly.shapes(x, 0).T * np.sqrt(w)
    z = found.shape(x) / joint.L * np.sqrt(w)
    triangle = np.linalg.qr(motions.T)[1]
    wanted = -np.linalg.lstsq(motions.T, z, rcond=None)[0]
    others = found.others
    push = joint.ways(others, free)
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
    """The shortest y, ``(d,)``, with G y >= h, for G of shape ``(c, d)``; 0 where none exists."""
    if not np.any(h > 0):
        return np.zeros(G.shape[1])
    size = float(np.abs(h).max())
    E = np.vstack([G.T, h / size])
    target = np.zeros(E.shape[0])
    target[-1] = 1.0
    r = E @ nnls(E, target)[0] - target
    return np.asarray(-r[:-1] / r[-1] * size) if -r[-1] > _ROUNDINGS else np.zeros(G.shape[1])


def _other_equilibria(found: _Solution) -> str:
    """The sentence that rigid motions do not change the equilibrium, or nothing.

    The motions that the touching stops allow are a cone.  What is left of a motion when as much as possible of it is
    taken by pushes of the touching stops, a problem of least squares, is the motion nearest to it in the cone; these
    are all 0 if the cone is, and all multiples of one motion if the cone is a ray or a line.
    """
    joint, free = found.joint, found.joint.unresisted(found.pressing)
    touching = [j for j in found.others if found.depth[j] >= -found.error_of_depth[j]]
    push, d = joint.ways(touching, free), free.shape[0]
    nearest = [side - push.T @ nnls(push.T, side)[0] if touching else side for side in (*np.eye(d), *-np.eye(d))]
    rays = [ray / np.linalg.norm(ray) for ray in nearest if np.linalg.norm(ray) > _PARALLEL]
    if not rays:
        return ""
    ray = rays[0]
    others = any(abs(abs(float(ray @ other)) - 1) > _PARALLEL for other in rays)
    both_ways = bool(np.all(np.abs(push @ ray) <= _PARALLEL))
    return nothing_holds(joint.problem.line, joint.motion(ray @ free).tolist(), both_ways, others)
