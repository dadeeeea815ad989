"""What is written is read again as the same pattern; what a laser does is measured, also by programs of others."""

from __future__ import annotations

import importlib.util
import json
import math
import re
import shutil
import subprocess
from itertools import pairwise
from xml.etree import ElementTree

import numpy as np
import pytest
from shapely import LineString, MultiLineString, unary_union

import origami_nlp as o
from origami_nlp.drawings import WriteOptions, read_drawing, write_drawing
from origami_nlp.pattern import examples, frame_drawing, parse_fold, read_fold
from tests.command_line import run

SVG = "{http://www.w3.org/2000/svg}"
NAMES = ("miura:4x4", "waterbomb:3x3", "squaretwist", "yoshimura:3x3")
ENDINGS = (".svg", ".cp", ".opx", ".dxf")
DIGITS = {".svg": 0.0, ".cp": 0.0, ".opx": 0.0, ".dxf": 1e-12}
"""Relative error of coordinates that a format may make."""


def needs(ending: str) -> None:
    if ending == ".dxf" and importlib.util.find_spec("ezdxf") is None:
        pytest.skip("ezdxf is not here")


def flat(name: str):
    (frame,) = parse_fold(json.dumps(examples.crease_pattern(name)))
    return frame


def edges(frame) -> dict[frozenset, tuple[str, float]]:
    """Of each edge its letter and fold angle [deg], by its ends to nine digits."""
    size = np.ptp(frame.coords)
    at = [tuple((np.round(p / size, 9) + 0.0).tolist()) for p in frame.coords]
    rows = zip(frame.edges.tolist(), frame.assignment, np.degrees(frame.fold_angles), strict=True)
    return {frozenset((at[a], at[b])): (letter, angle) for (a, b), letter, angle in rows}


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("name", NAMES)
def test_a_pattern_comes_back_from_each_format(tmp_path, name, ending):
    needs(ending)
    there, back = tmp_path / f"a{ending}", tmp_path / "b.fold"
    first = flat(name)
    o.convert(name, there)
    o.convert(there, back)
    (again,) = read_fold(back)
    one, other = edges(first), edges(again)
    assert one.keys() == other.keys()
    assert {k: letter for k, (letter, _) in one.items()} == {
        k: letter for k, (letter, _) in other.items()
    }
    x = np.sort(first.coords[:, 0]) - np.sort(again.coords[:, 0])
    assert np.abs(x).max() <= DIGITS[ending] * np.ptp(first.coords)
    if ending == ".svg":
        off = [abs(one[k][1] - other[k][1]) for k in one if one[k][0] in "MV"]
        assert max(off) <= 1e-9
    assert len(o.read_pattern(there).polygons) == len(o.read_pattern(back).polygons)


def test_fold_angles_come_back_from_opacity_alone(tmp_path):
    rng = np.random.default_rng(5)
    data = examples.crease_pattern("miura:3x3")
    signs = {"M": -1.0, "V": 1.0}
    phi = [signs.get(a, 0.0) * rng.uniform(0.1, 180) for a in data["edges_assignment"]]
    data["edges_foldAngle"] = phi
    path = tmp_path / "a.fold"
    path.write_text(json.dumps(data))
    o.convert(path, tmp_path / "a.svg")
    text = (tmp_path / "a.svg").read_text()
    bare = re.sub(r' data-\w+="[^"]*"', "", text)
    assert bare != text
    for drawn in (text, bare):
        made = read_drawing(drawn.encode(), ".svg")
        got = sorted(a for a in made.angles if not math.isnan(a))
        np.testing.assert_allclose(got, sorted(a for a in phi if a), atol=1e-9)


def laser(name: str = "waterbomb:3x3", **options):
    drawing = frame_drawing(flat(name))
    text, notes = write_drawing(drawing, ".svg", WriteOptions("laser", size=150.0, **options))
    root = ElementTree.fromstring(text)
    layers = {}
    for group in root.findall(f"{SVG}g"):
        shapes = []
        for path in group.findall(f"{SVG}path"):
            numbers = [float(n) for n in re.findall(r"-?[\d.]+", path.get("d"))]
            points = list(zip(numbers[::2], numbers[1::2], strict=True))
            shapes.append(points + points[:1] * path.get("d").endswith("Z"))
        layers[group.get("id")] = (group, shapes)
    return drawing, root, layers, notes


