"""Each format says what its own programs mean by it; what is odd, hostile or unknown is refused or listed."""

from __future__ import annotations

import importlib.util
import io
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.drawings import DrawingOptions, read_drawing
from origami_nlp.drawings.cp import read_cp
from origami_nlp.drawings.opx import read_opx
from origami_nlp.drawings.svg import path_chains, read_svg
from origami_nlp.pattern import parse_fold
from tests.hostile.__main__ import beans

PLAIN = DrawingOptions()
dxf_there = pytest.mark.skipif(
    importlib.util.find_spec("ezdxf") is None, reason="ezdxf is not here"
)


def svg(body: str, options: DrawingOptions = PLAIN, head: str = ""):
    text = f'<svg xmlns="http://www.w3.org/2000/svg" {head}>{body}</svg>'
    return read_svg(text.encode(), "it", options)


LINE = '<line x1="0" y1="0" x2="1" y2="0" {}/>'


@pytest.mark.parametrize(
    ("look", "letter"),
    [
        ('stroke="#000"', "B"),
        ('stroke="red"', "M"),
        ('stroke="#0000FF"', "V"),
        ('stroke="rgb(0, 255, 0)"', "C"),
        ('stroke="lime"', "C"),
        ('style="fill:none; stroke: yellow"', "F"),
        ('style="stroke:#f0f"', "U"),
        ('stroke="#808080"', "F"),
        ('stroke="blue" style="stroke:red !important"', "M"),
        ('stroke="blue" data-assignment="U"', "U"),
    ],
)
def test_a_stroke_says_what_a_line_is(look, letter):
    assert svg(LINE.format(look)).letters == (letter,)


@pytest.mark.parametrize("colour", ["green", "#EE1032", "rgb(254,0,0)", "url(#a)", "currentColor"])
def test_other_colours_are_listed_and_can_be_named(colour):
    with pytest.raises(o.OrigamiError):
        svg(LINE.format(f'stroke="{colour}"'))
    named = svg(LINE.format(f'stroke="{colour}"'), DrawingOptions(letters={colour: "V"}))
    assert named.letters == ("V",)
    both = svg(LINE.format('stroke="red"') + LINE.format(f'stroke="{colour}"'))
    assert both.letters == ("M",)


@pytest.mark.parametrize(
    ("inside", "outside", "angle"),
    [
        ('stroke="red" opacity="0.5"', "", -90.0),
        ('stroke="blue" stroke-opacity="0.5"', "", 90.0),
        ('stroke="blue" stroke-opacity="0.5" opacity=".5"', "", 45.0),
        ('stroke="blue" stroke-opacity="50%"', "", 90.0),
        ('stroke="blue"', 'stroke-opacity="0.25"', 45.0),  # inherited
        ('stroke="blue"', 'opacity="0.25"', math.nan),  # of the group: not the line's own
        ('stroke="blue" opacity="0"', "", math.nan),
        ('stroke="red" data-foldAngle="-12.5" opacity="0.9"', "", -12.5),
        ('stroke="black" opacity="0.5"', "", math.nan),
    ],
)
def test_opacity_is_the_fold_angle(inside, outside, angle):
    found = svg(f"<g {outside}>{LINE.format(inside)}</g>")
    np.testing.assert_allclose(found.angles, [angle], rtol=1e-15)


def test_style_sheets_reach_tags_classes_and_ids():
    sheet = """<style>/* red {} */ @import url(x); line {stroke: black} .m, .x {stroke: red} #v {stroke: blue}
      .half {stroke-opacity: 0.5} g line, line:hover {stroke: lime}</style>"""
    found = svg(
        sheet
        + LINE.format("")
        + LINE.format('class="a m"')
        + LINE.format('class="m" id="v"')
        + "<g>"
        + LINE.format('class="m half"')
        + "</g>"
    )
    assert found.letters == ("B", "M", "V", "M")
    np.testing.assert_allclose(found.angles, [math.nan, math.nan, math.nan, -90.0])
    assert found.notes[0] == "style sheet, selectors left out: g line, line:hover"


def test_transforms_apply_from_the_right():
    inner = LINE.format('stroke="red" transform="translate(10,0) rotate(90) scale(2)"')
    found = svg(f'<g transform="matrix(1 0 0 1 0 5)">{inner}</g>')
    # (1, 0) -> (2, 0) -> (0, 2) -> (10, 2) -> (10, 7), and y turned up
    np.testing.assert_allclose(found.ends, [[[10, -5], [10, -7]]], atol=1e-15)
    turned = svg(LINE.format('stroke="red" transform="rotate(180 1 1) skewX(0)"'))
    np.testing.assert_allclose(turned.ends, [[[2, -2], [1, -2]]], atol=1e-15)


def test_shapes_become_lines():
    found = svg(
        '<g stroke="red"><rect x="1" width="2" height="3"/><polyline points="0,0 1 0,1,1"/>'
        '<polygon points="0 0 1 0 1 1"/><path d="m0 0 1 0h1v-1z M5 5"/><circle r="3"/></g>'
        '<defs><path stroke="red" d="M0 0h9"/></defs><g display="none"><rect stroke="red"/></g>'
        '<line stroke="red" x1=" 1mm" x2="0"/>'
    )
    assert len(found.letters) == 4 + 2 + 3 + 4 + 1
    assert {"1 <circle> left out", "1 hidden shapes left out"} <= set(found.notes)
    np.testing.assert_allclose(found.ends[-1, 0], [96 / 25.4, 0])


