"""Every figure speaks one language: labels cover nothing, legends explain every mark, grey and dichromats see it."""

import dataclasses
import itertools

import pytest
from hypothesis import given, settings, strategies as st
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

import origami_nlp as o
from origami_nlp.barriers import draw_barriers
from origami_nlp.chart import landscape
from origami_nlp.display import (
    KINDS,
    PASSES,
    VERDICTS,
    label_marks,
    mark_minimum,
)
from origami_nlp.paper import draw_landscape
from tests.computed_once import PANELS, panel_barriers, panel_boundary, panel_result, thinned

TRACED = [o.examples.degree6("pi/4"), o.examples.degree6("pi/3"), o.examples.degree8("pi/12", 0.01)]
"""Of these panels other tests have the boundary."""
STRETCHES = (6, 8, 9)
"""Panels whose metastable stretches are looked for: the two that have some, and one that has none."""


def drawn(number):
    """The landscape of a panel: the colours are coarse, the boundary is that of its geometry."""
    scene = PANELS[number]
    traced = next(other for other in (*TRACED, *PANELS) if other.vertex == scene.vertex)
    boundary = panel_boundary(PANELS.index(traced))
    result = panel_result(scene, full=True)
    if number in STRETCHES:
        return draw_landscape(o.find_landscape(result, size=21))
    chart = landscape(scene, 21)
    places = tuple(chart.place(m.fold_angles) for m in result.minima)
    return draw_landscape(o.ExactLandscape(result, chart, boundary, places, ()))


def boxes(figure, gid):
    """Boxes in pixels of what carries a name; of a marker, the square of its size."""
    renderer = FigureCanvasAgg(figure).get_renderer()
    found = []
    for axes in figure.axes:
        for text in axes.texts:
            if text.get_gid() == gid:
                b = text.get_window_extent(renderer)
                found.append((b.x0, b.y0, b.x1, b.y1))
        for line in axes.lines:
            if line.get_gid() == gid:
                x, y = axes.transData.transform(line.get_xydata()[0])
                half = line.get_markersize() * figure.dpi / 144
                found.append((x - half, y - half, x + half, y + half))
    return found


def meet(a, b):
    return min(a[2], b[2]) - max(a[0], b[0]) > 0.5 and min(a[3], b[3]) - max(a[1], b[1]) > 0.5


def look(line):
    """Shape and filling."""
    return line.get_marker(), line.get_markerfacecolor(), line.get_fillstyle()


def explained(figure):
    """Assert that every mark has its shape and its filling in the legend."""
    handles = [
        h for legend in figure.legends for h in legend.legend_handles if hasattr(h, "get_marker")
    ]
    shapes, fillings = {h.get_marker() for h in handles}, {look(h)[1:] for h in handles}
    marks = [line for axes in figure.axes for line in axes.lines if line.get_gid() == "mark"]
    assert marks
    for mark in marks:
        assert mark.get_marker() in shapes and look(mark)[1:] in fillings
    words = {t.get_text() for legend in figure.legends for t in legend.get_texts()}
    shown = {mark.get_marker() for mark in marks}
    for kind, how in KINDS.items():
        assert (kind in words) == (how.marker in shown)
    for colour, text in VERDICTS.values():
        if colour != "#FFFFFF":
            assert (text in words) == (colour in {mark.get_markerfacecolor() for mark in marks})


@pytest.mark.parametrize("number", thinned([4, *range(4), *range(5, len(PANELS))], len(PANELS)))
def test_labels_of_the_panels_cover_nothing_and_marks_are_explained(number):
    figure = drawn(number)
    labels, marks = boxes(figure, "label"), boxes(figure, "mark")
    minima = panel_result(PANELS[number]).minima
    assert len(marks) == len(minima) and labels
    assert not any(meet(a, b) for a, b in itertools.combinations(labels, 2))
    assert not any(meet(a, b) for a in labels for b in marks)
    texts = [t for axes in figure.axes for t in axes.texts if t.get_gid() == "label"]
    numbers = [n for text in texts for n in text.get_text().split(", ")]
    assert sorted(map(int, numbers)) == list(range(1, len(minima) + 1))
    explained(figure)


@settings(max_examples=20)
@given(st.lists(st.tuples(st.floats(0.05, 0.95), st.floats(0.05, 0.95)), min_size=1, max_size=7))
def test_labels_find_room(points):
    """Seven marks anywhere, also on each other: every number stands once, and covers no other."""
    figure = Figure(figsize=(4, 4), dpi=100)
    axes = figure.add_axes((0.1, 0.1, 0.8, 0.8))
    for point in points:
        mark_minimum(axes, point, "interior", None, 12.0)
    axes.set(xlim=(0, 1), ylim=(0, 1))
    label_marks(axes, [(p, str(k), 12.0) for k, p in enumerate(points, start=1)], 9)
    labels = boxes(figure, "label")
    assert not any(meet(a, b) for a, b in itertools.combinations(labels, 2))
    numbers = [n for t in axes.texts for n in t.get_text().split(", ")]
    assert sorted(map(int, numbers)) == list(range(1, len(points) + 1))


def test_merge_trees_are_explained():
    found = panel_barriers()
    figure = draw_barriers(found)
    assert len([axes for axes in figure.axes if axes.lines]) == 1
    explained(figure)
    passes = {line.get_marker() for line in figure.axes[0].lines} & set(PASSES.values())
    assert passes == {PASSES[join.pass_kind] for join in found.merges}
    figure.draw_without_rendering()
    labels, marks = boxes(figure, "label"), boxes(figure, "mark")
    assert not any(meet(a, b) for a, b in itertools.combinations(labels, 2))
    assert not any(meet(a, b) for a in labels for b in marks)


def test_labels_of_many_minima_do_not_meet():
    found = panel_barriers()
    many = dataclasses.replace(found.result, minima=found.result.minima * 24)
    figure = draw_barriers(dataclasses.replace(found, result=many))
    figure.draw_without_rendering()
    labels = boxes(figure, "label")
    assert len(labels) == len(many.minima) > 40
    assert not any(meet(a, b) for a, b in itertools.combinations(labels, 2))
