"""Folded vertices as a FOLD file (spec 1.1): the crease pattern, and one folded frame a state.

The vertex is drawn as a disc of unit creases: vertex 0 in the middle, vertex i at the end of crease i; edge
i - 1 is crease i, face i - 1 the facet between creases i and i + 1.  Targets of the crease pattern
(``edges_foldAngle``, degrees) are the rest angles; stiffness, rest angles and preload are kept in the namespace
``origaminlp`` too, so that reading the file gives the same scene.  Where layers touch, ``faceOrders`` holds one
order that is free of crossings.  Coordinates of a folded frame: the frame of the paper, last facet in the plane.
"""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_path
from origami_nlp.folding.embedding import fold_vertex
from origami_nlp.folding.layers import layer_problem, ordered
from origami_nlp.io import write_whole
from origami_nlp.numerics import CONTACT_TOL
from origami_nlp.pattern import (
    FIXED_KEY,
    LIMITS_KEY,
    LOADS_KEY,
    PRELOAD_KEY,
    REST_KEY,
    STIFFNESS_KEY,
    Scene,
    laws_to_fold,
)
from origami_nlp.version import __version__

MOST_FRAMES = 61
"""States of one path that are written; a viewer shows them as a film."""


def frames_to_fold(scene: Scene, frames: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Return FOLD data with the crease pattern of a scene and folded states of it.

    Parameters
    ----------
    scene
        The scene.
    frames
        Of `folded_frame`.

    Returns
    -------
    dict
        A flat sheet has its crease pattern as the file's own frame; paper that does not lie flat has no flat pattern,
        and the first state takes its place (without one there is no frame with geometry).
    """
    n = scene.degree
    rim = [*range(1, n + 1)]
    states = list(frames)
    data: dict[str, Any] = {
        "file_spec": 1.1,
        "file_creator": f"origami_nlp {__version__}",
        "file_classes": ["singleModel"],
        "file_title": scene.name or "origami vertex",
        "edges_vertices": [[0, i] for i in rim] + [[i, i % n + 1] for i in rim],
        "faces_vertices": [[0, i, i % n + 1] for i in rim],
        STIFFNESS_KEY: [*scene.stiffness, *[None] * n],
        REST_KEY: [*(math.degrees(a) for a in scene.rest_angles), *[None] * n],
        **_loads(scene),
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
            **_letters_and_angles(scene.rest_angles),
        }
    elif states:
        own = ("frame_inherit", "frame_parent")
        data |= {key: value for key, value in states[0].items() if key not in own}
        states = states[1:]
    data["file_frames"] = states
    return data


def _loads(scene: Scene) -> dict[str, Any]:
    out: dict[str, Any] = {}
    if scene.preload:
        out[PRELOAD_KEY] = [*scene.preload, *[None] * scene.degree]
    if scene.laws:
        out |= laws_to_fold(scene.laws, scene.degree)
    if scene.limits:
        out[LIMITS_KEY] = [*np.degrees(scene.limits).tolist(), *[None] * scene.degree]
    if scene.loads:
        out[LOADS_KEY] = [load.to_dict() for load in scene.loads]
        out[FIXED_KEY] = scene.fixed_facet
    return out


def folded_frame(
    scene: Scene, fold_angles: Sequence[float], title: str, **more: Any
) -> dict[str, Any]:
    """Return a folded state of a scene as a frame of FOLD, which inherits from the crease pattern.

    Parameters
    ----------
    scene
        The scene.
    fold_angles
        All N [rad], closed.
    title
        Of the frame.
    more
        Values of our own keys, by their names without the namespace.

    Returns
    -------
    dict
        The frame.
    """
    phi = np.asarray(fold_angles, dtype=float)
    creases, _ = fold_vertex(scene.vertex, phi)
    orders = face_orders(creases, phi)
    return {
        "frame_title": title,
        "frame_classes": ["foldedForm"],
        "frame_attributes": ["3D", "selfTouching" if orders else "nonSelfTouching"],
        "frame_parent": 0,
        "frame_inherit": True,
        "vertices_coords": [[0.0, 0.0, 0.0], *creases.tolist()],
        **_letters_and_angles(phi.tolist()),
        "faceOrders": orders,
        **{f"origaminlp:{name}": value for name, value in more.items()},
    }


def path_frames(
    frame: Callable[..., dict[str, Any]],
    states: np.ndarray,
    energies: Sequence[float] | np.ndarray,
    title: str,
) -> list[dict[str, Any]]:
    """Return states along a path as frames of FOLD, at most `MOST_FRAMES` of them.

    Parameters
    ----------
    frame
        Makes a frame of fold angles [N], a title and what else is known: of a scene (`folded_frame`), or a pattern.
    states
        Fold angles [M, N] [rad], in order.
    energies
        [M].
    title
        Of the path; frames are numbered after it.

    Returns
    -------
    list of dict
        Frames, evenly spread over the length of the path, with its ends and its highest state.
    """
    states = np.asarray(states, dtype=float)
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(states, axis=0), axis=1))])
    wanted = np.searchsorted(length, np.linspace(0.0, length[-1], MOST_FRAMES - 1))
    shown = np.unique([*np.clip(wanted, 0, len(states) - 1), int(np.argmax(energies))])
    if len(states) <= MOST_FRAMES:
        shown = np.arange(len(states))
    return [
        frame(
            states[k],
            f"{title}, {number} of {len(shown)}: {energies[k]:.6g} J",
            energy=float(energies[k]),
            path=title,
        )
        for number, k in enumerate(shown.tolist(), start=1)
    ]


def face_orders(creases: np.ndarray, fold_angles: np.ndarray) -> list[list[int]]:
    """Return FOLD's faceOrders of a state: [f, g, s], face f on the side of g's normal (s = 1) or not (-1).

    The left of an arc, seen from outside the sphere, is the side of its facet's normal c_i x c_{i+1}.

    Parameters
    ----------
    creases
        Unit vectors c_i of the folded state, [N, 3].
    fold_angles
        All N [rad].

    Returns
    -------
    list
        Triples, sorted; empty where no layers touch.
    """
    problem = layer_problem(creases, fold_angles, CONTACT_TOL)
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


def _letters_and_angles(angles: Sequence[float]) -> dict[str, Any]:
    # 0 is F, not U: Origami Simulator makes hinges of M, V and F only; our stiffness says that it is a crease
    letters = ["V" if a > 0 else "M" if a < 0 else "F" for a in angles]
    pad = [0.0] * len(letters)
    return {
        "edges_assignment": [*letters, *"B" * len(letters)],
        "edges_foldAngle": [*map(math.degrees, angles), *pad],
    }


def save_fold(data: dict[str, Any], target: str | Path) -> None:
    """Write FOLD data as a file, whole or not at all; ``"-"`` for standard output.

    Parameters
    ----------
    data
        Of `frames_to_fold`.
    target
        The file.

    Raises
    ------
    OptionError
        If `target` is no path, or the file cannot be written.
    """
    check_path("target", target)
    write_whole(target, (json.dumps(data, indent=1, allow_nan=False) + "\n").encode())
