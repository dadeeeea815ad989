"""A landscape with everything on it exact: boundaries, minima with verdicts, metastable stretches.

The energy is evaluated on a grid (`chart.landscape`); what bounds it is not: the admissible region is put together from
contact boundaries traced to rounding (`chart.trace_boundary`), so that the grid's size decides how smooth the colours
are and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.chart import (
    Boundary,
    Landscape,
    Outline,
    Place,
    admissible_region,
    landscape,
    outline_of,
    trace_boundary,
    with_energy,
)
from origami_nlp.contact import SLOPE, STIFFNESS, flat_parts
from origami_nlp.display import Content, Line, Report, Section, Table, Viewable
from origami_nlp.minima import MinimaResult
from origami_nlp.problem import Model

if TYPE_CHECKING:
    from origami_nlp.barriers import Barriers

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
class ExactLandscape(Report, Viewable):
    """Energy over the chart, its exact boundary, and the exact minima with their places.

    Attributes
    ----------
    result
        The minima.
    chart
        The energy on a grid over the coordinates of the chart.
    boundary
        Contact boundaries; None where they are not traced (contact other than full, stops).
    regions
        Admissible region of each branch of the chart (`shapely.MultiPolygon`); () where the boundary is not traced.
    places
        Of the minima on the chart.
    metastable
        Stretches of nearly constant energy, in the order of the boundary's lines.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> exact = o.find_landscape(result, size=21)
    >>> exact.counts, len(exact.regions)
    ((2, 2, 2), 1)
    """

    result: MinimaResult
    chart: Landscape = field(metadata={"plain": False})
    boundary: Boundary | None
    regions: tuple[Any, ...] = field(metadata={"plain": False})
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

    @property
    def one_plane(self) -> bool:
        """Whether all branches fit into one picture, each on its own side of zero."""
        return self.chart.one_plane

    @property
    def outline(self) -> Outline:
        """What bounds the states of each branch; found now where the boundary is not traced."""
        if self.boundary is None:
            return outline_of(self.chart.scene)
        return Outline(self.regions, self.boundary)

    def table(self) -> Table:
        """Return one row a minimum: energy, place on the landscape, kind and verdict."""
        names = [name.split(" (")[0] for name in self.chart.coordinates]
        rows = []
        for k, m in enumerate(self.result.minima):
            point = self.places[k].point[: len(names)] if self.places else ()
            known = m.full_space.verdict if m.full_space else "-"
            where = [f"{v:.6f}" for v in point] or ["-"] * len(names)
            rows.append((str(k + 1), f"{m.energy:.9g}", *where, m.kind, known))
        heads = ("#", "energy [J]", *names, "kind", "full space")
        return Table(heads, rows, self.result.scene.label, "rr" + "r" * len(names) + "ll")

    def report_sections(self) -> Iterator[Section]:
        """Return the minima with their places and verdicts, and the boundary."""
        yield self.table()
        symmetric, not_unstable, stable = self.counts
        yield f"{symmetric} symmetric minima (N_sym)" + (
            "; stability in the full space was not asked for"
            if stable is None
            else f"; in the full space {not_unstable} not ruled out, {stable} stable (N_full)"
        )
        if self.boundary is None:
            why = "there are stops" if self.result.scene.limits else "contact is not 'full'"
            yield f"boundary not traced: {why}"
            return
        lines = self.boundary.lines
        handles, missed = sum(line.thin for line in lines), sum(map(len, self.boundary.missed))
        yield (
            f"{len(lines)} contact boundaries, {sum(line.length for line in lines):.2f} rad; "
            f"{handles} of them 1-handles; boundary points of the grid on no line: {missed}"
        )
        for part in self.metastable:
            where = "on one chart point, " if part.hidden else ""
            yield f"metastable: {part.length:.2f} rad, {where}{'; '.join(part.contacts)}"

    def view_content(self, barriers: Barriers | None = None) -> Content:
        """Return states and the map with its exact boundaries as plain data, see `view`.

        Parameters
        ----------
        barriers
            Of `find_barriers`: also the paths over the passes.

        Returns
        -------
        Content
            What a page shows.
        """
        content = self.result.view_content(self.chart)
        reported = [*self.report_sections(), *content.pieces]
        if barriers is not None:
            from origami_nlp.barriers import add_passes  # only who has barriers has loaded them

            content = add_passes(content, self.result.scene, barriers.passes, self.chart)
            reported = [*barriers.report_sections(), *reported]
        if self.boundary is not None:
            content = add_boundary(
                content, self.boundary, [*map(self._stretches, range(len(content.panels)))]
            )
        return replace(content, pieces=tuple(reported))

    def _stretches(self, branch: int) -> list[Line]:
        return [
            Line(
                part.points,
                f"metastable, {part.length:.3g} rad: {'; '.join(part.contacts)}",
                "metastable",
            )
            for part in self.metastable
            if part.branch == branch and not part.hidden
        ]


def find_landscape(
    result: MinimaResult, *, size: int = 401, boundary: Boundary | None = None
) -> ExactLandscape:
    """Put a landscape together: energy over the chart, exact boundaries and minima (the paper's figures 3 and 4).

    Parameters
    ----------
    result
        Minima of the scene, judged in the full space if verdicts are wanted.
    size
        Cells along each coordinate at which the energy is evaluated.
    boundary
        Of a scene with the same vertex, symmetry and contact, to save tracing it again.

    Returns
    -------
    ExactLandscape
        Without boundary where the scene's contact is not ``"full"``, and where it has stops.

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
    if boundary is not None:
        check_type("boundary", boundary, Boundary)
    scene = result.scene
    chart = landscape(scene, size)
    places = (
        tuple(chart.place(m.fold_angles, m.winding) for m in result.minima)
        if chart.branches
        else ()
    )
    if chart.kind != "area" or scene.contact != "full" or scene.limits:
        return ExactLandscape(result, chart, None, (), places, ())
    boundary = boundary or trace_boundary(scene)
    # the grid colours; what it colours is cut by these polygons
    regions = tuple(admissible_region(scene, boundary, k) for k in range(len(chart.branches)))
    return ExactLandscape(
        result, chart, boundary, regions, places, metastable_stretches(result, boundary)
    )


def metastable_stretches(result: MinimaResult, boundary: Boundary) -> tuple[Stretch, ...]:
    """Find the metastable stretches of every boundary line, with the thresholds of `find_segments`."""
    total = sum(result.scene.stiffness)
    angles = [np.array(m.fold_angles) for m in result.minima]
    out, model = [], Model(result.scene)
    for number, line in enumerate(boundary.lines):
        # the line is geometry; energy, slope and stiffness along it are the scene's
        curve = with_energy(model, line)
        if len(curve.s) < 3:
            continue
        for part in flat_parts(curve, number, total, SLOPE, STIFFNESS, angles):
            # linear between points of the line, which lie on the boundary to rounding
            s = np.linspace(part.start, part.end, 2 + int(part.length / PIECE))
            points = np.stack([np.interp(s, line.s, line.points[:, i]) for i in (0, 1)], axis=-1)
            out.append(Stretch(line.branch, points, part.length, line.contacts, line.hidden))
    return tuple(out)


def to_arrays(exact: ExactLandscape) -> dict[str, Any]:
    """Return everything as named NumPy arrays, for `numpy.savez_compressed`.

    Parameters
    ----------
    exact
        Of `find_landscape`.

    Returns
    -------
    dict of str to numpy.ndarray
        x_b, y_b, energy_b [ny, nx], fold_angles_b [ny, nx, N] [rad], admissible_b [ny, nx] of branch b;
        boundary_k_points, boundary_k_fold_angles, boundary_k_s of line k, with boundary_branch, boundary_contacts,
        boundary_thin;
        minima_fold_angles [m, N], minima_points [m, 2], minima_branch, minima_energy, minima_kind, minima_verdict;
        metastable_k_points with metastable_branch; coordinates: their names.

    Examples
    --------
    >>> import origami_nlp as o
    >>> from origami_nlp.landscape import to_arrays
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> to_arrays(o.find_landscape(result, size=21))["energy_0"].shape
    (21, 21)
    """
    chart, result = exact.chart, exact.result
    arrays: dict[str, Any] = {
        "coordinates": np.array(chart.coordinates),
        "branches": np.array([b.name for b in chart.branches]),
    }
    for b, branch in enumerate(chart.branches):
        arrays[f"x_{b}"], arrays[f"y_{b}"] = branch.axes
        arrays[f"energy_{b}"] = branch.energy
        arrays[f"fold_angles_{b}"] = branch.fold_angles
        arrays[f"admissible_{b}"] = np.isfinite(branch.energy)
    lines = exact.boundary.lines if exact.boundary else ()
    arrays["boundary_branch"] = np.array([line.branch for line in lines], dtype=int)
    arrays["boundary_contacts"] = np.array(["; ".join(line.contacts) for line in lines], dtype=str)
    arrays["boundary_thin"] = np.array([line.thin for line in lines], dtype=bool)
    for k, line in enumerate(lines):
        arrays[f"boundary_{k}_points"] = line.points
        arrays[f"boundary_{k}_fold_angles"] = line.fold_angles
        arrays[f"boundary_{k}_s"] = line.s
    minima, degree = result.minima, result.scene.degree
    arrays["minima_fold_angles"] = np.array([m.fold_angles for m in minima]).reshape(-1, degree)
    arrays["minima_energy"] = np.array([m.energy for m in minima])
    arrays["minima_kind"] = np.array([m.kind for m in minima], dtype=str)
    verdicts = [m.full_space.verdict if m.full_space else "not asked" for m in minima]
    arrays["minima_verdict"] = np.array(verdicts, dtype=str)
    arrays["minima_points"] = np.array([p.point for p in exact.places]).reshape(-1, 2)
    arrays["minima_branch"] = np.array([p.branch for p in exact.places], dtype=int)
    arrays["metastable_branch"] = np.array([m.branch for m in exact.metastable], dtype=int)
    for k, part in enumerate(exact.metastable):
        arrays[f"metastable_{k}_points"] = part.points
    return arrays


def add_boundary(
    content: Content, boundary: Boundary, stretches: Sequence[Sequence[Line]]
) -> Content:
    """Put contact boundaries, 1-handles and metastable stretches on the map of a scene.

    Parameters
    ----------
    content
        Of `MinimaResult.view_content`: a panel for each branch of the chart.
    boundary
        Of the scene.
    stretches
        Metastable ones, for each branch.

    Returns
    -------
    Content
        With these lines instead of the grid's.
    """
    panels = [
        replace(panel, lines=(*_lines(boundary, k), *stretches[k]))
        for k, panel in enumerate(content.panels)
    ]
    return replace(content, panels=tuple(panels))


def _lines(boundary: Boundary, branch: int) -> Iterator[Line]:
    for line in boundary.lines:
        if line.branch == branch and not line.hidden:
            look, what = ("handle", "1-handle") if line.thin else ("contact", "contact")
            yield Line(line.points, f"{what}: {'; '.join(line.contacts)}", look)
