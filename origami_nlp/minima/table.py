"""Many results in one table: a line a scene."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from origami_nlp.display import Table
from origami_nlp.minima.result import MinimaResult
from origami_nlp.numerics import residual_words

HEADS = (
    *("scene", "symmetric minima", "stable", "unstable", "undecided"),
    *("kinds", "starts", "largest KKT residual"),
)


def scenes_table(results: Sequence[MinimaResult], title: str) -> Table:
    """Return one row a scene, and their sums, of what is known of all."""
    rows, each = list[tuple[str, ...]](), list[list[int | None]]()
    for r in results:
        known = Counter(m.full_space.verdict for m in r.minima if m.full_space)
        kinds = Counter(m.kind.removeprefix("contact-") for m in r.minima)
        asked = known.total() == len(r.minima)
        verdicts = (known[v] if asked else None for v in ("stable", "unstable", "undecided"))
        each.append([len(r.minima), *verdicts])
        label = (r.scene.label or repr(r.scene.vertex)).replace("degree ", "N = ")
        worst = max((m.kkt_residual for m in r.minima if m.kkt_residual >= 0), default=None)
        rows.append(
            (
                label.replace("alpha_1 = ", "").replace("r_k = ", ""),
                *map(_text, each[-1]),
                ", ".join(f"{n} {kind}" for kind, n in kinds.items()),
                str(r.search.starts),
                "" if worst is None else residual_words(worst),
            )
        )
    sums = [None if None in some else sum(filter(None, some)) for some in zip(*each, strict=True)]
    rows.append(("total", *map(_text, sums), "", "", ""))
    return Table(HEADS, rows, title, "LrrrrLrr", framed=False)


def _text(count: int | None) -> str:
    return "-" if count is None else str(count)
