"""Numbers of branch minima of a cone over a whole plane of (r_k, v_0), without an optimiser.

With B' = 4 n (s - s_e) the slope at s is F = A'(s) + r B'(s): linear in r, so for one class, one rest state and one
cell of elevations the ratios with F < 0 at the left and F >= 0 at the right end make one interval,
and all ratios of a column of the map are served at once.  A cell is settled when no ratio of the map can have
a second zero of F there: where F' = A'' + 4 n r may vanish (an enclosure of A'' shows for which r), F itself
must not (mean value bound).  Other cells are halved, as in `cone.roots`.

Depth thresholds: with h_s(r) = well_A(s) + r well_B(s) - D U_flat(r), linear in r, the minimum of a cell is deep
enough when max h_s(r) > 0 over the cell.  Any s of the cell bounds this from below.  F rises through 0
on a settled cell, so at most width |F| is gained from either end: linear bounds from above.  At the first
and the last ratio of a cell they decide for all between; cells they leave open are halved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.paper.cone.classes import AssignmentClasses, assignment_classes
from origami_nlp.paper.cone.energy import SideEnergy
from origami_nlp.paper.cone.roots import CELLS, FREE, HALVINGS, TIE, curvature_bounds
from origami_nlp.paper.cone.rules import Cone, check_depth, check_ratio

LIMB = 30
"""Multiplicities beyond 63 bits are summed in limbs of this many bits."""


@dataclass(frozen=True, repr=False)
class CountMap(ShortRepr):
    """Numbers of branch minima, shape [ratios, elevations] each.

    Attributes
    ----------
    cone
        Degree and rules.
    ratios
        r = k_even/k_odd of the rows.
    elevations
        Rest elevations nu_0 of the columns [rad].
    interior, contact, cut
        By kind, see `ConeMinima`; int64 where all numbers fit, else exact Python integers (dtype object).
    depth
        Least depth of a minimum that counts, (U_flat - U)/U_flat.
    """

    cone: Cone
    ratios: np.ndarray
    elevations: np.ndarray
    interior: np.ndarray
    contact: np.ndarray
    cut: np.ndarray
    depth: float

    @property
    def branches(self) -> int:
        """Number of all branches, 2^(N/2 + 1)."""
        return self.cone.branches

    @property
    def at_end(self) -> np.ndarray:
        """Minima at the end of their branch, pinned there by contact or by the cut."""
        return self.contact + self.cut

    @property
    def total(self) -> np.ndarray:
        """All minima."""
        return self.interior + self.at_end


def count_map(
    cone: Cone | int,
    ratios: Sequence[float] | np.ndarray,
    elevations: Sequence[float] | np.ndarray,
    *,
    depth: float = 0.0,
    progress: Callable[[int], None] | None = None,
) -> CountMap:
    """Count branch minima by kind at every (r_k, v_0): `count` for a plane.

    Parameters
    ----------
    cone
        A `Cone`, or its degree.
    ratios, elevations
        Values of r_k, and of v_0 [rad], in any order.
    depth
        As in `count`.
    progress
        Called with the number of columns (elevations) done.

    Returns
    -------
    CountMap
        Numbers [ratios, elevations] of each kind.

    Raises
    ------
    OptionError, AngleError
        For values out of range.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.count_map(10, ratios=[0.02, 1.0], elevations=[-0.9, 0.3, 0.8]).total.tolist()
    [[37, 32, 32], [32, 32, 32]]
    """
    cone = Cone.of(cone)
    depth = check_depth(depth)
    given = np.array([check_ratio(r, "ratios") for r in np.atleast_1d(ratios)])
    columns = np.atleast_1d(np.asarray(elevations, dtype=float))
    if given.ndim != 1 or columns.ndim != 1 or not given.size or not columns.size:
        raise OptionError("ratios and elevations must be lists of numbers")
    order = np.argsort(given)
    classes = assignment_classes(cone.degree)
    limbs = _limbs(classes)
    shape = (len(limbs), len(given), len(columns))
    inside, pinned, cut = (np.zeros(shape, np.int64) for _ in range(3))
    for k, elevation in enumerate(columns):
        for direction in (1, -1):
            side = SideEnergy.of(cone, direction, elevation)
            for end, rows in side.by_end():
                column = _Column(side.only(rows), end, given[order], depth)
                own = limbs[:, rows]
                inside[:, order, k] += column.total(column.interior(), own)
                for counts, which in ((pinned, ~side.cut[rows]), (cut, side.cut[rows])):
                    counts[:, order, k] += column.total([column.at_end(which)], own)
        if progress:
            progress(k + 1)
    return CountMap(cone, given, columns, _whole(inside), _whole(pinned), _whole(cut), depth)


def _limbs(classes: AssignmentClasses) -> np.ndarray:
    """Multiplicities as int64 limbs, lowest first, [limbs, m]; one limb where sums stay below 2^63."""
    if classes.degree // 2 + 1 <= 62:
        return np.array([classes.multiplicity], dtype=np.int64)
    count = -(-(classes.degree // 2 + 1) // LIMB)
    mask = (1 << LIMB) - 1
    return np.array(
        [[(m >> (LIMB * k)) & mask for m in classes.multiplicity] for k in range(count)],
        dtype=np.int64,
    )


def _whole(limbs: np.ndarray) -> np.ndarray:
    if len(limbs) == 1:
        return limbs[0]
    total = np.zeros(limbs.shape[1:], dtype=object)
    for k in range(len(limbs)):
        total = total + limbs[k].astype(object) * (1 << (LIMB * k))
    return total


Events = tuple[np.ndarray, np.ndarray, np.ndarray]
"""(rows, first, stop): class rows[k] has a minimum at the ratios first[k] to stop[k] - 1."""


@dataclass(frozen=True)
class _Nodes:
    """(A', B') and, with a depth, the wells less D U_flat at elevations of classes: values [2 or 4, ...]."""

    values: np.ndarray

    @property
    def odd(self) -> np.ndarray:
        return self.values[0]

    @property
    def even(self) -> np.ndarray:
        return self.values[1]

    def deeper(self, ratio: np.ndarray, step: float | np.ndarray = 0.0) -> np.ndarray:
        """h(r), how much deeper than the threshold; `step` [rad] further along at the slope here."""
        slope_odd, slope_even, well_odd, well_even = self.values
        return well_odd + step * slope_odd + ratio * (well_even + step * slope_even)

    def pick(self, where: tuple[slice | np.ndarray | int, ...] | np.ndarray) -> _Nodes:
        own = where if isinstance(where, tuple) else (where,)
        return _Nodes(self.values[(slice(None), *own)])

    def join(self, more: _Nodes) -> _Nodes:
        return _Nodes(np.concatenate([self.values, more.values], axis=-1))

    def ratio(self) -> np.ndarray:
        """r at which the slope is zero; where B' = 0, +inf if F < 0 for all r, else -inf."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            level = -self.odd / self.even
        return np.where(self.even == 0, np.where(self.odd < 0, np.inf, -np.inf), level)


