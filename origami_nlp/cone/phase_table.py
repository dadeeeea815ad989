"""Tables of phase diagrams, printed numbers, full-space verdicts and limits of cones."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence

import numpy as np
from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from origami_nlp.cone.branches import direction_name
from origami_nlp.cone.flaps import write_flaps
from origami_nlp.cone.full_space import BranchVerdict, ConeFullSpace
from origami_nlp.cone.phase import PhaseDiagram
from origami_nlp.paper.cone_limits import Limit
from origami_nlp.paper.section5 import READINGS, Finding

FINDING_HEADS = ("printed", "N", "of", "exact", "deep", "deep, interior", "verdict")
SHORT_HEADS = ("printed", "of", "exact", "verdict")
LIMIT_HEADS = ("quantity", "order p", "series", "c", "series")
FULL_HEADS = ("flaps", "copies", "kind", "|v|", "depth", "slope", "verdict", "why")
SHOWN_READINGS = ("exact", "depth", "depth, interior")


def folding_table(
    heads: Sequence[str], rows: Sequence[Sequence[str]], title: str, wrap: Sequence[int] = (0,)
) -> Table:
    """Return a table whose columns `wrap` hold words, which wrap where the terminal is narrow."""
    table = Table(title=Text(title), title_justify="left", box=box.SIMPLE_HEAD, pad_edge=False)
    for k, head in enumerate(heads):
        words = k in wrap
        table.add_column(head, justify="left" if words else "right", no_wrap=not words)
    for row in rows:
        table.add_row(*(Text(cell) for cell in row))
    return table


def print_diagram(diagram: PhaseDiagram, console: Console) -> None:
    """Say which numbers occur and how much of the map each takes, and count the boundaries."""
    numbers, often = np.unique(diagram.minima, return_counts=True)
    total = diagram.map.branches
    rows = [
        [f"{int(n)}/{total}", f"{int(n) / total:.6g}", f"{k / diagram.minima.size:.2%}"]
        for n, k in zip(numbers, often, strict=True)
    ]
    console.print(folding_table(("branch minima", "normalised", "share of the map"), rows, ""))
    kinds = Counter(b.kind for b in diagram.boundaries)
    console.print("boundaries: " + ", ".join(f"{k} {n}" for k, n in kinds.items()))


def finding_row(finding: Finding) -> list[str]:
    """One printed number: what is found in its region under three of the readings, and the verdict.

    Cells: the numbers that occur, smallest to largest, and the share of the printed one.
    """
    s = finding.statement
    names = [r.name for r in READINGS]
    cells = []
    for name in SHOWN_READINGS:
        k = names.index(name)
        low, high, _ = finding.values[k]
        span = f"{low}" if low == high else f"{low} to {high}"
        cells.append("-" if np.isnan(finding.shares[k]) else f"{span} ({finding.shares[k]:.0%})")
    return [s.fraction, str(s.degree), f"{s.where}: {s.kind}", *cells, finding.verdict]


def short_row(finding: Finding) -> list[str]:
    """Cells of `finding_row` that fit a terminal."""
    printed, _, of, exact, _, _, verdict = finding_row(finding)
    return [printed, of, exact, verdict]


def print_full_space(found: ConeFullSpace, console: Console) -> None:
    """Print one row for each arrangement, direction and minimum, and the totals over all branches.

    slope: norm of the energy's gradient along closed states (0 for an equilibrium).
    """
    reasons = list(dict.fromkeys(_reason(s) for s in found.states))
    rows = [
        [
            f"{write_flaps(s.flaps)} {direction_name(s.direction)}",
            str(s.copies),
            s.kind,
            f"{s.elevation:.4f}",
            f"{s.depth:.4g}",
            "singular" if np.isnan(s.residual) else f"{s.residual:.2e}",
            s.verdict,
            f"[{reasons.index(_reason(s)) + 1}]",
        ]
        for s in found.states
    ]
    title = f"cone of degree {found.degree}, r_k = {found.ratio:g}, nu_0 = {found.rest.elevation:g}"
    console.print(folding_table(FULL_HEADS, rows, title))
    for k, reason in enumerate(reasons, start=1):
        console.print(Text(f"[{k}] {reason}"))
    words = [f"{found.count(v)} {v}" for v in ("stable", "unstable", "undecided")]
    console.print(f"of {found.count()} branch minima: " + ", ".join(words))


def _reason(state: BranchVerdict) -> str:
    """Certificate without the number of states of the descent."""
    return re.sub(r"a descent of \d+", "a descent of", state.full_space.certificate)


def limit_row(limit: Limit) -> list[str]:
    """One quantity with observed and expected rate."""
    rate = ["attained", "-", "-", "-"]
    if not limit.exact:
        rate = [
            f"{limit.order:.4f}",
            str(limit.expected_order),
            f"{limit.coefficient:.5f}",
            f"{limit.expected_coefficient:.5f}",
        ]
    return [limit.name, *rate]
