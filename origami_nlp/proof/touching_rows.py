"""What vanishes on a stratum where facets touch, as affine forms over boxes: closure, gaps, the Fritz John minor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import SUMMED
from origami_nlp.proof.affine import (
    TRIGONOMETRIC,
    Affine,
    concatenated,
    constant,
    mixed,
    stacked,
    turned,
)
from origami_nlp.proof.angles import Angles
from origami_nlp.proof.chains import Enclosed, VertexForms, taken
from origami_nlp.proof.domains import (
    AXES,
    FoldedDomain,
    FundamentalDomain,
    Product,
    folded_frame,
    next_frame,
)
from origami_nlp.proof.law_torques import LawTorques

COSINE = 1e-15
"""Error of the cosine of a sector angle, in the proof's forms."""


@dataclass(frozen=True, order=True)
class Row:
    """A gap that closes.

    Attributes
    ----------
    kind
        ``facet``: ray k on the facet from ray j; ``start``, ``end``: ray k on the plane of that mirror; ``meet``:
        rays k and j of the first mirror's plane on each other.
    rays
        (k, j), or (k,).
    gap
        Position in `Structure.gaps`; -1 where it is only where a contact ends.
    """

    kind: str
    rays: tuple[int, ...]
    gap: int

    def product(self, folded: FoldedDomain) -> Product:
        """What vanishes."""
        if self.kind == "facet":
            return folded.on_facet(*self.rays)
        if self.kind == "meet":
            return folded.meet(*self.rays)
        return folded.behind(self.rays[0], 0 if self.kind == "start" else 1)


class Kite:
    """The gap of ray 3 (or 1) on the axis of a wedge of two equal sectors a, less what it has in common with crease 2.

    With theta half the fold angle of the crease on the mirror, c_3 . n_1 = 2 sin a cos(phi_2 / 2) (cos a cos(phi_2 / 2)
    cos theta - sin(phi_2 / 2) sin theta): crease 2 fully folded puts rays 1 and 3 on each other, on the axis.  The last
    factor is the row.

    Parameters
    ----------
    sector
        a [rad].
    crease
        Variable of the crease on the mirror.
    size
        Variables n.
    """

    def __init__(self, sector: float, crease: int, size: int) -> None:
        self.cosine, self.crease, self.size = math.cos(sector), crease, size

    def at(self, angles: Angles) -> None:
        """Enclose cosines and sines of the half angles over boxes."""
        turn, boxes = angles.halves, angles.middle.shape[1]
        one, none = constant(np.ones(1), 0.0, 0, boxes)[0], constant(np.zeros(1), 0.0, 0, boxes)[0]
        self.c, self.s = [], []
        for v in range(self.size):
            by = taken(turn, v)
            c, s = mixed(one, by.cosine, none, by.sine), mixed(one, by.sine, none, by.cosine)
            self.c.append(turned(c, -s, by).on(self.size, [v]))
            self.s.append(turned(s, c, by).on(self.size, [v]))

    def value(self) -> Affine:
        """Enclose the row, [K]."""
        c, s, v = self.c, self.s, self.crease
        return (c[1] * c[v]).scaled(self.cosine, COSINE) - s[1] * s[v]

    def slopes(self) -> list[Affine | None]:
        """Enclose its derivatives by the turns, phi_2 and theta."""
        c, s, v = self.c, self.s, self.crease
        out: list[Affine | None] = [None] * self.size
        out[1] = ((s[1] * c[v]).scaled(self.cosine, COSINE) + c[1] * s[v]).scaled(-0.5)
        # d/dtheta of the last factor; d/dphi_2 above takes the 1/2 of the half angle
        out[v] = -((c[1] * s[v]).scaled(self.cosine, COSINE) + s[1] * c[v])
        return out


