"""Problems ready to use: the paper's joint, and the outside benchmark SDNL104."""

from __future__ import annotations

import math

from lapjoint.problem.beam import Beam, Circle, Material, Rectangle
from lapjoint.problem.damping import ModalDamping
from lapjoint.problem.excitation import BaseMotion, StepLoad
from lapjoint.problem.named_beam import NamedBeam
from lapjoint.problem.problem import Problem
from lapjoint.problem.supports_and_stops import Stop, Support

PAPER_DENSITY = 7890.0  # kg/m3, Tables 3 and 6
TABLE_4_DENSITY = 7830.0  # kg/m3, with which Table 4 was computed: found by recomputing it


def clamp(x: float = 0.0) -> Support:
    """A clamped point at `x`, m: both springs are infinite, and hold displacement and slope at zero."""
    return Support(x=x, translational=math.inf, torsional=math.inf)


def paper_joint(
    *,
    k_star: float = 1200.0,
    angular_frequency: float = 515.0,
    base_amplitude: float = 0.06,
    gap: float = 1e-3,
    density: float = PAPER_DENSITY,
    damping_ratio: float = 0.08,
) -> Problem:
    """The lap joint of Rahmani and Ervin (2014): Figures 2 and 3, Tables 3 and 6.

    Parameters
    ----------
    k_star : float
        Stiffness of each stop over 3 EI / L^3, dimensionless.
    angular_frequency : float
        Base excitation omega, rad/s.
    base_amplitude : float
        Base excitation Y, m (Table 6 calls it A).
    gap : float
        Gap of each stop, m.
    density : float
        Mass density rho, kg/m3; Table 4 of the paper comes out with 7830, its Tables 3 and 6 say 7890.
    damping_ratio : float
        Modal damping ratio in every contact state.

    Returns
    -------
    Problem
        Stops in the order P2 (tip, bottom), P3 (mid-span, bottom), P4 (tip, top), P5 (mid-span, top).
    """
    L = 2.5
    beam = Beam(
        length=L,
        material=Material(youngs_modulus=2.05e11, density=density),
        section=Rectangle(breadth=0.3, height=0.05),
    )
    k = k_star * 3 * beam.EI / L**3
    places = (("P2", L, "bottom"), ("P3", L / 2, "bottom"), ("P4", L, "top"), ("P5", L / 2, "top"))
    return Problem(
        title="Lap joint of Rahmani and Ervin (2014)",
        beam=beam,
        supports=(clamp(),),
        stops=tuple(
            Stop(name=name, x=x, side="top" if side == "top" else "bottom", gap=gap, stiffness=k)
            for name, x, side in places
        ),
        damping=ModalDamping(ratio=damping_ratio),
        base_motion=BaseMotion(amplitude=base_amplitude, angular_frequency=angular_frequency),
    )


def sdnl104() -> Problem:
    """Code_Aster's validation case SDNL104 (document V5.02.104): a cantilever dropped on one stop.

    Length 1 m, solid circle of radius 0.1 m, E = 1e10 Pa, rho = 1e6 kg/m3, undamped; a force of -1000 N is
    applied at the tip at t = 0, over a stop 1e-4 m below the tip, of stiffness 1e8 N/m.
    """
    return Problem(
        title="SDNL104 (V5.02.104): cantilever on one stop under a step force",
        beam=Beam(
            length=1.0,
            material=Material(youngs_modulus=1e10, density=1e6),
            section=Circle(diameter=0.2),
        ),
        supports=(clamp(),),
        stops=(Stop(name="tip", x=1.0, side="bottom", gap=1e-4, stiffness=1e8),),
        point_loads=(StepLoad(x=1.0, force=-1000.0),),
    )


def lap_joint(*, gap: float = 1e-4, play: float = 2e-4, base_amplitude: float = 5e-4) -> Problem:
    """Two overlapping steel plates, clamped at their far ends and shaken there, with a loose bolt.

    The upper plate is 0.3 m long and 4 mm thick, the lower 0.3 m and 6 mm, and they overlap by 60 mm.  At each end of
    the overlap is a gap that closes where the plates come together.  The bolt, in the middle, has play, and closes
    where the plates come apart.  All numbers are an example, and come from no publication.

    Parameters
    ----------
    gap : float
        Gap between the plates at both ends of the overlap, m.
    play : float
        Play of the bolt, m.
    base_amplitude : float
        Amplitude of the base, m.

    Returns
    -------
    Problem
        Stops in the order left edge, right edge, bolt.
    """
    steel = Material(youngs_modulus=2.05e11, density=7850.0)

    def plate(name: str, height: float, origin: float, offset: float, clamped: float) -> NamedBeam:
        section = Rectangle(breadth=0.04, height=height)
        supports = (clamp(clamped),)
        return NamedBeam(
            name=name, origin=origin, offset=offset, length=0.3, material=steel, section=section, supports=supports
        )

    return Problem(
        title="Lap joint of two plates with a loose bolt",
        beams=(plate("upper", 0.004, 0.0, 0.01, 0.0), plate("lower", 0.006, 0.24, 0.0, 0.3)),
        stops=(
            Stop(name="left edge", between=("upper:0.24", "lower:0"), gap=gap, stiffness=2e6),
            Stop(name="right edge", between=("upper:0.3", "lower:0.06"), gap=gap, stiffness=2e6),
            Stop(name="bolt", between=("lower:0.03", "upper:0.27"), gap=play, stiffness=2e7),
        ),
        damping=ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=base_amplitude, angular_frequency=300.0),
    )


PRESETS = {"paper": paper_joint, "sdnl104": sdnl104, "lap": lap_joint}
"""The problems that the command line takes as ``preset:NAME``, by their names."""
