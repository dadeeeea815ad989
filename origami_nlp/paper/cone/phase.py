"""The phase diagram of a cone: numbers of branch minima over (nu_0, r_k), and the exact curves that bound them.

The energy of a branch is A(t) + r B(t), t = |v| (`cone.energy`), so that its stationary
points solve r = -A'/B' and every boundary has an explicit r:

    start         t = 0: the slope at the flat state changes sign (U'' > 0 there: one minimum comes or goes),
    end           t = T: the slope at the end of the branch changes sign,
    fold          A'' B' = A' B'': a minimum and a maximum annihilate.

Folds are zero sets in the (nu_0, t) plane: traced on a grid (contourpy), then every point goes along the gradient to
the zero set.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from origami_nlp.arguments import check_callback, check_whole
from origami_nlp.display import Report, Section, Table
from origami_nlp.io import to_plain
from origami_nlp.numerics import NONZERO, SETTLED
from origami_nlp.paper.cone.classes import Branches, exact
from origami_nlp.paper.cone.energy import BranchEnergy
from origami_nlp.paper.cone.minima import CountMap, count_map
from origami_nlp.paper.cone.rules import Cone, Rest

KINDS = ("start", "end", "fold")
RATIO_LIMITS = (1e-9, 1e9)
"""Curves are cut where r leaves these: they go to zero or to infinity."""
LINES, MOST_LINES = 300, 100_000
"""Grid lines of each coordinate on which zero sets are traced, and how many memory bears."""
NEAREST = 1e-6
"""Smallest |nu_0| on a curve [rad]; all curves have limits for nu_0 -> 0, where no rest state is left.  The limits
are approached as nu_0^2 = 1e-12, while the fold condition / nu_0^2 keeps ten digits."""
POLISHING, DIFFERENCE = 12, 1e-5
"""Steps of Newton for points of a fold, and their differences, both in the logarithms of nu_0 and t."""
RATIOS = (1e-2, 1e2)
"""Smallest and largest ratio of a diagram."""
LARGEST_SIZE = 2000
LARGEST_DEGREE = 200
"""Of the boundaries: 7,500 classes of both directions at degree 200."""


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

    branches: Branches
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
    >>> {(c.branches.name(0), c.kind) for c in curves if c.branches.valleys == 2 and c.kind == "start"}
    {('MV2 up', 'start')}
    """
    every = Branches.of(cone)
    check_whole("lines", lines, 2, MOST_LINES)
    found = []
    for row in range(len(every)):
        branches = every[[row]]
        for limit in every.cone.rest_range:
            nu = np.sign(limit) * _crowded(abs(limit), lines)
            for kind, t in (("start", 0 * nu), ("end", branches.end + 0 * nu)):
                found += list(_pieces(branches, kind, nu, t))
            found += list(_folds(branches, np.sort(nu), lines))
    return found


def _energy(branches: Branches, nu: np.ndarray, t: np.ndarray) -> BranchEnergy:
    """Energy of one class at rest elevations and elevations, which are broadcast."""
    return BranchEnergy(branches, Rest(nu, *branches.cone.rest_angles(nu)), s=t)


def _crowded(limit: float, lines: int) -> np.ndarray:
    """Values from `NEAREST` to `limit`: half of them even, half geometric towards zero."""
    geometric = np.geomspace(NEAREST, limit, lines // 2)
    return np.unique(np.concatenate([geometric, np.linspace(NEAREST, limit, lines)]))


def _folds(branches: Branches, nu: np.ndarray, lines: int) -> Iterator[PhaseBoundary]:
    """Zero sets of the fold condition over 0 < t < T."""
    from contourpy import contour_generator

    def condition(rest: np.ndarray, at: np.ndarray) -> np.ndarray:
        # near nu_0 = 0 it vanishes as a power of it: divided, its zero sets have limits
        return np.asarray(_energy(branches, rest, at).fold / rest**2)

    end = float(branches.end[0])
    t = end * _crowded(1.0, lines)
    grid = condition(*np.meshgrid(nu, t, sparse=True))
    for line in contour_generator(nu, t, np.arcsinh(grid)).lines(0.0):
        at = np.asarray(line).T
        step = at
        for _ in range(POLISHING):  # along the gradient, in logarithms
            change = np.exp(DIFFERENCE * np.eye(2))[:, :, None]
            gradient = [condition(*(at * c)) - condition(*(at / c)) for c in change]
            slope = np.stack(gradient) / (2 * DIFFERENCE)
            step = condition(*at) * slope / np.maximum((slope**2).sum(axis=0), NONZERO)
            at = at * np.exp(-np.clip(step, -0.1, 0.1))
        good = (np.abs(step).max(axis=0) < SETTLED) & (at[1] <= end)
        good &= (at[0] >= nu[0]) & (at[0] <= nu[-1])
        yield from _pieces(branches, "fold", *at[:, good])


def _pieces(
    branches: Branches, kind: str, nu: np.ndarray, t: np.ndarray
) -> Iterator[PhaseBoundary]:
    """Cut a line where r is not within `RATIO_LIMITS`."""
    ratio = _energy(branches, nu, t).stationary_ratio
    good = (ratio > RATIO_LIMITS[0]) & (ratio < RATIO_LIMITS[1])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], good.astype(int), [0]])))
    for first, last in zip(edges[::2], edges[1::2], strict=True):
        if last - first > 1:
            cut = slice(first, last)
            yield PhaseBoundary(branches, kind, nu[cut], ratio[cut], t[cut])


