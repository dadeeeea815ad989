"""What minima of a vertex and of a pattern have in common as a result: lists, table, lines, rows."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from origami_nlp.minima.account import SearchReport
from origami_nlp.minima.fold_out import Part
from origami_nlp.minima.minimum import JudgedState
from origami_nlp.minima.stability import (
    asked,
    isolated_foldings,
    number_words,
    softest_words,
    stiffness_words,
)
from origami_nlp.minima.telling import (
    KIND_STYLE,
    MOST_ANGLES,
    VERDICT_STYLE,
    freedom_words,
    full_space_lines,
    moment_words,
)
from origami_nlp.numerics import rank
from origami_nlp.show import Cell, Table, Told, Turnable, Words


class FoundMinima(Told, Turnable):
    """Minima of a vertex or of a pattern in order of energy, and the record of the search for them.

    Attributes
    ----------
    minima
        In order of energy.
    search
        What the search did, why it stopped, and what it found that is no minimum or not decided.
    model
        The nonlinear programme that they are states of.

    Notes
    -----
    `to_frame` has a row a minimum: scene (its name), number (from 1), energy [the scene's units], kind, dimension,
    closure, kkt (residuals), hits, stable (None where the full space was not asked), softest (stiffness), barrier
    (energy), barrier_method, shallow, phi_1 .. phi_N [rad].
    """

    minima: tuple[JudgedState, ...]
    search: SearchReport
    _LAST: tuple[str, ...] = ()
    _COLUMNS = ""

    if TYPE_CHECKING:

        @property
        def model(self) -> Any: ...  # noqa: D102

    @property
    def name(self) -> str:
        """What is folded."""
        raise NotImplementedError

    @property
    def headline(self) -> str:
        """What is folded, and how many minima there are."""
        raise NotImplementedError

    @property
    def barrier_head(self) -> str:
        """Name of the column of barriers."""
        return "barrier"

    def _verdict_of(self, minimum: JudgedState) -> str:
        """Return what is known of a minimum in the full space; empty where there is nothing else to ask."""
        return ""

    def _freedoms_at(self, minimum: JudgedState) -> int:
        """Return the dimension of closed states beside a minimum."""
        return minimum.freedoms

    def _last_cells(self, minimum: JudgedState) -> list[str]:
        """Return the cells of a minimum below the heads `_LAST`."""
        raise NotImplementedError

    @property
    def undecided(self) -> tuple[JudgedState, ...]:
        """States that are stationary as far as could be told, without a certificate."""
        return self.search.undecided

    @property
    def rejected(self) -> tuple[JudgedState, ...]:
        """States that are no minima."""
        return self.search.rejected

    @property
    def crossing(self) -> tuple[JudgedState, ...]:
        """States that are not admissible, such as those in which facets pass through each other: no states of paper."""
        return tuple(s for s in self.rejected if s.verdict == "not admissible")

    @property
    def states(self) -> tuple[JudgedState, ...]:
        """All that was judged and kept, by energy."""
        every = (*self.minima, *self.undecided, *self.rejected)
        return tuple(sorted(every, key=lambda s: rank(s.energy / self.model.scale, ())))

    def to_fold(self) -> dict[str, Any]:
        """Return the states as FOLD data (spec 1.1), a folded frame each.

        Returns
        -------
        dict
            For `json.dump`.
        """
        raise NotImplementedError

    def mesh_parts(self) -> list[Part]:
        """Return the states side by side as triangles.

        Returns
        -------
        list of tuple
            Points [v, 3] and triangles [f, 3] of each.
        """
        raise NotImplementedError

    def table(self) -> Table:
        """Return one row a minimum."""
        return states_table(self)

    def _rows(self) -> Iterator[dict[str, object]]:
        for number, m in enumerate(self.minima, start=1):
            row: dict[str, object] = {"scene": self.name, "number": number}
            row |= {"energy": m.energy, "kind": m.kind, "dimension": m.local_dimension}
            row |= {"closure": m.closure_residual, "kkt": m.kkt_residual, "hits": m.hits}
            row["stable"] = m.full_space and m.full_space.verdict
            row |= {"softest": m.softest, "barrier": m.escape and m.escape.barrier}
            row |= {"barrier_method": m.escape and m.escape.method, "shallow": m.shallow}
            yield row | {f"phi_{k}": v for k, v in enumerate(m.fold_angles, start=1)}


def states_table(found: FoundMinima) -> Table:
    """Return one row a minimum: energy, kind, verdict where it was asked for, local dimension, and how it is held."""
    minima, grouped = found.minima, isolated_foldings(found.minima)
    full, noise = asked(minima), any(m.survival is not None for m in minima)
    heads = ["#", "energy [J]", "kind", "dimension", "softest", found.barrier_head, *found._LAST]
    rows = []
    for number, m in enumerate(minima, start=1):
        if number in grouped:
            continue
        known = found._verdict_of(m)
        row: list[Cell] = [
            str(number),
            f"{m.energy:.9g}",
            Words(m.kind, KIND_STYLE[m.kind]),
            *[Words(known, VERDICT_STYLE.get(known, ""))] * full,
            freedom_words(m.local_dimension, found._freedoms_at(m)),
            softest_words(m.softest),
            m.escape.words() if m.escape else "-",
            *found._last_cells(m),
        ]
        rows.append([*row, *[str(m.survival)] * noise])
    if grouped:
        some = [minima[k - 1] for k in grouped]
        energies = f"{some[0].energy:.4g} to {some[-1].energy:.4g}"
        row = [f"({len(some)})", energies, "flat foldings", *[""] * full]
        row += ["0 isolated", "held", "isolated", *[""] * (len(found._LAST) - 1)]
        row.append(str(sum(m.hits for m in some)) if "hits" in found._LAST else "")
        kept = max((m.survival.kept for m in some if m.survival), default=0)
        rows.append([*row, *[f"{kept} at most"] * noise])
    columns = "rrllrr" + found._COLUMNS
    if (
        full
    ):  # softness stands below the table, residuals in JSON and on the page: it keeps to 80 columns
        heads.insert(3, "full space")
        rows = [row[:5] + row[6:7] + row[9:] for row in rows]
        heads, columns = heads[:5] + heads[6:7] + heads[9:], "rrlllrr"
    if noise:
        heads, columns = [*heads, "survives"], columns + "r"
    return Table(heads, rows, found.headline, columns, framed=not full, narrow=full)


def state_lines(found: FoundMinima) -> list[str]:
    """Return the fold angles, contact moments and certificate of each minimum, a few lines each."""
    lines, minima = [], found.minima
    grouped = isolated_foldings(minima)
    for number, m in enumerate(minima, start=1):
        if number in grouped:
            continue
        if len(m.fold_angles) <= MOST_ANGLES:
            angles = " ".join(f"{a:8.3f}" for a in np.round(np.degrees(m.fold_angles), 3) + 0.0)
            lines.append(
                f"#{number} fold angles of creases 1..{len(m.fold_angles)} [deg]: {angles}"
            )
            told = [m.certificate]
        else:
            lines.append(f"#{number} {m.certificate}")
            told = []
        if m.winding > 1:
            lines.append(
                f"   winds {m.winding} times round the axis of {found.model.scene.group.name}"
            )
        shown = [c for c in m.contacts if len(m.fold_angles) <= MOST_ANGLES or not c.is_limit]
        lines += [f"   contact {c.words()}" for c in shown]
        lines += [f"   {words}" for words in told]
        if m.escape is not None:
            lines.append(f"   {stiffness_words(m)}")
        if m.moment is not None:
            lines.append(f"   {moment_words(m.moment, m.moment_residual, len(m.fold_angles))}")
        if m.solver is not None and not m.solver.agrees:
            lines.append(
                f"   IPOPT, started here, does not stay: {m.solver.status}, {m.solver.moved:.1g} rad away"
            )
        if m.full_space:
            lines += [f"   {words}" for words in full_space_lines(m.full_space)]
    if grouped:
        lines.append(
            f"#{number_words(grouped)}: {len(grouped)} isolated flat foldings, each crease open or shut and no other "
            "admissible state near: contact alone holds them, whatever the springs (all are in the JSON)"
        )
    return lines
