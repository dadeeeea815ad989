"""What is written is read again as the same pattern; lengths are measured, also by programs of others."""

from __future__ import annotations

import importlib.util
import json
import math
import re

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.drawings import read_drawing
from origami_nlp.pattern import examples, parse_fold, read_fold

NAMES = ("miura:4x4", "waterbomb:3x3", "squaretwist", "yoshimura:3x3")
ENDINGS = (".svg", ".cp", ".dxf")
DIGITS = {".svg": 0.0, ".cp": 0.0, ".dxf": 1e-12}
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
    assert all(one[k][0] == other[k][0] for k in one)
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


def test_dxf_states_millimetres_and_its_extents(tmp_path):
    needs(".dxf")
    import ezdxf

    path = tmp_path / "sized.dxf"
    o.convert("waterbomb:3x3", path, size=150.0)
    document = ezdxf.readfile(path)
    assert document.units == 4  # mm
    lines = document.modelspace().query("LINE")
    ends = np.array([(p.x, p.y) for one in lines for p in (one.dxf.start, one.dxf.end)])
    assert np.ptp(ends, axis=0).max() == pytest.approx(150.0)
    before = path.read_bytes()
    o.convert("waterbomb:3x3", path, size=150.0)
    assert before == path.read_bytes()
