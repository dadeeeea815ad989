"""Barriers as they are found, and how they are printed: tables and lines."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from origami_nlp.arguments import require
from origami_nlp.barriers.passes import Known, Pass, PassKind
from origami_nlp.display import (
    Content,
    Poser,
    Report,
    Section,
    Table,
    Viewable,
    angle_columns,
    record_row,
    record_table,
)
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import SAME_ENERGY
from origami_nlp.pattern_problem import path_frames, state_frame, states_to_fold

MOST_PAIRS = 30
"""Pairs of minima that have a line, those with a pass first; beyond, pairs of which nothing is known have none."""
MOST_STATES = 8
"""Pairs whose bounds are printed below the passes."""


@dataclass(frozen=True)
class Join:
    """Two branches of the merge tree meet.

    Attributes
    ----------
    energy
        Where, in the scene's units.
    pass_kind
        Of the pass, see `Pass`.
    first, second
        Numbers (1-based) of the minima on either side.
    """

    energy: float
    pass_kind: PassKind
    first: tuple[int, ...]
    second: tuple[int, ...]


@dataclass(frozen=True, repr=False)
class Barriers(Report, Viewable):
    """Passes for every pair of minima, and the merge tree.

    Attributes
    ----------
    result
        The minima.
    passes
        The lowest pass of each pair of them.
    merges
        The merge tree: where branches meet, in order of energy.
    left_out
        Parts that the time limit ended: passes that they would have found are missing.
    stopped
        Whether the user (Ctrl-C) ended it, in place of the time.

    Examples
    --------
    >>> import origami_nlp as o
    >>> scene = o.examples.degree6("pi/4", ratio=0.01)
    >>> found = o.find_barriers(scene, o.find_minima(scene, max_starts=16))
    >>> found.matrix().shape, len(found.merges)
    ((2, 2), 1)
    """

    result: MinimaResult
    passes: tuple[Pass, ...]
    merges: tuple[Join, ...]
    left_out: tuple[str, ...] = ()
    stopped: bool = field(default=False, metadata={"plain": False})

    PICTURE, SCHEMA = "draw_barriers", "origami-nlp/landscape/2"

    @property
    def interrupted(self) -> bool:
        """Whether the time limit ended it, or the search for its minima."""
        return bool(self.left_out)

    @property
    def label(self) -> str:
        """Whose minima these are."""
        return self.result.title

    def matrix(self) -> np.ndarray:
        """Return the barrier energies [m, m]: an ultrametric; the diagonal holds the minima's own energies."""
        m = len(self.result.minima)
        out = np.full((m, m), math.inf)
        np.fill_diagonal(out, [s.energy for s in self.result.minima])
        for p in self.passes:
            out[p.from_state - 1, p.to_state - 1] = out[p.to_state - 1, p.from_state - 1] = p.energy
        return out

    def to_networkx(self) -> Any:
        """Return the graph of states and passes (extra ``graph``).

        Returns
        -------
        networkx.Graph
            A node a minimum, by its number (1-based), with ``energy`` [J] and ``kind``; an edge a pass, with its
            ``energy``, ``kind`` and whether that is ``exact`` or a ``bound`` (``known``).

        Raises
        ------
        OptionError
            If networkx is not installed.
        """
        graph = require("networkx", "a graph of states and passes", "graph").Graph(name=self.label)
        for number, m in enumerate(self.result.minima, start=1):
            graph.add_node(number, energy=m.energy, kind=m.kind)
        for p in self.passes:
            if math.isfinite(p.energy):
                more = {"kind": p.pass_kind, "known": p.known.value}
                graph.add_edge(p.from_state, p.to_state, energy=p.energy, **more)
        return graph

    def table(self) -> Table:
        """Return one row for each pair of minima; energies in the scene's units."""
        return record_table(self.passes, self.verdict, narrow=True)

    @property
    def verdict(self) -> str:
        """How much energy it takes to leave the minima, in a sentence."""
        many = len(self.result.minima)
        words = f"{self.label}: {many} minim{'um' if many == 1 else 'a'}"
        known, energies = [], [m.energy for m in self.result.minima]

        def is_above(p: Pass, energy: float) -> bool:
            ends = (energies[k - 1] for k in p.pair)
            return p.known is Known.EXACT or max(p.least or -math.inf, *ends) >= energy

        for k, energy in enumerate(energies, start=1):
            mine = [p for p in self.passes if k in p.pair]
            least = min(mine, key=lambda p: p.energy, default=None)
            if least is not None and math.isfinite(least.energy):
                every = least.every or all(
                    is_above(p, least.energy / (1 + SAME_ENERGY)) for p in mine
                )
                sure = least.known is Known.EXACT and every
                known.append((least.energy - energy, "" if sure else "at most ", k))
        known.sort()
        if not known:
            return f"{words}, no pass between minima is known"
        origami = self.result.origami
        group = f" on paths that keep {origami.group.name}" if origami.is_symmetric else ""
        said = [f"{bound}{rise:.4g} J to leave #{k}" for rise, bound, k in known]
        if len(said) > 4:
            return f"{words}; it takes from {said[0]} to {said[-1]}{group}"
        return f"{words}; it takes {', '.join(said)}{group}"

    def to_fold(self) -> dict[str, Any]:
        """Return FOLD data: the crease pattern, and the states along the path of each pass as frames."""
        origami, frames = self.result.origami, list[dict[str, Any]]()
        for p in (one for one in self.passes if len(one.path)):
            title = "path {} to {}".format(*p.pair)
            frames += path_frames(partial(state_frame, origami), p.path, p.path_energy, title)
        return states_to_fold(origami, frames)

    def report_sections(self) -> Iterator[Section]:
        """Return the table of passes, and what bounds each."""
        many = len(self.passes) > MOST_PAIRS
        some = [p for p in self.passes if math.isfinite(p.energy) or p.least or not many]
        some.sort(key=lambda p: many and not math.isfinite(p.energy))
        yield (record_table(some[:MOST_PAIRS], self.verdict, narrow=True) if some else self.verdict)
        if left := len(some[MOST_PAIRS:]):
            yield f"... {left:,} more pairs: -o FILE.json"
        for why in dict.fromkeys(p.why for p in self.passes):
            pairs = [p.name for p in self.passes if p.why == why]
            more = f" and {len(pairs) - MOST_STATES} more" if len(pairs) > MOST_STATES else ""
            yield f"{', '.join(pairs[:MOST_STATES])}{more}: {why}"
        if self.left_out:
            ended = "interrupted" if self.stopped else OUT_OF_TIME
            yield f"{ended}, not through with: {', '.join(self.left_out)}"

    def _rows(self) -> Iterator[dict[str, object]]:
        for p in self.passes:
            row = {"scene": self.label} | record_row(p) | {"known": p.known.value}
            yield row | angle_columns(p.fold_angles)

    def view_content(self) -> Content:
        """Return states and the paths over the passes, the lowest pass first, as plain data, see `view`."""
        content, poser, tracks = self.result.view_content(), Poser(self.result.origami), []
        joined = [p for p in self.passes if math.isfinite(p.energy) and len(p.path) > 1]
        for p in sorted(joined, key=lambda p: p.energy):
            start, end = (k - 1 for k in p.pair)
            title = f"{start + 1} → {end + 1} over the pass at {p.energy:.6g} J ({p.pass_kind})"
            tracks.append(poser.track(title, p.path, p.path_energy, start=start))
        pieces = (*self.report_sections(), *content.pieces)
        return replace(content, tracks=(*content.tracks, *tracks), pieces=pieces)
