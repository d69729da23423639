"""What a solver, or its period map, must have for a piece of work, and the message that names what it lacks."""

from __future__ import annotations

from typing import Protocol

from lapjoint.errors import InputError


def lacking(found: object, protocol: type) -> str:
    """The members of a protocol that an object does not have, as a list in words; empty if it has all."""
    parts = [part for part in protocol.__mro__ if part not in (Protocol, object) and part.__module__ != "typing"]
    members = [name for part in parts for name in {**vars(part), **vars(part).get("__annotations__", {})}]
    known = (type(found), found)  # the class first, so that no property is computed
    missing = [
        name
        for name in dict.fromkeys(members)
        if not name.startswith("_") and not any(hasattr(one, name) for one in known)
    ]
    return " and ".join(filter(None, [", ".join(missing[:-1]), *missing[-1:]]))


def require(found: object, protocol: type, owner: str, work: str) -> None:
    """Raise InputError unless an object has all members of a protocol; the message names those that are missing, the
    `owner` of the object, as ``solver = fe``, and the `work` that needs them, in the plural."""
    missing = lacking(found, protocol)
    if missing:
        raise InputError(f"{owner}: lacks {missing} of {protocol.__module__}.{protocol.__name__}, which {work} need")