def creases(drawing, letters: str) -> np.ndarray:
    """Ends of creases as they stand on the page of 150 mm, [E, 2, 2]."""
    low, high = drawing.points.min(axis=0), drawing.points.max(axis=0)
    page = (drawing.points - [low[0], high[1]]) * [1, -1] * 150 / (high - low).max() + 5
    keep = [letter in letters for letter in drawing.letters]
    return page[drawing.edges[keep]]


def test_a_laser_file_has_layers_in_order_and_true_size():
    drawing, root, layers, _ = laser(holes=1.0)
    assert list(layers) == [
        "VALLEY",
        "MOUNTAIN",
        "HOLES",
        "BORDER",
    ]  # inside first, then the outline
    assert root.get("width").endswith("mm") and root.get("height").endswith("mm")
    box = [float(v) for v in root.get("viewBox").split()]
    assert float(root.get("width")[:-2]) == box[2] and float(root.get("height")[:-2]) == box[3]
    outline = np.concatenate([np.array(s) for s in layers["BORDER"][1]])
    assert np.ptp(outline, axis=0).max() == pytest.approx(150.0, abs=1e-5)
    assert len({group.get("stroke") for group, _ in layers.values()}) == 4
    assert {group.get("stroke-width") for group, _ in layers.values()} == {"0.025"}
    drawn = unary_union(MultiLineString(list(creases(drawing, "B")))).length
    assert sum(LineString(s).length for s in layers["BORDER"][1]) == pytest.approx(drawn, rel=1e-6)


@pytest.mark.parametrize("name", ["waterbomb:3x3", "miura:4x4"])
def test_each_line_is_there_once_and_straight_runs_are_one(name):
    drawing, _, layers, _ = laser(name)
    shapes = [LineString(s) for _, those in layers.values() for s in those]
    total = sum(s.length for s in shapes)
    assert total == pytest.approx(unary_union(shapes).length, rel=1e-7)
    whole = unary_union(MultiLineString(list(creases(drawing, "MVB"))))
    assert total == pytest.approx(whole.length, rel=1e-6)
    assert unary_union(shapes).hausdorff_distance(whole) < 1e-5
    folds = sum(len(layers[n][1]) for n in ("MOUNTAIN", "VALLEY"))
    straight = 0  # how often an edge goes on in another of its letter
    for letter in "MV":
        mine = creases(drawing, letter)
        both = np.concatenate([mine, mine[:, ::-1]])
        d = both[:, 1] - both[:, 0]
        d /= np.linalg.norm(d, axis=1, keepdims=True)
        met = np.linalg.norm(both[:, None, 0] - both[None, :, 0], axis=2) < 1e-6
        straight += int((met & (d @ d.T < -1 + 1e-12)).sum()) // 2
    assert folds == len(creases(drawing, "MV")) - straight
    assert (straight > 0) == (name == "waterbomb:3x3")


@pytest.mark.parametrize("holes", [0.0, 1.5])
def test_dashes_are_segments_that_never_meet(holes):
    on, gap = 3.0, 1.0
    drawing, _, layers, notes = laser(dash=(on, gap), holes=holes)
    assert not notes
    dashes = np.array([s for n in ("MOUNTAIN", "VALLEY") for s in layers[n][1]])
    np.testing.assert_allclose(np.linalg.norm(dashes[:, 1] - dashes[:, 0], axis=1), on, atol=1e-5)
    for a, b in creases(drawing, "MV"):
        along, length = (b - a) / np.linalg.norm(b - a), np.linalg.norm(b - a)
        t = (dashes - a) @ along
        off = np.abs((dashes - a) @ [-along[1], along[0]])
        mine = (off < 1e-4).all(axis=1) & (t > 0).all(axis=1) & (t < length).all(axis=1)
        own = np.sort(t[mine], axis=1)
        own = own[own[:, 0].argsort()]
        assert len(own) >= 1
        starts = [0.0, *own[:, 1]]
        ends = [*own[:, 0], length]
        assert min(e - s for s, e in zip(starts, ends, strict=True)) >= gap - 1e-5
        inner = [e - s for s, e in pairwise(own.ravel())][1::2]  # gaps between dashes are alike
        assert np.ptp([-x if x < 0 else x for x in inner] or [0.0]) < 1e-4
    if holes:
        circles = layers["HOLES"][0].findall(f"{SVG}circle")
        where = np.array([(float(c.get("cx")), float(c.get("cy"))) for c in circles])
        assert len(where) == len(examples.pattern("waterbomb", 3, 3).vertices)
        gaps = np.linalg.norm(dashes.reshape(-1, 1, 2) - where, axis=2)
        assert gaps.min() >= holes + gap - 1e-5
        assert {c.get("r") for c in circles} == {"1.500000"}


