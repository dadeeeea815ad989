"""Exact phase boundaries of cone branches in the plane of rest elevation nu_0 and ratio r.

The energy of a branch is A(t) + r B(t), t = |v| (`cone.energy`), so that its stationary
points solve r = -A'/B' and every boundary has an explicit r:

    start         t = 0: the slope at the flat state changes sign (U'' > 0 there: one minimum comes or goes),
    end           t = T: the slope at the end of the branch changes sign,
    fold          A'' B' = A' B'': a minimum and a maximum annihilate.

Folds are zero sets in the (nu_0, t) plane: traced on a grid (contourpy), then every point goes along the gradient to
the zero set.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_whole
from origami_nlp.numerics import NONZERO, SETTLED
from origami_nlp.paper.cone.classes import Branches
from origami_nlp.paper.cone.energy import BranchEnergy
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
