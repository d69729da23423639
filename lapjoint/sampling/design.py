"""The samples of a campaign: scrambled Sobol points, and the values of the uncertain numbers at them.

A design consists of `SETS` independently scrambled sets of Sobol points.  Within a set, points fill the space more
evenly than random ones; from set to set they are independent, so that the scatter of the sets shows the sampling error.

The design of Saltelli (2010), for total sensitivity indices, has two points A and B for each point of twice as many
variables, and for each variable i the point AB_i, which is A with the variable i of B.  A block is A, AB_1, ..., B.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.files import problem_from_tables, problem_tables
from lapjoint.problem.uncertain import OUTERMOST, with_drawn

SETS = 8
"""Number of independently scrambled sets: Student's t of 7 degrees of freedom is 1.2 times as wide as the normal
distribution, and with more sets each has fewer points, which fill the space less evenly."""
MOST_SAMPLES = SETS << 14
"""Largest number of samples."""
BITS = 30
"""Bits of the Sobol points: `OUTERMOST` is half of their resolution."""
SAMPLE, DRAWN = "sample", "drawn_"
"""Name of the dimension of samples in files, and the beginning of the names of the coordinates with drawn values."""
Kind = Literal["sobol", "saltelli"]


@dataclass(frozen=True)
class Samples:
    """The values of all uncertain numbers of a problem at all samples.

    Pickled samples hold the values, so that workers need not draw them.
    """

    design: Kind
    number: int
    """Number of points that were asked for; with "saltelli" the number of blocks."""
    seed: int
    values: tuple[tuple[float, ...], ...]
    """For each sample, the value of each variable, in the sequence of the problem."""
    sets: tuple[int, ...]
    """For each sample, the set to which it belongs, from 0."""
    matrices: tuple[int, ...]
    """For each sample, 0 if it is a point A, i + 1 for AB_i, i from 0, and d + 1 for B; 0 in a Sobol design."""

    @property
    def size(self) -> int:
        """Number of samples."""
        return len(self.values)

    @property
    def identity(self) -> dict[str, Any]:
        """What distinguishes these samples from others of the same problem, as values that JSON can hold."""
        return {"design": self.design, "number": self.number, "seed": self.seed}

    def noise(self, sample: int) -> int:
        """Number of the noise at a sample: samples with the same number have the same random excitation.

        Each point A has noise of its own, as if noise were one more uncertain number.  AB_i has the noise of A, from
        which it differs by its variable i alone, and B has its own.
        """
        width = max(self.matrices) + 1
        return 2 * (sample // width) + (self.matrices[sample] == width - 1 > 0)

    def problem(self, problem: Problem, sample: int) -> Problem:
        """The problem in which each uncertain number has its value at a sample, and none is uncertain.

        InputError is raised if there is no such problem.
        """
        tables = problem_tables(problem)
        del tables["uncertain"]
        source = describe(problem, self.values[sample], sample)
        return problem_from_tables(with_drawn(tables, problem.uncertain, self.values[sample], source), source)


def describe(problem: Problem, values: tuple[float, ...], sample: int) -> str:
    """A text for messages that names a sample: ``sample 3 (gap = 0.00102)``."""
    drawn = (f"{one.name} = {value:.6g}" for one, value in zip(problem.uncertain, values, strict=True))
    return f"sample {sample} ({', '.join(drawn)})"


def samples_of(problem: Problem, number: int, design: Kind = "sobol", seed: int = 0) -> Samples:
    """Draw samples of the uncertain numbers of a problem.

    Parameters
    ----------
    problem : Problem
        The problem; it must have uncertain numbers.
    number : int
        Number of points, `SETS` times a power of two from 2 on; with "saltelli" the number of blocks of d + 2 points.
    design : {"sobol", "saltelli"}
        Scrambled Sobol points, or the design for total sensitivity indices.
    seed : int
        Seed of the scrambling, 0 or more.

    Returns
    -------
    Samples
        The samples, the same for the same arguments.

    Raises
    ------
    InputError
        If an argument is not allowed, or nothing is uncertain.
    """
    if not problem.uncertain:
        raise InputError("samples: nothing in this problem is uncertain; give it an [[uncertain]] number")
    each = number // SETS if isinstance(number, int) and not isinstance(number, bool) else 0
    if each * SETS != number or each < 2 or each & (each - 1) or number > MOST_SAMPLES:
        allowed = f"{2 * SETS}, {4 * SETS}, {8 * SETS}, ... {MOST_SAMPLES}"
        raise InputError(f"samples = {number!r}: must be {SETS} times a power of two: {allowed}")
    if design not in get_args(Kind):
        raise InputError(f"design = {design!r}: allowed: {', '.join(get_args(Kind))}")
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**63:
        raise InputError(f"sample seed = {seed!r}: must be an integer from 0 to {2**63 - 1}")
    blocks = np.stack([_blocks(len(problem.uncertain), each, design, (seed, k)) for k in range(SETS)])
    sets, _, width, d = blocks.shape
    points = blocks.reshape(-1, d)
    columns = [one.quantiles(points[:, i]).tolist() for i, one in enumerate(problem.uncertain)]
    return Samples(
        design,
        number,
        seed,
        tuple(zip(*columns, strict=True)),
        tuple(np.repeat(np.arange(sets), each * width).tolist()),
        tuple(np.tile(np.arange(width), sets * each).tolist()),
    )


def _blocks(d: int, count: int, design: Kind, seed: tuple[int, int]) -> FloatArray:
    """The points of a set in blocks, (count, 1, d) or (count, d + 2, d), each between 0 and 1."""
    from scipy.stats import qmc

    dimensions = d if design == "sobol" else 2 * d
    sobol = qmc.Sobol(dimensions, scramble=True, bits=BITS, rng=np.random.default_rng(seed))
    points = sobol.random(count) + OUTERMOST
    if design == "sobol":
        return np.asarray(points[:, None])
    a, b = points[:, :d], points[:, d:]
    mixed = [np.where(np.arange(d) == i, b, a) for i in range(d)]
    return np.stack([a, *mixed, b], axis=1)
