"""Facets that cross, against the Flexible Collision Library: the same pairs, but for what is shallower than 1e-9."""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.facets import Sheet

fcl = pytest.importorskip("fcl", reason="python-fcl, of the extra test")
PATTERNS = {
    "miura": (3, 4),
    "metasheet": (4, 4),
    "waterbomb": (2, 2),
    "yoshimura": (3, 3),
    "resch": (1, 2),
    "squaretwist": (),
}
CUT = 1e-7
"""Corners that two facets share are cut off by this share of their sides: what crosses, crosses beyond."""
SHALLOW = 1e-9


def states(pattern, count, rng):
    """Fold angles that close where a projection finds some, else any: facets are placed along a tree of creases."""
    sheet = Sheet(pattern)
    for _ in range(count):
        phi = rng.uniform(-1, 1, pattern.creases) * rng.choice([0.5, 1.5, 3.0])
        closed, residual = sheet.project(phi)
        yield closed if residual < 1e-12 and np.abs(closed).max() > 0.1 else phi


def mesh(corners):
    model = fcl.BVHModel()
    triangles = np.array([(0, i, i + 1) for i in range(1, len(corners) - 1)])
    model.beginModel(len(corners), len(triangles))
    model.addSubModel(np.ascontiguousarray(corners), triangles)
    model.endModel()
    return fcl.CollisionObject(model)


def without(corners, other):
    """A convex polygon with each corner cut off that is a corner of the other polygon too."""
    shared = (np.linalg.norm(corners[:, None] - other[None], axis=2) < 1e-9).any(axis=1)
    if not shared.any():
        return corners
    out = []
    for i, x in enumerate(corners):
        before, after = corners[i - 1], corners[(i + 1) % len(corners)]
        out += [x + CUT * (before - x), x + CUT * (after - x)] if shared[i] else [x]
    return np.array(out)


def depth(a, b):
    """Shortest translation along an axis (normals, normals of sides, products of sides) that parts two polygons."""
    sides = [np.roll(x, -1, axis=0) - x for x in (a, b)]
    normals = [np.cross(e[0], e[1]) for e in sides]
    axes = [*normals, *np.cross(sides[0][:, None], sides[1][None]).reshape(-1, 3)]
    axes += [np.cross(n, e) for n, es in zip(normals, sides, strict=True) for e in es]
    axes = np.array([x / np.linalg.norm(x) for x in axes if np.linalg.norm(x) > 1e-9])
    of_a, of_b = a @ axes.T, b @ axes.T
    overlap = np.minimum(of_a.max(0) - of_b.min(0), of_b.max(0) - of_a.min(0))
    return overlap.min()


def compare(pattern, phi):
    """Return the number of crossing pairs of both, and pairs on which they disagree."""
    sheet = Sheet(pattern)
    ours = set(sheet.crossings.find(phi))
    x = sheet.crossings.poses.polygons(phi)
    neighbours = {tuple(sorted(p)) for p in zip(pattern.left, pattern.right, strict=True)}
    theirs, wrong = set(), []
    whole = [mesh(q) for q in x]
    for i in range(len(x)):
        for j in range(i):
            if (j, i) in neighbours:
                continue
            a, b = without(x[i], x[j]), without(x[j], x[i])
            objects = whole[i], whole[j]
            if len(a) > len(x[i]):
                objects = mesh(a), mesh(b)
            if fcl.collide(*objects, fcl.CollisionRequest(), fcl.CollisionResult()):
                theirs.add((j, i))
    for i, j in ours ^ theirs:
        deep = depth(x[i], x[j])
        if deep > SHALLOW * sheet.crossings.size:
            wrong.append((i, j, deep, (i, j) in ours))
    return len(ours), wrong


@pytest.mark.parametrize(
    "count", [pytest.param(8, id="48"), pytest.param(167, id="1002", marks=pytest.mark.slow)]
)
def test_the_same_facets_cross(count):
    rng = np.random.default_rng(count)
    crossed = 0
    for name, size in PATTERNS.items():
        p = o.examples.pattern(name, *size)
        for phi in states(p, count, rng):
            many, wrong = compare(p, phi)
            assert not wrong, (name, wrong)
            crossed += many
    assert crossed > 10 * count
