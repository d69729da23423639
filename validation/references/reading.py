"""References by name: printed digits, what they stand for, and where they come from."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from validation.verdict import Estimate, Kind

DATA = Path(__file__).with_name("references.toml")


@dataclass(frozen=True)
class Source:
    """Where numbers come from."""

    author: str
    title: str
    edition: str
    """Edition, version or year."""
    address: str
    """Address of the source: a DOI, an ISBN, a document's number, a file of this project."""
    kind: Kind
    read: str
    """How the digits came here."""
    made_by: str = ""
    """Module whose `main` prints the values, where they are computed by separate code."""

    @property
    def short(self) -> str:
        """The last name of the first author, for names of checks."""
        return self.author.split(",")[0].split(" and ")[0].split()[-1]

    @property
    def line(self) -> str:
        """Author, title, edition, address, and how it was read, in a line."""
        return f"{self.author}, {self.title} ({self.edition}), {self.address}; read: {self.read}"


@dataclass(frozen=True)
class Printed:
    """A number as it is printed, with its source."""

    text: str
    unit: str
    place: str
    """Place in the source."""
    source: Source

    @property
    def value(self) -> float:
        """The number, in its unit."""
        return float(self.text)

    @property
    def half_unit(self) -> float:
        """Half a unit of the last digit: the uncertainty by rounding."""
        mantissa, _, power = self.text.lower().partition("e")
        return 0.5 * 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))

    def estimate(self, besides: float = 0.0) -> Estimate:
        """The number as a reference.

        Parameters
        ----------
        besides : float
            Uncertainty of the number that it is compared with, in the unit.  Rounding is no chance: what it leaves and
            this add up in full.

        Returns
        -------
        Estimate
            The number, to half a unit of its last digit, with its address.
        """
        how = f"{self.source.line}; {self.place}; half a unit of the last digit"
        return Estimate(self.value, self.half_unit + besides, how, self.source.kind)


@cache
def sources() -> dict[str, Source]:
    """All sources, by key."""
    tables = tomllib.loads(DATA.read_text(encoding="utf-8"))["sources"]
    return {key: Source(**{**given, "kind": Kind(given["kind"])}) for key, given in tables.items()}


@cache
def _groups() -> dict[str, dict[str, tuple[Printed, ...]]]:
    found: dict[str, dict[str, tuple[Printed, ...]]] = {}
    for group in tomllib.loads(DATA.read_text(encoding="utf-8"))["group"]:
        source = sources()[group["source"]]
        found[group["name"]] = {
            key: tuple(
                Printed(text, group["unit"], group["place"], source)
                for text in (value if isinstance(value, list) else [value])
            )
            for key, value in group["values"].items()
        }
    return found


def group_names() -> tuple[str, ...]:
    """Names of all groups of values."""
    return tuple(_groups())


def group(name: str) -> dict[str, tuple[Printed, ...]]:
    """A group of values by key, each as a row of one number or several.

    Parameters
    ----------
    name : str
        The name of a group in ``references.toml``.

    Returns
    -------
    dict of str to tuple of Printed
        In the order of the file.
    """
    return _groups()[name]


def printed(name: str, key: str, i: int = 0) -> Printed:
    """One value.

    Parameters
    ----------
    name : str
        The name of a group in ``references.toml``.
    key : str
        The key of the row.
    i : int
        Which number of the row, from 0.

    Returns
    -------
    Printed
        The number with its source.
    """
    return _groups()[name][key][i]