def test_creases_shorter_than_a_dash_are_named():
    *_, layers, notes = laser(dash=(40.0, 3.0))
    assert any("shorter than a dash and two gaps" in note for note in notes)
    assert all(LineString(s).length > 1 for s in layers["MOUNTAIN"][1])


def test_flat_edges_are_no_creases_of_a_laser_and_windows_come_before_the_outline():
    text = b"".join(
        b"1 %g %g %g %g\n" % (*a, *b)
        for ring in ([(0, 0), (9, 0), (9, 9), (0, 9)], [(3, 3), (6, 3), (6, 6), (3, 6)])
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True)
    )
    made = read_drawing(text + b"2 0 0 3 3\n3 6 6 9 9\n4 0 9 3 6\n", ".cp")
    out, notes = write_drawing(made, ".svg", WriteOptions("laser", scale=10.0))
    assert notes == ("1 flat edges (F) are no creases: left out",)
    border = out[out.index('id="BORDER"') :]
    assert border.count("<path") == 2 and border.count("Z") == 2
    first, second = re.findall(r'd="M([^"]*)"', border)
    assert np.ptp([float(n) for n in re.findall(r"[\d.]+", first)]) < 35
    assert np.ptp([float(n) for n in re.findall(r"[\d.]+", second)]) > 85


@pytest.mark.parametrize(
    ("options", "why"),
    [
        ({"style": "laser"}, "no unit of length is stated"),
        ({"style": "carve"}, "must be one of"),
        ({"style": "laser", "scale": 1.0, "size": 2.0}, "give one of them"),
        ({"style": "laser", "scale": -1.0}, "must be positive"),
        ({"dash": (1.0, 1.0)}, "for lasers"),
        ({"style": "laser", "size": 10.0, "dash": (1.0, 0.0)}, "two lengths"),
        ({"style": "bench", "kind": ".cp"}, r"\.cp is written for simulator"),
    ],
)
def test_what_cannot_be_written_is_refused(options, why):
    kind = options.pop("kind", ".svg")
    drawing = frame_drawing(flat("miura:2x2"))
    with pytest.raises(o.OrigamiError, match=why):
        write_drawing(drawing, kind, WriteOptions(**options))


def test_a_page_for_the_bench_has_the_fold_angles_of_the_state(tmp_path):
    result = o.find_minima(examples.pattern("miura", 2, 2))
    o.write_fold(result, tmp_path / "states.fold")
    for k, state in enumerate(result.minima, start=1):
        made = o.convert(
            tmp_path / "states.fold", tmp_path / "b.svg", frame=k, write=WriteOptions("bench")
        )
        texts = [t.text for t in ElementTree.parse(tmp_path / "b.svg").iter(f"{SVG}text")]
        degrees = np.degrees(state.fold_angles)
        assert sorted(texts) == sorted(
            f"{i}: {a:+.1f}\u00b0" for i, a in enumerate(degrees, start=1)
        )
        assert "no size is known" in made.notes[-1]


