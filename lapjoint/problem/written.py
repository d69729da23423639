"""A problem as its file states it, for the functions that check it and place its parts."""

from __future__ import annotations

from typing import Protocol

from lapjoint.problem.beam import Beam
from lapjoint.problem.damping import Damping
from lapjoint.problem.excitation import PointLoad
from lapjoint.problem.initial import InitialState
from lapjoint.problem.links import Link
from lapjoint.problem.masses import Mass
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.static_loads import Gravity, UniformLoad
from lapjoint.problem.supports_and_stops import Stop, Support


class Written(Protocol):
    """The parts of a `Problem`, which say what they are there."""

    @property
    def beam(self) -> Beam | None: ...

    @property
    def beams(self) -> tuple[NamedBeam, ...]: ...

    @property
    def supports(self) -> tuple[Support, ...]: ...

    @property
    def masses(self) -> tuple[Mass, ...]: ...

    @property
    def stops(self) -> tuple[Stop, ...]: ...

    @property
    def stop_names(self) -> tuple[str, ...]: ...

    @property
    def links(self) -> tuple[Link, ...]: ...

    @property
    def damping(self) -> Damping: ...

    @property
    def point_loads(self) -> tuple[PointLoad, ...]: ...

    @property
    def uniform_loads(self) -> tuple[UniformLoad, ...]: ...

    @property
    def gravity(self) -> Gravity | None: ...

    @property
    def initial(self) -> InitialState: ...
