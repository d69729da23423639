"""Which contacts of two motions are the same, and when the motions have parted."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from lapjoint.answers import Contact
from lapjoint.orbits.contact_errors import differences, parting
from lapjoint.orbits.refinement import SAFETY, Refinement


def contacts(*starts: float, stop: int = 0, impulse: float = 1.0) -> list[Contact]:
    return [Contact(stop, start, start + 0.1, impulse, 10.0) for start in starts]


def test_partners_are_the_nearest_of_one_stop() -> None:
    found = differences(
        contacts(1.0, 2.0), [*contacts(1.01, impulse=1.5), *contacts(1.0, 2.0, stop=1), *contacts(1.98)]
    )
    assert found.start == pytest.approx([0.01, 0.02])
    assert found.impulse == pytest.approx([0.5, 0.0])
    assert found.peak_force == pytest.approx([0.0, 0.0])


def test_a_contact_that_the_other_motion_lacks_has_no_partner_and_the_rest_do() -> None:
    found = differences(contacts(1.0, 1.2, 2.0), contacts(1.0, 2.0))
    assert found.start.tolist() == [0.0, math.inf, 0.0]
    found = differences(contacts(1.0, 2.0), contacts(1.0, 1.2, 2.0))
    assert found.start.tolist() == [0.0, 0.0]
    assert np.isinf(differences(contacts(1.0), contacts(1.0, stop=1)).impulse[0])


def test_of_a_contact_that_the_other_motion_splits_the_start_alone_is_known() -> None:
    (one,) = whole = [Contact(0, 1.0, 2.0, 1.0, 10.0)]
    parts = [replace(one, end=1.4, impulse=0.7), replace(one, start=1.5, impulse=0.3)]
    for own, other in ((whole, parts), (parts, whole)):
        found = differences(own, other)
        assert found.start[0] == 0.0
        assert np.isinf(found.impulse).all()
        assert np.isinf(found.peak_force).all()
        assert np.isinf(found.dissipated).all()


def test_times_of_periodic_motions_are_compared_modulo_the_period() -> None:
    found = differences(contacts(0.01, 5.0), contacts(5.0, 9.99), period=10.0)
    assert found.start == pytest.approx([0.02, 0.0])


def test_marches_have_parted_where_partners_are_as_far_as_neighbours() -> None:
    own = contacts(1.0, 2.0, 3.0, 4.0)
    assert parting(own, differences(own, contacts(1.001, 2.01, 3.05, 4.02))) == 4
    assert parting(own, differences(own, contacts(1.001, 2.01, 3.2, 4.02))) == 2
    assert parting([], differences([], own)) == 0


def test_a_difference_and_the_share_of_the_finer_solver_make_an_error() -> None:
    bounds = Refinement("finer", 2.0, 1.0).bounds(np.array([-3.0, 1.0]), 3.0)
    assert bounds.tolist() == pytest.approx([SAFETY * 6.0, SAFETY * 4.0])


def test_each_derivative_takes_its_powers_of_the_resolution_down_to_one() -> None:
    four = Refinement("finer", 2.0, 4.0)
    for (dx, dt), share in {(0, 0): 1 / 15, (1, 0): 1 / 7, (2, 0): 1 / 3, (0, 1): 1 / 3, (3, 0): 1, (0, 2): 1}.items():
        assert four.bounds(np.zeros(1), 1.0, dx, dt) == pytest.approx(SAFETY * share)
