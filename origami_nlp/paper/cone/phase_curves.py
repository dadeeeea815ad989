"""Exact phase boundaries of cone branches in the plane of rest elevation nu_0 and ratio r.

The energy of a branch is A(t) + r B(t), t = |v| (`cone.energy`), so that its stationary
points solve r = -A'/B' and every boundary has an explicit r:

    start         t = 0: the slope at the flat state changes sign (U'' > 0 there: one minimum comes or goes),
    end           t = T: the slope at the end of the branch changes sign,
    fold          A'' B' = A' B'': a minimum and a maximum annihilate.

Folds are zero sets in the (nu_0, t) plane: traced on a grid (contourpy), then every point is bisected along its grid
edge to the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.paper.cone.classes import EnergyClass, energy_classes
from origami_nlp.paper.cone.energy import class_energy
from origami_nlp.paper.cone.rules import LARGEST_DEGREE, Cone

KINDS = ("start", "end", "fold")
RATIO_LIMITS = (1e-9, 1e9)
"""Curves are cut where r leaves these: they go to zero or to infinity."""
LINES = 300
"""Grid lines of each coordinate on which zero sets are traced."""
NEAREST = 1e-6
"""Smallest |nu_0| on a curve [rad]; all curves have limits for nu_0 -> 0, where no rest state is left.  The limits
are approached as nu_0^2 = 1e-12, while the fold condition / nu_0^2 keeps ten digits."""
MOST_LINES = 100_000
"""Grid lines that memory bears."""
ON_LINE = 1e-9
"""A vertex of a contour lies on a grid line to this share of its coordinate: contourpy returns node coordinates to
some eps, and neighbouring lines are at least 1/MOST_LINES apart."""
BISECTIONS = 80
"""Most halvings of a grid edge: 53 to the last bit of its middle, and 27 more for roots nearer to zero."""


@dataclass(frozen=True)
class PhaseBoundary:
    """A connected piece of one boundary of one class of branches.

    Attributes
    ----------
    branches
        The class.
    kind
        See the module.
    rest_elevation
        nu_0 [m] [rad].
    ratio
        r = k_even/k_odd [m].
    elevation
        |v| of the state that appears or vanishes [m] [rad].
    """

    branches: EnergyClass
    kind: str
    rest_elevation: np.ndarray = field(repr=False)
    ratio: np.ndarray = field(repr=False)
    elevation: np.ndarray = field(repr=False)


def phase_boundaries(cone: Cone | int, *, lines: int = LINES) -> list[PhaseBoundary]:
    """Compute every boundary of every class of branches of the cone.

    Parameters
    ----------
    cone
        A `Cone`, or its degree.
    lines
        Grid lines on which folds are looked for.

    Returns
    -------
    list of PhaseBoundary
        Curves (nu_0 [rad], r_k) with the kind of change and the class of branches.

    Raises
    ------
    OptionError
        If the degree or `lines` is out of range.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> curves = cone.phase_boundaries(6, lines=40)
    >>> {(c.branches.name, c.kind) for c in curves if c.branches.valleys == 2 and c.kind == "start"}
    {('MV2 up', 'start')}
    """
    cone = Cone.of(cone, LARGEST_DEGREE)
    check_whole("lines", lines, 2, MOST_LINES)
    found = []
    for branches in energy_classes(cone):
        for limit in cone.rest_range:
            nu = np.sign(limit) * _crowded(abs(limit), lines)
            for kind, t in (("start", 0.0), ("end", branches.end)):  # r is a function of nu_0
                ratio = class_energy(branches, t, nu).ratio
                found += list(_pieces(branches, kind, nu, ratio, np.full_like(nu, t)))
            found += list(_folds(branches, nu, lines))
    return found


def _crowded(limit: float, lines: int) -> np.ndarray:
    """Values from `NEAREST` to `limit`: half of them even, half geometric towards zero."""
    return np.unique(
        np.concatenate(
            [np.geomspace(NEAREST, limit, lines // 2), np.linspace(NEAREST, limit, lines)]
        )
    )


def _folds(branches: EnergyClass, nu: np.ndarray, lines: int) -> Iterator[PhaseBoundary]:
    """Zero sets of the fold condition over 0 < t < T."""
    from contourpy import contour_generator

    t = branches.end * _crowded(1.0, lines)

    def condition(at: np.ndarray, rest_at: np.ndarray) -> np.ndarray:
        # near nu_0 = 0 it vanishes as a power of it: divided, its zero sets have limits
        return np.asarray(class_energy(branches, at, rest_at).fold / rest_at**2)

    nu = np.sort(nu)
    grid = condition(t[:, None], nu[None, :])
    for found in contour_generator(nu, t, np.arcsinh(grid)).lines(0.0):
        line = np.asarray(found)
        at_nu, at_t = _bisected(condition, line[:, 0], line[:, 1], nu, t)
        yield from _pieces(branches, "fold", at_nu, class_energy(branches, at_t, at_nu).ratio, at_t)


def _bisected(
    condition: Callable[[np.ndarray, np.ndarray], np.ndarray],
    x: np.ndarray,
    y: np.ndarray,
    xs: np.ndarray,
    ys: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Move each vertex of a contour line along its grid edge to the sign change of the condition.

    A vertex lies on a grid line of one coordinate, and the other one is free.  Where it falls on a node to
    rounding, its edge may be any of those around: the first one with a sign change is taken.  Vertices without
    one are left out.
    """
    found = np.zeros(len(x), dtype=bool)
    at_x, at_y, low, high = x.copy(), y.copy(), x.copy(), x.copy()
    free_x = np.zeros(len(x), dtype=bool)
    for along_x in (True, False):
        free, grid, fixed, lines = (x, xs, y, ys) if along_x else (y, ys, x, xs)
        near = np.clip(np.searchsorted(lines, fixed), 1, len(lines) - 1)
        near -= np.abs(lines[near - 1] - fixed) <= np.abs(lines[near] - fixed)
        on_line = np.abs(lines[near] - fixed) <= ON_LINE * np.abs(fixed)
        edge = np.searchsorted(grid, free)
        # the edge that holds the vertex, then the edges on either side
        for step in (0, -1, 1):
            k = np.clip(edge + step, 1, len(grid) - 1)
            a, b, other = grid[k - 1], grid[k], lines[near]
            ends = [condition(v, other) if not along_x else condition(other, v) for v in (a, b)]
            take = ~found & on_line & (np.signbit(ends[0]) != np.signbit(ends[1]))
            low, high = np.where(take, a, low), np.where(take, b, high)
            at_x = np.where(take & ~np.bool_(along_x), other, at_x)
            at_y = np.where(take & np.bool_(along_x), other, at_y)
            free_x |= take & along_x
            found |= take
    at_x, at_y, low, high, free_x = (v[found] for v in (at_x, at_y, low, high, free_x))

    def value(free: np.ndarray) -> np.ndarray:
        return condition(np.where(free_x, at_y, free), np.where(free_x, free, at_x))

    below = np.signbit(value(low))
    for _ in range(BISECTIONS):
        middle = (low + high) / 2
        if ((middle == low) | (middle == high)).all():
            break
        same = np.signbit(value(middle)) == below
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.where(free_x, low, at_x), np.where(free_x, at_y, low)


def _pieces(
    branches: EnergyClass, kind: str, nu: np.ndarray, ratio: np.ndarray, t: np.ndarray
) -> Iterator[PhaseBoundary]:
    """Cut a line where r is not within `RATIO_LIMITS`."""
    with np.errstate(invalid="ignore"):
        good = (ratio > RATIO_LIMITS[0]) & (ratio < RATIO_LIMITS[1])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(int), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first > 1:
            cut = slice(first, last)
            yield PhaseBoundary(branches, kind, nu[cut], ratio[cut], t[cut])
