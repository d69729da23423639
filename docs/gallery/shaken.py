"""From a shaker's record to a table for a report: a tube that rattles in its support, and how often it hits how hard.

Here a random signal, in a file as a logger writes it, stands for the shaker's record.  The file is read with its units,
the motion is marched to the end of the record, and summarised by statistics with their intervals.
"""

from pathlib import Path

import numpy as np

import analytic
from lapjoint import Beam, Material, ModalDamping, Problem, Stop, Support, Tube, figures, statistics
from lapjoint.problem import RecordBaseMotion

here, rate, duration = Path(__file__).parent, 2000, 20.0  # samples a second, s
frequency = np.fft.rfftfreq(int(rate * duration), 1 / rate)
noise = np.fft.rfft(np.random.default_rng(7).standard_normal(int(rate * duration)))
signal = np.fft.irfft(np.where((frequency > 10) & (frequency < 200), noise, 0))
rows = [f"{1e3 * i / rate:.1f};{value:.4f}\n" for i, value in enumerate(2.0 * signal / signal.std())]
(here / "shaker.csv").write_text("run 7, table, vertical\ntime [ms];a [g]\n" + "".join(rows))

tube = Problem(
    title="Tube in a loose support",
    beam=Beam(
        length=1.0,
        material=Material(youngs_modulus=195e9, density=7900.0),
        section=Tube(outer_diameter=19e-3, inner_diameter=16e-3),
    ),
    supports=(Support(x=0.0, translational=np.inf), Support(x=1.0, translational=np.inf)),
    stops=tuple(Stop(name=side, x=0.5, side=side, gap=0.3e-3, stiffness=2e6) for side in ("top", "bottom")),
    damping=ModalDamping(ratio=0.02),
    base_motion=RecordBaseMotion(
        file=str(here / "shaker.csv"),
        skip=1,
        column="a [g]",
        time_column="time [ms]",
        unit="g",
        time_unit="ms",
        quantity="acceleration",
    ),
)
found = statistics(tube, options={"n_modes": 6})
middle = found.sel(x=0.5)
for name, unit, factor in (
    ("displacement_rms", "mm", 1e3),
    ("stress_rms", "MPa", 1e-6),
    ("stress_maximum", "MPa", 1e-6),
):
    value, (low, high) = factor * float(middle[name]), factor * middle[f"{name}_interval"].values
    print(f"{name} at mid-span: {value:.3g} ± {(high - low) / 4:.2g} {unit}")
for i, side in enumerate(("top", "bottom")):
    low, high = found.contact_rate_interval.values[i]
    print(f"contacts a second, {side}: {float(found.contact_rate[i]):.3g} ± {(high - low) / 4:.2g}")
panels = figures.new_panels(2, 1, 7.0, 4.6)
history = analytic.Solver(n_modes=6).simulate(tube, 0.3, errors=False)
figures.plot_motion(history, panels[0], x=0.5, samples=500)
figures.plot_exceedance(found, panels[1])
figures.save(panels, __file__.replace(".py", ".svg"))
