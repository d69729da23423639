"""Faults of random excitation, which both solvers read."""

from __future__ import annotations

from validation.faults.fault import Fault

RANDOM = (
    Fault(
        "random-two-sided",
        "a factor",
        "lapjoint:taps_for",
        "The one-sided density is taken for a two-sided one: signals have twice the mean square.",
        old="np.abs(np.fft.rfft(taps, N)) ** 2 @ interpolated * (2 / N)",
        new="np.abs(np.fft.rfft(taps, N)) ** 2 @ interpolated * (1 / N)",
    ),
    Fault(
        "random-linear-breakpoints",
        "a wrong interpolation",
        "lapjoint:Density.at",
        "Between breakpoints the density is a straight line, not one on logarithmic paper.",
        old="np.exp(np.interp(np.log(f[inside]), np.log(self.frequency), np.log(self.density)))",
        new="np.interp(f[inside], self.frequency, self.density)",
    ),
    Fault(
        "random-filter-of-samples",
        "a wrong normalisation",
        "lapjoint:taps_for",
        "The filter gives its samples the mean square that the lines between them should have.",
        old="... @ interpolated * (2 / N)",
        new="... @ np.ones(f.size) * (2 / N)",
    ),
    Fault(
        "random-block-twice",
        "counted twice",
        "lapjoint:Realisation._made_noise",
        "Each block of noise comes twice in a row.",
        old="(self.part, k)",
        new="(self.part, k // 2)",
    ),
    Fault(
        "random-blocks-apart",
        "a boundary condition",
        "lapjoint:Realisation._made_block",
        "A block is filtered without the noise of the next one: it closes in itself, and jumps to the next.",
        old="np.concatenate([self._noise(k), self._noise(k + 1)])",
        new="np.concatenate([self._noise(k), self._noise(k)])",
    ),
    Fault(
        "random-parts-alike",
        "an input ignored",
        "lapjoint:RandomLoad.realisation",
        "All forces with one seed are one signal.",
        old="return self._realisation(number + 1)",
        new="return self._realisation(1)",
    ),
    Fault(
        "random-force-of-the-base",
        "off by one",
        "lapjoint:RandomLoad.realisation",
        "The first force has the noise of the base.",
        old="return self._realisation(number + 1)",
        new="return self._realisation(number)",
    ),
    Fault(
        "random-velocity",
        "a dropped half",
        "lapjoint:Realisation.at",
        "Within a sample the velocity of the base grows by twice what the slope of its acceleration gives.",
        old="s * slope / 2",
        new="s * slope",
    ),
    Fault(
        "random-integral",
        "a dropped half",
        "lapjoint:integrated",
        "The displacement of the base lacks what the change of acceleration within a sample gives.",
        old="2 * before + taps",
        new="3 * before",
    ),
    Fault(
        "random-unit",
        "a wrong power",
        "lapjoint:_squares",
        "A density is multiplied by its unit, not by the square of that.",
        old="factor ** 2",
        new="factor",
    ),
    Fault(
        "random-edge-of-blocks",
        "an event dropped",
        "lapjoint:RampBlocks._made_block",
        "A block of forces lacks its first ramp: from its edge to its second knot the force does not change.",
        old="force.at(time)",
        new="force.at(np.where(time == start, time[1], time))",
    ),
    Fault(
        "random-seeds-of-loads",
        "an input ignored",
        "lapjoint:Problem.with_seeds",
        "Another realisation has another seed of its base; forces keep theirs.",
        old="seed_of(part.seed)",
        new='part.seed if hasattr(part, "x") else seed_of(part.seed)',
    ),
)
