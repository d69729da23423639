"""How likely it is that a branch is unknown, estimated from the random starts of a search.

A branch that only one start found would be unknown without that start: no other start, no end of the range, and no
branch to which these lead, leads there.  Random starts are alike, so the next start leads to an unknown branch about as
often as one of the starts made was the only one to find its branch.  If N starts led to stable motions, and n1 of them
led alone to their branch, the probability is about n1 / N (Good, Biometrika 40, 1953, p. 237).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass

from scipy.special import betaincinv

_CONFIDENCE = 0.99
"""Confidence of the Clopper-Pearson interval for n1 of N independent starts that is used as the 95 % interval.  The
unknown share varies with the branches found, which doubles the variance (Esty, Annals of Statistics 11, 1983, p. 905):
the quantile of 99 %, 2.33 standard deviations, is 1.64, that of 95 %, times the root of two."""


@dataclass(frozen=True)
class Reached:
    """Counts of the random starts that led to a stable motion, and of their branches."""

    starts: int = 0
    """Number of random starts that led to a stable motion."""
    branches: int = 0
    """Number of branches on which these motions lie; each motion whose branch was not followed counts as one."""
    alone: int = 0
    """Number of these branches to which only one random start leads, and nothing else."""

    @property
    def probability(self) -> float | None:
        """Probability that the next start, if it leads to a stable motion, leads to an unknown branch; None without
        starts."""
        return self.alone / self.starts if self.starts else None

    @property
    def bound(self) -> float:
        """Upper end of a one-sided 95 % interval of the probability."""
        if self.alone == self.starts:
            return 1.0
        return float(betaincinv(self.alone + 1, self.starts - self.alone, _CONFIDENCE))


def reached(
    stable: Sequence[str | None], others: Sequence[str | None], leads: Mapping[str, Set[str]], known: Set[str]
) -> Reached:
    """The counts of the branches to which random starts led.

    `stable` and `others` have one entry for each random start that led to a stable and to an unstable motion: the name
    of the branch on which the motion lies, or None if that branch was not followed.  `leads` gives, for each branch,
    the names of the branches to which motions on it lead.  `known` names the branches of the starts at the ends of the
    range.
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
    """Some branches, and all branches to which they lead, directly or through others."""
    found, waiting = set(branches), list(branches)
    while waiting:
        new = leads.get(waiting.pop(), set()) - found
        found |= new
        waiting += new
    return found
