"""Numbers of branch minima of a cone over a whole plane of (r_k, v_0): `count` at every point, classes by columns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.errors import OptionError
from origami_nlp.io import ShortRepr
from origami_nlp.paper.cone.classes import assignment_classes
from origami_nlp.paper.cone.energy import SideEnergy
from origami_nlp.paper.cone.minima import minima_of
from origami_nlp.paper.cone.numbers import SAFE
from origami_nlp.paper.cone.rules import Cone, check_depth, check_ratio


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
    given = np.array([check_ratio(r, "ratios") for r in np.atleast_1d(ratios).tolist()])
    rows = np.atleast_1d(elevations).tolist()
    columns = np.array([check_number("elevations", v) for v in rows])
    if given.ndim != 1 or columns.ndim != 1 or not given.size or not columns.size:
        raise OptionError("ratios and elevations must be lists of numbers")
    classes = assignment_classes(cone.degree)
    # object: exact however many branches there are
    numbers = np.array(classes.multiplicity, dtype=np.int64 if cone.branches <= SAFE else object)
    counts = np.zeros((3, len(given), len(columns)), numbers.dtype)
    # every class at every ratio, one after the other
    every, each = np.tile(np.arange(len(classes)), len(given)), np.repeat(given, len(classes))
    for k, elevation in enumerate(columns):
        for direction in (1, -1):
            side = SideEnergy.of(cone, direction, elevation).only(every)
            rows, s, at_end, _ = minima_of(side, each)[0]
            if depth > 0 and len(rows):
                deep = side.at(s, rows).depth(each[rows]) > depth
                rows, at_end = rows[deep], at_end[deep]
            kind = np.where(at_end, np.where(side.cut[rows], 2, 1), 0)
            for of in range(3):
                often = np.bincount(rows[kind == of], minlength=len(each))
                counts[of, :, k] += often.reshape(len(given), -1) @ numbers
        if progress:
            progress(k + 1)
    interior, contact, cut = counts
    return CountMap(cone, given, columns, interior, contact, cut, depth)
