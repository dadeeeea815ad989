"""What every result can do: travel, be drawn, saved, read back, become a data frame, and be one line in a list."""

import json
import math
import pickle

import numpy as np
import pytest
from matplotlib.figure import Figure

import origami_nlp as o
from tests.computed_once import (
    panel_barriers,
    panel_contacts,
    panel_points,
    panel_result,
    shared,
)

pytest.importorskip("pandas")


@shared
def results():
    """One of each kind, by class."""
    scene = o.examples.degree6("pi/4", 0.01)
    result = panel_result(scene)
    points = panel_points(15)
    contacts = panel_contacts()
    found = [result, points, contacts, contacts.segments, o.find_space(scene, rings=8)]
    found += [panel_barriers(), o.find_landscape(result, size=21)]
    quick = {"full": False, "effort": "quick", "max_starts": 16}
    loaded = [o.load_path(scene, 1, to=0.01, **quick)]
    sheet = o.examples.pattern("metasheet:2x3")
    states = o.find_minima(sheet, starts=1, prove=False, escape=False)
    found += [o.analyze_mobility(sheet), o.find_motion(sheet)]
    loaded.append(o.load_path(sheet, 1, to=0.01, state=states.minima[0]))
    found.append(o.paper.cone.phase_diagram(6, size=4))
    phi = np.linspace(-1.5, 1.5, 61)
    found.append(o.fit_hinge(o.HingeData(phi, phi * (phi**2 - 1))))
    named = {type(one).__name__: one for one in found}
    named["MinimaResult of a pattern"] = states
    return {**named, "LoadPath": loaded[0], "LoadPath of a pattern": loaded[1]}


KINDS = {  # rows of the data frame, has a picture, has a schema, is read back
    "MinimaResult": (lambda r: len(r.minima), True, True, True),
    "CriticalPoints": (lambda r: len(r.points), False, True, True),
    "ContactReport": (
        lambda r: sum(len(s.minimum.contacts) for s in r.states),
        False,
        True,
        False,
    ),
    "SegmentReport": (lambda r: len(r.segments), False, True, False),
    "Space": (lambda r: len(r.components), False, True, False),
    "Barriers": (lambda r: len(r.passes), True, True, True),
    "ExactLandscape": (None, True, True, False),
    "PhaseDiagram": (None, True, True, False),
    "LoadPath": (lambda r: sum(len(leg.points) for leg in r.legs), True, True, True),
    "MeasuredHinge": (lambda r: len(r.angle), True, True, True),
    "MinimaResult of a pattern": (lambda r: len(r.minima), True, True, True),
    "Mobility": (lambda r: 1, True, True, True),
    "Motion": (lambda r: len(r.fold_angles), True, True, True),
    "LoadPath of a pattern": (lambda r: sum(len(leg.points) for leg in r.legs), True, True, True),
}
by_kind = pytest.mark.parametrize("kind", KINDS)
STRICT = (
    "MinimaResult",
    "MinimaResult of a pattern",
    "CriticalPoints",
    "Barriers",
    "LoadPath",
    "LoadPath of a pattern",
    "Motion",
)


def test_results_travel_and_print_the_same():
    model = results()["MinimaResult"].model
    model.energy(np.zeros(model.size))  # a model that was used
    for found in results().values():
        again = pickle.loads(pickle.dumps(found))
        assert str(again) == str(found) and len(str(found)) > 40
    result = results()["MinimaResult"]
    again = pickle.loads(pickle.dumps(result))
    zero = np.zeros(again.model.size)
    assert again.model.energy(zero) == result.model.energy(zero)


@by_kind
def test_rows_of_a_data_frame(kind):
    count, found = KINDS[kind][0], results()[kind]
    if count is None:
        with pytest.raises(o.OrigamiError, match=f"{kind}.*rows"):
            found.to_frame()
        return
    frame = found.to_frame()
    assert len(frame) == count(found)
    twice = o.to_frame(found, found)
    assert len(twice) == 2 * len(frame) and list(twice.index) == list(range(len(twice)))


