"""Stable states as a FOLD file: the crease pattern, and one folded frame a state.

The vertex is drawn as a disc of unit creases: vertex 0 in the middle, vertex i at the end of crease i; edge
i - 1 is crease i, face i - 1 the facet between creases i and i + 1.  Targets of the crease pattern
(``edges_foldAngle``, degrees) are the rest angles; stiffness and rest angles are kept in the namespace
``origaminlp`` too, so that reading the file gives the same scene.  Where layers touch, ``faceOrders`` holds one
order that is free of crossings.  Coordinates of a folded frame: the frame of the paper, last facet in the plane.
"""

from __future__ import annotations

import itertools
import json
import math
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_path, check_type
from origami_nlp.errors import OptionError
from origami_nlp.files import write_whole
from origami_nlp.folding import fold_vertex, layer_problem, ordered
from origami_nlp.minima.minimum import Minimum
from origami_nlp.minima.result import MinimaResult
from origami_nlp.numerics import TOUCHES
from origami_nlp.pattern import PRELOAD_KEY, REST_KEY, STIFFNESS_KEY, Scene, Vertex
from origami_nlp.version import __version__

MESH_SUFFIXES = (".obj", ".stl", ".glb")


def minima_to_fold(result: MinimaResult) -> dict[str, Any]:
    """Return the states of `result` as FOLD data (spec 1.1).

    A flat sheet has its crease pattern as the file's own frame; paper that does not lie flat has no flat
    pattern, and the first state takes its place.
    """
    states = [_state_frame(result.scene, k, m) for k, m in enumerate(result.minima, start=1)]
    return fold_data(result.scene, states)


