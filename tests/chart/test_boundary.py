"""Exact boundaries, and the region they bound, against the closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely

import origami_nlp as o
from origami_nlp.chart import (
    Boundary,
    admissible_region,
    allowed,
    boundary_walk,
    chart_limits,
    chart_of,
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
