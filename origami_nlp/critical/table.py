"""Critical points as tables: one row a point, one row a panel."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.show import plain_text

if TYPE_CHECKING:
    from origami_nlp.critical.result import CriticalPoint, CriticalPoints

PANEL_HEADS = (
    "scene (N, alpha_1, r_k)",
    "minima",
    "saddles",
    "maxima",
    "interior",
    "boundary",
    "corners",
    "handles",
    "flat state",
    "other singular",
    "not essential",
    "Morse sum",
    "Euler characteristic",
    "closes",
    "same minima as the search",
)
"""Minima, saddles and maxima: numbers of essential points; `interior` to `other singular`: sums of contributions."""


def shown_points(found: CriticalPoints, everything: bool = False) -> list[CriticalPoint]:
    """Return the points that a person wants to see: the essential ones, or all of them."""
    return [p for p in found.points if everything or p.essential or p.kind == "undecided"]


def points_table(found: CriticalPoints, everything: bool = False) -> Table:
    """Return one row a critical point; those that are not essential only on request."""
    shown = shown_points(found, everything)
    hidden = len(found.points) - len(shown)
    title = found.scene.label or repr(found.scene.vertex)
    title += f"\n{len(shown)} critical points"
    title += f" ({hidden} more are not essential)" if hidden else ""
    table = Table(title=Text(title), title_justify="left")
    for head in ("#", "energy [J]", "stratum", "kind", "index", "adds", "residual"):
        left = head in ("stratum", "kind")
        table.add_column(Text(head), justify="left" if left else "right", no_wrap=True)
    for number, p in enumerate(shown, start=1):
        row = (
            str(number),
            f"{p.energy:.9g}",
            p.stratum,
            p.kind,
            "-" if p.index is None else str(p.index),
            f"{p.contribution:+d}" if p.contribution else "0",
            f"{p.residual:.0e}",
        )
        table.add_row(*(Text(cell) for cell in row))
    return table


def point_lines(found: CriticalPoints, everything: bool = False) -> list[str]:
    """Return two lines a point: where it is, and what touches and decides there."""
    rays = found.scene.group.rays
    creases = [ray.crease for ray in rays if ray.crease is not None]
    numbers = ", ".join(str(c + 1) for c in creases)
    lines = [f"fold angles of creases {numbers} [deg], contacts, and what decides:"]
    for number, p in enumerate(shown_points(found, everything), start=1):
        angles = " ".join(f"{math.degrees(p.fold_angles[c]):8.3f}" for c in creases)
        contacts = "; ".join(p.contacts) if p.contacts else "nothing touches"
        lines.append(f"#{number}  {angles.replace('-0.000', ' 0.000')}  {contacts}")
        moments = ", ".join(f"{v:.4g}" for v in p.multipliers)
        lines.append(f"    {p.how}" + (f"; moment {moments} N m" if moments else ""))
    return lines


def as_text(found: CriticalPoints) -> str:
    """Return the table and the Morse sum as plain text."""

    def tell(console: Console) -> None:
        console.print(points_table(found))
        for line in point_lines(found):
            console.print(Text(line))
        console.print(f"Morse sum {found.morse_sum}")
        for doubt in found.doubts:
            console.print(f"doubt: {doubt}")

    return plain_text(160, tell)


def panel_row(found: CriticalPoints, euler_characteristic: int) -> tuple[str, ...]:
    """Return one row of the table over panels; see `PANEL_HEADS`."""
    scene = found.scene
    essential = [p for p in found.points if p.essential]
    flat = [p for p in found.points if not any(p.fold_angles)]
    singular = [p for p in found.points if p.stratum == "singular" and any(p.fold_angles)]
    sums = [
        sum(p.contribution for p in essential if p.stratum == stratum)
        for stratum in ("interior", "boundary", "corner", "handle")
    ]
    sums += [sum(p.contribution for p in group) for group in (flat, singular)]
    verdict = found.verdict(euler_characteristic)
    name = scene.label.replace("degree ", "N = ").replace("alpha_1 = ", "")
    same = "-"
    if found.comparison is not None:
        lists = found.comparison
        same = (
            "yes" if lists.agree else f"no: +{len(lists.only_critical)} -{len(lists.only_search)}"
        )
    return (
        name.replace("r_k = ", ""),
        *(str(sum(p.kind == k for p in essential)) for k in ("minimum", "saddle", "maximum")),
        *(f"{v:+d}" if v else "0" for v in sums),
        str(len(found.points) - len(essential)),
        str(verdict.morse_sum),
        str(verdict.euler_characteristic),
        "yes" if verdict.closes and not found.doubts else "no" if not verdict.closes else "doubt",
        same,
    )
