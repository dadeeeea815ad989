"""A landscape in words: its minima with their places and verdicts, and its boundary."""

from __future__ import annotations

from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.landscape.exact import ExactLandscape


def print_landscape(exact: ExactLandscape, console: Console) -> None:
    """Print the minima of a landscape, how many stay minima in the full space, and its contact boundaries."""
    names = [name.split(" (")[0] for name in exact.chart.coordinates]
    table = Table(title=exact.result.scene.label, title_justify="left")
    for head in ("#", "energy [J]", *names, "kind", "full space"):
        left = head in ("kind", "full space")
        table.add_column(Text(head), justify="left" if left else "right", no_wrap=True)
    for number, (m, place) in enumerate(zip(exact.result.minima, exact.places, strict=True), 1):
        table.add_row(
            str(number),
            f"{m.energy:.9g}",
            *(f"{v:.6f}" for v in place.point),
            m.kind,
            m.full_space.verdict if m.full_space else "-",
        )
    console.print(table)
    text = " -> ".join("?" if n is None else str(n) for n in exact.counts)
    console.print(f"N_sym -> N_not-ruled-out -> N_full: {text}", highlight=False)
    if exact.boundary is None:
        console.print("boundary not traced: contact is not 'full'")
        return
    lines = exact.boundary.lines
    handles, missed = sum(line.thin for line in lines), sum(map(len, exact.boundary.missed))
    console.print(
        f"{len(lines)} contact boundaries, {sum(line.length for line in lines):.2f} rad; "
        f"{handles} of them 1-handles; boundary points of the grid on no line: {missed}",
        highlight=False,
    )
    for part in exact.metastable:
        where = "on one chart point, " if part.hidden else ""
        console.print(
            f"metastable: {part.length:.2f} rad, {where}{'; '.join(part.contacts)}", highlight=False
        )
