"""The contacts of a marched motion: from the switch that closes a stop to the one that opens it."""

from __future__ import annotations

from analytic.march.march import March
from lapjoint.answers import Contact


def contacts_of(motion: March) -> tuple[Contact, ...]:
    """All contacts of a motion that was marched with `depth`.

    Parameters
    ----------
    motion : March
        The motion, recorded.

    Returns
    -------
    tuple of Contact
        By start time.
    """
    joint, log = motion.joint, motion.log
    found: list[Contact] = []
    going: dict[int, tuple[int, bool]] = dict.fromkeys(joint.state_in(int(log.slot[0])).closed, (0, True))
    for i, stop in enumerate(log.stop):
        if stop < 0:
            continue
        if stop in going:
            first, open_start = going.pop(int(stop))
            found.append(_contact(motion, int(stop), first, i, open_start, open_end=False))
        else:
            going[int(stop)] = (i + 1, False)
    last = log.slot.size - 1
    found += [_contact(motion, k, first, last, open_start, open_end=True) for k, (first, open_start) in going.items()]
    return tuple(sorted(found, key=lambda contact: (contact.start, contact.stop)))


def _contact(motion: March, k: int, first: int, last: int, open_start: bool, *, open_end: bool) -> Contact:
    """The contact of stop `k` from the start of segment `first` to the end of segment `last`."""
    log, stop = motion.log, motion.joint.problem.stops[k]
    return Contact(
        stop=k,
        start=float(log.start[first]),
        end=float(log.end[last]),
        impulse=stop.sign * stop.stiffness * float(log.area[first : last + 1, k].sum()),
        peak_force=stop.stiffness * float(log.deepest[first : last + 1, k].max()),
        open_start=open_start,
        open_end=open_end,
    )
