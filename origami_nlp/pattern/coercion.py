"""What is folded, however it is stated: itself, the name of an example, a file, FOLD data, or a mesh."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type, shown
from origami_nlp.errors import OptionError
from origami_nlp.numerics import PLACES
from origami_nlp.pattern import examples
from origami_nlp.pattern.fold_file import parse_fold
from origami_nlp.pattern.pattern_file import frame_pattern, read_pattern
from origami_nlp.pattern.polygons import Side, side, sides_of
from origami_nlp.pattern.scene import Scene
from origami_nlp.pattern.scene_file import read_scene
from origami_nlp.pattern.sheet import Pattern
from origami_nlp.pattern.vertex import Vertex

Stated = Scene | Pattern | Mapping[str, Any] | str | PathLike[str]
"""How an origami may be stated: itself, FOLD data as a dict, the name of an example, or a file."""


def as_origami(stated: Stated) -> Scene | Pattern:
    """Return what is folded, one vertex as a scene or a whole pattern, however it is stated.

    Parameters
    ----------
    stated
        A scene, or a scene file (``.toml``); or what `as_pattern` takes.

    Returns
    -------
    Scene or Pattern
        The one or the other.

    Raises
    ------
    OptionError, FoldFileError, SceneFileError
        As `as_pattern` and `read_scene`.

    Examples
    --------
    >>> from origami_nlp.pattern import as_origami, examples
    >>> as_origami("metasheet:2x3")
    Pattern('metasheet': 6 facets, 7 creases, 2 interior vertices)
    >>> as_origami(examples.waterbomb()).degree
    6
    """
    if isinstance(stated, Scene):
        return stated
    if isinstance(stated, str | PathLike) and Path(fspath(stated)).suffix.lower() == ".toml":
        return read_scene(fspath(stated))
    return as_pattern(stated, "origami")


def as_scene(stated: Stated, asked: str = "this", instead: str = "") -> Scene:
    """Return the one vertex that a question is asked of, however it is stated.

    Parameters
    ----------
    stated
        As `as_origami` takes it.  A pattern is taken as the scene that it equals, without symmetry and with full
        contact: where it has one interior vertex with all its creases, and no paper beyond the sectors between them.
    asked, instead
        What is asked of one vertex alone, and what takes a pattern: for what is said of others.

    Returns
    -------
    Scene
        The vertex with its springs.

    Raises
    ------
    OptionError
        If it is a pattern that equals no scene; and as `as_origami`.

    Examples
    --------
    >>> from origami_nlp.pattern import as_scene
    >>> as_scene("waterbombbase").degree
    8
    """
    if not isinstance(stated, Pattern | str | PathLike):
        check_type("scene", stated, Scene)
    origami = as_origami(stated)
    scene = origami if isinstance(origami, Scene) else _equal_scene(origami)
    if scene is None:
        more = f"; {instead}" if instead else ""
        take = f"{asked} is for one vertex: read_fold_scene(file, vertex=K) takes one{more}"
        raise OptionError(f"scene = {origami!r}: {take}")
    return scene


def _equal_scene(pattern: Pattern) -> Scene | None:
    """Return the scene that a pattern equals; None where there is none."""
    n = pattern.creases
    if len(pattern.vertices) != 1 or pattern.holes or pattern.cell:
        return None
    loop = pattern.vertices[0]
    first = loop.creases.index(0) if 0 in loop.creases else 0
    if loop.creases[first:] + loop.creases[:first] != tuple(range(n)):
        return None
    ends, x = pattern.ends, pattern.corners
    along = x[ends.sum(axis=1) - loop.vertex] - x[loop.vertex]

    def angle(a: np.ndarray, b: np.ndarray) -> float:
        return float(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))

    sectors = []
    for i in range(n):
        j = (i + 1) % n
        (facet,) = {pattern.left[i], pattern.right[i]} & {pattern.left[j], pattern.right[j]}
        sectors.append(angle(along[i], along[j]))
        pieces = (p for p, f in zip(pattern.polygons, pattern.facet_of, strict=True) if f == facet)
        for corner in {c for piece in pieces for c in piece} - {loop.vertex}:
            way = x[corner] - x[loop.vertex]
            if angle(along[i], way) + angle(way, along[j]) - sectors[i] > PLACES:
                return None
    springs = tuple(pattern.stiffness.tolist()), tuple(pattern.rest.tolist())
    vertex = Vertex(tuple(sectors))
    limits, laws = pattern.limits, pattern.laws
    return Scene(vertex, *springs, "none", "full", name=pattern.name, limits=limits, laws=laws)


def as_pattern(
    stated: Pattern | Mapping[str, Any] | str | PathLike[str], name: str = "pattern"
) -> Pattern:
    """Return a pattern, however it is stated.

    Parameters
    ----------
    stated
        The pattern itself, the name of an example with its size, such as ``"miura:4x6"``, a FOLD file, or what one
        holds as a dict.
    name
        Of the argument, for what is said of a wrong one.

    Returns
    -------
    Pattern
        The sheet with its springs.

    Raises
    ------
    OptionError
        If it is neither of these, or the example has no such size.
    FoldFileError
        If the file is no FOLD file, or its frame is no sheet of rigid facets.

    Examples
    --------
    >>> from origami_nlp.pattern import as_pattern
    >>> as_pattern("metasheet:2x3")
    Pattern('metasheet': 6 facets, 7 creases, 2 interior vertices)
    """
    if isinstance(stated, str) and examples.is_example(stated):
        return examples.pattern(stated)
    if isinstance(stated, str | PathLike):
        return read_pattern(Path(stated))
    if isinstance(stated, Mapping):
        return frame_pattern(parse_fold(stated, "first")[0])
    check_type(name, stated, Pattern)
    return stated


def from_mesh(
    vertices: Sequence[Sequence[float]] | np.ndarray,
    faces: Sequence[Sequence[int]],
    assignment: Mapping[Side, str] | str = "U",
    *,
    stiffness: float | Sequence[float] | np.ndarray = 1.0,
    rest_angles: float | Sequence[float] | np.ndarray = math.pi,
) -> Pattern:
    """Make a pattern of a mesh: every side that two faces share is a crease.

    Parameters
    ----------
    vertices
        [V, 2] of a flat sheet, or [V, 3]; points out of one plane are those of a folded form, which is measured.
    faces
        Vertices of each, from 0, all of one sense; counter-clockwise where the sheet is flat.
    assignment
        Of a side, by its two vertices, the letter of FOLD: ``"M"``, ``"V"``, ``"U"``, ``"F"`` (no crease),
        ``"C"`` (a cut).  Sides that are not named are ``"U"``; or one letter for all.
    stiffness
        Of each crease [N m/rad], in the order of the creases of the pattern (by their vertices), or one for all.
    rest_angles
        Likewise [rad].  One for all is a size: valleys rest at it, mountains at less it, others flat.

    Returns
    -------
    Pattern
        `Pattern.ends` has the vertices of each crease.

    Raises
    ------
    FoldFileError
        If the faces are no sheet of rigid facets.
    OptionError, SceneError
        If there are not as many numbers as creases, or a side of `assignment` is none of the mesh.

    Examples
    --------
    >>> import origami_nlp as o
    >>> square = [(0, 0), (1, 0), (1, 1), (0, 1), (0.5, 0.5)]
    >>> faces = [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
    >>> letters = {(0, 4): "M", (1, 4): "V", (2, 4): "M", (3, 4): "M"}
    >>> pattern = o.from_mesh(square, faces, letters, stiffness=2.0, rest_angles=1.5)
    >>> pattern.stiffness.tolist(), pattern.rest.tolist()
    ([2.0, 2.0, 2.0, 2.0], [-1.5, 1.5, -1.5, -1.5])
    """
    try:
        points = np.asarray(vertices, float)
        rings = [tuple(int(v) for v in face) for face in faces]
        all_alike = isinstance(assignment, str)
        stated = {} if all_alike else {(a, b): x for (a, b), x in assignment.items()}  # type: ignore[union-attr]
        k, rest = np.asarray(stiffness, float), np.asarray(rest_angles, float)
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            raise ValueError(f"vertices has shape {points.shape}")
    except (TypeError, ValueError, AttributeError) as error:
        what = "vertices [V, 2] or [V, 3], faces, letters by pairs of vertices, and numbers"
        raise OptionError(f"a mesh is {what}: {error}") from None
    inner = assignment if all_alike else "U"
    letter = {s: inner if len(around) > 1 else "B" for s, around in sides_of(rings).items()}
    for (a, b), x in stated.items():
        if side(a, b) not in letter:
            raise OptionError(f"assignment[{shown((a, b))}]: these are no side of a face")
        letter[side(a, b)] = x
    flat = points.shape[1] == 2 or not np.ptp(points[:, 2])
    edges = sorted(letter)
    known: dict[str, Any] = {
        "vertices_coords": points.tolist(),
        "faces_vertices": [list(f) for f in rings],
        "edges_vertices": [list(e) for e in edges],
        "edges_assignment": [letter[e] for e in edges],
        "file_title": "mesh",
        "frame_classes": ["creasePattern" if flat else "foldedForm"],
    }
    size = {} if rest.ndim else {"rest_angle": float(rest)}
    made = frame_pattern(parse_fold(known, "first")[0], rest_from="file", **size)
    return made.with_springs(k.tolist(), rest.tolist() if rest.ndim else None)
