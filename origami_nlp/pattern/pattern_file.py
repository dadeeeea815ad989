"""A whole frame of a FOLD file as a pattern: facets, creases between them, springs; or why it is not one."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, check_type
from origami_nlp.errors import FoldFileError
from origami_nlp.numerics import INPUT_TOL, PLACES, groups, unit_normals
from origami_nlp.pattern.cells import make_sheet
from origami_nlp.pattern.coordinate_repair import made_exact
from origami_nlp.pattern.fold_faces import (
    Oddity,
    check_drawing,
    check_sides,
    coincident,
    face_walks,
    oriented,
)
from origami_nlp.pattern.fold_file import LOADS_KEY, PRELOAD_KEY, Frame, read_fold
from origami_nlp.pattern.fold_notes import NOISE, listed
from origami_nlp.pattern.fold_springs import FoldSprings, stated_sign, target_notes
from origami_nlp.pattern.polygons import Side, area, fold_between, side, sides_of
from origami_nlp.pattern.sheet import Pattern

LARGEST_SNAP = 0.02
"""Share of the sheet by which corners may be moved."""
NAMED = 3
"""Corners that moved most, which a note names."""
FORCES = f"{LOADS_KEY}: left out, forces of a file are those on one vertex"


def read_pattern(
    source: str | Path, *, frame: int | None = None, snap: float | None = None, **springs: Any
) -> Pattern:
    """Read a FOLD file as a pattern of rigid facets.

    Parameters
    ----------
    source
        FOLD file, or ``"-"`` for standard input.
    frame
        Which, from 0; by default the first with geometry.
    snap, springs
        As for `frame_pattern`.

    Returns
    -------
    Pattern
        The sheet with its springs; `Pattern.notes` has what is odd in the file and what was assumed.

    Raises
    ------
    FoldFileError
        If the file is no FOLD file, or its frame is no sheet of rigid facets.

    Examples
    --------
    >>> import json, os, tempfile, origami_nlp as o
    >>> path = os.path.join(tempfile.mkdtemp(), "miura.fold")
    >>> with open(path, "w") as file:
    ...     json.dump(o.examples.crease_pattern("miura", 4, 4), file)
    >>> o.read_pattern(path)
    Pattern('Miura, alpha = pi/3': 16 facets, 24 creases, 9 interior vertices)
    """
    (chosen,) = read_fold(source, "first" if frame is None else frame)
    return frame_pattern(chosen, snap=snap, **springs)


def frame_pattern(frame: Frame, *, snap: float | None = None, **springs: Any) -> Pattern:
    """Make a pattern of a frame.

    Facets are the faces that the frame states; those of a crease pattern that states none are walked round, and faces
    with a border all around are holes.  Facets are one across F and J edges without springs, and across sides that are
    no edges.  A folded form is measured: its fold angles are the reference.

    Parameters
    ----------
    frame
        Of `read_fold`.
    snap
        Share of the sheet by which corners of a drawing may be off: they are moved by at most that, and by as little
        as it takes, so that what holds within it holds exactly (equal sectors, creases in a line, Kawasaki).
    springs
        Of creases for which the file states none: `FoldSprings`, stiffness, rest_angle, rest_from.

    Returns
    -------
    Pattern
        Creases in the order of the file.

    Raises
    ------
    FoldFileError
        If the frame is no sheet of rigid facets: what is wrong, and what to change.

    Examples
    --------
    >>> from origami_nlp.pattern import examples, frame_pattern, parse_fold
    >>> (frame,) = parse_fold(examples.crease_pattern("squaretwist"))
    >>> len(frame_pattern(frame).vertices)
    4
    """
    check_type("frame", frame, Frame)
    asked = FoldSprings(**springs)
    asked.check(frame)
    wound = np.flatnonzero(np.nan_to_num(frame.preload))
    if len(wound):
        where = f"{PRELOAD_KEY}[{frame.numbers[wound[0]]}]"
        raise FoldFileError(f"{where}: give many vertices no preload but other rest angles")
    if snap is not None:
        check_number("snap", snap, 0.0, LARGEST_SNAP)
    sheet = _Sheet(frame, snap)
    edges = [(s, e) for s, e in sheet.edge.items() if frame.assignment[e] not in "BC"]
    measured, votes = sheet.measured()
    if votes < 0:  # which side valleys open to is a matter of how faces run: the letters decide
        sheet.polygons = [p[::-1] for p in sheet.polygons]
        sheet.orders = [(f, g, -s) for f, g, s in sheet.orders]
        sheet.notes.append("faces run the other way round than the assignments say: turned over")
        measured, _ = sheet.measured()
    creases, at = [s for s, _ in edges], [e for _, e in edges]
    found = np.array([measured.get(s, math.nan) for s in creases])
    k, rest = asked.of(frame, at, found)
    if at:
        sheet.notes += target_notes(frame, at, found) if frame.folded else []
        sheet.notes += asked.notes(frame, at, found)

    def of(values: Iterable[Any]) -> dict[Side, Any]:
        return dict(zip(creases, values, strict=True))

    made = make_sheet(
        sheet.corners,
        sheet.polygons,
        frame.lattice,
        rolled=frame.rolled,
        assignment=of(frame.assignment[e].replace("?", "U") for e in at),
        joins=sheet.joins,
        fold_angles=measured,
        numbers=of(frame.numbers[at].tolist()),
        stiffness=of(k),
        rest=of(rest),
        file_angles=of(frame.fold_angles[at]),
        limits=None if frame.limits is None else of(map(tuple, frame.limits[at].tolist())),
        laws=of(frame.laws[e] for e in at) if frame.laws else None,
        name=frame.title or Path(frame.source).stem or f"frame {frame.number}",
        notes=[*frame.notes, *sheet.notes, *([FORCES] if frame.loads else [])],
        orders=sheet.orders,
    )
    return replace(
        made,
        source=frame.source,
    )


class _Sheet:
    """Polygons of a frame, with corners of their own on both sides of cuts, and what their sides are.

    edge: of each side that two polygons share, by its corners in increasing order, its edge (position in the frame).
    orders: the frame's faceOrders, for the polygons as they are turned here.
    """

    def __init__(self, frame: Frame, snap: float | None) -> None:
        self.frame, self.snap = frame, snap
        self.notes: list[str] = []
        if frame.conflicts:
            k = min(frame.conflicts)
            a, b = map(frame.place, frame.edges[k].tolist())
            twice = "is stated twice, with other assignments or fold angles: keep one"
            raise FoldFileError(f"edges_vertices[{frame.numbers[k]}] from {a} to {b} {twice}")
        self.number = frame.edge_of
        self.orders: list[tuple[int, int, int]] = []
        self.polygons = self._faces() if frame.faces else self._walked()
        for one in face_oddities(frame, self.polygons):
            raise FoldFileError(one.text)
        self._cut()
        sides = sides_of(self.polygons)
        shared = [s for s, polygons in sorted(sides.items()) if len(polygons) > 1]
        # of a cell that repeats sides of the outline are creases too
        found = {s: self._edge(s) for s in (shared if frame.lattice is None else sorted(sides))}
        self.edge = {s: known for s, known in found.items() if known is not None}
        bare = [s for s in shared if s not in self.edge]
        if bare:
            self.notes.append(f"{len(bare)} sides between faces are no edges: joined to one facet")
        letters = frame.assignment
        self.joins = bare + [
            s
            for s, e in self.edge.items()
            if letters[e] == "J" or (letters[e] == "F" and not frame.is_sprung(e))
        ]
        if frame.lattice is None:
            self._note_borders(sides)
            self._make_exact()

    def _edge(self, ends: Side) -> int | None:
        return self.number.get(side(*(self.origin[v] for v in ends)))

    def _faces(self) -> list[tuple[int, ...]]:
        """Return the faces that the file states, all of one sense."""
        frame, x = self.frame, self.frame.coords
        faces, against = oriented(frame.faces)
        for f, face in enumerate(faces):
            if len(set(face)) < len(face):
                raise FoldFileError(f"faces_vertices[{f}] comes to a vertex twice: split the face")
        check_sides(faces)
        areas = [0.0 if frame.folded else area(x[list(face), :2]) for face in faces]
        if sum(areas) < 0 or (frame.folded and 2 * against > len(faces)):
            faces, against = [face[::-1] for face in faces], len(faces) - against
            areas = [-a for a in areas]
        for f in (f for f, a in enumerate(areas) if a < 0):
            why = "it overlaps its neighbour, or its vertices are in the wrong order"
            raise FoldFileError(f"faces_vertices[{f}] lies upside down: {why}")
        if 0 < against < len(faces):
            self.notes.append(f"{against} faces were turned over to orient all alike")
        for f, g, s in frame.face_orders:
            self.orders.append((f, g, s if faces[g] == frame.faces[g] else -s))
        return faces

    def _walked(self) -> list[tuple[int, ...]]:
        """Return the faces of a planar drawing but those outside, and holes."""
        frame = self.frame
        if frame.folded:
            raise FoldFileError("faces_vertices is missing: say what of a folded form is paper")
        check_drawing(frame)
        faces, holes = [], 0
        for walk in face_walks(frame):
            for i in (i for i, v in enumerate(walk) if walk[i - 2] == v):
                v = walk[i - 1]
                e = self.number[side(v, walk[i])]
                where = f"edges_vertices[{frame.numbers[e]}] ends within a facet"
                cure = "carry it on to a crease or the border, or leave it out"
                raise FoldFileError(f"{where}, at vertex {v} {frame.place(v)}: {cure}")
            if len(set(walk)) < len(walk):
                v = Counter(walk).most_common(1)[0][0]
                cure = "join what is inside it to its outline by a crease, or give faces_vertices"
                raise FoldFileError(f"a facet comes to vertex {v} {frame.place(v)} twice: {cure}")
            sides = (self.number[side(walk[i - 1], v)] for i, v in enumerate(walk))
            if {frame.assignment[e] for e in sides} <= set("BC"):
                holes += 1
            else:
                faces.append(walk)
        if holes:
            self.notes.append(f"{holes} faces with a border all around are holes")
        if not faces:
            cure = 'add the outline of the paper, edges with assignment "B"'
            cure = "all round are holes: say in faces_vertices what is paper" if holes else cure
            raise FoldFileError(f"edges_vertices encloses no facet: {cure}")
        return faces

    def _cut(self) -> None:
        """Give each piece of paper that meets at a vertex only, or across a cut, a corner of its own."""
        letters = self.frame.assignment
        places = [(p, v) for p, polygon in enumerate(self.polygons) for v in polygon]
        place = {key: k for k, key in enumerate(places)}
        cuts, slit, joined = 0, set[int](), []
        for ends, (first, *others) in sides_of(self.polygons).items():
            known = self.number.get(ends)
            if known is not None and letters[known] in "BC" and others:
                cuts += 1
                slit |= {*ends}
            else:
                joined += [(place[first, v], place[other, v]) for other in others for v in ends]
        piece = groups(len(places), joined).tolist()
        self.origin = list(range(len(self.frame.coords)))
        number, taken = dict[int, int](), set[int]()
        for (_, v), one in zip(places, piece, strict=True):
            if one not in number:
                number[one] = v if v not in taken else len(self.origin)
                self.origin += [v] * (v in taken)
                taken.add(v)
        corner = {key: number[one] for key, one in zip(places, piece, strict=True)}
        self.polygons = [tuple(corner[p, v] for v in q) for p, q in enumerate(self.polygons)]
        self.corners = self.frame.coords[self.origin]
        if cuts:
            self.notes.append(f"{cuts} edges B or C with facets on both sides are cuts")
        if points := sorted({*self.origin[len(self.frame.coords) :]} - slit):
            self.notes.append(f"paper meets in points, and is not joined, at {listed(points)}")

    def _make_exact(self) -> None:
        """Move corners by what their digits leave open, or by the snap that was asked for."""
        snap = (self.snap or 0.0) * float(np.ptp(self.corners, axis=0).max())
        made = made_exact(self.corners, self.polygons, self.joins, self.frame.unit, snap)
        moves = np.linalg.norm(made.corners - self.corners, axis=1)
        self.corners = made.corners
        if made.misses and self.snap is None and not self.frame.folded:
            miss = f"vertices miss folding flat by up to {math.degrees(made.misses):.2g} degrees"
            self.notes.append(
                f"{miss}: --snap 1e-3 moves corners so that they fold; --bend K bends"
            )
        if not made.moved:
            if self.snap is not None:
                self.notes.append(
                    f"--snap {self.snap:g}: nothing is to be moved, or more than that"
                )
            return
        what = "faces are plane"
        if made.relations:
            what = f"{made.relations} relations between sectors (equal, in a line, Kawasaki) hold"
            what += " and faces are plane" * self.frame.folded
        said = f"coordinates have few digits: corners are moved by up to {made.moved:.1e}, so that {what}"
        if self.snap is not None:
            most = (f"{v} ({moves[v]:.2g})" for v in np.argsort(-moves)[:NAMED].tolist())
            said += f"; most: vertices {', '.join(most)}"
        self.notes.append(said)

    def _note_borders(self, sides: dict[Side, list[int]]) -> None:
        """Note folds along borders, and refuse those that are sides of no face."""
        frame = self.frame
        alone = [e for s, n in sides.items() if len(n) == 1 and (e := self._edge(s)) is not None]
        drawn = sorted(int(frame.numbers[e]) for e in alone if frame.assignment[e] in "MV")
        if drawn:
            self.notes.append(
                f"edges {listed(drawn)} are drawn as folds on the border: read as borders"
            )
        used = {*self.edge.values(), *alone}
        for e in (e for e, a in enumerate(frame.assignment) if a in "MV" and e not in used):
            ends = frame.edges[e].tolist()
            cure = coincident(frame, ends) or "give its faces in faces_vertices, or leave it out"
            if "B" not in frame.assignment and not frame.faces:
                cure = "no border is drawn, add the outline of the paper"
            where = f"edges_vertices[{frame.numbers[e]}] from {' to '.join(map(frame.place, ends))}"
            raise FoldFileError(f"{where} is a fold but the side of no face: {cure}")

    def measured(self) -> tuple[dict[Side, float], float]:
        """Measure fold angles in the coordinates, and whether the file's letters speak for the side that is up."""
        frame, x = self.frame, self.corners
        if not frame.folded:
            return {}, 0.0
        left = {(p[i - 1], v): k for k, p in enumerate(self.polygons) for i, v in enumerate(p)}
        normals = np.array([unit_normals(x[list(p)]) for p in self.polygons])
        phi, votes, unsure = {}, 0.0, []
        joined = set(self.joins)
        lies = {side(f, g): float(s) for f, g, s in self.orders}
        for ends, e in self.edge.items():
            if ends in joined or not {ends, ends[::-1]} <= left.keys():
                continue
            over, under = left[ends], left[ends[::-1]]
            angle = fold_between(x[ends[1]] - x[ends[0]], normals[under], normals[over])
            sign = stated_sign(frame, e)
            if math.pi - abs(angle) < PLACES:
                # the normal of g says which side is up: s > 0 says that f lies above, a valley where g is on the other
                lie = lies.get(side(over, under), 0.0)
                votes += sign * lie
                sign = sign or lie
                unsure += [] if sign else [int(frame.numbers[e])]
                angle = math.copysign(math.pi, sign or 1.0)
            elif abs(angle) > PLACES:
                votes += sign * math.copysign(1.0, angle)
            phi[ends] = angle
        note = f"fully folded creases {listed(unsure)}, not assigned, are taken for valleys"
        if unsure and note not in self.notes:
            self.notes.append(note)
        return phi, votes


