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
from origami_nlp.minima.completeness import Completeness
from origami_nlp.minima.flags import ResultFlags
from origami_nlp.minima.minimum import JudgedState, SearchReport
from origami_nlp.minima.stability import NOT_ASKED, verdict
from origami_nlp.minima.telling import (
    flag_lines,
    scene_lines,
    search_lines,
    state_lines,
    states_table,
    undecided_lines,
)
from origami_nlp.pattern import Relations, Scene, scene_from_dict, scene_to_dict
from origami_nlp.programme import Model
from origami_nlp.show import Content, Piece, Table, Told, Turnable, Words

if TYPE_CHECKING:
    from origami_nlp.chart import Landscape

SUCCESS = "Solve_Succeeded"
"""What IPOPT says where it converged."""


@dataclass(frozen=True, repr=False)
class MinimaResult(Told, Turnable):
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

    Notes
    -----
    `to_frame` has a row a minimum: scene, number (from 1), energy [the scene's units], kind, dimension, closure, kkt
    (residuals), hits, stable (None where the full space was not asked), softest (stiffness), barrier (energy),
    barrier_method, shallow, phi_1 .. phi_N [rad].

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

    PICTURE, SCHEMA = "draw_minima", "origami_nlp/minima/1"

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

    def table(self) -> Table:
        """Return one row a minimum."""
        return states_table(self.scene, self.minima, self.model.freedom)

    def told(self) -> Iterator[Piece]:
        """Return the table, the states and the record of the search."""
        yield self.table()
        yield from state_lines(self.scene, self.minima)
        yield from undecided_lines(self.search)
        yield from scene_lines(self.scene)
        yield from flag_lines(self.flags)
        if self.completeness:
            yield from (Words(line) for line in self.completeness.lines())
        yield from (Words(line, "dim") for line in search_lines(self.search))

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

    def _rows(self) -> Iterator[dict[str, object]]:
        for number, m in enumerate(self.minima, start=1):
            row = {"scene": self.scene.label, "number": number}
            row |= {"energy": m.energy, "kind": m.kind, "dimension": m.local_dimension}
            row |= {"closure": m.closure_residual, "kkt": m.kkt_residual, "hits": m.hits}
            row["stable"] = m.full_space and m.full_space.verdict
            row |= {"softest": m.softest, "barrier": m.escape and m.escape.barrier}
            row |= {"barrier_method": m.escape and m.escape.method, "shallow": m.shallow}
            yield row | {f"phi_{k}": v for k, v in enumerate(m.fold_angles, start=1)}

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
