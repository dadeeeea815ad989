"""Every wrong argument of a public function gets one line with its name: never a traceback of ours, never silence."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import origami_nlp as o
from origami_nlp import write_fold
from origami_nlp.barriers import find_barriers
from origami_nlp.chart import landscape
from origami_nlp.paper import cone, draw_landscape, find_critical_points, find_landscape, find_space
from origami_nlp.pattern import fold_vertices, read_fold, scene_at
from origami_nlp.sweep import (
    load_states,
    load_sweep,
    parse_sweep,
    read_sweep,
    run_sweep,
)

SCENE = o.examples.degree6("pi/4")
N = SCENE.degree
NOTHING = (
    "text",
    b"bytes",
    math.nan,
    math.inf,
    -1,
    1.5,
    10**400,
    object(),
    np.zeros((2, 2)),
    {"a": 1},
    ["a"],
)
"""Wrong for every argument but those that say otherwise below."""


def but(*right):
    """`NOTHING` without numbers that are right."""
    return tuple(v for v in NOTHING if not (isinstance(v, int | float) and v in right))


LISTS = (None, 7, True, *NOTHING)
SCENES = (None, 0, True, [], "scene.toml", Path("scene.toml"), *NOTHING)
WHOLES = (None, 0.5, True, [], *NOTHING)
SEEDS = (None, 0.5, True, [], *but(10**400))
NUMBERS = (None, True, [], [1.0], *but(1.5))
FLAGS = (None, 0, 1, [], *NOTHING)
CALLS = (0, True, [], *NOTHING)
PATHS = (0, 1, True, [], "nul\0", *NOTHING[1:])
NAMES = (None, 0, True, [], *NOTHING)
STATES = (
    *(None, 0, True, [], [0.0] * (N - 1), [0.0] * (N + 1), np.zeros((2, N))),
    *([math.nan] + [0.0] * (N - 1), [0.0] * (N - 1) + [math.inf], ["a"] * N),
    *NOTHING,
)
ANGLES = (None, True, [], *but(1.5, -1))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Arguments that are right, by name; each case takes those it needs."""
    folder = tmp_path_factory.mktemp("arguments")
    result = o.find_minima(SCENE, max_starts=4)
    pattern = {
        "vertices_coords": [[0, 0], [1, 0], [0, 1], [-1, 0], [0, -1]],
        "edges_vertices": [[0, 1], [0, 2], [0, 3], [0, 4], [1, 2], [2, 3], [3, 4], [4, 1]],
        "edges_assignment": ["V", "M", "V", "V", "B", "B", "B", "B"],
    }
    (folder / "p.fold").write_text(json.dumps(pattern))
    return {
        "vertex": SCENE.vertex,
        "scene": SCENE,
        "origami": SCENE,
        "result": result,
        "fold_angles": np.array(result.minima[0].fold_angles),
        "folder": folder / "sweep",
        "path": folder / "out.fold",
        "frame": read_fold(folder / "p.fold")[0],
        "ax": Figure().subplots(),
    }


def case(function, name, wrong, *needs, **fixed):
    where = f"{function.__module__.removeprefix('origami_nlp.')}.{function.__name__}"
    return pytest.param(function, name, wrong, needs, fixed, id=f"{where}-{name}")