def face_oddities(frame: Frame, polygons: Sequence[tuple[int, ...]]) -> Iterator[Oddity]:
    """Go through faces that are no plane simple polygons.

    Parameters
    ----------
    frame
        Where they are.
    polygons
        The faces, by their vertices.

    Returns
    -------
    iterator of Oddity
        One each; its size is how far the face is off a plane, over its own.
    """
    from shapely import LinearRing

    for f, face in enumerate(polygons):
        p = frame.coords[list(face)] - frame.coords[face[0]]
        _, extent, axes = np.linalg.svd(p, full_matrices=False)
        name = f"faces_vertices[{f}]" if frame.faces else f"the facet at vertices {face}"
        at = tuple(face), (), (f,) if frame.faces else ()
        if extent[1] <= INPUT_TOL * extent[0]:
            yield Oddity(f"{name} has no area: leave it out, or move a vertex", *at)
        elif len(face) > 3 and not LinearRing(p @ axes[:2].T).is_simple:
            yield Oddity(
                f"{name} crosses or meets its own outline: order its vertices along it", *at
            )
        elif len(extent) > 2 and extent[2] > NOISE * extent[0]:
            off = float(extent[2] / extent[0])
            text = f"{name} is not flat (by {off:.2g} of its size): split it along a crease"
            yield Oddity(text, *at, off)
