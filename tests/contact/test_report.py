"""The report on contacts, and `origami-nlp contacts`: every output, and complaints in one line."""

from __future__ import annotations

import json

import numpy as np
import pytest

from origami_nlp.contact.report import ContactReport
from tests.computed_once import panel_contacts


@pytest.fixture(scope="module")
def report() -> ContactReport:
    return panel_contacts()


def test_json_numbers_are_those_of_the_report(report: ContactReport) -> None:
    data = json.loads(json.dumps(report.to_dict(), allow_nan=False))
    (state,), (plain,) = report.states, data["states"]
    assert plain["margin"]["norm"] == state.margin.norm
    assert plain["contacts"][0]["multiplier"] == state.minimum.contacts[0].multiplier
    assert state.softness == min(state.stiffness) / sum(report.result.scene.stiffness)
    assert data["segments"]["segments"][0]["states"] == [state.number]
    never = [c for c in plain["margin"]["creases"] if "cap" in c["ends"]]
    assert never and all(None in (c["positive"], c["negative"]) for c in never)


def test_states_to_turn_carry_their_loads_and_boundaries(report: ContactReport) -> None:
    content = report.view_content()
    (state,) = report.states
    lines = content.stations[state.number - 1].lines
    assert f"load margin: status: {state.margin.status}" in lines and len(content.stations) == 2
    assert report.segments is not None
    for track, curve in zip(content.tracks, report.segments.curves, strict=True):
        assert np.array_equal(track.parameter, curve.s) and "; ".join(curve.contacts) in track.title
        angles = [folded.fold_angles for folded in track.states]
        assert np.array_equal(angles, curve.fold_angles)
        assert [folded.energy for folded in track.states] == list(curve.energy)
