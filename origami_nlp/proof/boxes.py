"""Branch and prune: all boxes of fold angles, on all strata, until only small ones are left.

A batch of boxes of any strata is treated at once.  A box goes where a row of closure, or a minor or a twin row of its
stratum, certainly differs from zero.  Else it is contracted: for *any* matrix Y, what solves c + A xi + e eta = 0 has
xi = -Y c + (I - Y A) xi - Y e eta, hence |xi_v + (Y c)_v| <= sum_j |I - Y A|_vj + sum_r |Y_vr| e_r.  Two matrices are
tried: the inverse of A's best columns in the rows of closure, and the least squares of all rows in the metric of
their errors, Y = (I + A' E^-2 A)^-1 A' E^-2.  Nothing is trusted of how they were computed.  A box that did not
shrink to half its volume is cut in two at the middle of its widest side; both halves keep that double.

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

from origami_nlp.numerics import DEPENDENT, NONZERO, RANK, first_largest
from origami_nlp.problem import FoldLimits
from origami_nlp.proof.options import DEFAULT, ProofOptions
from origami_nlp.proof.pieces import VanishingRows
from origami_nlp.proof.rows import TINY, UNIT, Affine, variables

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
    """What is searched: rows over boxes."""

    @property
    def size(self) -> int: ...  # noqa: D102
    @property
    def linear(self) -> slice: ...  # noqa: D102
    @property
    def pivots(self) -> int: ...  # noqa: D102

    def rows(self, lower: np.ndarray, upper: np.ndarray, pins: np.ndarray) -> VanishingRows: ...  # noqa: D102


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


def joined(parts: list[Boxes]) -> Boxes:
    """Return boxes as one batch, in order."""
    return Boxes(
        *(
            np.concatenate([getattr(p, name) for p in parts], axis=-1)
            for name in ("lower", "upper", "pins")
        )
    )


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
    small: float | None = None,
    options: ProofOptions = DEFAULT,
    most: float = math.inf,
    seconds: float | None = None,
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
        Boxes narrower than this [rad] are candidates; None: than the options say.
    options
        How many boxes are treated together.
    most
        Stop after this many boxes.
    seconds
        Stop after so much processor time.
    until
        Stop then (`time.monotonic`).

    Returns
    -------
    Remainder
        Candidates and boxes that are open; every other point of `start` is excluded, or near the flat state.
    """
    stack, found = [start], []
    small = options.smallest if small is None else small
    boxes = flats = 0
    end = math.inf if seconds is None else time.process_time() + seconds
    while stack and boxes < most and time.process_time() < end and time.monotonic() < until:
        batch = _cut_to(
            min(options.fewest, options.batch),
            joined(list(_popped(stack, options.batch))),
            small,
        )
        boxes += len(batch)
        done, again = _shrunk(posed, batch, small)
        near = (_reach(again) <= flat) & (again.pins == 0).all(axis=0)
        flats += int(near.sum())
        found.append(done)
        if not near.all():
            stack.append(again[~near])
    nothing = start[:0]
    return Remainder(joined([nothing, *found]), joined([nothing, *stack]), boxes, flats)


def _cut_to(wanted: int, batch: Boxes, small: float) -> Boxes:
    """Cut a small batch until it has so many boxes: rows of a few take as long as rows of a hundred."""
    while len(batch) < wanted and (wide := batch.widths.max(axis=0, initial=0.0) >= small).any():
        batch = joined([batch[~wide], *_halves(batch[wide])])
    return batch


def _popped(stack: list[Boxes], wanted: int) -> Iterator[Boxes]:
    """Take up to `wanted` boxes off the end of a stack of batches."""
    while stack and wanted:
        top = stack.pop()
        if len(top) > wanted:
            stack.append(top[: len(top) - wanted])
            top = top[len(top) - wanted :]
        wanted -= len(top)
        yield top


def _reach(boxes: Boxes) -> np.ndarray:
    """Largest |fold angle| in each box, [K]."""
    return np.maximum(-boxes.lower, boxes.upper).max(axis=0)


