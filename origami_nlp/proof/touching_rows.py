"""What vanishes on a stratum where facets touch, over boxes: closure, gaps, minors with slopes of gaps beside it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import SUMMED
from origami_nlp.proof.pieces import Piece
from origami_nlp.proof.rows import (
    UNIT,
    Affine,
    Quadratic,
    Triples,
    joined_rows,
    number,
    pairs,
    variables,
)


@dataclass(frozen=True, order=True)
class Row:
    """A gap that closes.

    Attributes
    ----------
    kind
        ``facet``: ray k on the facet from ray j; ``start``, ``end``: ray k on the plane of that mirror; ``meet``:
        rays 0 and 3 of a D_1 wedge, in the plane of its mirrors, on each other.
    rays
        (k, j), or (k,).
    gap
        Position in `Structure.gaps`.
    """

    kind: str
    rays: tuple[int, ...]
    gap: int


Three = tuple[int, int, int]


class TouchedPiece:
    """The rows of a piece with some gaps closed.

    Ray k on facet j is reached from both ends of the facet, by fewer folds than the whole loop has: the gap is a row
    both ways, and boxes go where the ray is certainly beyond an end.

    Parameters
    ----------
    piece
        Without touches.
    touches
        Gaps that are closed.
    """

    def __init__(self, piece: Piece, touches: Sequence[Row]) -> None:
        self.piece, self.size = piece, piece.size
        gaps: list[Three] = []
        again: list[Three] = []
        refused: list[Three] = []
        self.on_each_other: list[Three] = []
        slopes: list[dict[int, Three]] = []
        for touch in touches:
            ways, beyond, slope = self._rows(touch)
            # one way of each before the other of any: with closure they are the independent rows
            gaps, again = [*gaps, ways[0]], again + ways[1:]
            refused, slopes = refused + beyond, [*slopes, slope]
        gaps += again
        wanted = [*gaps, *refused, *self.on_each_other]
        # of each gap the number of the slope by each variable
        self.columns: list[dict[int, int]] = []
        for slope in slopes:
            self.columns.append({v: len(wanted) + i for i, v in enumerate(slope)})
            wanted += slope.values()
        self.gaps, self.refused = len(gaps), len(refused)
        self.triples = Triples(piece.chain, wanted)
        self.kite = self._kite(touches)
        many = piece.pivots + len(touches) + 1
        self.subsets = list(itertools.combinations(range(self.size), many))

    def _rows(self, touch: Row) -> tuple[list[Three], list[Three], dict[int, Three]]:
        """Return a touch's gap, each way; what is certainly not positive; and its slopes."""
        c = self.piece.chain
        if touch.kind == "facet":
            ways = c.ways(*touch.rays)
            beyond = [t for w in ways for t in c.inside(*w)]
            return [c.gap(*w) for w in ways], beyond, c.gap_slopes(*ways[0])
        folds = [i for i in range(c.steps) if c.folds[i]]
        if touch.kind == "meet":
            self.on_each_other.append((c.first, c.up, 3))
            return [(c.first, 0, 3)], [], {int(c.variable[i]): (c.up, i, 3) for i in folds if i < 3}
        k, side = touch.rays[0], int(touch.kind == "end")
        slope = {
            int(c.variable[i]): (k, i, c.last) if side else (c.first, i, k)
            for i in folds
            if (i > k if side else i < k)
        }
        return [c.behind(k, side)], [], slope

    def _kite(self, touches: Sequence[Row]) -> Kite | None:
        a, kind = self.piece.sectors, touches[0].kind
        if kind not in ("start", "end") or len(touches) > 1 or len(a) != 2 or self.size != 3:
            return None
        return Kite(a[0], 0 if kind == "start" else 2) if abs(a[0] - a[1]) <= SUMMED else None

    def rows(
        self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray
    ) -> tuple[Affine, np.ndarray]:
        """Enclose closure, gaps, refusals and minors over boxes, and say which of them hold there, [R, K].

        Parameters
        ----------
        lower, upper
            Shape [n, K] [rad].
        pins
            -1, 0 or +1, shape [n, K].
        """
        piece = self.piece
        middle, half = variables(lower, upper)
        folded, torques = piece.chain.fold(middle, half), piece.torques(middle, half)
        triples = self.triples.at(folded)
        gaps, columns = (
            triples[: self.gaps],
            [{v: triples[i] for v, i in c.items()} for c in self.columns],
        )
        if self.kite is not None:
            gaps, columns = self.kite.rows(middle, half)
        closure = [piece.closure(folded).affine(), gaps.affine()]
        closure += [
            refusal(triples[self.gaps + i : self.gaps + i + 1].affine())
            for i in range(self.refused)
        ]
        for i in range(len(self.on_each_other)):  # not opposite: their cosine is 1
            row = triples[self.gaps + self.refused + i : self.gaps + self.refused + i + 1]
            closure.append((row + number(0 * row.value - 1.0, 4 * UNIT, self.size)).affine())
        critical = []
        if self.subsets:
            known = piece.minors(folded, torques)
            base = {tuple(s): known[i] for i, s in enumerate(piece.subsets.tolist())}
            for column in columns:
                base = expanded(base, column, self.size)
            critical = [Quadratic(*(v[None] for v in base[s].parts)).affine() for s in self.subsets]
        rows = joined_rows(closure + critical)
        asked = np.ones(rows.centre.shape, dtype=bool)
        for i, s in enumerate(self.subsets, start=len(asked) - len(self.subsets)):
            asked[i] = (pins == 0)[list(s)].all(axis=0)
        return rows, asked


