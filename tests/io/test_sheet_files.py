"""Motions, and the files of sheets: FOLD frames that say the same read back, meshes, pages, the command."""

import json
import math

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import origami_nlp as o
from origami_nlp.display import BORDER, MOUNTAIN, Poser, draw_state
from origami_nlp.pattern import frame_pattern, make_pattern, parse_fold
from origami_nlp.pattern_problem import (
    PatternProblem,
    Poses,
    state_frame,
    states_to_fold,
)
from origami_nlp.pattern_states import analyze_mobility, find_motion


def read(data):
    return [frame_pattern(f) for f in parse_fold(json.dumps(data))]


def sides(x, pattern):
    """Lengths of all sides and diagonals of facets."""
    return np.array([np.linalg.norm(x[a] - x[b]) for q in pattern.polygons for a in q for b in q])


@pytest.mark.parametrize("name", ["miura", "squaretwist", "resch"])
def test_frames_read_back_are_the_same_states(name):
    size = () if name == "squaretwist" else (2, 3)
    p = o.examples.pattern(name, *size)
    phi = analyze_mobility(p).folded
    data = states_to_fold(p, [state_frame(p, phi, "folded", energy=1.0)])
    flat, folded = read(data)
    assert flat.is_flat and np.abs(flat.rest - p.rest).max() < 1e-13
    assert np.array_equal(flat.stiffness, p.stiffness) and np.array_equal(flat.ends, p.ends)
    # measured from the coordinates alone, by normals of facets
    bare = {k: v for k, v in data["file_frames"][0].items() if k != "edges_foldAngle"}
    (_, measured) = read({**data, "file_frames": [bare]})
    for one in (folded, measured):
        assert np.abs(one.reference - phi).max() < 1e-12
    x = np.array(data["file_frames"][0]["vertices_coords"])
    assert np.abs(sides(x, p) - sides(p.corners, p)).max() < 1e-12  # facets are rigid


def test_the_motion_of_a_miura_is_its_law():
    p = o.examples.pattern("miura", 3, 4)
    motion = find_motion(p)
    straight = np.abs(p.directions[:, 1]) < 1e-9
    assert len(motion.fold_angles) > 30 and motion.dof == 1 and motion.touching is None
    for phi in motion.fold_angles[:-1]:
        z, h = np.abs(phi[~straight]), np.abs(phi[straight])
        assert np.ptp(z) < 1e-9 and np.ptp(h) < 1e-9
        assert np.abs(np.tan(h / 2) - math.cos(math.pi / 3) * math.tan(z[0] / 2)).max() < 1e-8 / (
            1e-9 + math.cos(z[0] / 2) ** 2
        )
    assert "fold limit" in motion.end and np.abs(motion.fold_angles[-1]).max() == math.pi
    assert np.array_equal(np.argsort(motion.arc), np.arange(len(motion.arc)))


def test_a_motion_ends_where_facets_touch():
    p = o.examples.pattern("metasheet", 3, 3)
    motion = find_motion(p)
    a, b = motion.touching
    problem = PatternProblem(p)
    last = motion.fold_angles[-1]
    assert problem.residual(last) < 1e-12 and not problem.crossings.find(last)
    beyond, _ = problem.project(
        last + 1e-4 * (last - motion.fold_angles[-2]) / np.abs(last - motion.fold_angles[-2]).max()
    )
    assert (min(a, b), max(a, b)) in problem.crossings.find(beyond)
    # a second way: distance of the two facets, sampled densely over both
    x = Poses(p).polygons(last)
    t = np.linspace(0, 1, 41)
    u, v = np.meshgrid(t, t)

    def sampled(q):
        e = [q[k] for k in range(4)]
        s = [(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v]
        return sum(w[..., None] * c for w, c in zip(s, e, strict=True)).reshape(-1, 3)

    apart = np.linalg.norm(sampled(x[a])[:, None] - sampled(x[b])[None], axis=2).min()
    assert apart < 0.05 * problem.crossings.size


def test_a_page_has_every_facet_and_both_sides_of_each_crease():
    p = o.examples.pattern("waterbomb", 2, 2)
    phi = analyze_mobility(p).folded
    poser = Poser(p)
    body, folded = poser.body, poser.folded(phi, 0.0)
    assert len(body.facets) == p.facets and len(body.creases) == p.creases
    x = folded.corners
    for crease, angle in zip(body.creases, phi, strict=True):
        normals = []
        for f in (crease.right, crease.left):
            a, b, c = x[list(body.facets[f][:3])]
            normals.append(np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a)))
        along = x[crease.end] - x[crease.start]
        turn = np.cross(*normals) @ along / np.linalg.norm(along)
        assert math.atan2(turn, normals[0] @ normals[1]) == pytest.approx(angle, abs=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_of_layers_in_one_plane_the_nearest_is_drawn(sign):
    """A pleat of three: its outer facets are longer, so that one of its two creases is out of sight."""
    x = np.array([0.0, 1.2, 2.2, 3.4])
    corners = np.array([(a, b) for a in x for b in (0.0, 1.0)])
    polygons = [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(3)]
    pattern = make_pattern(corners, polygons)
    figure = Figure()
    axes = figure.add_subplot()
    draw_state(axes, pattern, sign * np.array([math.pi, -math.pi]))
    drawn = {to_hex(c.get_color()[0]) for c in axes.collections if len(c.get_segments())}
    assert drawn == {BORDER, MOUNTAIN}
    shades = axes.images[0].get_array()
    red, _, blue, _ = shades[shades[..., 3] > 0].T
    assert (red > blue).mean() > 0.999  # the upper side


def test_layers_of_a_flat_folded_end_come_back():
    """Layers at a flat-folded end, what a touch leaves; both come back from JSON."""
    flat = find_motion(o.examples.pattern("miura", 2, 2))
    blocked = find_motion(o.examples.pattern("metasheet", 3, 3))
    free = find_motion(o.examples.pattern("yoshimura", 3, 3))
    for motion in (flat, blocked, free):
        assert bool(motion.layers) == (motion is flat)
        assert type(motion).from_dict(motion.to_dict()).layers == motion.layers
