"""What is solved: an immutable, validated description of a beam, its supports, its stops and its excitation.

The beam lies along x, from the root (x = 0) to the tip (x = L).  z(x, t) is the displacement relative to the
moving base, positive upwards; y(t) is the base: a sine, a sum of harmonics, a record, or random.  With
E I = EI and rho A = m::

    (EI z'')'' + damping + m z_tt = -m y_tt + supports + stops + masses + gravity + loads

A closed stop pushes with ``-k (|z| - gap) sign(z)``.  SI units throughout, angles in radians, angular
frequencies in rad/s.  Nothing numerical (modes, elements, tolerances) belongs here.
"""

from lapjoint.problem.beam import Beam, BeamPiece, BeamSegment, Circle, Material, Rectangle, Section, Tube
from lapjoint.problem.damping import Damping, ModalDamping, NoDamping, ViscousDamping
from lapjoint.problem.excitation import (
    AnyBaseMotion,
    BaseHarmonic,
    BaseMotion,
    HarmonicsBaseMotion,
    HarmonicsLoad,
    LoadHarmonic,
    PointLoad,
    SineLoad,
    StepLoad,
)
from lapjoint.problem.fatigue import SNLine
from lapjoint.problem.files import read_problem, write_problem
from lapjoint.problem.initial import (
    AtEquilibrium,
    AtRest,
    BeamsStart,
    BeamStart,
    InitialState,
    PolynomialShape,
    SampledShape,
    ShapeFunction,
    initial_from_functions,
)
from lapjoint.problem.line import Line
from lapjoint.problem.links import Link
from lapjoint.problem.masses import Mass
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.presets import paper_joint, sdnl104
from lapjoint.problem.problem import Problem
from lapjoint.problem.random_motion import RandomBaseMotion, RandomLoad
from lapjoint.problem.records import RecordBaseMotion, RecordLoad
from lapjoint.problem.schema import Finite, FloatArray, NonNegative, Part, Positive, SpringStiffness
from lapjoint.problem.static_loads import Gravity, UniformLoad
from lapjoint.problem.supports_and_stops import PlacedStop, Side, Stop, Support

__all__ = [
    "AnyBaseMotion",
    "AtEquilibrium",
    "AtRest",
    "BaseHarmonic",
    "BaseMotion",
    "Beam",
    "BeamPiece",
    "BeamSegment",
    "BeamStart",
    "BeamsStart",
    "Circle",
    "Damping",
    "Finite",
    "FloatArray",
    "Gravity",
    "HarmonicsBaseMotion",
    "HarmonicsLoad",
    "InitialState",
    "Line",
    "Link",
    "LoadHarmonic",
    "Mass",
    "Material",
    "ModalDamping",
    "NamedBeam",
    "NoDamping",
    "NonNegative",
    "Part",
    "PlacedStop",
    "PointLoad",
    "PolynomialShape",
    "Positive",
    "Problem",
    "RandomBaseMotion",
    "RandomLoad",
    "RecordBaseMotion",
    "RecordLoad",
    "Rectangle",
    "SNLine",
    "SampledShape",
    "Section",
    "ShapeFunction",
    "Side",
    "SineLoad",
    "SpringStiffness",
    "StepLoad",
    "Stop",
    "Support",
    "Tube",
    "UniformLoad",
    "ViscousDamping",
    "initial_from_functions",
    "paper_joint",
    "read_problem",
    "sdnl104",
    "write_problem",
]
