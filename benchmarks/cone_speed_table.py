"""The table of time against degree for cones, as Markdown."""

from __future__ import annotations

from collections.abc import Sequence

from benchmarks.cone_speed import BRUTE_NODES, MAP_SIZE, SAMPLED, SpeedRow
from origami_nlp.display import Table
from origami_nlp.paper.cone import number_words

HEADS = (
    "N",
    "branches",
    "classes",
    "exact count [ms]",
    "largest error of an elevation",
    "brute force [ms]",
    "miscounted points",
    f"map {MAP_SIZE} x {MAP_SIZE} [s]",
)


def cells(row: SpeedRow) -> tuple[str, ...]:
    """Return one row of the table as text."""
    return (
        str(row.degree),
        number_words(1 << (row.degree // 2 + 1)),
        f"{2 * row.classes:,}",
        f"{1e3 * row.exact_seconds:.3g}",
        f"{row.exact_error:.1e}",
        "-" if row.brute_seconds is None else f"{1e3 * row.brute_seconds:.4g}",
        "-" if row.brute_wrong is None else f"{row.brute_wrong} of {row.points}",
        "-" if row.map_seconds is None else f"{row.map_seconds:.3g}",
    )


def as_markdown(rows: Sequence[SpeedRow]) -> str:
    """Return the table with what was measured, in words."""
    lines = [
        "# Cones: time against degree",
        "",
        f"Written by `python -m benchmarks cones`: CPU time of one process, mean over {rows[0].points} "
        "random points (r_k log-uniform in 1e-4 to 1e4, rest elevation uniform in its range), first "
        "call of a degree included.  The error of the exact count is the largest relative error of an "
        f"elevation, against 40 digits, of {SAMPLED} interior minima a point; its numbers of "
        f"branches are integers.  Brute force folds every branch at {BRUTE_NODES} elevations; its "
        "error is the number of points where it miscounts (minima it steps over near the flat state "
        f"and near the end).  Maps hold {MAP_SIZE * MAP_SIZE:,} points.",
        "",
        Table(HEADS, [cells(row) for row in rows], columns="r" * len(HEADS)).markdown().rstrip(),
    ]
    return "\n".join(lines) + "\n"
