"""Which stop is touched first, and where: the edge of contact in two parameters, amplitude and frequency of the base.

Below the edge a cantilever with two stops moves as if it had no stops.  The edge therefore has a closed form: the least
ratio of gap to the amplitude at a stop for a base of amplitude 1.  The thin lines are this form, by numpy alone.
"""

from math import inf

import numpy as np

from lapjoint import FREQUENCY, Axis, BaseMotion, Beam, Problem, Stop, Support, ViscousDamping, branch, figures

joint = Problem(
    beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
    supports=(Support(x=0.0, translational=inf, torsional=inf),),
    stops=(
        Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0, name="tip"),
        Stop(x=0.6, side="bottom", gap=0.3e-3, stiffness=50.0, name="middle"),
    ),
    damping=ViscousDamping(coefficient=0.8),
    base_motion=BaseMotion(amplitude=1e-5, angular_frequency=5.0),
)


def response(omega: float, x: float) -> float:
    """|H|: clamped, free, and EI z'''' = (m w^2 - i C w) z + m w^2 between, with EI = m = L = 1."""
    square = omega**2 - 0.8j * omega
    b, particular = square**0.25, -(omega**2) / square
    roots = b * np.array([1.0, -1.0, 1.0j, -1.0j])  # z is the sum of exp(r x), and a part that does not depend on x
    rows = np.array([roots**0, roots, roots**2 * np.exp(roots), roots**3 * np.exp(roots)])
    return float(abs(particular + np.linalg.solve(rows, [-particular, 0, 0, 0]) @ np.exp(roots * x)))


def main(points: int = 21) -> None:
    frequencies = np.linspace(4.0, 24.0, points)
    also = Axis(FREQUENCY, frequencies)
    how = {"options": {"n_modes": 6}, "errors": False, "max_points": 80, "effort": 1}
    found = branch(joint, "base_motion.amplitude", 1e-5, 6e-4, also_over=also, **how)
    first = found.isel(bifurcation=found.bifurcation_first == 1)
    axes = figures.plot_loci(first, figures.new_axes(7.0, 3.6))
    fine = np.linspace(4.0, 24.0, 400)
    for stop in joint.stops:
        axes.plot(
            fine, [stop.gap / response(omega, stop.x) for omega in fine], "-", color="0.6", linewidth=0.6, zorder=0
        )
    edge = {omega: min(stop.gap / response(omega, stop.x) for stop in joint.stops) for omega in frequencies.tolist()}
    off = first.bifurcation_value / [edge[omega] for omega in first.bifurcation_also_over.values.tolist()] - 1
    print(f"{off.size} grazes, off the closed form by less than 1e-6: {bool((abs(off) < 1e-6).all())}")
    figures.save(axes, __file__.replace(".py", ".png"))


if __name__ == "__main__":
    main()
