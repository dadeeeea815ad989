"""Examples by name: their patterns by tests that share no code with what draws them, their states."""

import cmath
import json
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import examples, fold_vertices, parse_fold, scene_at
from tests.independent.rotations import project
from tests.relabelled_vertex import every_label

KNOWN = {  # name: degrees of interior vertices of the pattern, whether it folds flat vertex by vertex
    "miura": ({4}, True),
    "waterbomb": ({6}, True),
    "waterbombbase": ({8}, False),
    "birdbase": ({4, 6}, True),
    "squaretwist": ({4}, True),
    "yoshimura": ({6}, True),
    "resch": ({6}, False),
    "degree6": ({6}, True),
    "degree8": ({8}, False),
}


def around(data):
    """Interior vertices: letters and sectors [rad] around each, counter-clockwise, from coordinates alone."""
    xy = [complex(*p) for p in data["vertices_coords"]]
    ends = {v: [] for v in range(len(xy))}
    for (a, b), letter in zip(data["edges_vertices"], data["edges_assignment"], strict=True):
        ends[a].append((cmath.phase(xy[b] - xy[a]), letter))
        ends[b].append((cmath.phase(xy[a] - xy[b]), letter))
    found = {}
    for v, rays in ends.items():
        if "B" not in {letter for _, letter in rays}:
            turn, letters = zip(*sorted(rays), strict=True)
            sectors = [
                (q - p) % (2 * math.pi) for p, q in zip(turn, turn[1:] + turn[:1], strict=True)
            ]
            found[v] = "".join(letters), sectors
    return found


def area(points):
    return 0.5 * sum(
        (p.conjugate() * q).imag for p, q in zip(points, points[1:] + points[:1], strict=True)
    )


@pytest.mark.parametrize("name", KNOWN)
def test_patterns_are_what_is_known_of_them(name):
    data = examples.crease_pattern(name)
    degrees, flat = KNOWN[name]
    vertices = around(data)
    assert vertices and {len(sectors) for _, sectors in vertices.values()} == degrees
    for letters, sectors in vertices.values():
        assert math.isclose(sum(sectors), 2 * math.pi, abs_tol=1e-12)
        assert abs(sum(sectors[::2]) - math.pi) < 1e-12  # Kawasaki: all of these patterns
        assert (abs(letters.count("M") - letters.count("V")) == 2) == flat  # Maekawa
    # facets tile the outline: each counter-clockwise, areas add up, Euler's formula of a disc
    xy = [complex(*p) for p in data["vertices_coords"]]
    areas = [area([xy[v] for v in face]) for face in data["faces_vertices"]]
    assert min(areas) > 0
    border = {}
    for face in data["faces_vertices"]:
        for a, b in zip(face, face[1:] + face[:1], strict=True):
            border[a, b] = None
    border = {a: b for a, b in border if (b, a) not in border}
    ring = [next(iter(border))]
    while border[ring[-1]] != ring[0]:
        ring.append(border[ring[-1]])
    assert len(ring) == len(border) == data["edges_assignment"].count("B")
    assert math.isclose(area([xy[v] for v in ring]), sum(areas), rel_tol=1e-12)
    assert len(xy) - len(data["edges_vertices"]) + len(areas) == 1


def put_down(scene):
    """Sectors and springs of a scene under every label."""
    for labels in every_label(scene.degree):
        other = labels.of(scene)
        yield np.array([other.vertex.sector_angles, other.stiffness, other.rest_angles])


@pytest.mark.parametrize("name", KNOWN)
def test_the_scene_is_a_vertex_of_its_pattern_with_the_same_springs(name):
    scene = examples.by_name(name)
    (frame,) = parse_fold(json.dumps(examples.crease_pattern(name)))
    scenes = [scene_at(frame, v, symmetry=scene.symmetry) for v in fold_vertices(frame)[0]]
    first = next(put_down(scene))
    alike = (s for s in scenes if s.degree == scene.degree and s.group.name == scene.group.name)
    assert any(np.allclose(x, first, rtol=1e-12, atol=1e-12) for s in alike for x in put_down(s))
    with pytest.raises(o.OrigamiError, match=name if name not in examples.SIZES else "rows"):
        examples.crease_pattern(name, 0, 1)


def test_sizes_and_angles_reach_the_pattern():
    for name in examples.SIZES:
        small, large = (len(around(examples.crease_pattern(name, k, k))) for k in (2, 4))
        assert large > 3 * small > 0
    for name, alpha in (("miura", 1.0), ("yoshimura", 0.4), ("squaretwist", 0.7)):
        sectors = {
            round(a, 9)
            for _, s in around(examples.crease_pattern(name, alpha=alpha)).values()
            for a in s
        }
        assert alpha in sectors


def test_resch_tucks_close_as_the_finished_sheet_says():
    """The state of the docstring closes, by the independent projection; so does that of the middle of a tuck."""
    e = math.pi / 6
    for sectors, phi in (
        ((3 * e, 3 * e, 2 * e, e, e, 2 * e), (-90, -60, -90, -90, 180, -90)),
        ((2 * e,) * 6, (180, -60) * 3),
    ):
        x, residual = project(np.array(sectors), np.arange(6), np.radians([phi]))
        assert residual[0] < 1e-12 and np.abs(np.degrees(x[0]) - phi).max() < 1e-6
