"""States of an origami as a FOLD file (spec 1.1) that others open, and as a mesh.

The file's own frame is the reference state; every state is a frame with its coordinates and fold angles.  Edges are the
creases in their order, then joined sides, then the border; stiffness and rest angles are kept in the namespace
``origaminlp`` too, so that reading the file gives the same origami.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from origami_nlp.arguments import check_path
from origami_nlp.io import write_whole
from origami_nlp.pattern import (
    FIXED_KEY,
    LATTICE_KEY,
    LIMITS_KEY,
    LOADS_KEY,
    PRELOAD_KEY,
    REST_KEY,
    ROLLED_KEY,
    STIFFNESS_KEY,
    Origami,
    Pattern,
    in_plane,
    laws_to_fold,
)
from origami_nlp.pattern_problem.crossings import PatternCrossings
from origami_nlp.pattern_problem.layers import order_layers
from origami_nlp.pattern_problem.poses import Poses
from origami_nlp.pattern_problem.problem import PatternProblem
from origami_nlp.version import __version__

MeshFaces: TypeAlias = tuple[tuple[int, ...], ...]
"""Corners of each facet, from 0."""
MOST_FRAMES = 61
"""States of one path that are written; a viewer shows them as a film."""
ROOM = 1.25
"""States of a mesh stand apart by this many sizes of the sheet."""


def states_to_fold(origami: Origami, frames: Iterable[dict[str, Any]] = ()) -> dict[str, Any]:
    """Return an origami as FOLD data (spec 1.1), with states of it as frames.

    Parameters
    ----------
    origami
        A vertex is drawn as a disc of unit creases: vertex i at the end of crease i, vertex 0 in the middle.
    frames
        Of `state_frame`.

    Returns
    -------
    dict
        For `json.dump`; fold angles of a flat reference state are its rest angles, the targets of other programs.

    Examples
    --------
    >>> import json
    >>> from origami_nlp.pattern import examples, frame_pattern, parse_fold
    >>> from origami_nlp.pattern_problem import states_to_fold
    >>> (frame,) = parse_fold(json.dumps(states_to_fold(examples.pattern("miura", 2, 2))))
    >>> frame_pattern(frame)
    Pattern('Miura, alpha = pi/3': 4 facets, 4 creases, 1 interior vertices)
    """
    p = _paper(origami)
    others = p.other_sides

    def each(values: Iterable[Any]) -> list[Any]:
        return [*values, *[None] * len(others)]

    kind, attribute = ("creasePattern", "2D") if p.is_flat else ("foldedForm", "3D")
    seldom: dict[str, Any] = {
        "faceOrders": not p.is_flat and [list(o) for o in p.orders],
        LIMITS_KEY: p.limits and each(np.degrees(p.limits).tolist()),
        LATTICE_KEY: p.cell and p.cell.lattice[:, :2].tolist(),
        ROLLED_KEY: p.cell and p.cell.rolled is not None and list(p.cell.rolled),
    }
    seldom |= {f"origaminlp:{key}": getattr(origami, key) for key in ("symmetry", "contact")}
    seldom[PRELOAD_KEY] = origami.preload and each(origami.preload)
    seldom[LOADS_KEY] = [load.to_dict() for load in origami.loads]
    seldom[FIXED_KEY] = origami.loads and origami.fixed_facet
    return {
        "file_spec": 1.1,
        "file_creator": f"origami_nlp {__version__}",
        "file_classes": ["singleModel"],
        "file_title": origami.name or "origami",
        "frame_classes": [kind],
        "frame_attributes": [attribute],
        "vertices_coords": (in_plane(p) if p.is_flat else p.corners).tolist(),
        "edges_vertices": [*p.ends.tolist(), *map(list, others)],
        "edges_assignment": [*p.assignment, *_letters(p)],
        "edges_foldAngle": _degrees(p.rest if p.is_flat else p.reference, len(others)),
        "faces_vertices": [list(q) for q in p.polygons],
        STIFFNESS_KEY: each(p.stiffness.tolist()),
        REST_KEY: each(np.degrees(p.rest).tolist()),
        **laws_to_fold(p.laws, len(others)),
        **{key: value for key, value in seldom.items() if value},
        "file_frames": list(frames),
    }


def _paper(origami: Origami) -> Pattern:
    paper: Pattern = origami.paper
    rest = np.array(origami.rest)
    if paper is origami:
        return paper
    # 0 is F, not U: Origami Simulator makes hinges of M, V and F only; our stiffness says that it is a crease
    # FOLD knows no more than half turns
    reference = np.remainder(paper.reference + math.pi, 2 * math.pi) - math.pi
    shown = rest if paper.is_flat else reference
    return replace(paper, rest=rest, reference=reference, assignment="".join(_signed(shown)))


def state_frame(
    origami: Origami, fold_angles: Sequence[float] | np.ndarray, title: str, **more: Any
) -> dict[str, Any]:
    """Return a folded state as a frame of FOLD that inherits from the origami's own.

    Where facets lie on each other, ``faceOrders`` holds one order that is free of crossings, if one was found.

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
        The frame, with the coordinates of every vertex.
    """
    pattern, phi = _paper(origami), np.asarray(fold_angles, float)
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
        "edges_assignment": [*_signed(phi), *_letters(pattern)],
        "edges_foldAngle": _degrees(phi, len(pattern.other_sides)),
        "faceOrders": [list(order) for order in layers.orders],
        **({LATTICE_KEY: PatternCrossings(pattern).lattice(phi).tolist()} if planar else {}),
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
        Makes a frame of fold angles [N], a title and what else is known: `state_frame` of an origami.
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
    out = []
    for number, k in enumerate(shown.tolist(), start=1):
        name = f"{title}, {number} of {len(shown)}: {energies[k]:.6g} J"
        out.append(frame(states[k], name, energy=float(energies[k]), path=title))
    return out


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


def state_parts(
    origami: Origami, states: Sequence[np.ndarray]
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return states side by side, each as triangles.

    Parameters
    ----------
    origami
        What is folded.
    states
        Fold angles [n] [rad] of each.

    Returns
    -------
    list of tuple
        Points [v, 3] and triangles [f, 3]; what pads convex pieces to one length is triangles without area.
    """
    pattern = _paper(origami)
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


def state_mesh(origami: Origami, phi: np.ndarray) -> tuple[np.ndarray, MeshFaces]:
    """Return a state [N] [rad] as corners [V, 3] and facets, numbered from 0 as in its FOLD file."""
    pattern = _paper(origami)
    return pattern_corners(pattern, phi), tuple(map(tuple, pattern.polygons))


def _signed(phi: np.ndarray) -> list[str]:
    return ["M" if a < 0 else "V" if a > 0 else "F" for a in phi]


def _letters(p: Pattern) -> list[str]:
    """Return what sides that are no creases are: joined where two polygons share them, else borders."""
    return ["J" if many > 1 else "B" for many in p.other_sides.values()]


def _degrees(phi: np.ndarray, others: int) -> list[float]:
    return [math.degrees(a) for a in phi] + [0.0] * others


def save_fold(data: dict[str, Any], target: str | Path) -> None:
    """Write FOLD data as a file, whole or not at all; ``"-"`` for standard output.

    Parameters
    ----------
    data
        Of `states_to_fold`.
    target
        The file.

    Raises
    ------
    OptionError
        If `target` is no path, or the file cannot be written.
    """
    check_path("target", target)
    write_whole(target, (json.dumps(data, indent=1, allow_nan=False) + "\n").encode())
