"""Contacts and barriers of states that wind several times round their axis."""

import math
from dataclasses import replace

import pytest

from origami_nlp import Scene, Vertex, find_barriers, find_contacts, find_minima
from tests.paths.test_windings import STAR


@pytest.mark.slow  # a survey of several seconds
def test_contacts_and_barriers_are_those_of_the_winding():
    result = find_minima(STAR, prove=False, escape=False)
    (pinned,) = [k for k, m in enumerate(result.minima, 1) if m.contacts]
    assert result.minima[pinned - 1].winding == 3
    report = find_contacts(result)
    assert [s.number for s in report.states] == [pinned]
    assert report.states[0].margin.status not in ("unbounded", "zero")
    two = Scene(
        Vertex((0.4, math.pi / 4 - 0.4, math.pi / 4 - 0.4, 0.4) * 4),
        (1, 2, 0.5, 2) * 4,
        (2.0, 1.5, 0.7, 1.5) * 4,
        "D4",
        "fold-limits",
    )
    assert {m.winding for m in find_minima(two, prove=False, escape=False).minima} == {1, 3}
    for scene in (two, replace(two, winding=3)):
        found = find_barriers(scene)
        assert {m.winding for m in found.result.minima} == {scene.winding or 1}
        assert len(found.passes) == math.comb(len(found.result.minima), 2) > 0
