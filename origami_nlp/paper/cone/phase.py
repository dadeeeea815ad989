"""The phase diagram of a cone: numbers of branch minima over (nu_0, r_k), and the curves that bound them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from origami_nlp.arguments import check_callback, check_whole
from origami_nlp.display import Report, Section, Table
from origami_nlp.io import pick
from origami_nlp.paper.cone.classes import exact
from origami_nlp.paper.cone.minima import CountMap, count_map
from origami_nlp.paper.cone.phase_curves import PhaseBoundary, phase_boundaries
from origami_nlp.paper.cone.rules import Cone

RATIOS = (1e-2, 1e2)
"""Smallest and largest ratio of a diagram."""
LARGEST_SIZE = 2000
LARGEST_DEGREE = 200
"""Of the boundaries: 7,500 classes of both directions at degree 200."""


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

    def _numbers(self) -> dict[str, list[list[int]]]:
        m = self.map
        kinds = {"interior": m.interior, "contact_pinned": m.contact, "falling_at_cut": m.cut}
        return {name: numbers.tolist() for name, numbers in kinds.items()}

    def _rows(self) -> Iterator[dict[str, object]]:
        numbers = self._numbers()
        for i, nu in enumerate(self.map.elevations.tolist()):
            for k, r in enumerate(self.map.ratios.tolist()):
                each = {name: n[k][i] for name, n in numbers.items()}
                yield {"rest_elevation": nu, "ratio": r, **each}

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data; maps are [ratio][rest elevation], numbers beyond 2^53 text."""
        m, own = self.map, pick(self.map.cone, "degree", "rest", "end")
        maps = {k: [[*map(exact, row)] for row in n] for k, n in self._numbers().items()}
        each = "valleys changes direction multiplicity".split()
        boundaries = [
            dict(zip(each, b.branches.described(0), strict=True))
            | pick(b, "kind", "rest_elevation", "ratio", "elevation")
            for b in self.boundaries
        ]
        about = {"schema": self.SCHEMA, **own, "branches": str(m.cone.branches)}
        return (
            about
            | pick(m, "ratios", "rest_elevations=elevations")
            | maps
            | {"boundaries": boundaries}
        )

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