SPRINGS = {"stiffness": SCENE.stiffness, "rest_angles": SCENE.rest_angles}
CONE = {"cone": 6, "ratio": 1.0}
CASES = [
    case(o.Vertex, "sector_angles", LISTS),
    case(o.Vertex, "flat", FLAGS, sector_angles=("pi/2",) * 4),
    case(o.Vertex.from_degrees, "sector_angles", LISTS),
    case(o.Scene, "vertex", SCENES, **SPRINGS),
    case(
        o.Scene, "stiffness", (None, True, *but(1.5), [10**400] * N), "vertex", rest_angles=(0,) * N
    ),
    case(o.Scene, "rest_angles", LISTS, "vertex", stiffness=(1,) * N),
    case(o.Scene, "symmetry", NAMES, "vertex", **SPRINGS),
    case(o.Scene, "contact", NAMES, "vertex", **SPRINGS),
    case(o.Scene, "mirror", (True, [], *NOTHING), "vertex", symmetry="D1", **SPRINGS),
    case(o.Scene, "name", (0, True, [], *NOTHING[1:]), "vertex", **SPRINGS),
    case(o.Scene, "symmetry_tolerance", (None, True, [], *NOTHING), "vertex", **SPRINGS),
    case(SCENE.energy, "fold_angles", (None, 0, [], [0.0] * (N - 1), ["a"] * N, *NOTHING)),
    case(o.pose, "origami", (None, 0, True, [])),
    case(o.find_minima, "origami", (None, 0, True, [])),
    case(o.find_minima, "seed", SEEDS, origami=SCENE),
    case(o.find_minima, "max_starts", (0, *(v for v in SEEDS if v is not None)), origami=SCENE),
    case(
        o.find_minima,
        "guesses",
        (*LISTS[1:], [[0.0] * 5], [[math.nan] * 6], np.zeros(6)),
        origami=SCENE,
    ),
    case(o.find_minima, "full", tuple(v for v in FLAGS if v is not None), origami=SCENE),
    case(o.find_minima, "progress", CALLS, origami=SCENE),
    case(o.find_minima, "found", CALLS, origami=SCENE),
    case(o.draw_minima, "result", (SCENE, *SCENES)),
    case(o.draw_minima, "path", PATHS, "result"),
    case(o.draw_minima, "size", (7, *WHOLES), "result"),
    case(o.check_admissible, "origami", (None, 0, True, []), "fold_angles"),
    case(o.check_admissible, "fold_angles", STATES, origami=SCENE),
    case(
        o.check_admissible,
        "tolerance",
        (None, True, [], 0.02, *NOTHING),
        "fold_angles",
        origami=SCENE,
    ),
    *(case(f, "alpha", ANGLES) for f in (o.examples.degree6, o.examples.degree8)),
    *(case(f, "ratio", (0, *NUMBERS)) for f in (o.examples.degree6, o.examples.degree8)),
    *(case(f, "symmetry", NAMES) for f in (o.examples.degree6, o.examples.degree8)),
    *(case(f, "contact", NAMES) for f in (o.examples.degree6, o.examples.degree8)),
    case(o.format_scene, "scene", SCENES),
    case(o.parse_scene, "text", (None, 0, True, [], *NOTHING[1:])),
    *(case(f, "source", PATHS) for f in (o.read_scene, read_fold)),
    case(find_barriers, "origami", (None, 0, True, [])),
    case(find_barriers, "result", (SCENE, *SCENES[1:]), "origami"),
    case(find_barriers, "seed", SEEDS, "origami", "result"),
    case(find_space, "scene", SCENES),
    case(find_space, "rings", (7, 1026, *WHOLES), "scene"),
    case(find_critical_points, "scene", SCENES),
    case(find_critical_points, "rings", (7, 1026, *WHOLES), "scene"),
    case(landscape, "scene", SCENES),
    case(landscape, "size", (7, 10_000, *WHOLES), "scene"),
    case(landscape(SCENE, 8).place, "fold_angles", STATES),
    case(find_landscape, "result", (SCENE, *SCENES)),
    case(find_landscape, "size", (7, 10_000, *WHOLES), "result"),
    case(draw_landscape, "exact", (SCENE, *SCENES)),
    case(cone.Cone, "degree", (5, 7, *SEEDS)),
    case(cone.Cone, "rest", NAMES, degree=6),
    case(cone.Cone, "end", NAMES, degree=6),
    case(cone.count, "cone", (5, 4002, *WHOLES), ratio=1.0, elevation=0.5),
    case(cone.count, "ratio", (0, *NUMBERS), cone=6, elevation=0.5),
    case(cone.count, "elevation", (4, *NUMBERS[:-4]), **CONE),
    case(cone.full_space, "cone", (5, *WHOLES), ratio=1.0, elevation=0.5),
    case(cone.full_space, "ratio", (0, *NUMBERS), cone=6, elevation=0.5),
    case(cone.full_space, "progress", CALLS, elevation=0.5, **CONE),
    case(cone.phase_diagram, "cone", (5, 202, *WHOLES), size=4),
    case(cone.phase_diagram, "size", (1, 10_000, *WHOLES), cone=6),
    case(cone.phase_diagram, "progress", CALLS, cone=6, size=4),
    case(cone.phase_boundaries, "cone", (5, *WHOLES)),
    case(cone.phase_boundaries, "lines", (1, *WHOLES), cone=6),
    case(cone.foldings, "degree", (5, 34, *WHOLES)),
    case(cone.ConeBranch, "flaps", (*LISTS, "VXM", (1, 0)), direction="up"),
    case(cone.ConeBranch, "direction", (None, 0, [], "left", *but(-1)), flaps="VVM"),
    case(cone.draw_phase, "diagram", SCENES),
    case(fold_vertices, "frame", SCENES),
    case(scene_at, "frame", SCENES, number=0),
    case(scene_at, "number", WHOLES[1:], "frame"),  # None: the only vertex there is
    case(scene_at, "symmetry", NAMES, "frame", number=0),
    case(scene_at, "contact", NAMES, "frame", number=0),
    case(scene_at, "stiffness", (0, *NUMBERS), "frame", number=0),
    case(scene_at, "rest_angle", (4, *NUMBERS), "frame", number=0),
    case(write_fold, "result", (SCENE, *SCENES), "path"),
    case(write_fold, "path", (None, *PATHS), "result"),
    case(run_sweep, "sweep", SCENES, "folder"),
    *(case(f, "folder", (None, *PATHS)) for f in (load_states, load_sweep)),
    case(
        parse_sweep, "data", (None, 0, True, [], *(v for v in NOTHING if not isinstance(v, dict)))
    ),
    case(read_sweep, "path", (None, *PATHS)),
]


@pytest.mark.parametrize(("function", "name", "wrong", "needs", "fixed"), CASES)
def test_a_wrong_argument_is_named(made, function, name, wrong, needs, fixed):
    right = {key: made[key] for key in needs} | fixed
    words = {
        "scene": "scene|FOLD",
        "path": "path|sweep",
        "number": "number|vertex",
        "cone": "degree",
    }
    word = words.get(name, name)
    for value in wrong:
        with pytest.raises(o.OrigamiError) as raised:
            function(**right, **{name: value})
        message = str(raised.value)
        assert "\n" not in message and len(message) < 400
        assert any(w in message for w in word.split("|")), (value, message)
