"""Exact boundaries, and the region they bound, against the closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings, strategies as st

import origami_nlp as o
from origami_nlp.chart import (
    Boundary,
    admissible_region,
    allowed,
    boundary_lines,
    boundary_walk,
    chart_limits,
    chart_of,
    distance_from,
    grid,
    outline_of,
    trace_boundary,
)
from origami_nlp.folding import check_admissible, fold_vertex
from origami_nlp.kkt import State
from origami_nlp.problem import Model
from tests.computed_once import PANELS, panel_boundary, thinned
from tests.independent.arcs import nearest_touch

SCENES = {
    "pi/4": o.examples.degree6("pi/4", 1.0),
    "pi/3": o.examples.degree6("pi/3", 1.0),
    "octagon": o.examples.degree8("pi/12", 0.01),
}


def boundary(name: str) -> Boundary:
    return panel_boundary(PANELS.index(SCENES[name]))


@pytest.mark.parametrize("name", thinned([*SCENES], 3))
def test_lines_are_where_admissibility_ends(name):
    """Points of a line close and are admissible; a little to one side, in the chart, no state is."""
    scene, chart = SCENES[name], chart_of(SCENES[name])
    x0, x1, y0, y1 = chart_limits(chart)
    for line in boundary(name).lines:
        _, q = fold_vertex(scene.vertex, line.fold_angles)
        assert np.linalg.norm(q[:, 1:], axis=1).max() < 1e-12 and (q[:, 0] > 0).all()
        assert np.abs(line.fold_angles).max() <= math.pi
        assert all(
            check_admissible(scene.vertex, phi).admissible for phi in line.fold_angles[1:-1:25]
        )
        if line.hidden:
            continue
        # away from corners, where the line turns in the chart
        k = np.arange(len(line.s))[2:-2]
        ahead = line.points[k + 1] - line.points[k - 1]
        size = np.linalg.norm(ahead, axis=1)
        ends = line.points[[0, -1]]
        far = np.linalg.norm(line.points[k, None] - ends, axis=2).min(axis=1) > 0.3
        far &= size > 1e-4
        k, normal = k[far], np.stack([-ahead[far, 1], ahead[far, 0]], axis=-1)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        sides = []
        for sign in (1, -1):
            at = line.points[k] + sign * 1e-4 * normal
            inside = (at[:, 0] > x0) & (at[:, 0] < x1) & (at[:, 1] > y0) & (at[:, 1] < y1)
            sides.append(allowed(chart, line.branch, at[:, 0], at[:, 1])[0] & inside)
        both, either = sides[0] & sides[1], sides[0] | sides[1]
        assert not both.any()
        assert not either.any() if line.thin else either.all()


@pytest.mark.parametrize("name", ["pi/4", "octagon"])
def test_corners_met_by_newton_are_where_bisection_ends(monkeypatch, name):
    model, line = Model(SCENES[name]), max(boundary(name).lines, key=lambda line: line.length)
    middle = model.reduce(line.fold_angles[len(line.s) // 2])
    held = State(model, middle).on(line.rows)
    met = boundary_walk.walk(held)
    monkeypatch.setattr(boundary_walk, "_corner", lambda before, after: None)
    bisected = boundary_walk.walk(held)
    assert len(met.s) + 10 < len(bisected.s)  # halvings at either end
    assert (met.start, met.end) == (bisected.start, bisected.end)
    assert np.abs(met.states[[0, -1]] - bisected.states[[0, -1]]).max() < 1e-9


@pytest.mark.slow  # seconds of curves or searches
@pytest.mark.parametrize(
    "scene",
    [
        o.examples.degree6("pi/3", 1.0),
        pytest.param(SCENES["octagon"], marks=pytest.mark.slow),
        pytest.param(o.examples.degree6("5*pi/12", 1.0), marks=pytest.mark.slow),
    ],
)
def test_lines_that_symmetries_give_are_those_that_are_traced(monkeypatch, scene):
    given = trace_boundary(scene, 41)
    monkeypatch.setattr(boundary_lines, "_moves", lambda scene: [])
    traced = trace_boundary(scene, 41)
    assert len(given.lines) == len(traced.lines) > 4
    for line in given.lines:
        middle = line.fold_angles[None, len(line.s) // 2]
        (same,) = (ln for ln in traced.lines if distance_from(middle, ln.fold_angles)[0] < 1e-3)
        # chords of 0.04 rad; tangential corners are known to 1e-5
        assert same.length == pytest.approx(line.length, abs=3e-4)
        assert distance_from(line.fold_angles, same.fold_angles).max() < 3e-4
        assert (same.branch, same.thin, same.hidden) == (line.branch, line.thin, line.hidden)
        assert set(same.contacts) == set(line.contacts)
        apart = np.abs(line.fold_angles[0] - same.fold_angles[[0, -1]]).max(axis=1)
        ends = (same.start, same.end)[:: 1 if apart[0] < apart[1] else -1]
        for why, other in zip((line.start, line.end), ends, strict=True):
            # at the flat state closure loses rank, and all contacts close
            if not any(end.startswith("singular") for end in (why, other)):
                # where some contacts depend on each other more or fewer of them are named
                names = [set(end.partition("(")[2].rstrip(")").split("; ")) for end in (why, other)]
                assert why == other or names[0] & names[1]


@pytest.mark.slow  # a second look at what other tests of the room say
def test_a_line_along_two_contacts_does_not_go_on_where_one_of_them_branches():
    """Cells of other sizes start lines elsewhere: at (-pi/2, pi) that of crease 1 leaves the edge of the chart."""
    found = [boundary("pi/3"), trace_boundary(SCENES["pi/3"], 61)]
    lengths = [np.sort([line.length for line in each.lines]) for each in found]
    assert len(lengths[0]) == 18 and lengths[0] == pytest.approx(lengths[1], abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_bisected_points_lie_on_the_lines(name):
    found = boundary(name)
    assert found.complete
    for branch, points in enumerate(found.crossings):
        lines = [ln.points for ln in found.lines if ln.branch == branch]
        away = np.min([distance_from(points, ln) for ln in lines], axis=0)
        assert away.max() < 5e-4  # chords of at most 0.04 rad


@pytest.mark.slow
def test_corners_and_handles_of_pi_3():
    """At alpha_1 = pi/3 creases 1 and 4 can coincide, and four sets exist only at phi = +-pi exactly."""
    lines = boundary("pi/3").lines
    assert sum(ln.thin for ln in lines) == 4 and sum(ln.hidden for ln in lines) == 2
    for ln in lines:
        if ln.thin:
            assert len(ln.contacts) == 2
            ends = np.sort(np.abs(ln.points[[0, -1]]).min(axis=1))
            assert ends == pytest.approx([math.pi / 2, math.pi], abs=1e-6)
        if ln.hidden:  # cos phi = -1/3, the dihedral angle of an octahedron
            assert np.abs(ln.points) == pytest.approx(math.acos(-1 / 3), abs=1e-7)
    assert not any(ln.thin for ln in boundary("pi/4").lines)


def same_region(scene: o.Scene, found: Boundary, size: int) -> None:
    """The polygons hold a grid point exactly where the closed form has an admissible state."""
    chart = chart_of(scene)
    x0, x1, y0, y1 = chart_limits(chart)
    x, y = np.meshgrid(np.linspace(x0, x1, size)[1:-1], np.linspace(y0, y1, size)[1:-1])
    for branch in range(len(chart.signs)):
        region = admissible_region(scene, found, branch)
        good = allowed(chart, branch, x, y)[0]
        differ = good != shapely.contains_xy(region, x, y)
        at = shapely.points(x[differ], y[differ])
        assert (shapely.distance(at, region.boundary) < 5e-4).all()
        assert good.any() and differ.sum() < 0.002 * good.size


@pytest.mark.parametrize("name", SCENES)
def test_region_is_the_admissible_set(name):
    same_region(SCENES[name], boundary(name), 157)


@pytest.mark.slow
def test_a_line_is_cut_where_another_ends_on_it_tangentially():
    """Here the next contact closes quadratically, so that its end is known to 1e-5 only (found by hypothesis)."""
    check_vertex(0.5, 0.5)


@pytest.mark.slow
@settings(max_examples=25)
@given(a1=st.floats(0.4, 1.2), a2=st.floats(0.4, 1.2))
def test_regions_of_other_vertices(a1, a2):
    check_vertex(a1, a2)


def check_vertex(a1, a2):
    a3 = math.pi - a1 - a2
    vertex = o.Vertex((a1, a2, a3, a3, a2, a1))
    scene = o.Scene(vertex, (1.0,) * 6, (1.0, -1.0, 1.0, 1.0, 1.0, -1.0), "D1")
    found = trace_boundary(scene, 61)
    if found.complete:  # a tip narrower than a cell may be left out, and is then reported
        same_region(scene, found, 97)
    else:
        assert sum(map(len, found.missed)) < 0.02 * sum(map(len, found.crossings))


def test_tracing_wants_two_dof_and_contact():
    free = o.examples.degree6("pi/4", 1.0, contact="none")
    with pytest.raises(o.OrigamiError, match="contact = 'full'"):
        trace_boundary(free)
    with pytest.raises(o.OrigamiError, match="two symmetric degrees of freedom"):
        trace_boundary(o.examples.degree6("pi/4", 1.0, symmetry="none"))


@pytest.mark.parametrize("name", SCENES)
def test_polygons_are_made_of_exact_states(name):
    """Every corner of a region is the chart point of a state whose contact is closed to 1e-9, by other code."""
    scene, found = SCENES[name], boundary(name)
    gaps, points, branches = [], [], []
    for line in found.lines:
        if line.thin or line.hidden:
            continue
        creases, _ = fold_vertex(scene.vertex, line.fold_angles)
        limit = np.abs(math.pi - np.abs(line.fold_angles)).min(axis=1)
        gaps.append(np.minimum(limit, nearest_touch(creases)))
        points.append(line.points)
        branches.append(np.full(len(line.points), line.branch))
    assert np.concatenate(gaps).max() < 1e-9
    for branch in set(np.concatenate(branches)):
        exact = np.concatenate(points)[np.concatenate(branches) == branch]
        corners = shapely.get_coordinates(admissible_region(scene, found, branch))
        away = np.array([np.abs(exact - corner).max(axis=1).min() for corner in corners])
        assert len(corners) > 100 and away.max() < 1e-9


@pytest.mark.parametrize(
    "scene",
    thinned(
        [
            o.examples.degree8("pi/12", contact="none"),
            o.examples.degree6("5*pi/12", contact="fold-limits"),
        ],
        2,
    ),
)
def test_outlines_without_full_contact(scene):
    """Corners lie where states end, to 1e-9; random points are inside exactly where a state is."""
    chart = chart_of(scene)
    x0, x1, y0, y1 = chart_limits(chart)
    cell = (x1 - x0) / 384
    rng = np.random.default_rng(3)
    x, y = rng.uniform(x0, x1, 4000), rng.uniform(y0, y1, 4000)
    turn = np.exp(2j * np.pi * np.arange(16) / 16)
    for branch, region in enumerate(outline_of(scene).regions):
        good = allowed(chart, branch, x, y)[0]
        wrong = shapely.contains_xy(region, x, y) != good
        near = shapely.distance(region.boundary, shapely.points(x[wrong], y[wrong]))
        assert good.any() and not good.all()
        assert wrong.mean() < 1e-3 and (near < cell).all()
        corners = shapely.get_coordinates(region)
        corners = corners[(np.abs(corners) < (x1 - 1e-6, y1 - 1e-6)).all(axis=1)]
        # where two branches meet, at the flat state, sides within a cell may cross
        corners = corners[np.abs(corners).max(axis=1) > 2 * cell]
        around = corners[:, None] + 1e-9 * np.stack([turn.real, turn.imag], axis=-1)
        inside = allowed(chart, branch, around[..., 0], around[..., 1])[0]
        assert len(corners) > 100 and (inside.any(axis=1) & ~inside.all(axis=1)).all()


def test_several_halvings_at_once_end_where_one_by_one_does():
    """To the last bit, from every side of the admissible set."""
    chart = chart_of(SCENES["pi/3"])
    inside, beyond = grid.crossings_of(chart, 0, 20)
    apart = np.flatnonzero((inside != beyond).any(axis=1))[:8]
    inside, beyond = inside[apart], beyond[apart]
    found = grid.last_allowed(chart, 0, inside, beyond)
    for _ in range(grid.BISECTIONS):
        middle = (inside + beyond) / 2
        good = allowed(chart, 0, *middle.T)[0][:, None]
        inside, beyond = np.where(good, middle, inside), np.where(good, beyond, middle)
    assert len(found) == 8 and np.array_equal(found, inside)


def test_distances_from_a_line_are_those_of_shapely():
    rng = np.random.default_rng(0)
    line, points = rng.normal(size=(30, 2)), rng.normal(size=(200, 2))
    line[4] = line[3]  # a side of no length
    away = shapely.distance(shapely.LineString(line), shapely.points(points))
    assert np.abs(distance_from(points, line) - away).max() < 1e-14
