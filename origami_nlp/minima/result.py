"""What a search for minima returns, how it tells itself, and its JSON.

In JSON indices are 1-based, as in the paper; angles in radians; energies and moments in the scene's units.
A multiplier range that never ends, or a residual that does not apply, is null.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from origami_nlp.files import from_plain, pick, to_plain
from origami_nlp.kkt import State
from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.completeness import Completeness
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.fold_out import Part, minima_to_fold, vertex_parts
from origami_nlp.minima.found import FoundMinima, state_lines
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.noise import survival_words
from origami_nlp.minima.stability import (
    NOT_ASKED,
    barrier_head,
    count_words,
    not_asked_words,
    verdict,
)
from origami_nlp.minima.telling import (
    flag_lines,
    scene_lines,
    undecided_lines,
)
from origami_nlp.numerics import residual_words
from origami_nlp.pattern import Relations, Scene, scene_from_dict, scene_to_dict
from origami_nlp.programme import Model
from origami_nlp.show import Content, Piece, Words

if TYPE_CHECKING:
    from origami_nlp.chart import Landscape

SUCCESS = "Solve_Succeeded"
"""What IPOPT says where it converged."""


@dataclass(frozen=True, repr=False)
class MinimaResult(FoundMinima):
    """Minima of a scene in order of energy, and the record of the search for them.

    Attributes
    ----------
    scene
        The scene.
    model
        Its nonlinear programme.
    minima
        In order of energy.
    search
        What the search did, and why it stopped.
    completeness
        Whether the list is complete, as far as that was proved; None where it was not tried.

    Examples
    --------
    >>> import origami_nlp as o
    >>> result = o.find_minima(o.examples.degree6("pi/4", ratio=0.01), max_starts=16)
    >>> result.search.starts, [len(m.fold_angles) for m in result.minima]
    (16, [6, 6])
    """

    scene: Scene
    model: Model
    minima: tuple[JudgedState, ...]
    search: SearchReport
    completeness: Completeness | None = None

    PICTURE, SCHEMA = "draw_minima", "origami-nlp/minima/1"

    @property
    def flags(self) -> ResultFlags:
        """What is bad about the list, or to be known before it is used: each flag with cause and cure."""
        search, known, scene = self.search, self.completeness, self.scene
        proved = known.status if known else ""
        settled = proved == "proved" or search.stopped_by == "complete"
        return ResultFlags(
            nothing_found=not self.minima,
            may_miss_minima=not settled and proved != "proved-except-singular",
            singular_states_open=proved == "proved-except-singular",
            search_stopped_early=not settled and search.stopped_by in ("cap", "time"),
            starts_ended_nowhere=not settled and search.stalled > search.outcomes.get("minimum", 0),
            reached_once=not settled and search.seen_once > 0,
            still_finding=not settled and search.starts > 0 and search.quiet == 0,
            proof_added_minima=bool(known and known.added),
            undecided_states=bool(search.undecided),
            solver_failed=any(status != SUCCESS for status in search.statuses),
            residual_above_tolerance=any(m.flags.residual_above_tolerance for m in self.minima),
            geometry_moved=bool(scene.relations.made_exact),
            made_symmetric=scene.adjusted > 0,
            facets_may_cross=scene.contact != "full",
            stability_not_asked=any(verdict(scene, m) == NOT_ASKED for m in self.minima),
        )

    def state_of(self, minimum: JudgedState) -> State:
        """Return a minimum as a state of its programme.

        Parameters
        ----------
        minimum
            One of `minima`.

        Returns
        -------
        State
            With its contacts, multipliers and curvature.
        """
        model = self.model_of(minimum)
        return State(model, model.reduce(np.array(minimum.fold_angles)))

    def model_of(self, minimum: JudgedState) -> Model:
        """Return the programme that a minimum is a state of: that of its winding.

        Parameters
        ----------
        minimum
            One of `minima`.

        Returns
        -------
        Model
            `model` itself where states wind as often as that says.
        """
        if minimum.winding == self.model.structure.winding:
            return self.model
        return Model(replace(self.scene, winding=minimum.winding))

    _LAST = ("closure", "KKT", "hits")
    _COLUMNS = "rrr"

    @property
    def name(self) -> str:
        """The label of the scene."""
        return self.scene.label

    @property
    def headline(self) -> str:
        """What is folded, how many minima there are, symmetry and contact."""
        scene = self.scene
        return (
            f"{scene.label or scene.vertex!r}\n{count_words(scene, self.minima)}, "
            f"symmetry {scene.group.name}, contact {scene.contact}"
        )

    @property
    def barrier_head(self) -> str:
        """Name of the column of barriers: under an imposed symmetry ways out keep it."""
        return barrier_head(self.scene)

    def _verdict_of(self, minimum: JudgedState) -> str:
        """Return what is known of a minimum in the full space, see `stability.verdict`."""
        return verdict(self.scene, minimum)

    def _freedoms_at(self, minimum: JudgedState) -> int:
        """Return the degrees of freedom of the symmetric states."""
        return self.model.freedom

    def _last_cells(self, minimum: JudgedState) -> list[str]:
        """Return residuals and hits."""
        residuals = minimum.closure_residual, minimum.kkt_residual
        return [*map(residual_words, residuals), str(minimum.hits)]

    def to_fold(self) -> dict[str, Any]:
        """Return the states as FOLD data; those that are unstable in the full space with their descents."""
        return minima_to_fold(self.scene, self.minima)

    def mesh_parts(self) -> list[Part]:
        """Return the states side by side as triangles."""
        return vertex_parts(self.scene, [m.phi for m in self.minima])

    def told(self) -> Iterator[Piece]:
        """Return the table, the states and the record of the search."""
        yield self.table()
        yield from state_lines(self)
        survived = [m.survival.degrees for m in self.minima if m.survival]
        if survived:
            yield survival_words(max(survived), "rest and sector angles")
        yield from filter(None, [not_asked_words(self.scene, self.minima)])
        yield from undecided_lines(self.search)
        yield from scene_lines(self.scene)
        yield from flag_lines(self.flags)
        if self.completeness:
            yield from (Words(line) for line in self.completeness.lines())
        yield from (Words(line, "dim") for line in self.search.words())

    def to_html(self, *, picture: bool = True) -> str:
        """Return a piece of HTML, static and without links.

        Parameters
        ----------
        picture
            With that of `draw_minima`.

        Returns
        -------
        str
            The piece.
        """
        from origami_nlp.minima.html import as_html  # pictures are slow to import

        return as_html(
            self.scene,
            self.minima,
            self.model.freedom,
            self.search,
            self.completeness,
            self.flags,
            picture=picture,
        )

    def turned(self, chart: Landscape | None = None) -> Content:
        """Return states, descents and the map of the energy as plain data, see `view`.

        Parameters
        ----------
        chart
            The energy over the scene's coordinates, if it is known already.

        Returns
        -------
        Content
            What a page shows.
        """
        from origami_nlp.minima.turned import turn_minima  # charts are slow to import

        return turn_minima(self.scene, self.model, self.minima, tuple(self.told()), chart)

    def _to_plain(self) -> dict[str, Any]:
        return {
            "scene": scene_to_dict(self.scene),
            "model": pick(
                self.model,
                "variables=size",
                "equalities=equation_count",
                "inequalities=inequality_count",
                "contact_pairs",
                geometry=self.scene.relations,
                left_out=[pick(item, "what", "why") for item in self.model.left_out],
            ),
            "search": to_plain(self.search),
            "completeness": self.completeness and to_plain(self.completeness),
            "flags": to_plain(self.flags),
            "minima": to_plain(self.minima),
        }

    @classmethod
    def _from_plain(cls, data: dict[str, Any]) -> Self:
        """Rebuild all but the model, which is posed anew from the scene."""
        scene = scene_from_dict(data["scene"])
        if "geometry" in data["model"]:
            scene = replace(
                scene,
                relations=from_plain(Relations, data["model"]["geometry"], at="model.geometry"),
            )
        search = from_plain(SearchReport, data["search"], at="search")
        known = data.get("completeness")
        completeness = from_plain(Completeness, known, at="completeness") if known else None
        minima = from_plain(tuple[JudgedState, ...], data["minima"], at="minima")
        return cls(scene, Model(scene), minima, search, completeness)

    def _repr_html_(self) -> str:
        return self.to_html()
