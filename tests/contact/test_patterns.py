"""What holds the states of a pattern in contact: forces, and the load that their facets bear before they part."""

import pytest

import origami_nlp as o
from tests.computed_once import states


@pytest.fixture(scope="module")
def found():
    return states("squaretwist")


def test_forces_are_those_of_the_states(found):
    report = o.find_contacts(found)
    assert [s.number for s in report.states] == [
        n for n, s in enumerate(found.minima, 1) if s.contacts
    ]
    for state in report.states:
        reported = sorted(c.force for c in state.minimum.contacts)
        assert sorted(c.multiplier for c in state.contacts) == pytest.approx(reported, abs=1e-12)
    assert report.states and len(report.to_dict()["result"]["origami"]["polygons"]) == 9
