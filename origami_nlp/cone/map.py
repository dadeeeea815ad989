"""Numbers of branch minima of a cone over a whole plane of (r_k, v_0), without an optimiser.

With B' = 4 n (s - s_e) the slope at s is F = A'(s) + r B'(s): linear in r, so for one class, one rest state and one
cell of elevations the ratios with F < 0 at the left and F >= 0 at the right end make one interval,
and all ratios of a column of the map are served at once.  A cell is settled when no ratio of the map can have
a second zero of F there: where F' = A'' + 4 n r may vanish (an enclosure of A'' tells for which r), F itself
must not (mean value bound).  Other cells are halved, as in `cone_roots`.

Depth thresholds: with h_s(r) = well_A(s) + r well_B(s) - D U_flat(r), linear in r, the minimum of a cell is deep
enough when max h_s(r) > 0 over the cell.  Any s of the cell bounds this from below.  F rises through 0
on a settled cell, so at most width |F| is gained from either end: linear bounds from above.  At the first
and the last ratio of a cell they decide for all between; cells they leave open are halved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.cone.energy import DirectionClasses, crease_angles, rest_state
from origami_nlp.cone.flaps import ConeClasses, cone_classes
from origami_nlp.cone.minima import check_depth, check_ratio
from origami_nlp.cone.roots import CELLS, HALVINGS, TIE, curvature_bounds
from origami_nlp.errors import OptionError

LIMB = 30
"""Multiplicities beyond 63 bits are summed in limbs of this many bits."""


@dataclass(frozen=True)
class CountMap:
    """Numbers of branch minima, shape [ratios, elevations] each.

    interior, contact, cut: by kind, see `cone_minima.BranchMinima`; int64 where all numbers fit, else exact
    Python integers (dtype object).
    branches: number of all branches, 2^(N/2 + 1).
    """

    degree: int
    ratios: np.ndarray
    elevations: np.ndarray
    interior: np.ndarray
    contact: np.ndarray
    cut: np.ndarray
    depth: float
    rest_rule: str
    end_rule: str

    @property
    def branches(self) -> int:
        """Number of all branches, 2^(N/2 + 1)."""
        return 1 << (self.degree // 2 + 1)

    @property
    def at_end(self) -> np.ndarray:
        """Minima at the end of their branch, pinned there by contact or by the cut."""
        return self.contact + self.cut

    @property
    def total(self) -> np.ndarray:
        """All minima."""
        return self.interior + self.at_end


def count_map(
    degree: int,
    ratios: Sequence[float] | np.ndarray,
    elevations: Sequence[float] | np.ndarray,
    *,
    depth: float = 0.0,
    rest: str = "waterbomb",
    end: str = "contract",
    progress: Callable[[int], None] | None = None,
) -> CountMap:
    """Count branch minima by kind at every (r_k, v_0): `branch_minima` for a plane.

    Parameters
    ----------
    ratios, elevations
        Values of r_k, and of v_0 [rad], in any order.
    depth, rest, end
        As in `cone_minima.branch_minima`.
    progress
        Called with the number of columns (elevations) done.

    Raises
    ------
    OptionError, AngleError
        For values out of range.
    """
    depth = check_depth(depth)
    given = np.array([check_ratio(r, "ratios") for r in np.atleast_1d(ratios)])
    columns = np.atleast_1d(np.asarray(elevations, dtype=float))
    if given.ndim != 1 or columns.ndim != 1 or not given.size or not columns.size:
        raise OptionError("ratios and elevations must be lists of numbers")
    order = np.argsort(given)
    classes = cone_classes(degree)
    limbs = _limbs(classes)
    shape = (len(limbs), len(given), len(columns))
    inside, pinned, cut = (np.zeros(shape, np.int64) for _ in range(3))
    for k, elevation in enumerate(columns):
        state = rest_state(degree, elevation, rest)
        for direction in (1, -1):
            branches = DirectionClasses(classes, direction, state, end)
            for own_end in np.unique(branches.end):
                rows = np.nonzero(branches.end == own_end)[0]
                column = _Column(branches, rows, float(own_end), given[order], depth)
                inside[:, order, k] += column.total(column.interior(), limbs)
                for counts, which in ((pinned, ~branches.cut), (cut, branches.cut)):
                    counts[:, order, k] += column.total([column.at_end(which[rows])], limbs)
        if progress:
            progress(k + 1)
    one, two, three = (_whole(limbs) for limbs in (inside, pinned, cut))
    return CountMap(degree, given, columns, one, two, three, depth, rest, end)


def _limbs(classes: ConeClasses) -> np.ndarray:
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


class _Nodes:
    """What is known at elevations of classes: A', B', and (with a depth) the wells less D U_flat."""

    def __init__(self, column: _Column, s: np.ndarray, rows: np.ndarray | None = None) -> None:
        branches, block = column.branches, column.rows
        size, first, _ = crease_angles(branches.degree, s)
        kinds = (size + branches.reach * branches.signs) * first
        weights, vertex = branches.weights[block], branches.even_vertex[block]
        own = vertex[:, None] if rows is None else vertex[rows]

        def total(values: np.ndarray) -> np.ndarray:
            if rows is None:
                return weights @ values.T
            return np.einsum("kc,kc->k", weights[rows], values)

        self.odd = total(kinds)
        self.even = 4 * branches.flaps * (s - own) + 0 * self.odd
        self.well_odd = self.well_even = self.odd
        if column.depth > 0:
            flat_odd, flat_even = branches.flat_energies()
            wells = total(-size * (size / 2 + branches.reach * branches.signs))
            self.well_odd = wells - column.depth * flat_odd
            self.well_even = -2 * branches.flaps * s * (s - 2 * own) - column.depth * flat_even

    def pick(self, index: object) -> _Nodes:
        other = object.__new__(_Nodes)
        for name in ("odd", "even", "well_odd", "well_even"):
            setattr(other, name, getattr(self, name)[index])
        return other

    def join(self, more: _Nodes) -> _Nodes:
        other = object.__new__(_Nodes)
        for name in ("odd", "even", "well_odd", "well_even"):
            setattr(other, name, np.concatenate([getattr(self, name), getattr(more, name)]))
        return other

    def ratio(self) -> np.ndarray:
        """r at which the slope is zero; where B' = 0, +inf if F < 0 for all r, else -inf."""
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            level = -self.odd / self.even
        return np.where(self.even == 0, np.where(self.odd < 0, np.inf, -np.inf), level)