def test_curves_are_refused_or_left_out():
    arc = '<path stroke="red" d="M0 0 A1 1 0 012 0 L3 0"/>'
    with pytest.raises(o.OrigamiError, match="1 curves"):
        svg(arc)
    assert len(svg(arc, DrawingOptions(curves="leave")).letters) == 1
    # handles on their chord: no curve
    assert path_chains("M0 0 C1 1 2 2 3 3") == ([[(0.0, 0.0), (3.0, 3.0)]], 0)


def test_paths_go_on_as_svg_says():
    path = "M0 0 C0 1 1 1 1 0 S2 -1 2 0 q.5 1 1 0 t1 0 h1"
    assert path_chains(path) == ([[(4.0, 0.0), (5.0, 0.0)]], 4)
    assert path_chains("L1 1")[0] == []
    assert path_chains("M0 0 1 1z l2 0")[0][1] == [(0.0, 0.0), (2.0, 0.0)]


def test_entities_do_not_hide_in_another_encoding():
    bomb = '<?xml version="1.0" encoding="UTF-16"?><!DOCTYPE a [<!ENTITY b "c">]><svg>&b;</svg>'
    with pytest.raises(o.OrigamiError, match="defines XML entities"):
        read_drawing(bomb.encode("utf-16"), ".svg")
    doctype = b'<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://x/y.dtd">'
    harmless = doctype + b'<svg><path stroke="red" d="M0 0h1"/></svg>'
    assert read_svg(harmless, "it", PLAIN).letters == ("M",)


def test_lines_of_cp():
    text = b"\xef\xbb\xbf1 0 0 4 0\r\n2\t0 0 1e0 -2.5\n\n3 0 0 1 1\n4 0 0 1 2\njunk\n7 0 0 1 1\n2 0 0 nan 1\n"
    (frame,) = parse_fold(text.removeprefix(b"\xef\xbb\xbf"), source="a.cp")
    found = read_cp(text.removeprefix(b"\xef\xbb\xbf"), "it", PLAIN)
    assert found.letters == ("B", "M", "V", "F")
    np.testing.assert_array_equal(found.ends[1], [[0, 0], [1, 2.5]])  # y down in the file
    assert set(found.notes) <= set(frame.notes)
    with pytest.raises(o.OrigamiError, match="no lines to fold; 2 lines left out"):
        read_cp(b"hello\nworld", "it", PLAIN)


def test_beans_of_opx():
    rows = ("1 0 0 4 0", "2 0 0 0 1", "3 1 0 0 0", "4 2 0 0 0", "0 3 0 0 0", "2 NaN 0 0 0", "")
    found = read_opx(beans("\n".join(rows), "Crane $x$"), "it", PLAIN)
    assert found.letters == ("B", "M", "V", "U", "F")  # 4 is unassigned here, auxiliary in .cp
    assert found.title == "Crane $x$"
    np.testing.assert_array_equal(found.ends[1], [[0, 0], [0, -1]])
    assert any("1 lines left out" in note for note in found.notes)


@dxf_there
def test_layers_of_dxf_come_before_colours():
    import ezdxf

    document = ezdxf.new("R12")
    for layer, colour in (("MountainLine", 5), ("ValleyLine", 1), ("CutLine", 250), ("folds", 1)):
        document.layers.add(layer, color=colour)
    space = document.modelspace()
    for k, layer in enumerate(("MountainLine", "ValleyLine", "CutLine", "folds", "0")):
        space.add_line((0, k), (1, k), dxfattribs={"layer": layer})
    space.add_polyline2d([(0, 9), (1, 9), (1, 8)], dxfattribs={"layer": "AuxiliaryLine"})
    block = document.blocks.new("two")
    block.add_line((0, 0), (1, 0), dxfattribs={"color": 5})
    space.add_blockref("two", (5, 5), dxfattribs={"xscale": 2})
    space.add_circle((0, 0), 1, dxfattribs={"color": 1})
    text = io.StringIO()
    document.write(text)
    from origami_nlp.drawings.dxf import read_dxf

    with pytest.raises(o.OrigamiError, match="curves"):
        read_dxf(text.getvalue().encode(), "it", PLAIN)
    found = read_dxf(text.getvalue().encode(), "it", DrawingOptions(curves="leave"))
    assert "".join(found.letters) == "MVBMBFF"  # ORIPA's older colours contradict
    assert "1 INSERT left out" in found.notes
    np.testing.assert_array_equal(found.ends[1], [[0, 1], [1, 1]])  # y up
    asked = DrawingOptions(curves="leave", letters={"folds": "V", "MountainLine": "-"})
    assert read_dxf(text.getvalue().encode(), "it", asked).letters[:3] == ("V", "B", "V")
    with pytest.raises(o.OrigamiError, match="is no DXF file"):
        read_dxf(b"0\nSECTION\nnonsense", "it", PLAIN)
