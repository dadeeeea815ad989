"""Branch and prune: all boxes of fold angles, on all strata, until only small ones are left.

A batch of boxes of any strata is treated at once.  A box goes where a row of closure, or a minor or a twin row of its
stratum, certainly differs from zero.  Else it is contracted: for *any* matrix Y, what solves c + A xi + e eta = 0 has
xi = -Y c + (I - Y A) xi - Y e eta, hence |xi_v + (Y c)_v| <= sum_j |I - Y A|_vj + sum_r |Y_vr| e_r.  Y is the
least squares of all rows in the metric of their errors, (I + A' E^-2 A)^-1 A' E^-2; nothing is trusted of how it was
computed.  A box that did not shrink to half its volume is cut in two at the middle of its widest side; both halves keep
that double.

Rounding of the contraction: entries of Y A and Y c are sums of at most R products, so they, and the sums over them, are
off by at most gamma_{R+d+2} sum_r |Y_vr| (|c_r| + sum_j |A_rj| + e_r); four times that is added.

Bounds of xi are then moved outward onto a grid: they, and so all boxes, are the same on every processor.
"""

from __future__ import annotations

import itertools
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from origami_nlp.numerics import groups, pairs_within
from origami_nlp.problem import FoldLimits
from origami_nlp.proof.rows import TINY, UNIT, Affine, joined, variables

BATCH = 2_000
"""Boxes that are treated together."""
SMALLEST = 1e-5
"""Width [rad] of boxes that are candidates for roots or singular states: all narrower ones are."""
BEYOND = math.nextafter(math.pi, 4.0)
"""The double above pi: free angles range to it."""
EXACT = 1e-3
"""Least squares take no row to be more accurate than this, relative to its slopes: its square is what they miss by, and
one over that their condition."""
WIDER = 1e-9
"""Share of its half width by which a contracted box is left wider than computed: more than rounding."""
GRID = 2.0**-12
"""Width of the grid of bounds, over half a side of the box: wide beside what processors differ by, hardly a loss."""
OFF = 0.3
"""Bounds are moved by this share of it at least: those that common numbers (0, 1/2, 1) give lie between its lines."""
KEPT = 0.9
"""A contraction that leaves more than this share of every side is not carried out."""


class BoxProblem(Protocol):
    """What is searched: rows over boxes [n, K] that vanish at what is looked for, and on which strata, [R, K]."""

    def rows(  # noqa: D102
        self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray
    ) -> tuple[Affine, np.ndarray]: ...


@dataclass(frozen=True, eq=False)
class Boxes:
    """K boxes, each on its stratum.

    Attributes
    ----------
    lower, upper
        Shape [n, K] [rad].
    pins
        -1, 0 or +1, shape [n, K].
    """

    lower: np.ndarray
    upper: np.ndarray
    pins: np.ndarray

    def __len__(self) -> int:
        return self.lower.shape[1]

    def __getitem__(self, which: np.ndarray | slice) -> Boxes:
        w = which
        return Boxes(self.lower[:, w], self.upper[:, w], self.pins[:, w])

    @property
    def widths(self) -> np.ndarray:
        """Sides of free angles, 0 for pinned ones, [n, K]."""
        return np.where(self.pins == 0, self.upper - self.lower, 0.0)


def strata(n: int, limits: FoldLimits | None = None) -> Boxes:
    """Return the whole space: one box for each pin pattern, in the order of itertools.product((0, 1, -1), repeat=n).

    Parameters
    ----------
    n
        Number of variables.
    limits
        Their fold limits; +-pi by default.

    Returns
    -------
    Boxes
        Free variables range to the doubles beyond their limits.
    """
    pins = np.array(list(itertools.product((0, 1, -1), repeat=n)), dtype=np.int8).T
    every = limits or FoldLimits(np.full(n, -math.pi), np.full(n, math.pi))
    low, high = every.low[:, None], every.high[:, None]
    lower = np.where(pins == 0, np.nextafter(low, -BEYOND), np.where(pins > 0, high, low))
    upper = np.where(pins == 0, np.nextafter(high, BEYOND), np.where(pins > 0, high, low))
    return Boxes(lower, upper, pins)


@dataclass(frozen=True, eq=False)
class Remainder:
    """What branch and prune leaves.

    Attributes
    ----------
    candidates
        Small boxes, not excluded.
    open
        Boxes not treated, because time or the number of boxes was up.
    boxes
        How many were treated.
    flat
        How many lay within the flat state's radius.
    """

    candidates: Boxes
    open: Boxes
    boxes: int
    flat: int


def prune(
    posed: BoxProblem,
    start: Boxes,
    *,
    flat: float = 0.0,
    small: float = SMALLEST,
    most: float = math.inf,
    until: float = math.inf,
) -> Remainder:
    """Treat boxes until each is excluded, small, or near the flat state.

    Parameters
    ----------
    posed
        The rows.
    start
        The boxes to treat: `strata` for the whole space.
    flat
        Boxes within this of the flat state [rad] are left to its lemma; 0.0 where that does not hold.
    small
        Boxes narrower than this [rad] are candidates.
    most
        Stop after this many boxes.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    Remainder
        Candidates and boxes that are open; every other point of `start` is excluded, or near the flat state.
    """
    left, found = start, [start[:0]]
    boxes = flats = 0
    while len(left) and boxes < most and time.monotonic() < until:
        batch, left = left[-BATCH:], left[:-BATCH]
        boxes += len(batch)
        done, again = _shrunk(posed, batch, small)
        reach = np.maximum(-again.lower, again.upper).max(axis=0)
        near = (reach <= flat) & (again.pins == 0).all(axis=0)
        flats += int(near.sum())
        found.append(done)
        left = joined([left, again[~near]], -1)
    return Remainder(joined(found, -1), left, boxes, flats)


