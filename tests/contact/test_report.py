"""The report on contacts, and `origami-nlp contacts`: every output, and complaints in one line."""

from __future__ import annotations

import json

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


def test_states_to_turn_carry_their_loads(report: ContactReport) -> None:
    content = report.view_content()
    (state,) = report.states
    lines = content.stations[state.number - 1].lines
    assert f"load margin: status: {state.margin.status}" in lines and len(content.stations) == 2
