"""What holds the states of a pattern in contact: forces, and the load that their facets bear before they part."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import newton


@pytest.fixture(scope="module")
def found():
    return o.find_minima("squaretwist", max_starts=10, escape=False, prove=False)


def test_forces_are_those_of_the_states(found):
    report = o.find_contacts(found)
    assert [s.number for s in report.states] == [
        n for n, s in enumerate(found.minima, 1) if s.contacts
    ]
    for state in report.states:
        reported = sorted(c.force for c in state.minimum.contacts)
        assert sorted(c.multiplier for c in state.contacts) == pytest.approx(reported, abs=1e-12)
    assert report.states and len(report.to_dict()["result"]["origami"]["polygons"]) == 9


@pytest.mark.slow
def test_a_contact_opens_at_the_margin_and_not_before():
    """Solved under the worst load with the contacts held: just below all push, just above one pulls."""
    found = o.find_minima("resch:1x2", max_starts=10, escape=False)
    report, reported = o.find_contacts(found), 0
    for state in report.states:
        margin = state.margin
        if margin.status != "exact" or margin.ends != "opens":
            continue
        at = found.state_of(state.minimum)
        rows = tuple(c.contact for c in state.contacts)
        for factor in (0.98, 1.02):
            load = factor * np.array(margin.moments) / at.problem.scale
            end, forces = newton(at.problem.loaded(load), at.x, rows)
            assert end is not None and end.converged
            assert (forces.min() > 0) == (factor < 1)
        reported += 1
    assert reported >= 2


def test_what_is_for_vertices_says_so(found):
    with pytest.raises(o.OrigamiError, match="segments = True"):
        o.find_contacts(found, segments=True)
    with pytest.raises(o.OrigamiError, match="number of a minimum"):
        o.find_contacts(found, state=1000)