class TouchedWedge(Enclosed):
    """Rows of a wedge of D_n with some gaps closed.

    Parameters
    ----------
    piece
        The wedge.
    touches
        Gaps that are closed.
    """

    def __init__(self, piece: FundamentalDomain, touches: tuple[Row, ...]) -> None:
        self.piece, self.touches, self.laws = piece, touches, piece.laws
        self.size = piece.size
        self.pivots = min(piece.equations + len(touches), self.size)
        self.linear = slice(0, self.pivots)
        self.minor_count = 1 if piece.equations + len(touches) < self.size else 0
        self.kite = None
        a = piece.sectors
        axis = touches[0].kind in ("start", "end") and len(touches) == 1
        if axis and len(a) == 2 and piece.size == 3 and abs(a[0] - a[1]) <= SUMMED:
            self.kite = Kite(a[0], 0 if touches[0].kind == "start" else 2, 3)

    @property
    def springs(self) -> np.ndarray:
        """Stiffness over the largest, and rest angles, [2, n, 1]."""
        return self.piece.springs

    def asked(self, pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Return whether the minor holds on the strata of boxes, [R, K]."""
        return np.tile((pins == 0).all(axis=0), (self.minor_count, 1))

    def enclosed(self, angles: Angles) -> tuple[Affine, Affine]:
        """Enclose the rows over boxes."""
        f = self.piece.folded(angles)
        gaps = [t.product(f) for t in self.touches]
        if self.kite:
            self.kite.at(angles)
        rows = [self.kite.value()] if self.kite else [g.value() for g in gaps]
        closure = [p.value() for p in f.closure] + rows
        for p in f.lift:
            value = p.value()
            closure.append(Affine(value.centre - 1.0, value.slopes, value.error + TRIGONOMETRIC))
        for t in self.touches:
            if t.kind == "meet":  # on each other, not opposite
                value = Product((f.rays[t.rays[0]], f.rays[t.rays[1]]), 1.0).value()
                closure.append(value)
        critical = []
        if self.minor_count:
            columns = [[p.slope(f.rays, i) for i in range(self.size)] for p in (*f.closure, *gaps)]
            if self.kite:
                columns[-1] = self.kite.slopes()
            critical = [determinant(self.piece.torques(angles), columns)]
        boxes = angles.middle.shape[1]
        return stacked(closure, boxes), stacked(critical, boxes, self.size)


class TouchedVertex(VertexForms):
    """Rows of a vertex without symmetry with creases on facets.

    Crease k on facet j is reached from both ends of the facet.  From its far end, in its plane: with x along ray j + 1,
    y on from the facet and z along its normal, rays j+2 .. k are a chain of the folds j+1 .. k-1; from the near end it
    is the same chain read backwards, in the mirror.  Both ways c_k has z = 0, it is the same point, and inside the
    facet: with y > 0 it is beyond the end (sectors below pi).

    Parameters
    ----------
    sectors, stiffness, rest, laws
        As for `VertexForms`.
    touches
        (k, j), 0-based.
    """

    def __init__(
        self,
        sectors: np.ndarray,
        stiffness: np.ndarray,
        rest: np.ndarray,
        touches: tuple[tuple[int, int], ...],
        laws: LawTorques | None = None,
    ) -> None:
        super().__init__(sectors, stiffness, rest, laws=laws)
        self.touches = touches
        self.number = {tuple(f): i for i, f in enumerate(self.fours.tolist())}
        self.minor_count = 1 if 3 + len(touches) < self.size else 0

    def asked(self, pins: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Return whether the minor holds on the strata of boxes, [R, K]."""
        return np.tile((pins == 0).all(axis=0), (self.minor_count, 1))

    def enclosed(self, angles: Angles) -> tuple[Affine, Affine]:
        """Enclose the rows over boxes."""
        n, boxes = angles.middle.shape
        closure = [self.closure(angles)]
        slopes = []
        for k, j in self.touches:
            # the same ray by two walks: both depend on fewer folds than the whole loop
            ahead = self._chain(angles, j, k, 1)
            behind = self._chain(angles, j, k, -1)
            closure.append(self._same_point(ahead[-1], behind[-1], j))
            closure.append(_refused([ahead[-1][1], behind[-1][1]]))
            slopes.append(ahead)
        critical: list[Affine] = []
        if self.minor_count:
            critical = [self._minor(angles, slopes[0])]
        return concatenated(closure), stacked(critical, boxes, n)

    def _chain(self, angles: Angles, j: int, k: int, way: int) -> list[Affine]:
        """Enclose the rays j+1 .. k, or j .. k backwards, seen from the first: [3, K] each in n variables."""
        n, boxes = angles.middle.shape
        first = (j + 1) % n if way > 0 else j
        frame, turn = [constant(e, 0.0, 0, boxes) for e in AXES], angles.whole
        used: list[int] = []
        crease = first
        found = [frame[0].on(n, used)]
        while crease != k:
            frame = folded_frame(frame, taken(turn, crease))
            used.append(crease)
            sector = self.sectors[crease if way > 0 else crease - 1]
            frame = next_frame(frame, sector, self.doubt)
            crease = (crease + way) % n
            found.append(frame[0].on(n, used))
        return found

    def _same_point(self, ahead: Affine, behind: Affine, j: int) -> Affine:
        """c_k as seen from both ends of facet j: z twice, and x and y by the angle of the facet."""
        a = self.sectors[j]
        boxes = ahead.centre.shape[-1]
        c, s = np.full(boxes, math.cos(a)), np.full(boxes, math.sin(a))
        x, y, z = ahead[0], ahead[1], ahead[2]
        back = [
            behind[0] - mixed(x, c, y, -s, self.doubt),
            behind[1] + mixed(x, s, y, c, self.doubt),
            z,
            behind[2],
        ]
        return stacked(back)

    def _minor(self, angles: Angles, rays: Sequence[Affine]) -> Affine:
        """Enclose det [G | C | w] of five creases, w_i = z . (c_i x c_k) for those between: expanded along w."""
        (k, j), n = self.touches[0], self.size
        fours = self.minors(angles)
        total = None
        for step in range(1, (k - j) % n):
            i = (j + step) % n
            c, d = rays[step - 1], rays[-1]
            # z . (c_i x c_k), the gap's slope by the fold of crease i
            w = c[0] * d[1] - c[1] * d[0]
            term = fours[self.number[tuple(m for m in range(n) if m != i)]] * w
            term = term if i % 2 == 0 else -term
            total = term if total is None else total + term
        assert total is not None
        return total


def _refused(forms: Sequence[Affine]) -> Affine:
    """A row that excludes boxes where one of these is certainly positive, and says nothing elsewhere, [1, K]."""
    out = 1.0 - np.all([f.centre <= f.radius() for f in forms], axis=0)
    slopes = np.zeros((1, *forms[0].slopes.shape))
    return Affine(out[None], slopes, 2.0 - 1.5 * out[None])


def determinant(first: Affine, columns: Sequence[Sequence[Affine | None]]) -> Affine:
    """Enclose the determinant of a square matrix of forms, by minors of its first columns: [K].

    Parameters
    ----------
    first
        The first column, [n, K].
    columns
        The others, by column and row; None is 0.
    """
    n = first.centre.shape[0]
    minors: dict[tuple[int, ...], Affine] = {(i,): first[i] for i in range(n)}
    for column in columns:
        grown: dict[tuple[int, ...], Affine] = {}
        for rows, value in minors.items():
            for i in range(n):
                entry = column[i]
                if i in rows or entry is None:
                    continue
                with_i = tuple(sorted((*rows, i)))
                term = value * entry
                # expanded along the last column
                term = term if (len(rows) - with_i.index(i)) % 2 == 0 else -term
                grown[with_i] = grown[with_i] + term if with_i in grown else term
        # invariant: minors[rows] is the determinant of these rows and the columns so far
        minors = grown
    return minors[tuple(range(n))]