def expanded(
    minors: dict[tuple[int, ...], Quadratic], column: dict[int, Quadratic], n: int
) -> dict[tuple[int, ...], Quadratic]:
    """Return the minors with one column more, expanded along it, by their rows."""
    many = len(next(iter(minors))) + 1
    out = {}
    for rows in itertools.combinations(range(n), many):
        terms = [
            (minors[(*rows[:a], *rows[a + 1 :])] * column[v]).times((-1.0) ** a)
            for a, v in enumerate(rows)
            if v in column
        ]
        if terms:
            out[rows] = sum(terms[1:], terms[0])
    return out


def refusal(row: Affine) -> Affine:
    """Return a row that excludes boxes where another is certainly positive, and says nothing elsewhere."""
    out = (row.centre > row.radius()).astype(float)
    return Affine(out, 0 * row.slopes, 2.0 - 1.5 * out)


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
    """

    def __init__(self, sector: float, crease: int) -> None:
        self.cosine, self.crease = math.cos(sector), crease

    def rows(
        self, middle: np.ndarray, half: np.ndarray
    ) -> tuple[Quadratic, list[dict[int, Quadratic]]]:
        """Enclose the row, and its derivatives by the turns, phi_2 and theta."""
        c, s = half_angle(middle, half, 1)
        d, t = half_angle(middle, half, self.crease)
        a = self.cosine
        row = (c * d).times(a) + (s * t).times(-1.0)
        by_fold = (s * d).times(-0.5 * a) + (c * t).times(-0.5)
        by_turn = (c * t).times(-a) + (s * d).times(-1.0)
        return row, [{1: by_fold[0], self.crease: by_turn[0]}]


def half_angle(middle: np.ndarray, half: np.ndarray, v: int) -> tuple[Quadratic, Quadratic]:
    """Return cosine and sine of half of an angle over boxes, one row each."""
    n = middle.shape[0]
    r = 0.5 * half[v]
    own = pairs(n)[2][v, v]
    out = []
    at = np.cos(0.5 * middle[v]), np.sin(0.5 * middle[v])
    for value, slope in (at, (at[1], at[0])):
        row = number(value[None], 0.0, n)
        sign = -1.0 if value is at[0] else 1.0
        row.slopes[0, v], row.bends[0, own] = sign * slope * r, -0.5 * value * r**2
        row.rest[0] = r**3 / 6 + 16 * UNIT * (1 + r) ** 2
        out.append(row)
    return out[0], out[1]