def test_the_frame_of_minima_says_what_they_are():
    result = results()["MinimaResult"]
    frame = result.to_frame()
    phi = frame[[f"phi_{k}_rad" for k in range(1, 7)]].to_numpy()
    assert np.array_equal(phi, [m.fold_angles for m in result.minima])
    energies = result.scene.energy(phi)  # from the angles, not from the result
    assert np.allclose(frame["energy_J"], energies, rtol=1e-14, atol=0)
    assert list(frame["kind"]) == [m.kind for m in result.minima]
    barriers = results()["Barriers"]
    rows = barriers.to_frame()
    low = frame.set_index("number")["energy_J"]
    assert np.allclose(rows["energy_J"] - low[rows["from_state"]].to_numpy(), rows["rises_J"])
    contacts = results()["ContactReport"].to_frame()
    assert (contacts["least_N_m"] <= contacts["moment_N_m"] * (1 + 1e-9)).all()
    with pytest.raises(o.OrigamiError, match="results"):
        o.to_frame()
    with pytest.raises(o.OrigamiError, match=r"results\[2\]"):
        o.to_frame(result, result.minima)


@by_kind
def test_pictures(kind, tmp_path):
    found = results()[kind]
    if not KINDS[kind][1]:
        with pytest.raises(o.OrigamiError, match=f"{kind}.*picture"):
            found.draw()
        return
    path = tmp_path / "picture.png"
    figure = found.draw(path)
    assert isinstance(figure, Figure) and figure.axes
    assert path.read_bytes().startswith(b"\x89PNG")
    assert figure._repr_png_().startswith(b"\x89PNG")  # what a notebook shows


def test_tables_are_written_and_json_under_no_other_name(tmp_path):
    found = results()["MinimaResult"]
    text = found.to_csv(tmp_path / "states.csv")
    assert (tmp_path / "states.csv").read_bytes().decode() == text
    with pytest.raises(o.OrigamiError, match=r"to_csv\(path\) writes tables"):
        found.save(tmp_path / "again.csv")


@by_kind
def test_saved_and_read_back(kind, tmp_path):
    found, path = results()[kind], tmp_path / "result.json"
    _, _, has_schema, is_read = KINDS[kind]
    if not has_schema:
        with pytest.raises(o.OrigamiError, match=f"{kind}.*schema"):
            found.save(path)
        assert not path.exists()
        return
    found.save(path)
    if not is_read:
        for load in (o.read_result, type(found).load):
            with pytest.raises(o.OrigamiError, match="read back"):
                load(path)
        return
    for again in (o.read_result(path), type(found).load(path)):
        assert type(again) is type(found) and again.to_dict() == found.to_dict()
    other = "CriticalPoints" if kind.startswith("MinimaResult") else "MinimaResult"
    with pytest.raises(o.OrigamiError, match="schema"):
        type(results()[other]).load(path)
    path.write_text("{")
    with pytest.raises(o.OrigamiError, match="JSON"):
        type(found).load(path)


def broken(data):
    """Files that hold no such result: their text by what is wrong with them, and a word of the complaint."""
    first = next(k for k in ("minima", "pattern", *data) if isinstance(data.get(k), list | dict))
    of_another = {**data, "schema": "origami-nlp/paper/1"}
    text = json.dumps(data)
    yield text[: len(text) // 2], "JSON"
    yield "", "is empty"
    yield "[" * 100_000, "nested"
    yield "[]", "schema"
    yield json.dumps(of_another), "schema"
    yield json.dumps({k: v for k, v in data.items() if k != "schema"}), "schema"
    yield json.dumps({**data, first: math.nan}), "NaN"
    yield json.dumps({**data, first: {"a": 1}}), first
    yield json.dumps({**data, first: [{"a": 1}]}), first


@pytest.mark.parametrize("kind", [kind for kind, (*_, is_read) in KINDS.items() if is_read])
def test_what_is_not_whole_is_refused_in_one_line(kind, tmp_path):
    found, path = results()[kind], tmp_path / "broken.json"
    data, missing = found.to_dict(), set()
    for key in data:
        try:
            type(found).from_dict({k: v for k, v in data.items() if k != key})
        except o.OrigamiError as error:
            assert "\n" not in str(error) and (key in str(error) or key == "model")
            missing.add(key)
    assert len(missing) > 2  # some may be missing
    for text, word in broken(data):
        path.write_text(text)
        with pytest.raises(o.OrigamiError, match=word) as reported:
            type(found).load(path)
        assert "broken.json" in str(reported.value) and "\n" not in str(reported.value)
        assert len(str(reported.value)) < 500
    if kind in STRICT:
        with pytest.raises(o.OrigamiError, match="unknown key 'more'"):
            type(found).from_dict({**data, "more": 1})


@pytest.mark.parametrize("path", [None, 3, "", "no/such/folder/x.json", "\0"])
def test_paths_that_are_none(path):
    result = results()["MinimaResult"]
    calls = [result.save, o.MinimaResult.load, *[result.draw] * (path is not None)]
    for call in calls:
        with pytest.raises(o.OrigamiError):
            call(path)
