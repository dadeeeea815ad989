"""States of a sheet as a FOLD file (spec 1.1) that others open, and as a mesh.

The file's own frame is the reference state; every state is a frame with its coordinates and fold angles.  Edges are the
creases in their order, then joined sides, then the border; stiffness and rest angles are kept in the namespace
``origaminlp`` too, so that reading the file gives the same pattern.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from origami_nlp.folding import folded_frame, frames_to_fold
from origami_nlp.pattern import (
    LATTICE_KEY,
    LIMITS_KEY,
    REST_KEY,
    ROLLED_KEY,
    STIFFNESS_KEY,
    Pattern,
    Scene,
    in_plane,
    laws_to_fold,
)
from origami_nlp.pattern_problem.crossings import PatternCrossings
from origami_nlp.pattern_problem.layers import order_layers
from origami_nlp.pattern_problem.poses import Poses
from origami_nlp.pattern_problem.problem import PatternProblem
from origami_nlp.version import __version__

ROOM = 1.25
"""States of a mesh stand apart by this many sizes of the sheet."""


def states_to_fold(
    origami: Scene | Pattern, frames: Iterable[dict[str, Any]] = ()
) -> dict[str, Any]:
    """Return a vertex or a pattern as FOLD data (spec 1.1), with states of it as frames.

    Parameters
    ----------
    origami
        What is folded.
    frames
        Of `state_frame`.

    Returns
    -------
    dict
        For `json.dump`: as `folding.frames_to_fold` or `pattern_to_fold` has it.
    """
    made = frames_to_fold if isinstance(origami, Scene) else pattern_to_fold
    return made(origami, frames)  # type: ignore[arg-type]


def state_frame(
    origami: Scene | Pattern, fold_angles: Sequence[float] | np.ndarray, title: str, **more: Any
) -> dict[str, Any]:
    """Return a folded state of a vertex or a pattern as a frame of FOLD.

    Parameters
    ----------
    origami
        What is folded.
    fold_angles
        Of a closed state, [N] [rad].
    title
        Of the frame.
    more
        Values of our own keys, by their names without the namespace.

    Returns
    -------
    dict
        As `folding.folded_frame` or `pattern_frame` has it.
    """
    made: Any = folded_frame if isinstance(origami, Scene) else pattern_frame
    frame: dict[str, Any] = made(origami, fold_angles, title, **more)
    return frame


def pattern_to_fold(pattern: Pattern, frames: Iterable[dict[str, Any]] = ()) -> dict[str, Any]:
    """Return a pattern as FOLD data, with states of it as frames.

    Parameters
    ----------
    pattern
        The sheet.
    frames
        Of `pattern_frame`.

    Returns
    -------
    dict
        For `json.dump`; fold angles of a flat reference state are its rest angles, the targets of other programs.

    Examples
    --------
    >>> import json
    >>> from origami_nlp.pattern import examples, frame_pattern, parse_fold
    >>> from origami_nlp.pattern_problem import pattern_to_fold
    >>> (frame,) = parse_fold(json.dumps(pattern_to_fold(examples.pattern("miura", 2, 2))))
    >>> frame_pattern(frame)
    Pattern('Miura, alpha = pi/3': 4 facets, 4 creases, 1 interior vertices)
    """
    p = pattern
    others = p.other_sides
    none = [None] * len(others)
    kind, attribute = ("creasePattern", "2D") if p.is_flat else ("foldedForm", "3D")
    letters = [*p.assignment, *_letters(p)]
    return {
        "file_spec": 1.1,
        "file_creator": f"origami_nlp {__version__}",
        "file_classes": ["singleModel"],
        "file_title": p.name or "pattern",
        "frame_classes": [kind],
        "frame_attributes": [attribute],
        "vertices_coords": (in_plane(p) if p.is_flat else p.corners).tolist(),
        "edges_vertices": [*p.ends.tolist(), *map(list, others)],
        "edges_assignment": letters,
        "edges_foldAngle": _degrees(p.rest if p.is_flat else p.reference, len(others)),
        "faces_vertices": [list(q) for q in p.polygons],
        **({} if p.is_flat or not p.orders else {"faceOrders": [list(o) for o in p.orders]}),
        STIFFNESS_KEY: [*p.stiffness.tolist(), *none],
        REST_KEY: [*np.degrees(p.rest).tolist(), *none],
        **laws_to_fold(p.laws, len(others)),
        **({LIMITS_KEY: [*np.degrees(p.limits).tolist(), *none]} if p.limits else {}),
        **({LATTICE_KEY: p.cell.lattice[:, :2].tolist()} if p.cell else {}),
        **({ROLLED_KEY: list(p.cell.rolled)} if p.cell and p.cell.rolled is not None else {}),
        "file_frames": list(frames),
    }


def pattern_frame(
    pattern: Pattern, fold_angles: Sequence[float] | np.ndarray, title: str, **more: Any
) -> dict[str, Any]:
    """Return a folded state as a frame of FOLD that inherits from the pattern's own.

    Where facets lie on each other, ``faceOrders`` holds one order that is free of crossings, if one was found.

    Parameters
    ----------
    pattern
        The sheet.
    fold_angles
        Of a closed state, [n] [rad].
    title
        Of the frame.
    more
        Values of our own keys, by their names without the namespace.

    Returns
    -------
    dict
        The frame, with the coordinates of every vertex.
    """
    phi = np.asarray(fold_angles, float)
    letters = ["M" if a < 0 else "V" if a > 0 else "F" for a in phi]
    x = pattern_corners(pattern, phi)
    layers = order_layers(PatternProblem(pattern), phi)
    planar = pattern.cell is not None and pattern.cell.rolled is None
    return {
        "frame_title": title,
        "frame_classes": ["foldedForm"],
        "frame_attributes": ["3D", *(["selfTouching"] if layers.pairs else [])],
        "frame_parent": 0,
        "frame_inherit": True,
        "vertices_coords": x.tolist(),
        "edges_assignment": [*letters, *_letters(pattern)],
        "edges_foldAngle": _degrees(phi, len(pattern.other_sides)),
        "faceOrders": [list(order) for order in layers.orders],
        **({LATTICE_KEY: PatternCrossings(pattern).lattice(phi).tolist()} if planar else {}),
        **{f"origaminlp:{name}": value for name, value in more.items()},
    }


def pattern_corners(pattern: Pattern, fold_angles: Sequence[float] | np.ndarray) -> np.ndarray:
    """Return where the corners of a pattern are in a folded state.

    Parameters
    ----------
    pattern
        The sheet.
    fold_angles
        Of a closed state, [n] [rad].

    Returns
    -------
    ndarray
        Coordinates [V, 3] in the pattern's unit, in the order of its corners; the facet in the middle stays.
    """
    phi = np.asarray(fold_angles, float)
    x = Poses(pattern).corners(phi)[: len(pattern.corners)]  # of a cell without its neighbours
    return np.where(np.isnan(x), pattern.corners, x)  # vertices of no facet stay


def pattern_parts(
    pattern: Pattern, states: Sequence[np.ndarray]
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return states side by side, each as triangles.

    Parameters
    ----------
    pattern
        The sheet.
    states
        Fold angles [n] [rad] of each.

    Returns
    -------
    list of tuple
        Points [v, 3] and triangles [f, 3]; what pads convex pieces to one length is triangles without area.
    """
    if pattern.cell:
        pattern, crease_of = pattern.cell.tiles
        states = [np.asarray(phi, float)[crease_of] for phi in states]
    crossings = PatternCrossings(pattern)
    pieces, q = crossings.pieces.shape
    fan = np.array([(0, i, i + 1) for i in range(1, q - 1)])
    faces = (q * np.arange(pieces)[:, None, None] + fan).reshape(-1, 3)
    aside = np.array([ROOM * crossings.size, 0.0, 0.0])
    placed = (crossings.placed(np.asarray(phi, float)).reshape(-1, 3) for phi in states)
    return [(x + k * aside, faces) for k, x in enumerate(placed)]


def _letters(p: Pattern) -> list[str]:
    """Return what sides that are no creases are: joined where two polygons share them, else borders."""
    return ["J" if many > 1 else "B" for many in p.other_sides.values()]


def _degrees(phi: np.ndarray, others: int) -> list[float]:
    return [math.degrees(a) for a in phi] + [0.0] * others