class _Column:
    """All ratios of a map at one rest state, for the classes of one direction with one end."""

    def __init__(
        self,
        branches: DirectionClasses,
        rows: np.ndarray,
        end: float,
        ratios: np.ndarray,
        depth: float,
    ) -> None:
        self.branches, self.rows, self.end = branches, rows, end
        self.ratios, self.depth = ratios, depth
        self.stiff = 4.0 * branches.flaps
        self.grid = np.linspace(0.0, end, CELLS + 1)
        self.at_grid = _Nodes(self, self.grid)
        last = self.at_grid.pick((slice(None), slice(CELLS, None)))
        scale = branches.slope_scale(np.array([end]), 0.0, rows)
        vertex = np.abs(branches.even_vertex[rows])
        # the rest state at the very end of its branch: no slope there, whatever r
        self.tied = (np.abs(last.odd[:, 0]) <= TIE * scale) & (
            np.abs(last.even[:, 0]) <= TIE * self.stiff * (end + vertex)
        )
        self.at_grid.odd[self.tied, -1] = -1.0  # "falls to the end": counted there, by at_end()
        self.at_grid.even[self.tied, -1] = 0.0

    def total(self, events: list[Events], limbs: np.ndarray) -> np.ndarray:
        """Sum multiplicities at every ratio, [limbs, ratios]."""
        steps = np.zeros((len(limbs), len(self.ratios) + 1), np.int64)
        for rows, first, stop in events:
            own = limbs[:, self.rows[rows]]
            for limb, value in zip(steps, own, strict=True):
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
            with np.errstate(divide="ignore", invalid="ignore"):
                least = -last.well_odd / last.well_even
            flat = last.well_even == 0
            least = np.where(flat, np.where(last.well_odd > 0, -np.inf, np.inf), least)
            rising = last.well_even >= 0
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
        middle = _Nodes(self, (self.grid[:-1] + self.grid[1:]) / 2)
        weights = self.branches.weights[self.rows]
        low, high = curvature_bounds(self.branches, self.grid[:-1], self.grid[1:])
        half = np.diff(self.grid) / 2
        shape = left.odd.shape
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
            middle = _Nodes(self, (a + b) / 2, r)
            low, high = curvature_bounds(self.branches, a, b)
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
        low = np.maximum(np.where(up_left, -inf, at_left), np.where(up_right, at_right, -inf))
        high = np.minimum(np.where(up_left, at_left, inf), np.where(up_right, inf, at_right))
        first, stop = self._range(low, high)
        # ratios for which F may turn on the cell, and those for which it may vanish there too
        reach = half * (fast - slow) * (1 + 1e-12)
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
        deep = np.zeros(first.shape, bool)
        for nodes in (left, right, middle):
            at_ends = [nodes.well_odd + r * nodes.well_even for r in span]
            deep |= (at_ends[0] > 0) & (at_ends[1] > 0)
        shallow = np.zeros(first.shape, bool)
        for nodes, sign in ((left, -1.0), (right, 1.0)):
            step = 2 * sign * half
            odd, even = nodes.well_odd + step * nodes.odd, nodes.well_even + step * nodes.even
            at_ends = [odd + r * even for r in span]
            shallow |= (at_ends[0] <= 0) & (at_ends[1] <= 0)
        return deep, shallow & ~deep
