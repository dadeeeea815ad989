"""The figure and the HTML: what is in them, nothing on top of something else, nothing global."""

import dataclasses
import io
import itertools
import math
from html import escape

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text

import origami_nlp as o
from origami_nlp.display import KINDS, MOUNTAIN, VALLEY, draw_state
from tests.computed_once import PANELS, panel_result, shared, thinned

COARSE = 21  # cells of the landscape: the pictures are not looked at here

SCENES = {
    "degree 6, handles and a family": o.examples.degree6("pi/3", 1),
    "degree 6": o.examples.degree6("pi/4", 1),
    "degree 8": o.examples.degree8("pi/12", 100),
    "one degree of freedom": o.Scene(
        o.Vertex(("pi/3", "2*pi/3", "2*pi/3", "pi/3")), (1,) * 4, (1, 1, -1, 1), "D1"
    ),
    "no chart": o.Scene(
        o.Vertex(("pi/3", "pi/3", "pi/2", "pi/3", "pi/2")), (1,) * 5, (1, -1, 1, -1, 1), "none"
    ),
    "no contact": o.examples.degree8("pi/12", 1, contact="none"),
}


@shared
def searched(name):
    return o.find_minima(SCENES[name], max_starts=64, escape=False)


class Results:
    """Of the scenes, each searched when it is asked for."""

    def __getitem__(self, name):
        scene = SCENES[name]
        return panel_result(scene) if scene in PANELS else searched(name)


@pytest.fixture(scope="module")
def results():
    return Results()


def texts(figure):
    """Visible texts with their boxes in pixels."""
    figure.draw_without_rendering()
    found = []
    unseen = (
        set()
    )  # labels of ticks beyond the ends of an axis, which matplotlib makes and does not draw
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        low, high = sorted(axis.get_view_interval())
        slack = 1e-9 * (high - low)
        unseen |= {
            tick.label1
            for tick in axis.get_major_ticks()
            if not low - slack <= tick.get_loc() <= high + slack
        }
    for text in figure.findobj(Text):
        if text in unseen:
            continue
        if not text.get_visible() or not text.get_text().strip() or not text.get_figure():
            continue
        found.append((text.get_text(), text.get_window_extent()))
    return found


def overlapping(figure):
    """Pairs of texts whose boxes, less the leading that surrounds letters, overlap."""
    pairs = []
    for (a, p), (b, q) in itertools.combinations(texts(figure), 2):
        dx = min(p.x1, q.x1) - max(p.x0, q.x0)
        dy = min(p.y1, q.y1) - max(p.y0, q.y0)
        if dx > 0.25 * min(p.width, q.width) and dy > 0.35 * min(p.height, q.height):
            pairs.append((a, b))
    return pairs


def outside(figure):
    width, height = figure.get_size_inches() * figure.dpi
    return [
        t
        for t, box in texts(figure)
        if box.x0 < -1 or box.y0 < -1 or box.x1 > width + 1 or box.y1 > height + 1
    ]


@pytest.mark.parametrize("name", thinned([*SCENES][1:], 5))
def test_figures_are_complete_and_tidy(results, name, tmp_path):
    result = results[name]
    path = tmp_path / "figure.png"
    figure = o.draw_minima(result, path, size=COARSE)
    assert imread(path).shape[2] in (3, 4)
    assert not overlapping(figure)
    assert not outside(figure)
    written = "\n".join(text for text, _ in texts(figure))
    said, printed = " ".join(written.split()), " ".join(str(result).split())
    for row in result.rows:  # the picture and the table say the same
        assert f"{row.number}: U = {row.energy:.4g} J, {row.stability} {row.kind}" in said
        assert f"{row.number} {row.energy:.6g} {row.stability.split()[0]}" in printed


@pytest.mark.parametrize("name", thinned([n for n in SCENES if n != "no chart"][::-1], 9))
def test_every_minimum_is_marked_whole(results, name):
    """A marker of its kind at its place, not clipped at the border."""
    result = results[name]
    figure = o.draw_minima(result, size=COARSE)
    marks = [line for axes in figure.axes for line in axes.get_lines() if line.get_gid() == "mark"]
    # beyond |phi| = pi there is no landscape to mark them on: the figure says so
    inside = [m for m in result.minima if np.abs(m.fold_angles).max() <= math.pi + 1e-9]
    assert len(marks) == len(inside) > 0
    said = any("Not on the landscape" in text for text, _ in texts(figure))
    assert said == (len(inside) < len(result.minima))
    width, height = figure.get_size_inches() * figure.dpi
    for m in inside:
        same = [k for k in marks if k.get_marker() == KINDS[m.kind].marker]
        assert same
    for mark in marks:
        assert not mark.get_clip_on()
        (x, y) = mark.axes.transData.transform(mark.get_xydata()[0])
        assert 0 < x < width and 0 < y < height


@pytest.mark.parametrize("name", ["figure", "figure.xyz", "figure.json"])
def test_unknown_format(results, name, tmp_path):
    with pytest.raises(o.OrigamiError, match="picture format"):
        o.draw_minima(results["no chart"], tmp_path / name)
    assert not list(tmp_path.iterdir())


def picture(vertex, phi):
    """Axes with a state, and the colours of its creases."""
    axes = Figure().add_subplot()
    draw_state(axes, vertex, phi)
    lines = [c for c in axes.collections if c.get_paths()]
    return axes, {to_hex(c.get_colors()[0]) for c in lines} & {MOUNTAIN, VALLEY}


def test_flat_sheet_is_seen_from_above_and_numbered():
    axes, _ = picture(o.Vertex(("pi/2",) * 4), np.zeros(4))
    assert [t.get_text() for t in axes.texts] == ["1", "2", "3", "4"]
    places = np.array([t.get_position() for t in axes.texts])
    x, y = places[:, 0], places[:, 1]
    assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) > 0  # still counter-clockwise


def test_mountains_are_red_and_valleys_blue():
    vertex = o.Vertex(("pi/2",) * 4)
    assert picture(vertex, [1.0, 0, 1.0, 0])[1] == {VALLEY}
    assert picture(vertex, [-1.0, 0, -1.0, 0])[1] == {MOUNTAIN}
    assert not picture(vertex, [0, 0, 0, 0])[1]


def test_html_escapes_names(results):
    result, name = results["no chart"], "<script>alert(1)</script> & $x_1$"
    scene = dataclasses.replace(result.scene, name=name)
    result = dataclasses.replace(result, origami=scene, minima=())
    html = result.to_html()
    assert "<script" not in html and escape(name) in html
    o.draw_minima(result).savefig(io.BytesIO())  # a name is no formula
