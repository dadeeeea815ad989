"""Meshes of flat vertices of degree four that need not fold flat: their vertices, and in which signs they fold.

Round a vertex with unit vectors u_1..u_4 along its creases let w_i = cot(phi_i/2) and [ij] = u_i x u_j.  The product
of the quaternions s_i (w_i + u_i) is +-1 where (w_1 + u_1)(w_2 + u_2) is -[12]/[34] times (w_4 - u_4)(w_3 - u_3).  In
the plane of the sheet that is

    [13] w_2 + [23] w_1 + [12] w_3 = 0,    and so for every three creases that follow each other;

the product is 1, no full turn, where an odd number of folds are negative.  With 1 + w_3^2 = (1 + w_1^2)/q
(`fold_states`) that leaves two curves through the flat state, phi_3 of the sign of phi_1 (mode 1) or of the other
(mode -1).  No fold is 0 off the flat state unless opposite creases are in one line, and no two are at 180 degrees
unless the vertex folds flat (q = 1): both are refused.  So a mode says the signs of all folds: in mode 1 those of w_2
and w_4 are opposite; in mode -1, at flat, |w_3| = sqrt(x) |w_1| with x = [23][34]/([12][41]), so that w_2 has the
sign of ([12][34] - [23][41]) w_1 / [13], and w_4 the same.

Vertices with equal sectors are congruent: where they are in one mode, and one fold is the same but for its sign, all
are. So each mesh comes with classes of equal sectors, of which relations that hold identically are made
(`quad_states`).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from origami_nlp.numerics import CLOSURE_TOL
from origami_nlp.pattern import Pattern
from origami_nlp.proof.balls import Ball, exact, rational
from origami_nlp.proof.flat_sheets import (
    Vector,
    VertexRound,
    between,
    cross,
    dot,
    flat_sheet,
    sector,
    sector_sum,
)
from origami_nlp.proof.fold_states import Corner, Side, corner_of, why_no_stop
from origami_nlp.proof.rows import UNIT

MOST_VERTICES = 12
"""Of a mesh: 4,096 choices of modes."""


class QuadVertex(NamedTuple):
    """A vertex of degree four, seen from each of its creases.

    Attributes
    ----------
    creases
        In order round it.
    corners
        From each crease.
    squares
        q of the row from each crease: sin^2(phi/2) of the crease opposite is q sin^2(phi/2).
    sectors
        Classes of the sectors, from each crease to the next.
    signs
        Of each mode, 1 and -1: of all folds, the first one positive.
    """

    creases: tuple[int, ...]
    corners: tuple[Corner, ...]
    squares: tuple[Ball, ...]
    sectors: tuple[int, ...]
    signs: dict[int, tuple[int, ...]]


@dataclass(frozen=True)
class QuadMesh:
    """A mesh of such vertices that hangs together.

    Attributes
    ----------
    vertices
        Each after one that shares a crease with it.
    creases
        How many.
    deviation
        By how much sectors of the file that are taken as equal differ [rad]; 0 where none do.
    moved
        `SheetInPlane.moved`.
    """

    vertices: tuple[QuadVertex, ...]
    creases: int
    deviation: float
    moved: float

    def signs(self, modes: tuple[int, ...]) -> dict[int, int] | None:
        """Return the signs of folds of the first vertices in these modes; None where they contradict each other."""
        found: dict[int, int] = {}
        for vertex, mode in zip(self.vertices, modes, strict=False):
            own = dict(zip(vertex.creases, vertex.signs[mode], strict=True))
            known = next((c for c in vertex.creases if c in found), None)
            turn = 1 if known is None else found[known] * own[known]
            for c, s in own.items():
                if found.setdefault(c, turn * s) != turn * s:
                    return None
        return found


def why_no_quad_mesh(pattern: Pattern) -> str:
    """Return why not all closed states of a pattern are known as those of a mesh of degree four; "" where they are.

    Parameters
    ----------
    pattern
        Of any number of vertices.

    Returns
    -------
    str
        The first vertex that is in the way, and why.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.proof import why_no_quad_mesh
    >>> why_no_quad_mesh(o.examples.pattern("metasheet", 3, 3))
    ''
    >>> why_no_quad_mesh(o.examples.pattern("miura", 3, 3))
    'vertex 2 folds flat'
    """
    return why_no_stop(pattern) or as_quad_mesh(pattern)[1]


def as_quad_mesh(pattern: Pattern) -> tuple[QuadMesh | None, str]:
    """Return the mesh of a pattern, or None and why its states are not enumerated."""
    sheet, why = flat_sheet(pattern)
    if sheet is None:
        return None, why
    if len(sheet.rounds) > MOST_VERTICES:
        return None, f"{len(sheet.rounds)} vertices (at most {MOST_VERTICES})"
    for one in sheet.rounds:
        u = one.directions
        if sector_sum(u) <= CLOSURE_TOL:
            return None, f"vertex {one.vertex} folds flat"
        for i in (0, 1):
            if abs(cross(u[i], u[i + 2])) <= Fraction(CLOSURE_TOL) * abs(dot(u[i], u[i + 2])):
                return None, f"at vertex {one.vertex} opposite creases are in one line"
    # the most sensitive first: least is done to its folds before
    bends = [
        min(
            float(cross(u[i], u[i + 2]) ** 2 / (dot(u[i], u[i]) * dot(u[i + 2], u[i + 2])))
            for i in (0, 1)
        )
        for u in (one.directions for one in sheet.rounds)
    ]
    order = _in_order([r.creases for r in sheet.rounds], int(np.argmin(bends)))
    around = {c for r in sheet.rounds for c in r.creases}
    if len(order) < len(sheet.rounds) or len(around) < pattern.creases:
        return None, "vertices do not hang together, or a crease is none of theirs"
    classes = _Classes()
    numbers = [classes.of(r.directions) for r in sheet.rounds]
    room = 4 * classes.deviation + 16 * UNIT * bool(classes.deviation)
    vertices = [_vertex(sheet.rounds[i], numbers[i], room) for i in order]
    return QuadMesh(tuple(vertices), pattern.creases, classes.deviation, sheet.moved), ""


def _vertex(ring: VertexRound, sectors: tuple[int, ...], room: float) -> QuadVertex:
    seen = [corner_of(ring.turned(i)) for i in range(4)]
    corners = tuple(_widened(corner, room) for corner, _ in seen)
    squares = []
    for corner, (_, q) in zip(corners, seen, strict=True):
        near, far = corner.sides
        ball = near.sin_b * near.sin_c * (far.sin_b * far.sin_c).inverse()
        squares.append(ball if room else rational(q))
    return QuadVertex(ring.creases, corners, tuple(squares), sectors, _signs(ring))


def _signs(ring: VertexRound) -> dict[int, tuple[int, ...]]:
    """Return the signs of folds in both modes, the first one positive."""
    u, sense = ring.directions, ring.sense
    c = [sense * cross(u[i], u[(i + 1) % 4]) for i in range(4)]
    across = _sign(sense * cross(u[0], u[2]))
    # w_2 [13] = -([23] w_1 + [12] w_3), w_4 [13] = [34] w_1 + [41] w_3
    beside = _sign(c[0] * c[2] - c[1] * c[3]) * across
    return {1: (1, -across, 1, across), -1: (1, beside, -1, beside)}


def _widened(corner: Corner, room: float) -> Corner:
    if not room:
        return corner
    near, far = (Side(*(b.widened(exact(room).centre) for b in side)) for side in corner.sides)
    return corner._replace(sides=(near, far))


class _Classes:
    """Sectors that are equal, but for rounding."""

    def __init__(self) -> None:
        self.known: list[Vector] = []
        self.deviation = 0.0

    def of(self, u: list[Vector]) -> tuple[int, ...]:
        """Return the classes of the sectors between directions."""
        found = []
        for a, b in zip(u, u[1:] + u[:1], strict=True):
            own = sector(a, b)
            off = [between(own, other) for other in self.known]
            number = next((i for i, x in enumerate(off) if x <= CLOSURE_TOL), len(off))
            if number == len(off):
                self.known.append(own)
            else:
                self.deviation = max(self.deviation, off[number])
            found.append(number)
        return tuple(found)


def _sign(x: Fraction) -> int:
    return (x > 0) - (x < 0)


def _in_order(rounds: list[tuple[int, ...]], first: int) -> list[int]:
    """Return vertices, each but the first after one that shares a crease with it."""
    order = [first]
    for v in order:
        beside = (w for w, ring in enumerate(rounds) if set(ring) & set(rounds[v]))
        order += [w for w in beside if w not in order]
    return order