def fold_data(scene: Scene, states: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the crease pattern of a scene with frames of `folded_frame` as FOLD data."""
    n = scene.degree
    rim = [*range(1, n + 1)]
    edges = [[0, i] for i in rim] + [[i, i % n + 1] for i in rim]
    pad = [0.0] * n
    data: dict[str, Any] = {
        "file_spec": 1.1,
        "file_creator": f"origami_nlp {__version__}",
        "file_classes": ["singleModel"],
        "file_title": scene.name or "origami vertex",
        "edges_vertices": edges,
        "faces_vertices": [[0, i, i % n + 1] for i in rim],
        STIFFNESS_KEY: [*scene.stiffness, *[None] * n],
        REST_KEY: [*(math.degrees(a) for a in scene.rest_angles), *[None] * n],
        **({PRELOAD_KEY: [*scene.preload, *[None] * n]} if scene.preload else {}),
        **(
            {
                "origaminlp:loads": [load.to_dict() for load in scene.loads],
                "origaminlp:heldFacet": scene.held_facet,
            }
            if scene.loads
            else {}
        ),
        "origaminlp:symmetry": scene.symmetry,
        "origaminlp:contact": scene.contact,
    }
    if scene.vertex.flat:
        a = scene.vertex.azimuths
        data |= {
            "frame_title": "crease pattern",
            "frame_classes": ["creasePattern"],
            "frame_attributes": ["2D"],
            "vertices_coords": [[0.0, 0.0], *np.stack([np.cos(a), np.sin(a)], axis=1).tolist()],
            "edges_assignment": [*(_letter(v) for v in scene.rest_angles), *"B" * n],
            "edges_foldAngle": [*(math.degrees(v) for v in scene.rest_angles), *pad],
        }
    elif states:
        own = ("frame_inherit", "frame_parent")
        data |= {key: value for key, value in states[0].items() if key not in own}
        states = states[1:]
    else:
        raise OptionError(
            "no minimum was found, and paper that is not flat has no crease pattern to write"
        )
    data["file_frames"] = states
    return data


def write_fold(result: MinimaResult, target: str | Path) -> None:
    """Write states as a FOLD file (spec 1.1): the crease pattern, and one folded frame a state.

    Parameters
    ----------
    result
        Of `find_minima`.
    target
        The file, written whole or not at all; ``"-"`` for standard output.

    Raises
    ------
    OptionError
        If `result` is no result, or the file cannot be written.

    Examples
    --------
    >>> import json, pathlib, tempfile, origami_nlp as o
    >>> path = pathlib.Path(tempfile.mkdtemp(), "states.fold")
    >>> o.write_fold(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), path)
    >>> [frame["frame_title"] for frame in json.loads(path.read_text())["file_frames"]]
    ['state 1: interior, 0.0090858 J', 'state 2: contact-touching, 1.2337 J']
    """
    check_type("result", result, MinimaResult)
    check_path("target", target)
    write_whole(
        target, (json.dumps(minima_to_fold(result), indent=1, allow_nan=False) + "\n").encode()
    )


def _letter(angle: float) -> str:
    # 0 is F, not U: Origami Simulator makes hinges of M, V and F only; our stiffness says that it is a crease
    return "V" if angle > 0 else "M" if angle < 0 else "F"


def _state_frame(scene: Scene, number: int, m: Minimum) -> dict[str, Any]:
    full = m.full_space
    title = f"state {number}: {m.kind}, {m.energy:.6g} J" + (f", {full.verdict}" if full else "")
    return {
        **folded_frame(scene.vertex, np.array(m.fold_angles), title),
        "origaminlp:energy": m.energy,
        "origaminlp:kind": m.kind,
        "origaminlp:certificate": m.certificate,
        "origaminlp:closureResidual": m.closure_residual,
        "origaminlp:kktResidual": m.kkt_residual if math.isfinite(m.kkt_residual) else None,
        "origaminlp:multipliers": [{"contact": c.text, "moment": c.multiplier} for c in m.contacts],
        **({"origaminlp:fullSpace": full.verdict} if full else {}),
    }


def folded_frame(vertex: Vertex, fold_angles: np.ndarray, title: str) -> dict[str, Any]:
    """Return one folded state [N] as a frame of a FOLD file."""
    creases, _ = fold_vertex(vertex, fold_angles)
    orders = face_orders(creases, fold_angles)
    n = len(fold_angles)
    return {
        "frame_title": title,
        "frame_classes": ["foldedForm"],
        "frame_attributes": ["3D", "selfTouching" if orders else "nonSelfTouching"],
        "frame_parent": 0,
        "frame_inherit": True,
        "vertices_coords": [[0.0, 0.0, 0.0], *creases.tolist()],
        "edges_assignment": [*(_letter(v) for v in fold_angles), *"B" * n],
        "edges_foldAngle": [*np.degrees(fold_angles).tolist(), *[0.0] * n],
        "faceOrders": orders,
    }


def face_orders(creases: np.ndarray, fold_angles: np.ndarray) -> list[list[int]]:
    """Return FOLD's faceOrders of a state: [f, g, s], face f on the side of g's normal (s = 1) or not (-1).

    The left of an arc, seen from outside the sphere, is the side of its facet's normal c_i x c_{i+1}.
    """
    problem = layer_problem(creases, fold_angles, TOUCHES)
    order = problem.order() if problem is not None else None
    if problem is None or order is None:
        return []
    found: dict[tuple[int, int], int] = {}
    for strands in problem.segments.values():
        for (a, _), (b, run) in itertools.combinations(strands, 2):
            pair, flip = ordered(a, b)
            left = order[pair] != flip  # a is left of b, along the segment
            found.setdefault((a[0], b[0]), 1 if left == (run > 0) else -1)
    return [[f, g, s] for (f, g), s in sorted(found.items())]


def write_mesh(result: MinimaResult, target: str | Path) -> None:
    """Write the states side by side as one triangle mesh, by way of trimesh (extra ``mesh``).

    Parameters
    ----------
    result
        Of `find_minima`.
    target
        The file, ``.obj``, ``.stl`` or ``.glb``.

    Raises
    ------
    OptionError
        If trimesh is not installed, the name ends in something else, there is no minimum, or the file cannot be
        written.

    Examples
    --------
    >>> import pathlib, tempfile, origami_nlp as o
    >>> path = pathlib.Path(tempfile.mkdtemp(), "states.stl")
    >>> o.write_mesh(o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16), path)
    >>> path.stat().st_size > 0
    True
    """
    suffix = check_mesh(target)
    import trimesh

    n = result.scene.degree
    faces = np.array([[0, i, i % n + 1] for i in range(1, n + 1)])
    parts = []
    for k, m in enumerate(result.minima):
        creases, _ = fold_vertex(result.scene.vertex, np.array(m.fold_angles))
        points = np.vstack([np.zeros((1, 3)), creases]) + np.array([2.5 * k, 0.0, 0.0])
        parts.append(trimesh.Trimesh(points, faces, process=False))
    if not parts:
        raise OptionError(f"--mesh = {str(target)!r}: no minimum was found to write")
    content = trimesh.util.concatenate(parts).export(None, file_type=suffix[1:])
    write_whole(target, content.encode() if isinstance(content, str) else content)


def check_mesh(target: str | Path) -> str:
    """Return the suffix of a mesh file, after seeing that it can be written (see `write_mesh`)."""
    from importlib.util import find_spec

    suffix = Path(target).suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise OptionError(
            f"--mesh = {str(target)!r}: the name must end in {', '.join(MESH_SUFFIXES)}"
        )
    if find_spec("trimesh") is None:
        raise OptionError('--mesh needs trimesh: pip install "origami_nlp[mesh]"')
    return suffix
