"""A bar between two equally loose pins: its own mirror image, left for right and top for bottom."""

from __future__ import annotations

from lapjoint import BaseMotion, Beam, Circle, Material, ModalDamping, Problem, Stop, Support


def bar(omega: float, gap: float = 0.2e-3, amplitude: float = 1e-3) -> Problem:
    """The pinned beam of the gallery with equal bores."""
    ends = (("left", 0.0), ("right", 1.0))
    return Problem(
        title="Bar between two equally loose pins",
        beam=Beam(length=1.0, material=Material(youngs_modulus=2.05e11, density=7850.0), section=Circle(diameter=0.02)),
        supports=tuple(Support(x=x, translational=2e3) for _, x in ends),
        stops=tuple(
            Stop(name=f"{name}, {side}", x=x, side=side, gap=gap, stiffness=5e6)
            for name, x in ends
            for side in ("bottom", "top")
        ),
        damping=ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=amplitude, angular_frequency=omega),
    )
