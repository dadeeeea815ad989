"""A pattern of a mesh: points, the facets that they bound, and which sides of these are creases."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from origami_nlp.arguments import shown
from origami_nlp.errors import OptionError
from origami_nlp.pattern.fold_file import frame_of
from origami_nlp.pattern.pattern_file import frame_pattern
from origami_nlp.pattern.polygons import sides_of
from origami_nlp.pattern.sheet import Pattern

Side = tuple[int, int]


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
        stated = (
            {} if isinstance(assignment, str) else {(a, b): x for (a, b), x in assignment.items()}
        )
        k, rest = np.asarray(stiffness, float), np.asarray(rest_angles, float)
        if points.ndim != 2 or points.shape[1] not in (2, 3):
            raise ValueError(f"vertices has shape {points.shape}")
    except (TypeError, ValueError, AttributeError) as error:
        raise OptionError(
            f"a mesh is vertices [V, 2] or [V, 3], the vertices of each face, letters by pairs of vertices, and "
            f"numbers: {error}"
        ) from None
    rest_of_all = assignment if isinstance(assignment, str) else "U"
    letter = {s: rest_of_all if len(around) > 1 else "B" for s, around in sides_of(rings).items()}
    for (a, b), x in stated.items():
        if (min(a, b), max(a, b)) not in letter:
            raise OptionError(
                f"assignment[{shown((a, b))}]: vertices {a} and {b} are no side of a face"
            )
        letter[min(a, b), max(a, b)] = x
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
    made = frame_pattern(frame_of(known), rest_from="file", **size)
    return made.with_springs(k.tolist(), rest.tolist() if rest.ndim else None)
