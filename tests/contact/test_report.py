"""The report on contacts, and `origami-nlp contacts`: every output, and complaints in one line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.contact import find_contacts
from origami_nlp.contact.report import SOFT, ContactReport, margin_lines, margin_number
from origami_nlp.minima import images
from tests.command_line import run, scene_file
from tests.computed_once import panel_result


@pytest.fixture(scope="module")
def report() -> ContactReport:
    result = panel_result(o.examples.degree8("pi/12", 0.01))
    return find_contacts(result, segments=True)


def test_command_writes_all_its_files(tmp_path: Path) -> None:
    scene = scene_file(tmp_path, o.examples.degree8("pi/6", 0.01))
    files = {k: tmp_path / f"report.{k}" for k in ("json", "html")}
    options = [part for path in files.values() for part in ("-o", str(path))]
    done = run("contacts", scene, "--segments", *options)
    assert done.code == 0, done.err
    assert "load margin" in done.out and "metastable" in done.out
    data = json.loads(files["json"].read_text())
    assert data["schema"] == "origami-nlp/contacts/3"
    (state,) = data["states"]
    minimum = data["result"]["minima"][state["number"] - 1]
    assert minimum["kind"] == "contact-pinned" and state["margin"]["checked"]
    assert f"{state['margin']['norm']:.5g}" in done.out
    page = files["html"].read_text()
    assert (
        page.startswith("<!doctype html>") and "largest moment on the creases of one orbit" in page
    )


def test_a_scene_without_pinned_states_says_so(tmp_path: Path) -> None:
    scene = scene_file(tmp_path, o.examples.degree8("pi/4", 1.0))
    done = run("contacts", scene, "--segments")
    assert done.code == 0
    assert "0 of 2 minima" in " ".join(done.out.split())
    assert "no contact boundary to follow" in done.out


def test_json_numbers_are_those_of_the_report(report: ContactReport) -> None:
    data = json.loads(json.dumps(report.to_dict(), allow_nan=False))
    (state,) = report.states
    (plain,) = data["states"]
    assert plain["margin"]["norm"] == state.margin.norm
    assert plain["margin"]["moments"] == list(state.margin.moments)
    assert len(plain["margin"]["creases"]) == report.result.model.size
    assert plain["contacts"][0]["multiplier"] == state.minimum.contacts[0].multiplier
    assert plain["softness"] == pytest.approx(
        min(state.stiffness) / sum(report.result.scene.stiffness)
    )
    assert plain["soft"] == (plain["softness"] <= SOFT)
    assert data["segments"]["segments"][0]["states"] == [state.number]
    never = [c for c in plain["margin"]["creases"] if "cap" in c["ends"]]
    assert never and all(None in (c["positive"], c["negative"]) for c in never)


def test_every_status_of_a_margin_has_words() -> None:
    result = panel_result(o.examples.degree6("pi/3", 1.0))
    report = find_contacts(result, check=False)
    words = {s.margin.status: margin_number(s.margin) for s in report.states}
    assert words["zero"] == "0" and words["unbounded"] == "unbounded"
    assert float(words["exact"]) > 0
    text = report.full_table().markdown() + str(report)
    assert "unbounded" in text and "any of" in text  # ranges of dependent contacts
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert len({line.count("|") - line.count("\\|") for line in rows[:3]}) == 1
    assert "NOT confirmed" in text  # without re-solving nothing is claimed to be checked


def test_states_to_turn_carry_their_loads_and_boundaries(report: ContactReport) -> None:
    content = report.view_content()
    (state,) = report.states
    lines = content.stations[state.number - 1].lines
    assert set(margin_lines(state.margin)) <= set(lines) and len(content.stations) == 2
    assert report.segments is not None
    for track, curve in zip(content.tracks, report.segments.curves, strict=True):
        assert np.array_equal(track.parameter, curve.s) and "; ".join(curve.contacts) in track.title
        angles = [folded.fold_angles for folded in track.states]
        assert np.array_equal(angles, curve.fold_angles)
        assert [folded.energy for folded in track.states] == list(curve.energy)


def test_contacts_have_images_under_the_symmetry(report: ContactReport) -> None:
    model, (state,) = report.result.model, report.states
    contact = state.minimum.contacts[0]
    assert images(model, contact)[0] == contact.creases
    # facets in contact come with their mirror images
    result = panel_result(o.examples.degree6("pi/3", 1.0))
    pair = next(c for m in result.minima for c in m.contacts if c.facets)
    assert set(images(result.model, pair)[1]) >= set(pair.facets)
    assert len(images(result.model, pair)[1]) == 2 * len(pair.facets)
    assert np.isfinite(pair.multiplier)
