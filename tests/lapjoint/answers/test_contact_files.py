"""Contacts go to files with all their digits."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import pytest

from lapjoint import History, InputError
from lapjoint.answers.contact_files import CONTACT_COLUMNS, write_contacts


def test_contacts_are_written_with_all_their_digits(history: History, tmp_path: Path) -> None:
    write_contacts(history, tmp_path / "contacts.csv")
    with (tmp_path / "contacts.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert tuple(rows[0]) == CONTACT_COLUMNS
    assert [row["stop"] for row in rows] == ["above", "below"]
    for row, contact in zip(rows, history.contacts, strict=True):
        for column, value in (
            ("start_s", contact.start),
            ("end_s", contact.end),
            ("duration_s", contact.duration),
            ("impulse_Ns", contact.impulse),
            ("peak_force_N", contact.peak_force),
        ):
            assert float(row[column]) == value
        assert (row["open_start"], row["open_end"]) == ("False", "False")

    write_contacts(history, tmp_path / "contacts.json")
    content = json.loads((tmp_path / "contacts.json").read_text())
    assert content["contacts"][1]["impulse_Ns"] == history.contacts[1].impulse
    assert content["impulses_Ns"]["above"] == history.contacts[0].impulse
    with pytest.raises(InputError, match=r"\.csv or \.json"):
        write_contacts(history, tmp_path / "contacts.xls")
