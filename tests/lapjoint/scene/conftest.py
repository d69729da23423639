"""What the tests of scenes share."""

from __future__ import annotations

import pytest
from written_history import with_section

from lapjoint import History


@pytest.fixture
def solid(history: History) -> History:
    """The motion that is written down, of a beam with a section."""
    return with_section(history)
