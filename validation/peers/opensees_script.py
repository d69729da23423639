"""What OpenSees is told: the model, its modes, its march.  Runs in a process of its own.

A Plain pattern with element loads shakes the beam; `UniformExcitation` would count the mass of elements with `-mass`
twice.  Axial displacements are fixed.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, Problem, Support, ViscousDamping

FAR = 1e3  # Displacement at which the law of the gap springs ends, m: far beyond any motion
_Z, _ROTATION = 2, 3  # Degrees of freedom of a node in a plane: 1 along x, 2 across, 3 rotation
_SPRING_DIRECTION = {_Z: 2, _ROTATION: 6}  # Direction of a zeroLength element by degree of freedom
_NEARLY = 1e3  # Distance over the tolerance below which a motion may still be settling to lower multiples
_SPRINGS = 10_000  # First tag of springs and of their ground nodes


@dataclass(frozen=True)
class Record:
    """Displacements and slopes of all nodes at every step, and their rates."""

    nodes: FloatArray
    """Positions, m, shape ``(n,)``."""
    times: FloatArray
    """Times of the steps, s, shape (m,)."""
    values: FloatArray
    """Displacements, m, and slopes, rad, shape ``(m, n, 2)``."""
    rates: FloatArray
    """Rates of displacements and slopes, m/s and rad/s, shape (m, n, 2)."""


def mesh(problem: Problem, elements: int) -> FloatArray:
    """Nodes of about `elements` equal elements, one at every support and stop: shape (n,), in m, ascending."""
    L = problem.line.length
    fixed = sorted({0.0, L, *(s.x for s in problem.structure.supports), *(s.x for s in problem.structure.stops)})
    cuts = [np.linspace(a, b, max(1, round(elements * (b - a) / L)) + 1)[:-1] for a, b in itertools.pairwise(fixed)]
    return np.concatenate([*cuts, [L]])


def load_opensees() -> Any:
    """The module, or ImportError where it or a library of it is missing (it raises RuntimeError for some)."""
    try:
        import openseespy.opensees as ops
    except (ImportError, RuntimeError, OSError) as error:
        raise ImportError(str(error)) from error
    return ops


class Model:
    """A beam on its supports; stops are added open (gap springs) or, for modes, closed."""

    def __init__(self, problem: Problem, elements: int) -> None:
        self.ops, self.problem, self.nodes = load_opensees(), problem, mesh(problem, elements)
        self.springs = 0
        self._beam()
        for support in problem.structure.supports:
            self._support(support)

    def _beam(self) -> None:
        ops, beam = self.ops, self.problem.line
        ops.wipe()
        ops.model("basic", "-ndm", 2, "-ndf", 3)
        for i, x in enumerate(self.nodes.tolist()):
            ops.node(i, x, 0.0)
        ops.geomTransf("Linear", 1)
        for e in range(self.nodes.size - 1):
            ops.element("elasticBeamColumn", e, e, e + 1, 1.0, beam.EI, 1.0, 1, "-mass", beam.m, "-cMass")
        rigid: dict[int, set[int]] = {}
        for support in self.problem.structure.supports:
            fixed = rigid.setdefault(self.node_at(support.x), set())
            fixed |= {d for d, k in ((_Z, support.translational), (_ROTATION, support.torsional)) if math.isinf(k)}
        for i in range(self.nodes.size):
            fixed = rigid.get(i, set())
            ops.fix(i, 1, int(_Z in fixed), int(_ROTATION in fixed))

    def node_at(self, x: float) -> int:
        """Tag of the node at a support or stop at `x`, m."""
        return int(np.argmin(np.abs(self.nodes - x)))

    def _support(self, support: Support) -> None:
        for direction, k in ((_Z, support.translational), (_ROTATION, support.torsional)):
            if 0 < k < math.inf:
                self._spring(support.x, direction, "Elastic", k)

    def _spring(self, x: float, direction: int, law: str, *numbers: Any) -> None:
        ops, tag, node = self.ops, _SPRINGS + self.springs, self.node_at(x)
        self.springs += 1
        ops.uniaxialMaterial(law, tag, *numbers)
        ops.node(tag, float(self.nodes[node]), 0.0)
        ops.fix(tag, 1, 1, 1)
        ops.element("zeroLength", tag, tag, node, "-mat", tag, "-dir", _SPRING_DIRECTION[direction])

    def close(self, state: ContactState) -> None:
        """Tie the beam to the springs of the closed stops."""
        for k in state.closed:
            self._spring(self.problem.structure.stops[k].x, _Z, "Elastic", self.problem.structure.stops[k].stiffness)

    def add_stops(self) -> None:
        """Add every stop with its gap."""
        for stop in self.problem.structure.stops:
            force = stop.sign * stop.stiffness * (FAR - stop.gap)
            law = sorted([(-stop.sign * FAR, 0.0), (stop.sign * stop.gap, 0.0), (stop.sign * FAR, force)])
            strain, stress = zip(*law, strict=True)
            self._spring(stop.x, _Z, "ElasticMultiLinear", "-strain", *strain, "-stress", *stress)

    def shake(self) -> None:
        """Load the beam by the inertia of the base motion, and set the damping and the time stepping."""
        ops, problem, beam = self.ops, self.problem, self.problem.line
        if isinstance(problem.damping, ViscousDamping):
            ops.rayleigh(problem.damping.coefficient / beam.m, 0.0, 0.0, 0.0)
        for tag, force in enumerate(problem.forces.harmonic, start=1):
            ops.timeSeries("Trig", tag, 0.0, 1e9, 2 * math.pi / force.angular_frequency)
            ops.pattern("Plain", tag, tag)
            ops.eleLoad("-ele", *range(self.nodes.size - 1), "-type", "-beamUniform", beam.m * force.amplitude)
        for command, *options in _ANALYSIS:
            getattr(ops, command)(*options)

    def state(self) -> tuple[FloatArray, FloatArray]:
        """Displacement and slope of all nodes, and their rates, each ``(n, 2)``."""
        ops, tags = self.ops, range(self.nodes.size)
        values = [[ops.nodeDisp(i, _Z), ops.nodeDisp(i, _ROTATION)] for i in tags]
        return np.array(values), np.array([[ops.nodeVel(i, _Z), ops.nodeVel(i, _ROTATION)] for i in tags])

    def march(self, start: float, steps: int, dt: float) -> Record:
        """Record of `steps` steps of `dt` s from the model's present state at time `start`, s, which is recorded
        too."""
        states = [self.state()]
        for i in range(steps):
            if self.ops.analyze(1, dt) != 0:
                raise RuntimeError(f"OpenSees does not converge at t = {start + i * dt:g} s")
            states.append(self.state())
        values, rates = (np.array(part) for part in zip(*states, strict=True))
        times = start + dt * np.arange(steps + 1, dtype=float)
        return Record(self.nodes, times, values, rates)


_ANALYSIS = (  # Newmark's average acceleration; increments down to 1e-12, within 20 steps of Newton's method
    ("constraints", "Plain"),
    ("numberer", "Plain"),
    ("system", "BandGeneral"),
    ("test", "NormDispIncr", 1e-12, 20),
    ("algorithm", "Newton"),
    ("integrator", "Newmark", 0.5, 0.25),
    ("analysis", "Transient"),
)


def eigen(
    problem: Problem, elements: int, state: ContactState, count: int
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Nodes, m, shape (n,); the lowest angular frequencies of a contact state, rad/s, ascending, shape (count,);
    displacements and slopes of the nodes, of any size, shape (count, n, 2)."""
    model = Model(problem, elements)
    model.close(state)
    found = np.array(model.ops.eigen("-fullGenLapack", count))
    tags, order = range(model.nodes.size), np.argsort(found)
    vectors = [[[model.ops.nodeEigenvector(i, int(k) + 1, d) for d in (_Z, _ROTATION)] for i in tags] for k in order]
    return model.nodes, np.sqrt(np.maximum(found[order], 0.0)), np.array(vectors)


