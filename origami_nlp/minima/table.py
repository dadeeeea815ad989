"""Many results in one table: a record a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from origami_nlp.display import Table, record_table, short_label, shown
from origami_nlp.minima.result import SUCCESS, MinimaResult
from origami_nlp.numerics import residual_words


@dataclass(frozen=True)
class SceneRow:
    """One scene, or all of them.

    Attributes
    ----------
    scene
        Its name.
    minima, kinds
        How many it has, and how many of each kind.
    stable, unstable, undecided
        Of them in the full space, where that was asked for.
    starts, failed, kkt
        Of the search; where IPOPT did not converge; the largest residual.
    """

    scene: str = field(metadata=shown("scene"))
    minima: int = field(metadata=shown("symmetric minima"))
    stable: int | None = field(metadata=shown("stable"))
    unstable: int | None = field(metadata=shown("unstable"))
    undecided: int | None = field(metadata=shown("undecided"))
    kinds: str = field(default="", metadata=shown("kinds"))
    starts: int | None = field(default=None, metadata=shown("starts", missing=""))
    failed: int | None = field(default=None, metadata=shown("failed", missing=""))
    kkt: float | None = field(default=None, metadata=shown("KKT", spec=residual_words, missing=""))


def scene_row(r: MinimaResult) -> SceneRow:
    """Return the counts of one scene."""
    kinds = [m.kind.removeprefix("contact-") for m in r.minima]
    known = [m.full_space.verdict for m in r.minima if m.full_space]

    def count(v: str) -> int | None:
        return known.count(v) if len(known) == len(r.minima) else None  # type: ignore[arg-type]

    return SceneRow(
        short_label(r.scene.label or repr(r.scene.vertex)),
        len(kinds),
        count("stable"),
        count("unstable"),
        count("undecided"),
        ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)),
        r.search.starts,
        sum(bool(m.solver and m.solver.status != SUCCESS) for m in r.minima),
        max((m.kkt_residual for m in r.minima if m.kkt_residual >= 0), default=None),
    )


def scenes_table(results: Sequence[MinimaResult], title: str) -> Table:
    """Return one row a scene, and their sums, of what is known of all."""
    rows = [scene_row(r) for r in results]
    counts = zip(*((r.minima, r.stable, r.unstable, r.undecided) for r in rows), strict=True)
    sums = [None if None in some else sum(filter(None, some)) for some in counts]
    return record_table([*rows, SceneRow("total", sums[0] or 0, *sums[1:])], title)  # type: ignore[arg-type]
