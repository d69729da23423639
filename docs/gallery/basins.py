"""Basins of three motions: a cantilever with one stop above its tip, driven at three times its lowest frequency.

It never touches the stop, or hits it and repeats after three periods of the excitation, or after five.  A start is a
point of the plane: how far the tip is bent, and how fast it is let go.  The colour is the motion that remains.
"""

from lapjoint import basins, figures, paper_joint

omega = 131.0  # rad/s
# The beam of the paper with one light stop, weak damping, and a base that moves by half the gap.
joint = paper_joint(angular_frequency=omega, base_amplitude=1e-3, gap=2.25e-3, k_star=5.0, damping_ratio=0.018)
joint = joint.replace(title="One stop above the tip", stops=joint.stops[2:3])


def main(points: int = 60) -> None:
    reach = 8e-3  # m, twice what the motions without contact have
    ranges = (-reach, reach), (-reach * omega, reach * omega)
    found = basins(joint, plane="z(2.5),v(2.5)", grid=(points, points), ranges=ranges)
    for i in range(found.sizes["motion"]):
        error = float(found.fraction_high[i] - found.fraction_low[i]) / 4
        print(f"{int(found.period_multiple[i])} periods: {float(found.fraction[i]):.3f} ± {error:.3f} of the starts")
    figures.save(figures.plot_basins(found), __file__.replace(".py", ".png"))


if __name__ == "__main__":
    main()
