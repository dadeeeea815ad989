"""What combinations of rows say of a box: that it holds nothing, or where in it what it holds lies.

Every combination of rows that vanish somewhere vanishes there too.  So any suggestion y of factors, computed in doubles
and trusted in nothing, may show that nothing is there (the combination cannot vanish), and bounds each xi_j that the
combination holds linearly: a + b_j xi_j + sum_k b_k xi_k = 0 gives xi_j in (-a + [-1, 1] sum_(k != j) |b_k|) / b_j.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from flint import arb, arb_mat

from origami_nlp.proof.check_domains import BallChain
from origami_nlp.proof.check_forms import AROUND, Box, Form, Terms, linear, nonzero, parts

BLUNT = 1e-9
"""Share of its largest slope that a row's error is taken to be at least, for suggestions."""


class Bounds:
    """Bounds of the xi of a box, wherever rows that were added vanish.

    Parameters
    ----------
    moving
        Variables that have some width.

    Attributes
    ----------
    empty
        Whether the rows cannot all vanish.
    known
        Lowest and highest xi of each variable.
    """

    def __init__(self, moving: Sequence[int]) -> None:
        self.empty = False
        self.known: dict[int, tuple[Any, Any]] = {j: (arb(-1), arb(1)) for j in moving}

    def add(self, j: int, reach: Any) -> None:
        """Learn that xi_j lies in a ball."""
        low, high = self.known[j]
        self.known[j] = low, high = low.max(reach.lower()), high.min(reach.upper())
        self.empty |= bool(low > high)

    def add_rows(self, rows: Sequence[Form]) -> None:
        """Learn that rows vanish: each by itself, and least squares of all in the metric of their errors."""
        moving = list(self.known)
        if any(map(nonzero, rows)):
            self.empty = True
        if self.empty or not moving or not rows:
            return
        middle = np.array([[float(f[1].get(j, ZERO).mid()) for j in moving] for f in rows])
        error = np.array([float(f[0].rad()) for f in rows])
        error += BLUNT * np.abs(middle).max(axis=1) + TINY
        square = np.concatenate([middle / error[:, None], np.eye(len(moving))])
        if not np.isfinite(square).all():
            return
        # least squares of xi with |xi| <= 1 as rows of their own: doubles, a suggestion only
        suggested = np.linalg.pinv(square)[:, : len(rows)] / error
        # from here on balls: whatever y is, y . rows vanishes where all rows do
        y = arb_mat([[arb(v) for v in line] for line in suggested.tolist()])
        slopes = (y * arb_mat([[f[1].get(j, ZERO) for j in moving] for f in rows])).tolist()
        centres = (y * arb_mat([[f[0]] for f in rows])).entries()
        for place, (j, line, centre) in enumerate(zip(moving, slopes, centres, strict=True)):
            own = line[place]
            # a slope whose ball holds 0, or nearly, would divide by next to nothing
            if own.abs_lower() > own.abs_upper() / 2:
                others = sum((v.abs_upper() for v in line), arb(0)) - own.abs_upper()
                self.add(j, (AROUND * others - centre) / own)

    def beyond(
        self, j: int, whole: tuple[float, float], kept: tuple[float, float]
    ) -> list[tuple[float, float]]:
        """Return what an angle loses from `whole` to `kept`, within it, less what is known not to be there."""
        if self.empty:
            return []
        middle, radius = parts(*whole)
        low, high = (middle + radius * bound for bound in self.known[j])
        found = []
        if whole[0] < kept[0] and not low >= arb(kept[0]):
            found.append((whole[0], kept[0]))
        if kept[1] < whole[1] and not high <= arb(kept[1]):
            found.append((kept[1], whole[1]))
        return found

    def narrowed(self, box: Box) -> Box:
        """Return the box without what the bounds exclude, ends rounded outwards."""
        found = list(box)
        for j, (low, high) in self.known.items():
            middle, radius = parts(*box[j])
            ends = float((middle + radius * low).lower()), float((middle + radius * high).upper())
            found[j] = (
                max(box[j][0], math.nextafter(ends[0], -math.inf)),
                min(box[j][1], math.nextafter(ends[1], math.inf)),
            )
        return tuple(found)


ZERO, TINY = arb(0), 1e-300


class States(Bounds):
    """Bounds of the closed states in a box, and of the critical ones among them.

    Parameters
    ----------
    piece, box, pins
        The piece of paper, the box, and the sign of each pinned crease (0: free).
    """

    def __init__(self, piece: BallChain, box: Box, pins: Sequence[int]) -> None:
        super().__init__([j for j, s in enumerate(pins) if not s])
        self.piece, self.box, self.pins = piece, box, pins
        terms, frame = piece.closure(box, pins)
        self._masks = list(terms)
        columns = [terms[mask].entries() for mask in self._masks]
        system = arb_mat([[column[r] for column in columns] for r in range(len(frame))])
        self._local = arb_mat([[arb(v) for v in line] for line in frame]) * system
        self._combine([self._masks.index(1 << j) for j in self.known])

    def _combine(self, places: Sequence[int]) -> None:
        """Add the rows by themselves, and what is normal to columns: it separates best."""
        entries, width, zero = self._local.entries(), len(self._masks), self._masks.index(0)
        spare, count = self.piece.spare, self._local.nrows()

        def tangent(p: int) -> list[float]:
            return [float(entries[r * width + p].mid()) for r in range(spare, count)]

        found = suggestions(spare, tangent(zero), [tangent(p) for p in places])
        combined = (arb_mat([[arb(v) for v in y] for y in found]) * self._local).entries()
        for k in range(len(found)):
            row = combined[k * width : (k + 1) * width]
            sizes = [v.abs_upper() for v in row]
            sizes[zero] = ZERO
            total = sum(sizes, ZERO)
            # |centre| > sum |coefficients|: the combination vanishes nowhere in the box
            if row[zero].abs_lower() > total:
                self.empty = True
                return
            for j, p in zip(self.known, places, strict=True):
                if row[p].abs_lower() > sizes[p] / 2:  # a ball that is hardly known bounds nothing
                    self.add(j, (AROUND * (total - sizes[p]) - row[zero]) / row[p])

    def add_critical(self) -> None:
        """Learn that the states are critical."""
        if self.empty:
            return
        rows = range(self._local.nrows())
        terms: Terms = {
            mask: arb_mat([[self._local[r, p]] for r in rows]) for p, mask in enumerate(self._masks)
        }
        self.add_rows([*linear(terms), *self.piece.critical_rows(self.box, self.pins)])


def suggestions(
    spare: int, centre: Sequence[float], columns: Sequence[Sequence[float]]
) -> list[list[float]]:
    """Suggest combinations of the rows of closure.

    Parameters
    ----------
    spare
        How many rows, the first ones, are of second order.
    centre, columns
        The other rows' coefficients of 1 and of each xi; at most three of each.

    Returns
    -------
    list
        The rows themselves; the part of the centre normal to each column; what is normal to every two columns (to each
        one where there are two rows), the faces of the zonotope that they span.
    """
    size = len(centre)
    wanted = [[float(r == c) for c in range(size)] for r in range(size)]
    if size == 2:
        # normal to a column: that variable drops out
        wanted += [[-a[1], a[0]] for a in columns]
    elif size == 3:
        wanted += [list(centre)]
        wanted += [_across(a, _across(a, centre)) for a in columns]
        wanted += [_across(a, b) for a, b in itertools.combinations(columns, 2)]
    first = [[float(r == c) for c in range(spare + size)] for r in range(spare)]
    return first + [[0.0] * spare + v for v in wanted]


def _across(a: Sequence[float], b: Sequence[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
