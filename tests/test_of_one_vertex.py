"""What is asked of one vertex alone: of patterns that equal one, and what is said of others; pages and meshes."""

from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import as_scene
from tests.command_line import run
from tests.computed_once import thinned
from tests.patterns import scene_pattern

WAYS = {
    "boundaries": (
        lambda it: o.find_bifurcation_set(it, "stiffness[1]=0.5:2", "stiffness[2]=0.5:2"),
        "follow takes a pattern",
    ),
    "space": (o.find_space, "find_motion follows a pattern"),
    "critical points": (o.find_critical_points, "find_minima takes a pattern"),
}


@pytest.mark.parametrize("name", WAYS)
def test_of_several_vertices_one_line_says_what_takes_them(name):
    ask, instead = WAYS[name]
    for it in ("metasheet:2x3", o.examples.pattern("metasheet", 2, 3)):
        with pytest.raises(o.OrigamiError, match="is for one vertex: read_fold_scene") as said:
            ask(it)
        assert instead in str(said.value) and "\n" not in str(said.value)
    with pytest.raises(o.OrigamiError, match="scene = 3 must be a Scene"):
        ask(3)


@pytest.mark.parametrize("degree", thinned([5, 4, 7], 3))
def test_a_pattern_of_one_vertex_is_taken_as_the_scene_that_it_equals(degree):
    rng = np.random.default_rng(degree)
    sectors = rng.uniform(0.5, 1.5, degree)
    vertex = o.Vertex(tuple(sectors * 2 * np.pi / sectors.sum()))
    scene = o.Scene(vertex, tuple(rng.uniform(1, 2, degree)), tuple(rng.uniform(-2, 2, degree)))
    scene = replace(scene, symmetry="none")
    again = as_scene(scene_pattern(scene))
    assert again.vertex.sector_angles == pytest.approx(scene.vertex.sector_angles, abs=1e-14)
    assert again.stiffness == scene.stiffness and again.rest_angles == scene.rest_angles
    assert again.contact == "full" and again.group.is_trivial


def test_paper_beyond_the_sectors_makes_another_sheet():
    pattern = scene_pattern(o.examples.waterbomb())
    assert as_scene(pattern).degree == 6
    with pytest.raises(o.OrigamiError, match="is for one vertex"):
        as_scene(replace(pattern, polygons=((0, 1, 2, 4), *pattern.polygons[1:])))


@pytest.mark.parametrize("whole", thinned([False, True], 2), ids=("vertex", "pattern"))
def test_a_load_path_is_written_as_a_mesh(whole, tmp_path):
    trimesh = pytest.importorskip("trimesh")
    target, scene = tmp_path / "ends.stl", o.examples.degree6("5*pi/12")
    pattern = o.examples.pattern("metasheet", 2, 2) if whole else scene_pattern(scene)
    (tmp_path / "a.toml").write_text(o.format_scene(scene))
    given = ("metasheet:2x2" if whole else tmp_path / "a.toml", "--crease", 1, "--to", 0.02)
    done = run("load", *given, "-o", target)
    assert done.code == 0 and f"written: {target}" in done.out
    area = 0.0
    for polygon in pattern.polygons:
        x = pattern.corners[list(polygon)]
        area += np.linalg.norm(np.cross(x - x[0], np.roll(x, -1, axis=0) - x[0]).sum(axis=0)) / 2
    mesh = trimesh.load(target)
    assert mesh.area == pytest.approx(2 * area, rel=1e-5)  # where the one leg begins and ends
    wrong = run("load", *given, "-o", tmp_path / "ends.txt")
    assert wrong.code == 2 and ".obj, .stl, .glb" in wrong.err