def test_the_command_writes_and_says_what_it_did(tmp_path):
    done = run("convert", "miura:3x3", tmp_path / "a.svg")
    assert done.code == 0 and "written:" in done.out
    done = run("convert", tmp_path / "a.svg", tmp_path / "b.dxf", "--colour", "red")
    assert done.code == 2 and "KEY=LETTER" in done.err
    swapped = run("convert", tmp_path / "a.svg", tmp_path / "b.cp", "--colour", "red=V")
    assert swapped.code == 0 and "(12 V, 12 B)" in swapped.out
    done = run("convert", tmp_path / "a.svg", tmp_path / "b.txt")
    assert done.code == 2 and "must end in one of" in done.err


def query(path, *words) -> str:
    return subprocess.run([*words, str(path)], capture_output=True, text=True, timeout=300).stdout


@pytest.mark.skipif(shutil.which("inkscape") is None, reason="Inkscape is not here")
def test_inkscape_measures_the_same_lengths(tmp_path):
    path = tmp_path / "laser.svg"
    o.convert("waterbomb:3x3", path, write=WriteOptions("laser", size=150.0))
    rows = [line.split(",") for line in query(path, "inkscape", "--query-all").splitlines()]
    sizes = {row[0]: [float(v) / 96 * 25.4 for v in row[3:5]] for row in rows}
    assert max(sizes["BORDER"]) == pytest.approx(150.0 + 0.025, abs=1e-3)  # with its stroke
    assert {"MOUNTAIN", "VALLEY"} <= sizes.keys()


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("soffice") is None, reason="LibreOffice is not here")
def test_libreoffice_shows_the_whole_drawing(tmp_path):
    needs(".dxf")
    path = tmp_path / "laser.dxf"
    o.convert("waterbomb:3x3", path, write=WriteOptions("laser", size=150.0))
    words = ["soffice", "--headless", "--convert-to", "svg:draw_svg_Export", "--outdir"]
    query(path, *words, str(tmp_path))
    shown = re.findall(
        r'stroke="rgb\(255,0,0\)" d="M ([^"]*) Z"', (tmp_path / "laser.svg").read_text()
    )
    outlines = [[float(n) for n in re.findall(r"-?\d+", one)] for one in shown]
    best = max((np.array(one).reshape(-1, 2) for one in outlines), key=len)
    # it makes every DXF 10 cm long: what is left to hold against it are the proportions
    width, height = np.ptp(best, axis=0)
    low, high = (getattr(flat("waterbomb:3x3").coords[:, :2], f)(axis=0) for f in ("min", "max"))
    assert width / height == pytest.approx((high - low)[0] / (high - low)[1], rel=1e-3)


def test_dxf_states_millimetres_and_its_extents(tmp_path):
    needs(".dxf")
    import ezdxf

    path = tmp_path / "laser.dxf"
    o.convert("waterbomb:3x3", path, write=WriteOptions("laser", size=150.0, holes=2.0))
    document = ezdxf.readfile(path)
    assert document.units == 4  # mm
    assert max(document.header["$EXTMAX"]) == pytest.approx(150.0)
    space = document.modelspace()
    (outline,) = space.query('LWPOLYLINE[layer=="BORDER"]')
    corners = np.array(outline.get_points("xy"))
    assert outline.closed and np.ptp(corners, axis=0).max() == pytest.approx(150.0)
    assert [e.dxf.layer for e in space][-1] == "BORDER"
    assert {c.dxf.radius for c in space.query("CIRCLE")} == {2.0}
    before = path.read_bytes()
    o.convert("waterbomb:3x3", path, write=WriteOptions("laser", size=150.0, holes=2.0))
    assert before == path.read_bytes()


def test_what_fold_to_fold_leaves_out_is_named(tmp_path):
    data = examples.crease_pattern("miura:2x2")
    edges = len(data["edges_vertices"])
    data["edges_origaminlp:stiffness"] = [1.0] * edges
    data["edges_origaminlp:limits"] = [[-90.0, 90.0]] * edges
    (tmp_path / "stated.fold").write_text(json.dumps(data))
    notes = o.convert(tmp_path / "stated.fold", tmp_path / "drawn.fold").notes
    assert any("rest angles, fold limits of the file: left out" in n for n in notes)