def _shrunk(posed: BoxProblem, batch: Boxes, small: float) -> tuple[Boxes, Boxes]:
    """Exclude, contract, bisect what did not shrink by half: boxes that were small and are left, and all others."""
    rows = posed.rows(batch.lower, batch.upper, batch.pins)
    # a row that differs from zero all over a box: no state there, or no critical one on this stratum
    out = rows.closure.nonzero().any(axis=0)
    no = (rows.critical.nonzero() & rows.asked).any(axis=0)
    keep = np.flatnonzero(~(out | no))
    batch, lower, upper, empty = _contracted(posed, batch[keep], rows, keep)
    share = _shares(batch, lower, upper)
    carried = ~empty & (share.min(axis=0) < KEPT)
    lower = np.where(carried, lower, batch.lower)
    upper = np.where(carried, upper, batch.upper)
    after = Boxes(lower, upper, batch.pins)
    cut = ~empty & (np.where(carried, share, 1.0).prod(axis=0) >= 0.5)
    done = ~empty & (batch.widths.max(axis=0) < small)
    cut &= ~done & (after.widths.max(axis=0) >= small)
    return after[done], joined([after[~empty & ~done & ~cut], *_halves(after[cut])])


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
    posed: BoxProblem, batch: Boxes, rows: VanishingRows, keep: np.ndarray
) -> tuple[Boxes, np.ndarray, np.ndarray, np.ndarray]:
    """Contract boxes: the batch, new bounds [n, K], and which are empty [K]."""
    middle, half = variables(batch.lower, batch.upper)
    low, high = _bounds(posed, rows, keep)
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
    return batch, lower, upper, empty


def _bounds(
    posed: BoxProblem, rows: VanishingRows, keep: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Bounds of xi in some boxes, [n, K]."""
    a, c, e = _batch_first(rows.closure, keep)
    low, high = _bounds_by(a, c, e, _inverse_of_pivots(a, posed))
    if len(rows.asked):
        asked = rows.asked[:, keep].T
        more = _batch_first(rows.critical, keep)
        a = np.concatenate([a, more[0] * asked[:, :, None]], axis=1)
        c = np.concatenate([c, more[1] * asked], axis=1)
        e = np.concatenate([e, np.where(asked, more[2], 1.0)], axis=1)
    low2, high2 = _bounds_by(a, c, e, _least_squares(a, e))
    # a matrix that came out as NaN bounds nothing
    return np.fmax(low, low2).T, np.fmin(high, high2).T


def _batch_first(rows: Affine, keep: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A [K, R, n], c [K, R] and e [K, R] of some boxes."""
    a = np.ascontiguousarray(rows.slopes[:, :, keep].transpose(2, 0, 1))
    return a, rows.centre[:, keep].T, rows.error[:, keep].T


def _bounds_by(
    a: np.ndarray, c: np.ndarray, e: np.ndarray, y: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Bounds [K, n] of xi where c + a xi + e eta = 0, by the matrices y [K, n, R]."""
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
    return at - spread, at + spread


def _inverse_of_pivots(a: np.ndarray, posed: BoxProblem) -> np.ndarray:
    """Matrices [K, n, R]: the inverse of the columns, in the linear rows of closure, that are most independent."""
    boxes, count, n = a.shape
    rows = a[:, posed.linear]
    rest, k = rows, np.arange(boxes)
    chosen = np.empty((boxes, posed.pivots), dtype=int)
    for p in range(posed.pivots):
        chosen[:, p] = best = first_largest((rest * rest).sum(axis=1))
        u = rest[k, :, best]
        u = u / np.maximum(np.sqrt((u * u).sum(axis=1)), NONZERO)[:, None]
        # Gram and Schmidt with pivoting: each column chosen is the largest of what the others leave
        rest = rest - u[:, :, None] * (u[:, None, :] @ rest)
    square = np.take_along_axis(rows, chosen[:, None, :], axis=2)
    volume = np.linalg.norm(square, axis=1).prod(axis=1)
    poor = ~(np.abs(np.linalg.det(square)) > DEPENDENT * volume)
    inverse = np.linalg.inv(np.where(poor[:, None, None], np.eye(posed.pivots), square))
    # pinned angles have no slopes: what rounding makes of their columns is no inverse
    inverse[poor] = np.linalg.pinv(np.nan_to_num(square[poor], posinf=0.0, neginf=0.0), rcond=RANK)
    y = np.zeros((boxes, n, count))
    part = np.zeros((boxes, n, posed.pivots))
    np.put_along_axis(part, chosen[:, :, None], inverse, axis=1)
    y[:, :, posed.linear] = part
    return y


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
