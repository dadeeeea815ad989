"""Barriers as tables: in the terminal, in Markdown, and as JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from origami_nlp.barriers.find import Barriers

if TYPE_CHECKING:
    from rich.console import Console

HEADS = (
    "from",
    "to",
    "pass [J]",
    "rises by [J]",
    "back by [J]",
    "kind",
    "fold angles at the pass [deg]",
)


def rows(barriers: Barriers) -> list[tuple[str, ...]]:
    """Return one row for each pair of minima; energies in the scene's units."""
    minima = barriers.result.minima
    out: list[tuple[str, ...]] = []
    for p in barriers.passes:
        one, two = (minima[k - 1].energy for k in (p.from_state, p.to_state))
        if math.isinf(p.energy):
            out.append((f"#{p.from_state}", f"#{p.to_state}", "-", "-", "-", "none", p.why))
            continue
        angles = ", ".join(f"{math.degrees(a) + 0.0:.2f}" for a in p.fold_angles)
        if p.pass_kind == "flat state":
            angles = "all 0"
        out.append(
            (
                f"#{p.from_state}",
                f"#{p.to_state}",
                f"{p.energy:.9g}",
                f"{p.energy - one:.6g}",
                f"{p.energy - two:.6g}",
                p.pass_kind,
                angles,
            )
        )
    return out


def full_words(barriers: Barriers) -> list[str]:
    """Return one line for each pair of fully stable minima: what is known without the symmetry."""
    out = []
    for f in barriers.full:
        pair = f"#{f.from_state} - #{f.to_state}"
        if f.verdict == "same":
            what = f"{f.upper:.9g} J as well: no symmetry-breaking path is lower ({f.why})"
        elif f.verdict == "lower":
            what = (
                f"the symmetric pass has index {f.index} there: a lower one exists, between "
                f"{f.lower:.6g} and {f.upper:.6g} J"
            )
        else:
            index = "" if f.index is None else f", the symmetric pass has index {f.index} there"
            what = f"between {f.lower:.6g} J ({f.why}) and {f.upper:.6g} J (explicit path){index}"
        out.append(f"{pair} in the full space: {what}")
    return out


def print_barriers(barriers: Barriers, console: Console) -> None:
    """Print the table of passes and the lines on the full space."""
    from rich.table import Table

    table = Table(title=f"lowest passes of '{barriers.scene.label}'", title_justify="left")
    for k, head in enumerate(HEADS):
        table.add_column(head, justify="right" if k < 5 else "left", no_wrap=k < 6)
    for row in rows(barriers):
        table.add_row(*row)
    console.print(table)
    for p in barriers.passes:
        console.print(f"#{p.from_state} - #{p.to_state}: {p.why}", markup=False, highlight=False)
    for basin in barriers.unlisted:
        if basin.lands_on is None:
            console.print(
                f"a basin {basin.depth:.3g} J deep on the graph descends to no listed minimum",
                highlight=False,
            )
    for line in full_words(barriers):
        console.print(line, markup=False, highlight=False)


def barriers_to_dict(barriers: Barriers) -> dict[str, Any]:
    """Return the JSON document of one scene's barriers."""
    return {
        "schema": "origami-nlp/barriers/1",
        "name": barriers.scene.name,
        "minima": [
            {
                "number": k + 1,
                "energy": m.energy,
                "kind": m.kind,
                "fold_angles": list(m.fold_angles),
            }
            for k, m in enumerate(barriers.result.minima)
        ],
        "barriers": barriers.to_dict(),
        "merges": [
            {
                "energy": j.energy,
                "pass_kind": j.pass_kind,
                "first": list(j.first),
                "second": list(j.second),
            }
            for j in barriers.merges
        ],
        "paths": [
            {
                "from": p.from_state,
                "to": p.to_state,
                "fold_angles": p.path.tolist(),
                "energy": p.path_energy.tolist(),
            }
            for p in barriers.passes
        ],
        "unlisted_basins": [
            {"depth": u.depth, "fold_angles": list(u.fold_angles), "lands_on": u.lands_on}
            for u in barriers.unlisted
        ],
        "full_space": [f.to_dict() for f in barriers.full],
    }


def markdown_rows(barriers: Barriers) -> list[str]:
    """Return Markdown table rows, one a pair: scene, pair, minima, pass, kind, where, full space."""
    name = barriers.scene.label.replace("degree ", "N = ").replace(" alpha_1 =", "")
    name = name.replace(" r_k =", "").replace("*", r"\*")
    full = {(f.from_state, f.to_state): f for f in barriers.full}
    minima = barriers.result.minima
    out = []
    for p, row in zip(barriers.passes, rows(barriers), strict=True):
        one, two = (minima[k - 1].energy for k in (p.from_state, p.to_state))
        f = full.get((p.from_state, p.to_state))
        if f is None:
            said = "an end is unstable there" if barriers.full or _judged(barriers) else "not asked"
        elif f.verdict == "same":
            said = f"same: {f.why}"
        else:
            said = f"{f.verdict}: at most {f.drop:.3g} J lower; {f.why}"
        out.append(
            f"| {name} | {row[0]} - {row[1]} | {one:.6g}, {two:.6g} | {row[2]} | {row[5]} | "
            f"{row[6]} | {said} |"
        )
    return out


def _judged(barriers: Barriers) -> bool:
    return any(m.full_space is not None for m in barriers.result.minima)
