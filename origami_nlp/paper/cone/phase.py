"""The phase diagram of a cone: numbers of branch minima over (nu_0, r_k), and the curves that bound them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.arguments import check_callback, check_flag, check_number, check_whole, shown
from origami_nlp.display import Report, Section, Table
from origami_nlp.errors import OptionError
from origami_nlp.paper.cone.classes import direction_name
from origami_nlp.paper.cone.map import CountMap, count_map
from origami_nlp.paper.cone.numbers import exact
from origami_nlp.paper.cone.phase_curves import KINDS, PhaseBoundary, phase_boundaries
from origami_nlp.paper.cone.rules import Cone, check_depth, check_ratio

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
    contact
        Whether those at the end of a branch count (pinned by contact, or at a cut).
    boundaries
        Of every class; those of kind "end" move a minimum between inside and end.
    """

    map: CountMap
    contact: bool
    boundaries: tuple[PhaseBoundary, ...] = field(repr=False)

    SCHEMA, READS, PICTURE = "origami-nlp/paper/1", False, "draw_phase"

    def report_sections(self) -> Iterator[Section]:
        """Return which numbers occur and how much of the map each takes, and the number of boundaries."""
        numbers, often = np.unique(self.minima, return_counts=True)
        total = self.map.branches
        rows = [
            [f"{int(n)}/{total}", f"{int(n) / total:.6g}", f"{k / self.minima.size:.2%}"]
            for n, k in zip(numbers, often, strict=True)
        ]
        yield Table(
            ("branch minima", "normalised", "share of the map"), rows, columns="Lrr", framed=False
        )
        kinds = Counter(b.kind for b in self.boundaries)
        yield "boundaries: " + ", ".join(f"{k} {n}" for k, n in kinds.items())

    def _numbers(self) -> dict[str, np.ndarray]:
        m = self.map
        return {"interior": m.interior, "contact_pinned": m.contact, "falling_at_cut": m.cut}

    def _rows(self) -> Iterator[dict[str, object]]:
        for i, nu in enumerate(self.map.elevations.tolist()):
            for k, r in enumerate(self.map.ratios.tolist()):
                each = {name: int(n[k, i]) for name, n in self._numbers().items()}
                yield {"rest_elevation": nu, "ratio": r, **each}

    def to_dict(self) -> dict[str, Any]:
        """Return plain JSON data; maps are [ratio][rest elevation], numbers beyond 2^53 text."""
        m = self.map
        return {
            "schema": self.SCHEMA,
            "degree": m.cone.degree,
            "branches": str(m.branches),
            "rest": m.cone.rest,
            "end": m.cone.end,
            "depth": m.depth,
            "contact": self.contact,
            "ratios": m.ratios.tolist(),
            "rest_elevations": m.elevations.tolist(),
            **{
                name: [[exact(n) for n in row] for row in numbers.tolist()]
                for name, numbers in self._numbers().items()
            },
            "boundaries": [
                {
                    "valleys": b.branches.valleys,
                    "changes": b.branches.changes,
                    "direction": direction_name(b.branches.direction),
                    "multiplicity": exact(b.branches.multiplicity),
                    "kind": b.kind,
                    "rest_elevation": b.rest_elevation.tolist(),
                    "ratio": b.ratio.tolist(),
                    "elevation": b.elevation.tolist(),
                }
                for b in self.boundaries
            ],
        }

    @property
    def degree(self) -> int:
        """N."""
        return self.map.cone.degree

    @cached_property
    def minima(self) -> np.ndarray:
        """Number of branch minima [ratios, elevations]."""
        return self.map.total if self.contact else self.map.interior

    def bounding(self, counted: str) -> tuple[PhaseBoundary, ...]:
        """Return the boundaries at which a number of minima changes.

        Parameters
        ----------
        counted
            ``all`` minima, those in the ``interior`` of their branch, or those ``at end``.

        Returns
        -------
        tuple of PhaseBoundary
            Of the kinds that change it.
        """
        kinds = {"all": ("start", "fold"), "interior": KINDS, "at end": ("end",)}[counted]
        return tuple(b for b in self.boundaries if b.kind in kinds)

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers that occur."""
        return tuple(int(x) for x in np.unique(self.minima))


def phase_diagram(
    cone: Cone | int,
    *,
    size: int = 200,
    ratios: tuple[float, float] = RATIOS,
    rest_elevations: tuple[float, float] | None = None,
    depth: float = 0.0,
    contact: bool = True,
    progress: Callable[[int], None] | None = None,
) -> PhaseDiagram:
    """Compute a phase diagram: numbers of branch minima over (nu_0, r_k), and their exact boundaries.

    Parameters
    ----------
    cone
        A `Cone`, or its degree: even, 6 to 200.
    size
        Points of the map along each coordinate, at the centres of its cells: 2 to 2,000.
    ratios
        Smallest and largest r_k; spaced geometrically.
    rest_elevations
        Lowest and highest nu_0 [rad]; default: all before contact (for the printed rest formula, the paper's).
    depth
        Count only minima with (U_flat - U)/U_flat > depth, see `count`; boundaries are those of all minima.
    contact
        Whether minima at the end of a branch count.
    progress
        Called with the number of columns of the map that are done.

    Returns
    -------
    PhaseDiagram
        Draw it with `draw_phase`.

    Raises
    ------
    OptionError, AngleError
        For values out of range.

    Examples
    --------
    >>> from origami_nlp.paper import cone
    >>> cone.phase_diagram(6, size=4).numbers
    (8,)
    """
    cone = Cone.of(cone, LARGEST_DEGREE)
    check_whole("size", size, 2, LARGEST_SIZE)
    check_flag("contact", contact)
    check_callback("progress", progress)
    bottom, top = (check_ratio(r, "ratios") for r in _pair("ratios", ratios))
    low, high = cone.rest_range
    if rest_elevations is not None:
        pair = _pair("rest_elevations", rest_elevations)
        low, high = (check_number("rest_elevations", v, low, high) for v in pair)
    if not (bottom < top and low < high):
        raise OptionError(
            f"ratios = {ratios!r} and rest_elevations = ({low}, {high}) must increase"
        )
    cells = (np.arange(size) + 0.5) / size
    r = bottom * (top / bottom) ** cells
    nu = low + (high - low) * cells
    nu = nu[nu != 0]  # on that line no branch has a minimum but the flat state
    counts = count_map(cone, r, nu, depth=check_depth(depth), progress=progress)
    curves = phase_boundaries(cone)
    inside = [b for b in curves if _within(b, (low, high), (bottom, top))]
    return PhaseDiagram(counts, contact, tuple(inside))


def _pair(name: str, value: object) -> tuple[Any, Any]:
    if not isinstance(value, tuple | list) or len(value) != 2:
        raise OptionError(f"{name} = {shown(value)} must be two numbers, low and high")
    return value[0], value[1]


def _within(curve: PhaseBoundary, nu: tuple[float, float], ratio: tuple[float, float]) -> bool:
    """Whether a curve runs through the window of a diagram."""
    x, y = curve.rest_elevation, curve.ratio
    return bool(((x >= nu[0]) & (x <= nu[1]) & (y >= ratio[0]) & (y <= ratio[1])).any())
