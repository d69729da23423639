"""The problem as a whole, and what its parts must obey together: see `lapjoint.problem` for the equation."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property
from typing import Any, Literal, Self

from pydantic import model_validator

from lapjoint.errors import ExcitationWarning, InputError, RecordWarning
from lapjoint.problem.beam import Beam, uniform_slowest_bending
from lapjoint.problem.damping import Damping, NoDamping
from lapjoint.problem.excitation import AnyBaseMotion, BaseMotion, Excitation, PointLoad, StepLoad, Wave
from lapjoint.problem.forces import ConstantForce, Forces, common_fundamental, forces_of
from lapjoint.problem.hints import hints
from lapjoint.problem.initial import AtEquilibrium, AtRest, InitialShape, InitialState
from lapjoint.problem.limits import faults_of_excitation, faults_of_part, faults_of_size
from lapjoint.problem.line import Line
from lapjoint.problem.links import Link
from lapjoint.problem.masses import Mass
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.placing import (
    can_be_placed,
    line_of,
    load_faults,
    moved_supports,
    names_used_twice,
    place_faults,
    placed,
    shape_on_line,
    start_faults,
    uniform_load_shape,
)
from lapjoint.problem.random_motion import Random, RandomBaseMotion, RandomLoad
from lapjoint.problem.records import Record, RecordBaseMotion, RecordLoad
from lapjoint.problem.schema import Part
from lapjoint.problem.static_loads import Gravity, UniformLoad
from lapjoint.problem.structure import Structure
from lapjoint.problem.supports_and_stops import Stop, Support
from lapjoint.problem.uncertain import Uncertain, uncertain_faults

_ROUNDINGS = 1e-12
"""Largest relative excess of a duration over that of a record that is rounding."""
_SAMPLES_A_PERIOD = 10
"""Samples per period of the slowest bending below which straight lines between them miss accelerations by percents."""


SCHEMA_VERSION: Literal[1] = 1
"""Version of the keys of a file, raised whenever an older reader would misread a newer file, or refuse it."""


class Problem(Part):
    """A beam with supports, stops, damping, excitation and an initial state."""

    schema_version: Literal[1] = SCHEMA_VERSION
    """Version of this schema; a file may state it, and one of another version is refused."""
    title: str = ""
    """What this problem is, in a line."""
    beam: Beam | None = None
    """The beam: its length, stiffness and mass."""
    beams: tuple[NamedBeam, ...] = ()
    """Several beams instead of one, each with its supports and masses."""
    links: tuple[Link, ...] = ()
    """Springs and dampers between two beams."""
    supports: tuple[Support, ...] = ()
    """Linear springs, always acting; none: a free beam."""
    stops: tuple[Stop, ...] = ()
    """Gapped one-sided springs."""
    masses: tuple[Mass, ...] = ()
    """Masses that the beam carries at points."""
    damping: Damping = NoDamping()
    """Damping of the beam; none, if not given."""
    base_motion: AnyBaseMotion | None = None
    """Motion y(t) of the base; a base at rest, if not given."""
    point_loads: tuple[PointLoad, ...] = ()
    """Forces at points, from t = 0 on."""
    gravity: Gravity | None = None
    """Gravity along z, from t = 0 on; none, if not given."""
    uniform_loads: tuple[UniformLoad, ...] = ()
    """Constant forces along the beam, from t = 0 on."""
    initial: InitialState = AtRest()
    """Displacement and velocity at t = 0; straight and at rest, if not given."""
    uncertain: tuple[Uncertain, ...] = ()
    """Random variables of which campaigns with samples draw values; none: each number is as it stands."""

    @model_validator(mode="after")
    def _parts_fit_together(self) -> Self:
        faults = [*place_faults(self)]
        if not faults or can_be_placed(self):
            faults += [
                *names_used_twice(self),
                *faults_of_size(self, self.structure, self._excitation),
                *_base_of_stops_in_space(self),
            ]
        if not faults:
            faults = [*start_faults(self, self.line)] or [*moved_supports(self, self.line)]
        if not faults and self.uncertain:
            with warnings.catch_warnings(action="ignore", category=ExcitationWarning):
                faults = [*uncertain_faults(self, self.uncertain)]
        if faults:
            raise ValueError("\n".join(faults))
        _warn_of_excitation(self)
        return self

    @property
    def stop_names(self) -> tuple[str, ...]:
        """Names of the stops, in order; those without a name are called ``stop 1``, ``stop 2`` ..."""
        return tuple(stop.name or f"stop {i + 1}" for i, stop in enumerate(self.stops))

    @cached_property
    def structure(self) -> Structure:
        """The joint without its excitation and its start; copies `with_excitation` share it."""
        return placed(self, self.line)

    @cached_property
    def line(self) -> Line:
        """The beams on one axis; a position is a number on it, see `lapjoint.problem.line`."""
        return line_of(self)

    def position(self, place: float | str) -> float:
        """The position on the line of beams, m, of a place such as ``upper:0.3``.

        Parameters
        ----------
        place : float or str
            Position from the root, m; of several beams the name of one, and a position on it.

        Returns
        -------
        float
            The position, m, which motions and modes take as x; of one beam that from its root.

        Raises
        ------
        InputError
            If there is no such beam, or the position is outside it.
        """
        return self.line.at(place)

    def one_position(self, place: float | str | None = None) -> float:
        """The position of the one place at which a motion is looked at.

        Parameters
        ----------
        place : float or str, optional
            The place, as `position` takes it; by default the stop farthest from the root, or the tip if there are no
            stops.

        Returns
        -------
        float
            The position, m.

        Raises
        ------
        InputError
            If there is no such place.
        """
        if place is not None:
            return self.position(place)
        return max((stop.met for stop in self.structure.stops), default=self.line.length)

    @property
    def start(self) -> InitialShape:
        """The initial state, other than an equilibrium, as functions of the position."""
        assert not isinstance(self.initial, AtEquilibrium)
        return shape_on_line(self.initial, self.line)

    @cached_property
    def forces(self) -> Forces:
        """All that drives the beam, as lists of forces that solvers read."""
        fundamental = common_fundamental(_angular_frequencies(self._excitation).values())
        return forces_of(self.structure, self.base_motion, self.point_loads, self.static_loads, fundamental)

    @cached_property
    def static_loads(self) -> tuple[ConstantForce, ...]:
        """Gravity and the uniform loads."""
        found = []
        if self.gravity is not None:
            found.append(ConstantForce(self.structure.weight, self.gravity.acceleration))
        for load in self.uniform_loads:
            found.append(ConstantForce(uniform_load_shape(load, self.line), load.force_per_length))
        return tuple(force for force in found if force.force)

    @cached_property
    def moved_stops(self) -> tuple[Wave, ...]:
        """The waves of y(t), by which stops fixed in space move relative to the base; none without such stops."""
        moves = self.base_motion is not None and any(stop.in_space for stop in self.structure.stops)
        return self.base_motion.waves if moves and self.base_motion is not None else ()

    @property
    def excitation_frequency(self) -> float | None:
        """The lowest frequency that a periodic part states, rad/s, if all others are its multiples; else None."""
        return self.forces.fundamental

    def require_excitation_frequency(self, purpose: str) -> float:
        """The fundamental of all periodic excitation; an `InputError` if there is none.

        Parameters
        ----------
        purpose : str
            What needs it, as "steady state"; the message begins with it.

        Returns
        -------
        float
            omega, rad/s.

        Raises
        ------
        InputError
            If there is no periodic excitation, or no fundamental of all of it; the message says which frequencies.
        """
        if self.excitation_frequency is not None:
            return self.excitation_frequency
        if self.records:
            raise InputError(f"{purpose}: {next(iter(self.records))} is a record, which has no period; simulate it")
        if self.random:
            path = next(iter(self.random))
            raise InputError(f"{purpose}: {path} is random, and has no period; simulate it, or ask for statistics")
        found = _angular_frequencies(self._excitation)
        there = ", ".join(f"{path}.angular_frequency = {omega:.10g}" for path, omega in found.items())
        if there:
            there += ' (kind = "harmonics" may state a lower one)'
        raise InputError(
            f"{purpose}: the excitation must have one angular_frequency, or whole multiples of the lowest; "
            + (there or "there is neither a base_motion with an amplitude nor a periodic load with a force")
            + "; `lapjoint simulate`, and `simulate` in Python, follow any motion from its start"
            + ("" if there else "; `lapjoint equilibrium` says how the joint rests")
        )

    def require_excitation_period(self, purpose: str) -> float:
        """The period T = 2 pi / omega of all periodic excitation, s. See `require_excitation_frequency`."""
        return 2 * math.pi / self.require_excitation_frequency(purpose)

    @property
    def hints(self) -> tuple[str, ...]:
        """A line for each value that looks like a slip of unit; see `lapjoint.problem.hints`."""
        return hints(self, self.structure, self.forces)

    @property
    def _excitation(self) -> dict[str, AnyBaseMotion | PointLoad]:
        """The base motion and the point loads, by their paths."""
        base = {} if self.base_motion is None else {"base_motion": self.base_motion}
        return base | {f"point_loads[{i}]": load for i, load in enumerate(self.point_loads)}

    @property
    def records(self) -> dict[str, RecordBaseMotion | RecordLoad]:
        """All recorded excitation, by its path."""
        return {path: it for path, it in self._excitation.items() if isinstance(it, RecordBaseMotion | RecordLoad)}

    @property
    def random(self) -> dict[str, RandomBaseMotion | RandomLoad]:
        """All random excitation, by its path."""
        return {path: it for path, it in self._excitation.items() if isinstance(it, RandomBaseMotion | RandomLoad)}

    def reseeded(self, seed: int) -> Problem:
        """The problem with one seed, 0 or more, in all random parts, which are independent. See `with_seeds`."""
        return self.with_seeds(lambda own: seed)

    def with_seeds(self, seed_of: Callable[[int], int]) -> Problem:
        """The problem with another realisation of each random part.

        Parameters
        ----------
        seed_of : callable
            Takes the seed of a random part, and gives the one that it is to have, 0 or more.

        Returns
        -------
        Problem
            A validated copy.

        Raises
        ------
        pydantic.ValidationError
            If a seed is not possible.
        """

        def other(part: Any) -> Any:
            if not isinstance(part, Random):
                return part
            fields = {name: getattr(part, name) for name in type(part).model_fields}
            return type(part).model_validate(fields | {"seed": seed_of(part.seed)})

        with warnings.catch_warnings(action="ignore", category=ExcitationWarning):  # it was said of this problem
            return self.replace(
                base_motion=other(self.base_motion), point_loads=tuple(other(load) for load in self.point_loads)
            )

    @property
    def longest(self) -> float:
        """Longest duration that can be simulated, s: that of the shortest record, or infinite."""
        return min((record.duration for record in self.records.values()), default=math.inf)

    def check_duration(self, duration: float) -> None:
        """Refuse a duration that is no time, or ends after a record.

        Parameters
        ----------
        duration : float
            How long, s.

        Raises
        ------
        InputError
            If it is not positive and finite, or ends after a record.
        """
        if not (math.isfinite(duration) and duration > 0):
            raise InputError(f"duration = {duration!r}: must be positive and finite, in s")
        if duration > self.longest * (1 + _ROUNDINGS):
            path, record = min(self.records.items(), key=lambda item: item[1].duration)
            raise InputError(
                f"duration = {duration!r}: the record of {path} ends at {record.duration:.12g} s; allowed are times up "
                "to then"
            )

    def replace(self, **changes: Any) -> Problem:
        """A validated copy with some of the top-level parts changed.

        Parameters
        ----------
        **changes : object
            New values by the names of the parts, as ``stops=()``.

        Returns
        -------
        Problem
            The copy; this problem stays as it is.

        Raises
        ------
        InputError
            If the parts do not fit together.
        """
        return Problem(**{name: getattr(self, name) for name in Problem.model_fields} | changes)

    def with_excitation(self, **changes: Any) -> Problem:
        """A copy with another base motion, or other point loads; the other parts are not validated again.

        Parameters
        ----------
        **changes : object
            New values, as parts or as the tables of a file, by the names ``base_motion`` and ``point_loads``.

        Returns
        -------
        Problem
            The copy that `replace` gives, in less time.

        Raises
        ------
        InputError
            If a part is not valid, or does not fit this beam.
        """
        kept = {"base_motion": self.base_motion, "point_loads": self.point_loads}
        parts = Excitation(**kept | changes)
        made = self._driven_by(**{name: getattr(parts, name) for name in changes})
        off = load_faults(made, made.line), _base_of_stops_in_space(made)
        if any(map(any, off)) or any(faults_of_excitation(made._excitation)):
            return self.replace(**changes)  # it is refused there, with all that is wrong
        _warn_of_excitation(made)
        return made

    def with_base_numbers(self, **numbers: float) -> Problem:
        """A copy with other numbers of a sinusoidal base motion; nothing else is validated again.

        Parameters
        ----------
        **numbers : float
            New values by the names of the fields of `BaseMotion`, such as ``angular_frequency``.

        Returns
        -------
        Problem
            The copy that `with_excitation` gives, in less time.

        Raises
        ------
        InputError
            If the base does not move as a sine, or a number is not valid.
        """
        if not isinstance(self.base_motion, BaseMotion):
            raise InputError("base_motion: is no sine")
        base = BaseMotion(**vars(self.base_motion) | numbers)
        if any(faults_of_part("base_motion", base)):
            return self.replace(base_motion=base)  # it is refused there
        return self._driven_by(base_motion=base)

    def _driven_by(self, **parts: Any) -> Problem:
        """A copy with other parts of its excitation, which are valid."""
        _ = self.structure, self.line  # made once, for all copies
        made = self.model_copy(update=parts)
        for name in ("forces", "moved_stops"):  # what is cached belongs to this problem
            vars(made).pop(name, None)
        return made


def require_one_beam(problem: Problem, who: str) -> None:
    """Raise `InputError` for several beams; `who` says who does what for one beam alone."""
    if problem.line.several:
        raise InputError(f"beams: {who} for one [beam], and not for [[beams]]")


def resting(structure: Structure, constant: tuple[ConstantForce, ...] = ()) -> Problem:
    """A structure at rest under constant forces, for all that depends on nothing else.

    It has no parts as a file states them: who reads them there, instead of those of the structure, gets an error.
    """
    made = Problem.model_construct(damping=structure.damping)
    for name in ("beam", "beams", "supports", "masses", "stops", "links"):
        vars(made).pop(name, None)
    vars(made).update(structure=structure, line=structure.line, forces=Forces(constant, ()))
    return made


def _angular_frequencies(parts: Mapping[str, AnyBaseMotion | PointLoad]) -> dict[str, float]:
    """Angular frequencies, rad/s, of the periodic parts of an excitation that are not zero, by their paths."""
    return {
        path: part.angular_frequency
        for path, part in parts.items()
        if not isinstance(part, StepLoad | Record | Random) and any(wave.amplitude for wave in part.waves)
    }


def _base_of_stops_in_space(problem: Problem) -> Iterator[str]:
    """A line if stops fixed in space see a displacement that is integrated from a record whose drift is not removed."""
    base = problem.base_motion
    if not isinstance(base, RecordBaseMotion) or base.quantity == "displacement" or base.remove == "drift":
        return
    for i, stop in enumerate(problem.stops):
        if stop.in_space:
            yield (
                f'stops[{i}].fixed_to = "space": base_motion.remove is "{base.remove}"; a record of {base.quantity} is '
                'integrated to the displacement that this stop sees, so its drift must go: remove = "drift"'
            )
            return


def _warn_of_excitation(problem: Problem) -> None:
    """Warn of excitation that is possible, but seldom meant."""
    for line in _too_slow(problem):
        warnings.warn(line, RecordWarning, stacklevel=3)
    for line in _too_low(problem):
        warnings.warn(line, ExcitationWarning, stacklevel=3)


def _slowest_bending(problem: Problem) -> float:
    """A bound, rad/s, below all bending modes: Dunkerley's, of a cantilever as soft and heavy as any segment, with the
    masses; several beams are taken in a row, with all masses at the end."""
    line, structure = problem.line, problem.structure
    EI, m = min(piece.EI for piece in line.pieces), max(piece.inertia for piece in line.pieces)
    length = sum(beam.length for beam in line.beams)
    squares = 1 / uniform_slowest_bending(EI, m, length) ** 2
    for mass in structure.masses:
        x = length if line.several else mass.x
        squares += (mass.mass * x**3 / 3 + mass.rotary_inertia * x) / EI
    return 1 / math.sqrt(squares)


def _too_slow(problem: Problem) -> Iterator[str]:
    """Records with few samples in a period of the slowest bending, which is a cantilever's."""
    for path, record in problem.records.items():
        slowest = _slowest_bending(problem) / (2 * math.pi)
        rate = (record.time.size - 1) / record.duration
        if rate < _SAMPLES_A_PERIOD * slowest:
            yield (
                f"{path}: has {rate:.3g} samples a second, and the beam bends at {slowest:.3g} Hz or more: what lies "
                "between samples decides how its modes are driven"
            )


def _too_low(problem: Problem) -> Iterator[str]:
    """Random excitation that ends below the slowest bending."""
    for path, part in problem.random.items():
        slowest = _slowest_bending(problem) / (2 * math.pi)
        if part.density.top < slowest:
            yield (
                f"{path}: its psd ends at {part.density.top:.3g} Hz, and the beam bends at {slowest:.3g} Hz or more: "
                "it drives no mode at its own frequency"
            )
