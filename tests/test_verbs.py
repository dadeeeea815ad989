"""One function a question, whether it is asked of a vertex or of a pattern."""

import json

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern_states import find_states

PATTERN = "metasheet:3x3"


@pytest.fixture(scope="module")
def found():
    return o.find_minima(PATTERN, starts=4, escape=False)


def test_a_scene_and_a_pattern_are_searched_by_one_function(found):
    scene = o.examples.degree6("pi/4", ratio=0.01)
    result = o.find_minima(scene, max_starts=16, escape=False)
    assert len(result.minima) == 2
    contacts = [c for m in result.to_dict()["minima"] for c in m["contacts"]]
    assert contacts and not any(
        "contact" in c for c in contacts
    )  # the kernel's numbers stay inside
    same = find_states(PATTERN, starts=4, escape=False).minima
    assert [m.energy for m in found.minima] == [m.energy for m in same]


def test_what_is_no_contact_is_named():
    for origami in (o.examples.waterbomb(), PATTERN):
        with pytest.raises(o.OrigamiError, match=r"^contact = False "):
            o.find_minima(origami, contact=False)
    with pytest.raises(o.OrigamiError, match=r"^effort = 'much' is unknown: "):
        o.find_minima(PATTERN, effort="much")


def test_load_path_takes_the_same_arguments_of_both(found):
    (folded, *_) = [m for m in found.minima if np.any(m.fold_angles)]
    path = o.load_path(PATTERN, 1, to=0.01, effort="quick", max_starts=2)
    assert path.legs[0].points[-1].t == pytest.approx(0.01)
    path = o.load_path(found.pattern, 1, to=0.01, state=folded)
    assert path.legs[0].points[-1].t == pytest.approx(0.01)
    path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=0.01, starts=3)
    assert path.legs[0].points[-1].t == pytest.approx(0.01)
    for wrong in ({"effort": "much"}, {"starts": -1}, {"max_starts": 0}, {"seed": 0.5}):
        (name,) = wrong
        with pytest.raises(o.OrigamiError, match=f"^{name} = "):
            o.load_path(PATTERN, 1, **wrong)


def test_a_cap_on_starts_of_a_pattern_counts_those_that_are_drawn():
    search = o.find_minima("miura:2x2", max_starts=3, escape=False).search
    assert search.drawn == 3 < o.find_minima("miura:2x2", starts=4, escape=False).search.drawn


def test_a_scene_file_is_a_scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(o.format_scene(o.examples.degree6("pi/4", ratio=0.01)))
    one = o.find_minima(path, max_starts=16, escape=False, prove=False)
    assert [m.kind for m in one.minima] == ["interior", "contact-touching"]


def test_states_of_a_pattern_go_to_a_file_and_come_back(found, tmp_path):
    path = tmp_path / "states.fold"
    o.write_fold(found, path)
    frames = json.loads(path.read_text())["file_frames"]
    assert len(frames) == len(found.minima)
    for frame, state in zip(frames, found.minima, strict=True):
        angles = np.radians(frame["edges_foldAngle"][: len(state.fold_angles)])
        assert np.abs(angles - state.fold_angles).max() < 1e-12
    again = o.read_pattern(path)
    assert o.classify(again, found.minima[0].fold_angles).verdict == "minimum"
