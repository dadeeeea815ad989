"""Why the faces of a FOLD frame do not hang together in one sheet, and what to change."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from origami_nlp.errors import FoldFileError
from origami_nlp.numerics import TYPED, groups
from origami_nlp.pattern.fold_file import Frame
from origami_nlp.pattern.polygons import sides_of

Face = tuple[int, ...]


def check_sides(faces: Sequence[Face]) -> None:
    """Complain about faces, oriented alike as far as can be, that come back to each other turned over."""
    directed = Counter((f[i - 1], v) for f in faces for i, v in enumerate(f))
    for (a, b), count in directed.items():
        if count == 2 and (b, a) not in directed:
            raise FoldFileError(
                f"faces_vertices cannot be oriented alike: across the edge between vertices {a} and {b} they come back "
                "turned over; on a one-sided surface, a Moebius band, there are no mountains and valleys"
            )


def check_parts(frame: Frame, faces: Sequence[Face], origin: Sequence[int]) -> None:
    """Complain about faces that fall apart.

    Parameters
    ----------
    frame
        Where they are.
    faces
        With corners of their own on both sides of cuts.
    origin
        The vertex of the frame that each corner is.
    """
    part = groups(len(faces), [(fs[0], g) for fs in sides_of(faces).values() for g in fs[1:]])
    count = int(part.max(initial=-1)) + 1
    if count > 1:
        own = [(f, tuple(origin[v] for v in face)) for f, face in enumerate(faces)]
        hint = "" if frame.folded else _hint(frame.coords[:, :2], own, part)
        raise FoldFileError(
            f"the facets fall into {count} parts that no crease joins: "
            + (hint or "give each part a file of its own")
        )


def _hint(xy: np.ndarray, faces: list[tuple[int, Face]], part: np.ndarray) -> str:
    """Look for vertices of one part in the place of a vertex, or on a side, of another."""
    near = TYPED * float(np.ptp(xy, axis=0).max())
    of: dict[int, set[int]] = {}
    for f, face in faces:
        for v in face:
            of.setdefault(v, set()).add(int(part[f]))
    used: np.ndarray = np.array(sorted(of))
    for f, face in faces:
        others = np.asarray(used)[np.array([int(part[f]) not in of[int(v)] for v in used], bool)]
        for i, b in enumerate(face):
            a = face[i - 1]
            side, out = xy[b] - xy[a], xy[others] - xy[a]
            length = float(np.linalg.norm(side))
            along = np.asarray(out @ side / length)
            off = np.abs(out[:, 0] * side[1] - out[:, 1] * side[0]) / length
            on = others[(off <= near) & (along > near) & (along <= length + near)]
            if on.size:
                v = int(on.flat[0])
                if float(np.linalg.norm(xy[v] - xy[b])) <= near:
                    return f"vertices {min(b, v)} and {max(b, v)} are in the same place, make them one vertex"
                return f"vertex {v} lies on the side of a facet from vertex {a} to {b}, add it to that facet"
    return ""