class _Column:
    """All ratios of a map at one rest state, for the classes of one direction with one end."""

    def __init__(self, side: SideEnergy, end: float, ratios: np.ndarray, depth: float) -> None:
        self.side, self.end, self.ratios, self.depth = side, end, ratios, depth
        self.stiff = 4.0 * side.flaps
        self.grid = np.linspace(0.0, end, CELLS + 1)
        self.at_grid = self.nodes(self.grid)
        last = self.at_grid.pick((slice(None), CELLS))
        scale = side.at(np.array([end])).slope_scale(0.0)[:, 0]
        # the rest state at the very end of its branch: no slope there, whatever r
        tied = (np.abs(last.odd) <= TIE * scale) & (
            np.abs(last.even) <= TIE * self.stiff * (end + np.abs(side.even_vertex))
        )
        self.at_grid.odd[tied, -1] = -1.0  # "falls to the end": counted there, by at_end()
        self.at_grid.even[tied, -1] = 0.0

    def nodes(self, s: np.ndarray, rows: np.ndarray | None = None) -> _Nodes:
        """Evaluate at elevations, of all classes or of one each."""
        here = self.side.at(s, rows)
        wells = here.over(self.depth) if self.depth > 0 else ()
        return _Nodes(np.stack(np.broadcast_arrays(*here.slopes, *wells)))

    def total(self, events: list[Events], limbs: np.ndarray) -> np.ndarray:
        """Sum multiplicities at every ratio, [limbs, ratios]."""
        steps = np.zeros((len(limbs), len(self.ratios) + 1), np.int64)
        for rows, first, stop in events:
            for limb, value in zip(steps, limbs[:, rows], strict=True):
                # differences at both ends of an interval of ratios, summed up once for all
                np.add.at(limb, first, value)
                np.subtract.at(limb, stop, value)
        return np.cumsum(steps[:, :-1], axis=1)

    def at_end(self, which: np.ndarray) -> Events:
        """Ratios at which the energy of the classes `which` (mask) falls at the end, deep enough."""
        last = self.at_grid.pick((slice(None), -1))
        level = last.ratio()
        up = last.even >= 0
        low, high = np.where(up, -np.inf, level), np.where(up, level, np.inf)
        if self.depth > 0:  # well_odd + r well_even > 0
            well_odd, well_even = last.values[2:]
            with np.errstate(divide="ignore", invalid="ignore"):
                least = -well_odd / well_even
            flat = well_even == 0
            least = np.where(flat, np.where(well_odd > 0, -np.inf, np.inf), least)
            rising = well_even >= 0
            low = np.maximum(low, np.where(rising, least, -np.inf))
            high = np.minimum(high, np.where(rising, np.inf, least))
        first, stop = self._range(low, high)
        some = np.nonzero((stop > first) & which)[0]
        return some, first[some], stop[some]

    def interior(self) -> list[Events]:
        """Ratios at which there is a minimum inside the branch, cell by cell."""
        every = slice(None)
        left = self.at_grid.pick((every, slice(0, CELLS)))
        right = self.at_grid.pick((every, slice(1, CELLS + 1)))
        middle = self.nodes((self.grid[:-1] + self.grid[1:]) / 2)
        weights = self.side.weights
        low, high = curvature_bounds(self.side, self.grid[:-1], self.grid[1:])
        half = np.diff(self.grid) / 2
        shape = left.odd.shape
        # all classes on all cells at once; then, halved again and again, those that are left open
        r, c = (x.ravel() for x in np.indices(shape))
        settled = self._settle(
            left, right, middle, weights @ low.T, weights @ high.T, half + np.zeros(shape)
        )
        counted, first, stop, open_ = (x.ravel() for x in settled)
        found = [(r[counted], first[counted], stop[counted])]
        r, c = r[open_], c[open_]
        a, b = self.grid[c], self.grid[c + 1]
        left, right = left.pick((r, c)), right.pick((r, c))
        middle = middle.pick((r, c))
        for level in range(HALVINGS):
            if not r.size:
                break
            m = (a + b) / 2
            r, a, b = np.concatenate([r, r]), np.concatenate([a, m]), np.concatenate([m, b])
            left, right = left.join(middle), middle.join(right)
            middle = self.nodes((a + b) / 2, r)
            low, high = curvature_bounds(self.side, a, b)
            slow = np.einsum("kc,kc->k", weights[r], low)
            fast = np.einsum("kc,kc->k", weights[r], high)
            counted, first, stop, open_ = self._settle(left, right, middle, slow, fast, (b - a) / 2)
            if level == HALVINGS - 1:  # a fold at a ratio of the map, to rounding
                counted = counted | (open_ & (stop > first))
            found.append((r[counted], first[counted], stop[counted]))
            r, a, b = r[open_], a[open_], b[open_]
            left, right, middle = left.pick(open_), right.pick(open_), middle.pick(open_)
        return found

    def _range(self, low: np.ndarray, high: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Indices (first, stop) of the ratios in [low, high)."""
        return np.searchsorted(self.ratios, low), np.searchsorted(self.ratios, high)

    def _settle(
        self,
        left: _Nodes,
        right: _Nodes,
        middle: _Nodes,
        slow: np.ndarray,
        fast: np.ndarray,
        half: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """(counted, first, stop, open): cells that hold minima, at which ratios, and cells to halve.

        slow, fast: bounds of A'' on the cells; half: half their widths.
        """
        at_left, at_right = left.ratio(), right.ratio()
        up_left, up_right = left.even >= 0, right.even >= 0
        inf = np.inf
        # F < 0 at the left and F >= 0 at the right: each linear in r, and both together an interval
        low = np.maximum(np.where(up_left, -inf, at_left), np.where(up_right, at_right, -inf))
        high = np.minimum(np.where(up_left, at_left, inf), np.where(up_right, inf, at_right))
        first, stop = self._range(low, high)
        # ratios for which F may turn on the cell, and those for which it may vanish there too
        reach = half * (fast - slow) * FREE
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            one, two = (-middle.odd - reach) / middle.even, (-middle.odd + reach) / middle.even
        one, two = np.where(np.isnan(one), -inf, one), np.where(np.isnan(two), inf, two)
        turn_low = np.maximum(-fast / self.stiff, np.minimum(one, two))
        turn_high = np.minimum(-slow / self.stiff, np.maximum(one, two))
        open_ = (turn_low <= turn_high) & (
            np.searchsorted(self.ratios, turn_low)
            < np.searchsorted(self.ratios, turn_high, side="right")
        )
        some = stop > first
        if self.depth > 0:
            deep, shallow = self._deep(left, right, middle, first, stop, half)
            open_ = open_ | (some & ~deep & ~shallow)
            some = some & ~shallow
        return some & ~open_, first, stop, open_

    def _deep(
        self,
        left: _Nodes,
        right: _Nodes,
        middle: _Nodes,
        first: np.ndarray,
        stop: np.ndarray,
        half: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Whether the minima of a cell are deeper than the threshold at all its ratios, and at none."""
        last = len(self.ratios) - 1
        span = self.ratios[np.minimum(first, last)], self.ratios[np.maximum(stop - 1, 0)]
        deep, shallow = np.zeros(first.shape, bool), np.zeros(first.shape, bool)
        for nodes in (left, right, middle):
            deep |= (nodes.deeper(span[0]) > 0) & (nodes.deeper(span[1]) > 0)
        for nodes, step in ((left, -2 * half), (right, 2 * half)):
            shallow |= (nodes.deeper(span[0], step) <= 0) & (nodes.deeper(span[1], step) <= 0)
        return deep, shallow & ~deep