def _shrunk(posed: BoxProblem, batch: Boxes, small: float) -> tuple[Boxes, Boxes]:
    """Exclude, contract, bisect what did not shrink by half: boxes that were small and are left, and all others."""
    rows, asked = posed.rows(batch.lower, batch.upper, batch.pins)
    # a row that differs from zero all over a box: no state there, or no critical one on this stratum
    keep = np.flatnonzero(~(rows.nonzero() & asked).any(axis=0))
    batch = batch[keep]
    lower, upper, empty = _contracted(batch, *_bounds(rows, asked, keep))
    share = _shares(batch, lower, upper)
    carried = ~empty & (share.min(axis=0) < KEPT)
    lower = np.where(carried, lower, batch.lower)
    upper = np.where(carried, upper, batch.upper)
    after = Boxes(lower, upper, batch.pins)
    cut = ~empty & (np.where(carried, share, 1.0).prod(axis=0) >= 0.5)
    done = ~empty & (batch.widths.max(axis=0) < small)
    cut &= ~done & (after.widths.max(axis=0) >= small)
    halves = _halves(after[cut])
    return after[done], joined([after[~empty & ~done & ~cut], *halves], -1)


def _shares(batch: Boxes, lower: np.ndarray, upper: np.ndarray) -> np.ndarray:
    """Which share of each side is left, [n, K]; 1 for pinned angles."""
    old = batch.widths
    return np.where(old > 0, (upper - lower) / np.where(old > 0, old, 1.0), 1.0)


def _halves(batch: Boxes) -> list[Boxes]:
    """Cut boxes at the middle of their widest side."""
    axis = batch.widths.argmax(axis=0)
    k = np.arange(len(batch))
    middle = 0.5 * (batch.lower[axis, k] + batch.upper[axis, k])
    first, second = batch.upper.copy(), batch.lower.copy()
    first[axis, k] = second[axis, k] = middle
    return [Boxes(batch.lower, first, batch.pins), Boxes(second, batch.upper, batch.pins)]


def _contracted(
    batch: Boxes, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Contract boxes by bounds of xi: new bounds [n, K], and which are empty [K]."""
    middle, half = variables(batch.lower, batch.upper)
    # outward: down for lower bounds, up for upper ones
    low = np.fmax(np.floor(low / GRID - OFF) * GRID, -1.0)
    high = np.fmin(np.ceil(high / GRID + OFF) * GRID, 1.0)
    empty = np.asarray((low > high).any(axis=0))
    free = batch.pins == 0
    # by `WIDER`, and at least to the next double: more than what rounding does to the sum
    lower = np.nextafter(middle + half * (low - WIDER), -np.inf)
    upper = np.nextafter(middle + half * (high + WIDER), np.inf)
    lower = np.where(free & (low > -1.0), np.maximum(batch.lower, lower), batch.lower)
    upper = np.where(free & (high < 1.0), np.minimum(batch.upper, upper), batch.upper)
    return lower, upper, empty


def _bounds(rows: Affine, asked: np.ndarray, keep: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of xi in some boxes where c + a xi + e eta = 0, [n, K]; NaN, which bounds nothing, where none came out."""
    on = asked[:, keep].T
    a = np.ascontiguousarray(rows.slopes[:, :, keep].transpose(2, 0, 1)) * on[:, :, None]
    c, e = rows.centre[:, keep].T * on, np.where(on, rows.error[:, keep].T, 1.0)
    y = _least_squares(a, e)
    _, count, n = a.shape
    # xi = -Y c + (I - Y A) xi - Y e eta with |xi|, |eta| <= 1
    rest = -(y @ a)
    i = np.arange(n)
    rest[:, i, i] += 1.0
    size = np.abs(y)
    at = -(y @ c[:, :, None])[:, :, 0]
    spread = np.abs(rest).sum(axis=2) + (size @ e[:, :, None])[:, :, 0]
    total = (size @ (np.abs(c) + np.abs(a).sum(axis=2) + e)[:, :, None])[:, :, 0]
    spread = spread + 4 * (count + n + 8) * UNIT * (1.0 + total)
    return (at - spread).T, (at + spread).T


def _least_squares(a: np.ndarray, e: np.ndarray) -> np.ndarray:
    """Matrices [K, n, R] of the least squares of all rows in the metric of their errors."""
    # exact rows would leave nothing of the unit matrix in doubles
    e = np.maximum(e, EXACT * np.abs(a).max(axis=2)) + TINY
    scaled = a / e[:, :, None]
    turned = scaled.transpose(0, 2, 1)
    normal = turned @ scaled
    i = np.arange(a.shape[2])
    # |xi| <= 1 counts as a row too: the matrix is regular whatever A is
    normal[:, i, i] += 1.0
    return np.linalg.solve(normal, turned) / e[:, None, :]


def clusters(boxes: Boxes) -> Iterator[Boxes]:
    """Group boxes of one stratum that are close to each other: cells of twenty times the smallest are no two apart."""
    middle = 0.5 * (boxes.lower + boxes.upper)
    # other strata are far away
    cells = np.concatenate([np.floor(middle / (20 * SMALLEST)), 9.0 * boxes.pins]).T
    cells, cell = np.unique(cells, axis=0, return_inverse=True)
    label = groups(len(cells), pairs_within(cells, 2))[cell.ravel()] if len(boxes) else np.zeros(0)
    return (boxes[label == k] for k in range(int(label.max(initial=-1)) + 1))


def by_stratum(boxes: Boxes) -> Iterator[Boxes]:
    """Group boxes by their strata."""
    strata_, which = np.unique(boxes.pins.T, axis=0, return_inverse=True)
    return (boxes[which.ravel() == s] for s in range(len(strata_)))
