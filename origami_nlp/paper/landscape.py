"""A landscape with everything on it exact: boundaries, minima with verdicts, metastable stretches.

The energy is evaluated on a grid (`chart.landscape`), whose size decides how smooth the colours are and nothing else:
contact boundaries are exact to rounding (`chart.trace_boundary`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.chart import (
    Boundary,
    Landscape,
    Place,
    landscape,
    outline_of,
    with_energy,
)
from origami_nlp.contact import flat_parts
from origami_nlp.display import Report, Section, record_table
from origami_nlp.minima import MinimaResult
from origami_nlp.pattern_problem import pose

PIECE = 0.01
"""Spacing [rad of arclength] of the points of a metastable stretch."""


@dataclass(frozen=True)
class Stretch:
    """A metastable stretch of a contact boundary: where the energy is nearly flat (see `contact.find_segments`).

    Attributes
    ----------
    branch
        Of the chart.
    points
        Chart coordinates [m, 2].
    length
        Arclength in all N fold angles [rad].
    contacts
        Held closed along it.
    hidden
        Whether all of it shares one point of the chart.
    """

    branch: int
    points: np.ndarray = field(repr=False, metadata={"plain": False})
    length: float
    contacts: tuple[str, ...]
    hidden: bool

    ALSO = ("ends",)

    @property
    def ends(self) -> tuple[np.ndarray, np.ndarray]:
        """Its first and its last point on the chart."""
        return self.points[0], self.points[-1]


@dataclass(frozen=True, repr=False)
class ExactLandscape(Report):
    """Energy over the chart, its exact boundary, and the exact minima with their places.

    Attributes
    ----------
    result
        The minima.
    chart
        The energy on a grid over the coordinates of the chart.
    boundary
        Contact boundaries; None where they are not traced (contact other than full).
    places
        Of the minima on the chart.
    metastable
        Stretches of nearly constant energy, in the order of the boundary's lines.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> exact = o.find_landscape(result, size=21)
    >>> exact.counts, len(exact.boundary)
    ((2, 2, 2), 8)
    """

    result: MinimaResult
    chart: Landscape = field(metadata={"plain": False})
    boundary: Boundary | None
    places: tuple[Place, ...]
    metastable: tuple[Stretch, ...]

    PICTURE, SCHEMA, READS = "draw_landscape", "origami-nlp/landscape/2", False
    ALSO = ("counts",)

    @property
    def counts(self) -> tuple[int, int | None, int | None]:
        """N_sym, N_not-ruled-out, N_full: symmetric minima, those not unstable and those stable in the full space.

        The last two are None if the full space was not asked about.
        """
        verdicts = [m.full_space.verdict for m in self.result.minima if m.full_space]
        if len(verdicts) < len(self.result.minima):
            return len(self.result.minima), None, None
        # the paper's triplet N_sym -> N_nr -> N_full: undecided ones are not ruled out
        stable = verdicts.count("stable")
        return len(verdicts), stable + verdicts.count("undecided"), stable

    def report_sections(self) -> Iterator[Section]:
        """Return the minima with their places and verdicts, and the boundary."""
        yield self.result.table()
        if self.places:
            names = ", ".join(name.split(" (")[0] for name in self.chart.coordinates)
            yield record_table(self.places, f"where they are on ({names})")
        counts = zip(
            ("symmetric", "not ruled out", "stable in the full space"), self.counts, strict=True
        )
        yield "minima: " + ", ".join(f"{n} {what}" for what, n in counts if n is not None)
        if self.boundary is None:
            yield "boundary not traced: contact is not 'full', or contacts meet too closely"
            return
        lines = self.boundary
        total, thin = sum(line.length for line in lines), sum(line.thin for line in lines)
        yield f"{len(lines)} contact boundaries, {total:.2f} rad; {thin} of them 1-handles"
        for part in self.metastable:
            where = "on one chart point, " if part.hidden else ""
            yield f"metastable: {part.length:.2f} rad, {where}{'; '.join(part.contacts)}"


def find_landscape(result: MinimaResult, *, size: int = 401) -> ExactLandscape:
    """Put a landscape together: energy over the chart, exact boundaries and minima (the paper's figures 3 and 4).

    Parameters
    ----------
    result
        Minima of the scene, judged in the full space if verdicts are wanted.
    size
        Cells along each coordinate at which the energy is evaluated.

    Returns
    -------
    ExactLandscape
        Without boundary where the scene's contact is not ``"full"``.

    Raises
    ------
    OptionError
        If an argument is not what it must be.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> exact = o.find_landscape(result, size=21)
    >>> exact.chart.coordinates, len(exact.places)
    (('phi_2', 'phi_3'), 2)
    """
    check_type("result", result, MinimaResult)
    scene = result.scene
    chart = landscape(scene, size)
    places = (
        tuple(chart.place(m.fold_angles, m.winding) for m in result.minima)
        if chart.branches
        else ()
    )
    boundary = outline_of(scene) if chart.kind == "area" else None
    stretches = metastable_stretches(result, boundary) if boundary else ()
    return ExactLandscape(result, chart, boundary, places, stretches)


def metastable_stretches(result: MinimaResult, boundary: Boundary) -> tuple[Stretch, ...]:
    """Find the metastable stretches of every boundary line, with the thresholds of `find_segments`."""
    total = sum(result.scene.stiffness)
    angles = [np.array(m.fold_angles) for m in result.minima]
    out, problem = [], pose(result.scene)
    for number, line in enumerate(boundary):
        # the line is geometry; energy, slope and stiffness along it are the scene's
        curve = with_energy(problem, line)
        if len(curve.s) < 3:
            continue
        for part in flat_parts(curve, number, total, angles):
            # linear between points of the line, which lie on the boundary to rounding
            s = np.linspace(part.start, part.end, 2 + int(part.length / PIECE))
            points = np.stack([np.interp(s, line.s, line.points[:, i]) for i in (0, 1)], axis=-1)
            out.append(Stretch(line.branch, points, part.length, line.contacts, line.hidden))
    return tuple(out)
