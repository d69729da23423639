"""Five systems of the literature on impacting beams, each as a curve of impulses over frequency by both solvers.

Lines are the analytic solver, dots finite elements; a cross is a motion that repeats only after several periods, or not
at all.  The dotted line is the last system with one mode.  Beams have length, bending stiffness and mass per length 1,
unless their entry says otherwise.
"""

from math import inf

import numpy as np

import analytic
from lapjoint import FREE, FREQUENCY, Axis, BaseMotion, Beam, ModalDamping, Problem, Stop, Support, figures, sweep
from lapjoint.problem import FloatArray, Link, Mass, NamedBeam

UNIT = {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}
SHAKEN = {"damping": ModalDamping(ratio=0.03), "base_motion": BaseMotion(amplitude=1e-3, angular_frequency=1.0)}


def clamp(x: float = 0.0) -> Support:
    return Support(x=x, translational=inf, torsional=inf)


def pins(*places: float) -> tuple[Support, ...]:
    return tuple(Support(x=x, translational=inf) for x in places)


SYSTEMS = {
    # A clamped-clamped beam carries a rigid body, which strikes a compliant base (Ervin and Wickert).
    "rigid body on a clamped beam": Problem(
        beam=Beam(**UNIT),
        supports=(clamp(), clamp(1.0)),
        masses=(Mass(x=0.5, mass=1.0, rotary_inertia=0.02),),
        stops=(Stop(x=0.5, side="bottom", gap=2e-3, stiffness=200.0),),
        **SHAKEN,
    ),
    # Two pinned beams cross at mid-span, one above the other (Ervin).
    "two orthogonal beams": Problem(
        beams=(
            NamedBeam(name="upper", supports=pins(0.0, 1.0), **UNIT),
            NamedBeam(name="lower", supports=pins(0.0, 1.0), **UNIT | {"bending_stiffness": 4.0}),
        ),
        stops=(Stop(between=("upper:0.5", "lower:0.5"), gap=2e-3, stiffness=200.0),),
        **SHAKEN,
    ),
    # A beam over two spans, clamped at one end, whose other end is between two stops (Chattopadhyay).
    "two spans in a gap": Problem(
        beam=Beam(**UNIT),
        supports=(clamp(), *pins(0.6)),
        stops=tuple(Stop(x=1.0, side=side, gap=2e-3, stiffness=100.0) for side in ("top", "bottom")),
        **SHAKEN,
    ),
    # A second member stands on the tip of the first: its root turns with the tip, and rides up and down with it as a
    # mass, but does not move across; the base does not move across it either (Pun and others).
    "L-shaped beam with a limit stop": Problem(
        beams=(
            NamedBeam(name="first", supports=(clamp(),), masses=(Mass(x=1.0, mass=0.5),), **UNIT),
            NamedBeam(name="second", supports=pins(0.0), base_share=0.0, **UNIT | {"length": 0.5}),
        ),
        links=(Link(between=("first:1", "second:0"), torsional=inf),),
        stops=(Stop(x="second:0.5", side="top", gap=1e-3, stiffness=50.0),),
        **SHAKEN,
    ),
    # A cantilever that strikes one stop at its tip (Moon and Shaw, Shaw).
    "cantilever with one stop": Problem(
        beam=Beam(**UNIT), supports=(clamp(),), stops=(Stop(x=1.0, side="top", gap=2e-3, stiffness=50.0),), **SHAKEN
    ),
}


def swept(system: Problem, frequencies: FloatArray, solver: str, **options: int) -> tuple[FloatArray, FloatArray]:
    """Largest impulse in a cycle, and how many periods the motion takes to repeat; 0 if it does not."""
    found = sweep(system, [Axis(FREQUENCY, frequencies)], solver=solver, options=options, errors=False)
    return np.abs(found.impulse.values).max(axis=1), found.period_multiple.values


def main(points: int = 61) -> None:
    panels = figures.new_panels(5, 1, 7.0, 8.4)
    for axes, (name, system) in zip(panels, SYSTEMS.items(), strict=True):
        lowest = float(analytic.Solver().modes(system, FREE, 1).angular_frequencies[0])
        ratios = np.linspace(0.4, 2.8, points)
        at = lowest * ratios
        impulse, periods = swept(system, at, "analytic", n_modes=16)
        fe, as_many = swept(system, at[::6], "fe", elements=8)
        axes.plot(ratios, impulse, "-", lw=1, color="0.6")
        axes.plot(ratios[periods != 1], impulse[periods != 1], "x", ms=4, color="C1")
        axes.plot(ratios[::6], fe, ".", color="C0")
        axes.set_title(name, fontsize=9, loc="left")
        same = (periods[::6] == as_many) & (as_many > 0)
        apart = np.abs(impulse[::6] - fe)[same].max() / impulse.max()
        longer, how = np.mean(periods > 1), ("no", "few", "many")
        print(f"{name}: peak at {ratios[impulse.argmax()]:.2f} of the lowest frequency,", end=" ")
        print(f"{how[int(longer > 0) + int(longer > 0.1)]} motions of several periods; solvers agree: {apart < 0.01}")
        if name == "cantilever with one stop":
            single, more = swept(system, at, "analytic", n_modes=1)
            axes.plot(ratios, single, ":", lw=1, color="0.2")
            print(f"  with one mode: peak at {ratios[single.argmax()]:.2f},", end=" ")
            print("many motions of several periods" if np.mean(more > 1) > 0.1 else "few motions of several periods")
    panels[2].set_ylabel("impulse in a cycle")
    panels[-1].set_xlabel("excitation frequency over the lowest natural frequency")
    figures.save(panels[0], __file__.replace(".py", ".svg"))


if __name__ == "__main__":
    main()
