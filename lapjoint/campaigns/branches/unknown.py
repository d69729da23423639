"""How likely it is that a branch is unknown: what random starts tell of the starts that were not made.

A start's branch would be unknown without that start if nothing else leads there: neither another start, nor the ends of
the range, nor a branch that these lead to.  Random starts are alike, so the next start leads to an unknown branch about
as often as a start that was made would have done without the others' help: with a probability of n1 / N, if N starts
led to stable motions and n1 of them alone to their branch (Good, Biometrika 40, 1953, p. 237).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from scipy.special import betaincinv

_CONFIDENCE = 0.99
"""Confidence of the interval of Clopper and Pearson for n1 of N independent starts.  The unknown branches' share varies
with the known ones, so that the variance of its distance from n1 / N is about twice that of n1 / N (Esty, Annals of
Statistics 11, 1983, p. 905): 99 %, 2.33 standard deviations, stand for 95 %, 1.64 times the root of two of them."""


@dataclass(frozen=True)
class Reached:
    """What random starts led to, counting those that led to a stable motion."""

    starts: int = 0
    """Number of random starts that led to a stable motion."""
    branches: int = 0
    """Number of branches that these motions lie on; each motion that was not followed counts as one."""
    alone: int = 0
    """Number of these branches to which nothing leads but one start."""

    @property
    def probability(self) -> float | None:
        """Probability that the next start, if it leads to a stable motion, leads to an unknown branch; None of none."""
        return self.alone / self.starts if self.starts else None

    @property
    def bound(self) -> float:
        """Probability that the true one exceeds in about one search of twenty."""
        if self.alone == self.starts:
            return 1.0
        return float(betaincinv(self.alone + 1, self.starts - self.alone, _CONFIDENCE))


def reached(
    stable: Sequence[str | None], others: Sequence[str | None], leads: Mapping[str, Set[str]], known: Set[str]
) -> Reached:
    """Count what random starts led to.

    Parameters
    ----------
    stable, others : sequence of str or None
        The branch of each random start that led to a stable motion, and to an unstable one; None if no branch was
        followed that has the motion.
    leads : mapping of str to set of str
        The branches on which the motions lie that each branch leads to: those that spring from it, and its mother.
    known : set of str
        The branches that starts at the ends of the range lead to.

    Returns
    -------
    Reached
        The counts.
    """
    known = _all_from(known, leads)
    found = [set() if one is None else _all_from({one}, leads) for one in (*stable, *others)]
    alone = 0
    for i, own in enumerate(stable):
        is_known = own in known or any(own in there for k, there in enumerate(found) if k != i)
        alone += own is None or not is_known
    unfollowed = sum(own is None for own in stable)
    return Reached(len(stable), len({*stable} - {None}) + unfollowed, alone)


def _all_from(branches: Set[str], leads: Mapping[str, Set[str]]) -> set[str]:
    """Some branches, and all that they lead to, directly or through others."""
    found, waiting = set(branches), list(branches)
    while waiting:
        new = leads.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found
