"""What a search for minima returns, of a vertex or of a pattern: lists, tables, words, and its plain data.

In JSON indices are 1-based, as in the paper; angles in radians; energies and moments in the units of the springs.
A multiplier range that never ends, or a residual that does not apply, is null.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp import pattern_problem
from origami_nlp.arguments import check_type, check_whole
from origami_nlp.display import (
    Content,
    Details,
    Report,
    Section,
    Table,
    Viewable,
    angle_columns,
    field_table,
    pieces_html,
    record_row,
    record_table,
)
from origami_nlp.errors import OptionError
from origami_nlp.io import figure_bytes
from origami_nlp.kkt import State
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.completeness import Completeness
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.fold_out import Part, minima_to_fold
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.report_lines import angle_lines, lattice_table, state_lines
from origami_nlp.minima.rows import CERTIFIED, StateRow, listed_table, state_rows
from origami_nlp.minima.stability import NOT_ASKED, verdict
from origami_nlp.minima.summary import find_images, verdict_words
from origami_nlp.numerics import INPUT_TOL, rank
from origami_nlp.pattern import Pattern, Relations, Scene, same_laws
from origami_nlp.pattern_problem import MeshFaces, state_mesh, state_parts

if TYPE_CHECKING:
    from origami_nlp.pattern_problem import FoldedLattice, FoldedTube

MOST_LINES = 30
"""States of which the report has a line; the others are in its details."""
SIZE, DPI = 301, 72
"""Cells along each coordinate, and dots an inch, of a picture in HTML: to keep notebooks small."""


@dataclass(frozen=True, repr=False)
class MinimaResult(Report, Viewable):
    """Minima of a vertex or of a pattern in order of energy, and the record of the search for them.

    Attributes
    ----------
    origami
        What is folded: a scene, which is one vertex with its springs, or a pattern.
    minima
        In order of energy.
    search
        What the search did, why it stopped, and what it found that is no minimum or not decided.
    completeness
        Whether the list is complete, as far as that was proved; None where it was not tried.
    relations
        What was decided on special relations of a scene's sector angles; None of a pattern.
    curves
        Of a pattern, those with one degree of freedom that were traced; none of a result that was read from a file.
    model
        The nonlinear program that its states are states of: posed anew where it is not given.

    Notes
    -----
    `to_frame` has a row a minimum: the fields of `StateRow`, with their units, and phi_1_rad .. phi_N_rad.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> [len(m.fold_angles) for m in result.minima]
    [6, 6]
    >>> found = o.find_minima("metasheet:2x3", starts=4)
    >>> type(found) is type(result), len(found.minima[0].fold_angles)
    (True, 7)
    """

    origami: Scene | Pattern
    minima: tuple[JudgedState, ...]
    search: SearchReport
    completeness: Completeness | None = None
    relations: Relations | None = None
    curves: tuple[Any, ...] = field(default=(), compare=False, metadata={"plain": False})
    model: Any = field(default=None, compare=False, metadata={"plain": False})

    PICTURE, SCHEMA = "draw_minima", "origami-nlp/minima/6"
    ALSO = ("model", "flags", "lattices")

    def __post_init__(self) -> None:
        stated: Any = self.origami
        if self.relations is not None and self.relations != stated.relations:
            stated = replace(stated, relations=self.relations)
            object.__setattr__(self, "origami", stated)
        object.__setattr__(self, "relations", stated.relations)
        if self.model is None:
            object.__setattr__(self, "model", pattern_problem.pose(stated))

    # ------------------------------------------------------------ what is folded

    @property
    def scene(self) -> Scene:
        """The vertex with its springs; `OptionError` of a pattern."""
        if isinstance(self.origami, Scene):
            return self.origami
        raise OptionError("result = minima of a pattern: use those of a scene, which is one vertex")

    @property
    def pattern(self) -> Pattern:
        """The pattern; `OptionError` of a vertex."""
        if isinstance(self.origami, Pattern):
            return self.origami
        raise OptionError("result = minima of a scene: use those of a pattern")

    @property
    def name(self) -> str:
        """Of what is folded: the label of a scene, the name of a pattern."""
        return self.origami.label

    @property
    def title(self) -> str:
        """What was typed, else its name, else its sector angles."""
        return self.origami.title

    # ------------------------------------------------------------ states

    @property
    def undecided(self) -> tuple[JudgedState, ...]:
        """States that are stationary up to rounding, without a certificate."""
        return self.search.undecided

    @property
    def rejected(self) -> tuple[JudgedState, ...]:
        """States that are no minima."""
        return self.search.rejected

    @property
    def states(self) -> tuple[JudgedState, ...]:
        """All that was judged and kept, by energy."""
        every = (*self.minima, *self.undecided, *self.rejected)
        return tuple(sorted(every, key=lambda s: rank(s.energy / self.model.scale, ())))

    def state_of(self, minimum: JudgedState) -> State:
        """Return a state as one of `model`.

        Parameters
        ----------
        minimum
            One of `minima`, or of `states` of a pattern.

        Returns
        -------
        State
            With its contacts, multipliers and curvature.
        """
        return State(self.model, self.model.reduce(np.array(minimum.fold_angles)))

    @cached_property
    def lattices(self) -> tuple[FoldedLattice | FoldedTube, ...]:
        """Of a cell that repeats its folded lattice, or tube, in each minimum, and how it gives way; else nothing."""
        if self.origami.cell is None:
            return ()
        lattice = pattern_problem.measured_cell(self.origami.paper)
        return tuple(lattice.at(self.state_of(m)) for m in self.minima)

    @property
    def flags(self) -> ResultFlags:
        """What is bad about the list, or to be known before it is used: each flag with cause and cure."""
        search, known = self.search, self.completeness
        one = self.origami
        proved = known.status if known else ""
        settled = proved in ("proved", "proved-except-singular")
        return ResultFlags(
            nothing_found=not self.minima,
            may_miss_minima=not settled,
            singular_states_open=proved == "proved-except-singular",
            search_stopped_early=not settled and search.stopped_by in ("cap", "time"),
            starts_ended_nowhere=not settled and search.stalled > len(self.minima),
            reached_once=not settled and search.seen_once > 0,
            still_finding=not settled and search.drawn > 0 and search.quiet == 0,
            proof_added_minima=bool(known and known.added),
            undecided_states=bool(search.undecided),
            solver_failed=any(
                m.solver and m.solver.status != "Solve_Succeeded" for m in self.minima
            ),
            residual_above_tolerance=any(m.flags.residual_above_tolerance for m in self.minima),
            geometry_moved=bool(one.relations and one.relations.made_exact),
            made_symmetric=one.adjusted > 0,
            facets_may_cross=search.contact != "full",
            panels_simplified=bool(one.panels),
            copies_curl=bool(one.cell and one.cell.rolled == (0, 0)),
            stability_not_asked=any(verdict(self.origami, m) == NOT_ASKED for m in self.minima),
        )

    # ------------------------------------------------------------ written

    def to_fold(self) -> dict[str, Any]:
        """Return the states as FOLD data (spec 1.1), a folded frame each.

        Returns
        -------
        dict
            For `json.dump`; of a vertex, states that are unstable in the full space with their descents.
        """
        return minima_to_fold(self.origami, self.minima)

    def coordinates(self, number: int) -> np.ndarray:
        """Return where the corners of the origami are in a minimum.

        Parameters
        ----------
        number
            Of the minimum, from 1 as in the table.

        Returns
        -------
        ndarray
            Coordinates [V, 3]: of a pattern in its unit, corner after corner; of a vertex itself, then the ends of its
            creases, of length 1.

        Raises
        ------
        OptionError
            If there is no such minimum.

        Examples
        --------
        >>> import origami_nlp as o
        >>> found = o.find_minima(o.examples.miura("pi/3"), prove=False)
        >>> found.coordinates(1).shape
        (5, 3)
        """
        return self.to_mesh(number)[0]

    def to_mesh(self, number: int) -> tuple[np.ndarray, MeshFaces]:
        """Return a minimum as a mesh of its facets.

        Parameters
        ----------
        number
            Of the minimum, from 1 as in the table.

        Returns
        -------
        tuple
            Coordinates of the corners [V, 3], as `coordinates` has them, and the corners of each facet, from 0.

        Raises
        ------
        OptionError
            If there is no such minimum.

        Examples
        --------
        >>> import origami_nlp as o
        >>> vertices, faces = o.find_minima("miura:2x2", starts=1).to_mesh(1)
        >>> vertices.shape, faces[0]
        ((9, 3), (0, 1, 2, 3))
        """
        number = check_whole("number", number, 1, len(self.minima))
        return state_mesh(self.origami, self.minima[number - 1].phi)

    def mesh_parts(self) -> list[Part]:
        """Return the states side by side as triangles.

        Returns
        -------
        list of tuple
            Points [v, 3] and triangles [f, 3] of each.
        """
        return state_parts(self.origami, [m.phi for m in self.minima])

    # ------------------------------------------------------------ printed

    @property
    def verdict(self) -> str:
        """How many states are stable, under which assumptions, and whether the list is complete."""
        words = verdict_words(self.origami, self.minima, self.completeness, self.search)
        return f"{self.title}: {words}"

    @property
    def stable(self) -> tuple[JudgedState, ...]:
        """The stable states: minima that no broken symmetry leaves, and that are not shallow; in order of energy.

        Where facets may cross (contact "fold-limits" or "none") only those are that were judged with full contact.

        Examples
        --------
        >>> import origami_nlp as o
        >>> found = o.find_minima(o.examples.degree6("pi/3", ratio=1), prove=False)
        >>> len(found.minima), len(found.stable)
        (4, 3)
        """
        return tuple(m for m, row in zip(self.minima, self.rows, strict=True) if row.stable)

    @cached_property
    def rows(self) -> tuple[StateRow, ...]:
        """The minima as tables, frames and captions of pictures have them."""
        images = find_images(self.origami, self.model, self.minima)
        return state_rows(self.origami, self.name, self.minima, images)

    def table(self) -> Table:
        """Return one row a minimum: energy, stability, what holds it, softest mode, escape barrier."""
        return listed_table(self.rows, self.verdict)

    def report_sections(self) -> Iterator[Section]:
        """Return how many states are stable, a line each, fold angles, what is not proved, and then the details."""
        table, proof = self.table(), self.completeness
        rest = table.rows[MOST_LINES:]
        yield replace(table, rows=table.rows[:MOST_LINES]) if self.minima else self.verdict
        if rest:
            yield f"... {len(rest)} more states: --verbose, or -o FILE.json"
        if self.lattices:
            yield lattice_table(self.lattices[:MOST_LINES])
        shown = [row.number for row in self.rows if not row.image]
        yield from angle_lines(self.minima, shown[:MOST_LINES])
        yield from self.origami.load_lines
        yield from proof.open_lines() if proof else ()
        yield from () if proof and proof.proved else self.search.open_lines()
        more = replace(table, rows=rest, title="further states") if rest else None
        yield Details(tuple(self._details(more, shown[:MOST_LINES])))

    def _details(self, more: Table | None, shown: Sequence[int]) -> Iterator[Table | str]:
        """Return certificates, residuals, flags, the proof, the record of the search, and what is modelled."""
        if more:
            yield more
        numbers = range(1, len(self.minima) + 1)
        yield from angle_lines(self.minima, [k for k in numbers if k not in shown])
        if self.minima:
            yield record_table(self.rows, "", CERTIFIED, narrow=True)
        for k, m in enumerate(self.minima, start=1):
            yield "\n   ".join([f"#{k}", *state_lines(m)])
        yield self.flags.table()
        if self.completeness:
            yield from self.completeness.report_sections()
        crossing = [s for s in self.rejected if s.verdict == "not admissible"]
        if others := (*self.undecided, *self.search.refused, *crossing):
            yield record_table(others[:MOST_LINES], "states that are not listed")
        yield field_table(self.search, "search")
        open_ = self.model.equation_count - self.model.size
        stress = sorted({open_ + s.dof for s in self.minima})
        yield f"states of self-stress: {' or '.join(map(str, stress)) or '-'}"
        yield "modelled: rigid facets without thickness, springs at creases; on paths to a state facets may cross"

    def _rows(self) -> Iterator[dict[str, object]]:
        for row, m in zip(self.rows, self.minima, strict=True):
            yield record_row(row) | angle_columns(m.fold_angles)

    def to_html(self, *, picture: bool = True) -> str:
        """Return a piece of HTML, static and without links: the report, and a picture.

        Parameters
        ----------
        picture
            With that of `draw_minima`.

        Returns
        -------
        str
            The piece.
        """
        reported = pieces_html(self.report_sections())
        if not picture or not self.minima:
            return reported
        figure = self._from_room(self.PICTURE)(self, size=SIZE)  # pictures are slow to import
        data = base64.b64encode(figure_bytes(figure, "png", DPI)).decode("ascii")
        text = "The states, each drawn folded, and the energy landscape where there is one"
        look = f"width='{figure.get_figwidth() * DPI:.0f}' style='max-width:100%;height:auto'"
        return f"{reported}\n<img alt='{text}' {look} src='data:image/png;base64,{data}'>"

    def _repr_html_(self) -> str:
        return self.to_html()

    def view_content(self) -> Content:
        """Return states, descents and traced curves as plain data, see `view`."""
        content: Content = self._from_room("view_minima")(self)  # bodies are slow to import
        return content


def check_result(result: Any, stated: Scene | Pattern) -> None:
    """Raise an error unless `result` is what a search for the minima of an origami returned.

    Parameters
    ----------
    result
        Of `find_minima`.
    stated
        The origami: the same shape, springs, loads, fold limits and contact.

    Raises
    ------
    OptionError
        If it is something else, or that of another origami.
    """
    check_type("result", result, MinimaResult)
    one, other = pattern_problem.pose(stated), result.model
    same = same_laws(one.pattern.laws, other.pattern.laws) and all(
        a.shape == b.shape and np.allclose(a, b, rtol=INPUT_TOL, atol=INPUT_TOL)
        for a, b in zip(_folded(one), _folded(other), strict=True)
    )
    if not same:
        raise OptionError(
            f"result = minima of another origami, {result.title}: use those of {stated.title}"
        )


def _folded(problem: Any) -> list[np.ndarray]:
    """Return the shape of what is folded, its springs, loads and limits."""
    corners, springs, limits = problem.pattern.corners, problem.springs, problem.fold_limits
    zero, scale = np.zeros(problem.size), problem.scale
    parts = (scale * springs.stiffness, springs.rest, scale * springs.load, limits.low, limits.high)
    asked = np.array([problem.contact, problem.has_limits], dtype=float)
    return [corners - corners.mean(axis=0), asked, *(zero + part for part in parts)]
