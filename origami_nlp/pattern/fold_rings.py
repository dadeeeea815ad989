"""Which vertices of a FOLD frame are interior, and what follows what around each: linear in the size of the frame.

And why faces do not hang together in one sheet, and what to change.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from origami_nlp.drawings import half_edges
from origami_nlp.errors import FoldFileError
from origami_nlp.numerics import INPUT_TOL
from origami_nlp.pattern.fold_file import FOLDS, Frame
from origami_nlp.pattern.fold_notes import listed
from origami_nlp.pattern.polygons import area, side, sides_of


class Rings:
    """Which vertices are interior, and the edges and facets around each, counter-clockwise.

    edge[v], next[v]: of each neighbour of vertex v the edge to it, and the neighbour after it.
    """

    def __init__(self, frame: Frame, turned: bool = False) -> None:
        self.frame = frame
        self.turned = turned
        self.edge: list[dict[int, int]] = [{} for _ in frame.coords]
        for e, (a, b) in enumerate(frame.edges.tolist()):
            self.edge[a][b] = self.edge[b][a] = e
        self.notes: tuple[str, ...] = ()
        self.next: list[dict[int, int]] = [{} for _ in frame.coords]
        border = self._by_faces(self._oriented() if frame.folded else face_walks(frame))
        cut = {e for e, a in enumerate(frame.assignment) if a in "BC"}
        outside = {int(v) for e in border | cut for v in frame.edges[e]}
        drawn = sorted(border - cut)
        open_ends = "" if frame.folded else self._open_ends(border, cut)
        if open_ends:
            self.notes = (*self.notes, open_ends)
        elif drawn:
            shown = listed([int(frame.numbers[e]) for e in drawn])
            self.notes = (
                *self.notes,
                f"edges {shown} lie on the border but are drawn as folds: read as borders",
            )
        self.interior = {v for v, n in enumerate(self.edge) if n and v not in outside}

    def around(self, v: int) -> tuple[list[int], str]:
        """Return the neighbours of v counter-clockwise, and why they do not close up (or '')."""
        after = self.next[v]
        if not after:
            return [], "no face of the file touches it: a folded form needs faces_vertices"
        start = min(after)
        ring, here = {start: None}, after[start]  # a dictionary keeps their order
        while here != start:
            if here in ring or here not in after:
                return list(ring), "the faces around it do not close up"
            ring[here] = None
            here = after[here]
        return list(ring), ""

    def _open_ends(self, border: set[int], cut: set[int]) -> str:
        """Describe what to add where creases end in the open, so that vertices inside the paper lie on its outside."""
        of = self.frame.edges.tolist()
        at = {v for e in border for v in of[e]}
        ends = sorted(v for v in at if len(self.edge[v]) == 1)
        lost = [
            v
            for v in sorted(at - {v for e in cut for v in of[e]})
            if sum(self.frame.assignment[e] in FOLDS + "?" for e in self.edge[v].values()) >= 3
        ]
        if not (ends and lost):
            return ""
        return (
            f"creases end in the open (vertices {listed(ends)}), so vertices {listed(lost)} do not count as "
            'interior: add the outline of the paper, edges with assignment "B" that join the ends'
        )

    def _by_faces(self, faces: Sequence[tuple[int, ...]]) -> set[int]:
        """Order by faces; edges with one face only are the border."""
        sides = np.zeros(len(self.frame.edges), dtype=int)
        missing, twisted = set(), False
        for face in faces:
            n = len(face)
            for i, v in enumerate(face):
                after, before = face[(i + 1) % n], face[i - 1]
                twisted |= after in self.next[v]
                self.next[v][after] = before
                if after in self.edge[v]:
                    sides[self.edge[v][after]] += 1
                else:
                    missing.add((v, after))
        if missing:
            self.notes = (*self.notes, f"{len(missing)} sides of faces are no edges of the file")
        if twisted:
            self.notes = (*self.notes, "some faces overlap at a vertex or cannot be oriented alike")
        return set(np.flatnonzero(sides < 2).tolist())

    def _oriented(self) -> list[tuple[int, ...]]:
        """Turn faces so that neighbours run along a common side in opposite directions."""
        faces = [f[::-1] if self.turned else f for f in self.frame.faces]
        faces, against = oriented(faces)
        if against:
            self.notes = (*self.notes, f"{against} faces were turned over to orient all alike")
        return faces


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
    faces = list(faces)
    at = sides_of(faces)
    done: set[int] = set()
    against = 0
    for seed in range(len(faces)):
        queue = [seed] if seed not in done else []
        done.add(seed)
        while queue:
            f = queue.pop()
            along = {(faces[f][i - 1], faces[f][i]) for i in range(len(faces[f]))}
            for a, b in along:
                # once crossed, all that share a side are done
                for g in at.pop(side(a, b), ()):
                    if g in done:
                        continue
                    done.add(g)
                    queue.append(g)
                    if (a, b) in {(faces[g][i - 1], faces[g][i]) for i in range(len(faces[g]))}:
                        faces[g] = faces[g][::-1]
                        against += 1
    return faces, against


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
    used: list[int] = np.unique(frame.edges).tolist()
    which, through = tree.query(points(xy[used]), predicate="dwithin", distance=near)
    same, touching = set(), set()
    for v, e in zip(np.array(used)[which].tolist(), through.tolist(), strict=True):
        if v not in frame.edges[e]:
            twins = coincident(frame, [v])
            if twins in same:
                continue
            same |= {twins} - {""}
            touching |= {
                (e, other) for other in np.flatnonzero((frame.edges == v).any(axis=1)).tolist()
            }
            number = int(frame.numbers[e])
            yield Oddity(
                twins or f"edges_vertices[{number}] passes through vertex {v}: split it there",
                (v,),
                () if twins else (number,),
            )
    pairs = {(min(i, j), max(i, j)) for i, j in tree.query(lines, predicate="crosses").T.tolist()}
    for i, j in sorted(pairs):
        if {(i, j), (j, i)} & touching:
            continue  # in the vertex through which one of them passes
        a, b = sorted((int(frame.numbers[i]), int(frame.numbers[j])))
        yield Oddity(
            f"edges_vertices[{a}] and [{b}] cross without a vertex: add one where they meet, and split both",
            (),
            (a, b),
        )


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
            raise FoldFileError(
                f"faces_vertices cannot be oriented alike: across the edge between vertices {a} and {b} they come back "
                "turned over; on a one-sided surface, a Moebius band, there are no mountains and valleys"
            )
