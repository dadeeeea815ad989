"""The minima that a grid reports, as a table."""

from __future__ import annotations

from collections.abc import Sequence

from rich.table import Table
from rich.text import Text

from studies.grid_minima import GridMinimum


def grid_minima_table(
    points: Sequence[GridMinimum], size: int, coordinates: Sequence[str]
) -> Table:
    """Return a row a grid minimum: where it is, and the exact minimum that it flows to.

    size: points of the grid along each coordinate.  coordinates: names of the two, as the chart states them.
    """
    table = Table(
        title=f"{len(points)} grid minima on {size} x {size} points", title_justify="left"
    )
    x, y = coordinates[0], coordinates[1].split(" (")[0]
    for head in ("branch", x, y, "energy [J]", "excl.", "to", "moves", "loses"):
        table.add_column(Text(head), justify="right", no_wrap=True)
    for g in points:
        table.add_row(
            g.branch.removeprefix("branch ") or "-",
            *(f"{v:.4f}" for v in g.point),
            f"{g.energy:.6g}",
            f"{g.excluded_neighbours}/8",
            f"#{g.minimum}" if g.minimum else g.end,
            f"{g.distance:.3f}",
            f"{g.drop:.1e}",
        )
    return table