def motion(problem: Problem, elements: int, duration: float, dt: float) -> Record:
    """The motion from rest over `duration` s, in equal steps no longer than `dt` s."""
    steps = math.ceil(duration / dt * (1 - 1e-12))
    return _shaken(problem, elements).march(0.0, steps, duration / steps)


def settled(
    problem: Problem, elements: int, dt: float, repeats: float, max_period_multiple: int, max_periods: int
) -> tuple[int, float, Record]:
    """March from rest until the motion repeats, in steps no longer than `dt` s, over `max_periods` excitation periods
    at most: the period multiple (0 if it did not settle, at most `max_period_multiple`), the residual over the size of
    the motion, and the record of the last multiple, one period at least.  Distances below `repeats` of that size count
    as repetition."""
    period, model = problem.require_excitation_period("steady state"), _shaken(problem, elements)
    steps = 2 * math.ceil(period / dt / 2)  # even, so that a mirrored motion is so on the steps too
    residual, last = math.inf, list[Record]()
    for n in range(max_periods):
        last = [*last[-max_period_multiple:], model.march(n * period, steps, period / steps)]
        apart = [_distance(problem, last[-1], last[-1 - multiple]) for multiple in range(1, len(last))]
        multiple, residual = repetition(apart, repeats)
        if multiple:
            return multiple, residual, _joined(last[-multiple:])
    return 0, residual, last[-1]


def repetition(apart: list[float], repeats: float) -> tuple[int, float]:
    """Period multiple of a motion (0: none yet) and its residual, from its distances to the motion 1, 2 ... periods
    ago.  A motion that is still settling may be nearer to an earlier period than to the last: lower multiples must be
    well apart."""
    for i, distance in enumerate(apart):
        if distance <= repeats:
            return i + 1, distance
        if distance <= _NEARLY * repeats:
            break
    return 0, min(apart, default=math.inf)


def _shaken(problem: Problem, elements: int) -> Model:
    model = Model(problem, elements)
    model.add_stops()
    model.shake()
    return model


def _distance(problem: Problem, one: Record, other: Record) -> float:
    """Largest difference of two periods at their ends and in their impulses, over the size of each quantity."""
    pairs = [(one.values[:, :, 0], other.values[:, :, 0]), (one.rates[:, :, 0], other.rates[:, :, 0])]
    parts = [float(np.abs(a[-1] - b[-1]).max() / max(np.abs(a).max(), 1e-300)) for a, b in pairs]
    a, b = _impulses(problem, one), _impulses(problem, other)
    return max(*parts, float(np.abs(a - b).max(initial=0.0) / max(np.abs(a).max(initial=0.0), 1e-300)))


def _impulses(problem: Problem, record: Record) -> FloatArray:
    at = [int(np.argmin(np.abs(record.nodes - stop.x))) for stop in problem.structure.stops]
    beyond = [
        stop.stiffness * np.maximum(stop.sign * record.values[:, i, 0] - stop.gap, 0.0)
        for stop, i in zip(problem.structure.stops, at, strict=True)
    ]
    return np.array([np.trapezoid(force, record.times) for force in beyond])


def _joined(records: list[Record]) -> Record:
    def glued(parts: list[FloatArray]) -> FloatArray:
        return np.concatenate([parts[0][:1], *(part[1:] for part in parts)])

    return Record(
        records[0].nodes,
        glued([record.times for record in records]),
        glued([record.values for record in records]),
        glued([record.rates for record in records]),
    )
