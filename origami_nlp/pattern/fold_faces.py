"""The faces of a FOLD frame: walked round in a drawing, or stated and turned alike; what is wrong with them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from origami_nlp.drawings import half_edges
from origami_nlp.errors import FoldFileError
from origami_nlp.numerics import INPUT_TOL, groups
from origami_nlp.pattern.fold_file import Frame
from origami_nlp.pattern.polygons import area, sides_of


def face_walks(frame: Frame) -> list[tuple[int, ...]]:
    """Walk around every face of a flat drawing, keeping it on the left, none round the outside of a piece."""
    xy, m = frame.coords[:, :2], len(frame.edges)
    tail, _, after = half_edges(xy, frame.edges)
    seen: set[int] = set()
    found = []
    for step in np.lexsort((np.tile(np.arange(m), 2), tail)).tolist():
        walk = []
        while step not in seen:
            seen.add(step)
            walk.append(int(tail[step]))
            step = int(after[step])
        if walk and area(xy[walk]) > 0:
            found.append(tuple(walk))
    return found


def oriented(faces: Sequence[tuple[int, ...]]) -> tuple[list[tuple[int, ...]], int]:
    """Turn faces so that neighbours run along a common side in opposite directions; how many were turned."""
    along = {(k, f[i - 1], v) for k, f in enumerate(faces) for i, v in enumerate(f)}
    joined = []  # faces as they are, 2 k, and turned over, 2 k + 1
    for (a, b), (k, *others) in sides_of(faces).items():
        for other in others:
            over = ((k, a, b) in along) == ((other, a, b) in along)
            joined += [(2 * k, 2 * other + over), (2 * k + 1, 2 * other + 1 - over)]
    alike = groups(2 * len(faces), joined).reshape(-1, 2)
    turned = alike[:, 0] > alike[:, 1]  # the first of those that hang together stays
    out = [f[::-1] if over else f for f, over in zip(faces, turned, strict=True)]
    return out, int(turned.sum())


class Oddity(NamedTuple):
    """What is wrong with a frame, as its message says it, and the vertices, edges and faces of the file there."""

    text: str
    vertices: tuple[int, ...] = ()
    edges: tuple[int, ...] = ()
    faces: tuple[int, ...] = ()
    size: float | None = None


def check_drawing(frame: Frame) -> None:
    """Raise an error for edges that cross, or pass through a vertex, in a drawing whose faces are to be traced."""
    for one in drawing_oddities(frame):
        raise FoldFileError(one.text)


def drawing_oddities(frame: Frame) -> Iterator[Oddity]:
    """Go through edges of a drawing that cross, or pass through a vertex.

    Parameters
    ----------
    frame
        A flat one.

    Returns
    -------
    iterator of Oddity
        One each.
    """
    from shapely import STRtree, linestrings, points

    xy = frame.coords[:, :2]
    lines = linestrings(xy[frame.edges])
    tree = STRtree(lines)
    near = INPUT_TOL * float(np.ptp(xy, axis=0).max())
    used = np.unique(frame.edges)
    which, through = tree.query(points(xy[used]), predicate="dwithin", distance=near)
    same, touching = set(), set[tuple[int, int]]()
    for v, e in zip(used[which].tolist(), through.tolist(), strict=True):
        if v in frame.edges[e] or (twins := coincident(frame, [v])) in same:
            continue
        same |= {twins} - {""}
        beside = np.flatnonzero((frame.edges == v).any(axis=1)).tolist()
        touching |= {(e, other) for other in beside} | {(other, e) for other in beside}
        number = int(frame.numbers[e])
        text = twins or f"edges_vertices[{number}] passes through vertex {v}: split it there"
        yield Oddity(text, (v,), () if twins else (number,))
    pairs = {(min(i, j), max(i, j)) for i, j in tree.query(lines, predicate="crosses").T.tolist()}
    for i, j in sorted(pairs - touching):  # else in the vertex through which one of them passes
        a, b = sorted((int(frame.numbers[i]), int(frame.numbers[j])))
        text = f"edges_vertices[{a}] and [{b}] cross without a vertex: split both where they meet"
        yield Oddity(text, (), (a, b))


def coincident(frame: Frame, vertices: Iterable[int]) -> str:
    """Name another vertex in the place of one of some, and what to do; or '' where there is none."""
    near = INPUT_TOL * float(np.ptp(frame.coords, axis=0).max())
    for v in vertices:
        off = np.linalg.norm(frame.coords - frame.coords[v], axis=1)
        off[v] = np.inf
        if off.min() <= near:
            a, b = sorted((int(v), int(off.argmin())))
            return f"vertices {a} and {b} are in the same place, make them one vertex"
    return ""


Face = tuple[int, ...]


def check_sides(faces: Sequence[Face]) -> None:
    """Raise an error for faces, oriented alike as far as can be, that come back to each other turned over."""
    directed = Counter((f[i - 1], v) for f in faces for i, v in enumerate(f))
    for (a, b), count in directed.items():
        if count == 2 and (b, a) not in directed:
            why = f"across the edge between vertices {a} and {b} they come back turned over"
            raise FoldFileError(f"faces_vertices cannot be oriented alike (Moebius band): {why}")
