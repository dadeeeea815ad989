"""Contacts of states that wind several times round their axis."""

import pytest

from origami_nlp import find_contacts, find_minima
from tests.paths.test_windings import STAR


@pytest.mark.slow  # a survey of several seconds
def test_contacts_are_those_of_the_winding():
    result = find_minima(STAR, prove=False, escape=False)
    (pinned,) = [k for k, m in enumerate(result.minima, 1) if m.contacts]
    assert result.minima[pinned - 1].winding == 3
    report = find_contacts(result)
    assert [s.number for s in report.states] == [pinned]
    assert report.states[0].margin.status not in ("unbounded", "zero")
