"""A lap joint whose plates both move: `preset:lap`, two steel plates that overlap, with a loose bolt.

Above, the impulse of each stop in a cycle over the frequency at which both plates are shaken.  Below, the plates at the
peak, when the bolt pulls hardest; displacements are five times as large as they are.
"""

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import FREE, FREQUENCY, Axis, ContactState, figures, sweep
from lapjoint.problem.presets import lap_joint

LARGER = 5.0  # Times that displacements are drawn as large as they are
BOLT = 2


def main(points: int = 28) -> None:
    joint = lap_joint()
    curve = sweep(joint, [Axis(FREQUENCY, np.linspace(210.0, 480.0, points))], options={"n_modes": 24})
    above, below = figures.new_panels(2, 1, 7.0, 4.8)
    for k, name in enumerate(joint.stop_names):
        above.plot(curve.angular_frequency, curve.impulse.values[:, k], ".-", color=f"C{k}", label=name)
    above.set(xlabel="excitation frequency [rad/s]", ylabel="impulse in a cycle [N s]")
    above.legend(fontsize=8)

    peak = float(curve.angular_frequency.values[curve.impulse.values[:, BOLT].argmax()])
    shaken = joint.replace(base_motion=joint.base_motion.model_copy(update={"angular_frequency": peak}))
    found = [solver.steady_state(shaken) for solver in (analytic.Solver(), fe_lapjoint.Solver(elements=12))]
    for name, steady in zip(("analytic", "FE"), found, strict=True):
        print(f"{name}, {peak:.0f} rad/s: {steady.outcome.value} Impulses {steady.impulses.round(2)} N s")
    loose, tight = (
        analytic.Solver().modes(joint, state, 1).angular_frequencies[0] for state in (FREE, ContactState((0, 1, 2)))
    )
    print(f"The lowest frequency is {loose:.0f} rad/s with all stops open, {tight:.0f} with all closed.")

    history, places = found[0].history, {beam.name: beam for beam in joint.beams}
    t = np.linspace(history.start, history.end, 2001)
    when = float(t[history.penetration(t)[BOLT].argmax()])

    def drawn(name: str, x: float) -> tuple[float, float]:
        """Where a point of a plate is drawn, mm."""
        beam, z = places[name], history.displacement(joint.position(f"{name}:{x}"), when).item()
        return 1e3 * (beam.origin + x), 1e3 * (beam.offset + LARGER * z)

    for beam in joint.beams:
        below.plot(*zip(*(drawn(beam.name, x) for x in np.linspace(0.0, beam.length, 41)), strict=True), "-k", lw=3)
    for k, stop in enumerate(joint.stops):
        ends = [place.split(":") for place in stop.between]
        below.plot(*zip(*(drawn(name, float(x)) for name, x in ends), strict=True), "-", color=f"C{k}", lw=2)
    below.set(xlabel="x [mm]", ylabel=f"z, {LARGER:.0f} times [mm]")
    figures.save(above, __file__.replace(".py", ".svg"))


if __name__ == "__main__":
    main()