@dataclass(frozen=True, repr=False)
class PhaseDiagram(Report):
    """Map and boundaries.

    Attributes
    ----------
    map
        Minima by kind, shape [ratios, elevations].
    boundaries
        Of every class; those of kind "end" move a minimum between inside and end.
    """

    map: CountMap
    boundaries: tuple[PhaseBoundary, ...] = field(repr=False)

    SCHEMA, READS, PICTURE = "origami-nlp/paper/1", False, "draw_phase"

    def report_sections(self) -> Iterator[Section]:
        """Return which numbers occur and how much of the map each takes, and the number of boundaries."""
        total, minima = self.map.cone.branches, self.map.total
        rows = [
            [f"{int(n)}/{total}", f"{int(n) / total:.6g}", f"{k / minima.size:.2%}"]
            for n, k in zip(*np.unique(minima, return_counts=True), strict=True)
        ]
        heads = ("branch minima", "normalised", "share of the map")
        yield Table(heads, rows, columns="Lrr", framed=False)
        kinds = Counter(b.kind for b in self.boundaries)
        yield "boundaries: " + ", ".join(f"{k} {n}" for k, n in kinds.items())

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data; maps are [ratio][rest elevation], numbers beyond 2^53 text."""
        m, cone = self.map, self.map.cone
        kinds = {"interior": m.interior, "contact_pinned": m.contact, "falling_at_cut": m.cut}
        maps = {name: [[*map(exact, row)] for row in n.tolist()] for name, n in kinds.items()}
        each = "valleys changes direction multiplicity".split()
        boundaries = [
            dict(zip(each, b.branches.described(0), strict=True))
            | {k: getattr(b, k) for k in ("kind", "rest_elevation", "ratio", "elevation")}
            for b in self.boundaries
        ]
        about = {"schema": self.SCHEMA, **{k: getattr(cone, k) for k in ("degree", "rest", "end")}}
        about |= {"branches": str(cone.branches), "ratios": m.ratios}
        about |= {"rest_elevations": m.elevations, **maps, "boundaries": boundaries}
        return to_plain(about)  # type: ignore[no-any-return]

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers that occur."""
        return tuple(int(x) for x in np.unique(self.map.total))


def phase_diagram(
    cone: Cone | int, *, size: int = 200, progress: Callable[[int], None] | None = None
) -> PhaseDiagram:
    """Compute a phase diagram: numbers of branch minima over (nu_0, r_k), and their exact boundaries.

    The ratio r_k runs from 0.01 to 100, spaced geometrically, and nu_0 over all rest elevations before contact (for the
    printed rest formula, the paper's); `count_map` and `phase_boundaries` are for other windows.

    Parameters
    ----------
    cone
        A `Cone`, or its degree: even, 6 to 200.
    size
        Points of the map along each coordinate, at the centres of its cells: 2 to 2,000.
    progress
        Called with the number of columns of the map that are done.

    Returns
    -------
    PhaseDiagram
        Draw it with `draw_phase`.

    Raises
    ------
    OptionError
        For values out of range.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.phase_diagram(6, size=4).numbers
    (8,)
    """
    cone = Cone.of(cone, LARGEST_DEGREE)
    check_whole("size", size, 2, LARGEST_SIZE)
    check_callback("progress", progress)
    (bottom, top), (low, high) = RATIOS, cone.rest_range
    cells = (np.arange(size) + 0.5) / size
    nu = low + (high - low) * cells
    nu = nu[nu != 0]  # on that line no branch has a minimum but the flat state
    counts = count_map(cone, bottom * (top / bottom) ** cells, nu, progress=progress)
    inside = [b for b in phase_boundaries(cone) if ((b.ratio >= bottom) & (b.ratio <= top)).any()]
    return PhaseDiagram(counts, tuple(inside))
