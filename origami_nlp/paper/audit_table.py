"""The audit of published states as a terminal table, Markdown and JSON (schema ``origami-nlp/audit/1``)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich.table import Table

from origami_nlp.paper.audit import CAUSES, Audited, PanelAudit
from origami_nlp.pattern import scene_to_dict

SCHEMA = "origami-nlp/audit/1"
HEADS = ("published", *CAUSES, "exact minima", "represented", "reached", "appendix A strict")
MEANING = {
    "exact": "nearest candidate, within two grid steps, of an exact minimum",
    "duplicate": "closes, and is the same fold angles, the same sheet with the other sign of +-pi, or the same exact "
    "minimum as another candidate",
    "on a handle": "lies on a one-dimensional set beside which nothing is admissible, and slides along it by more than "
    "two grid steps",
    "grid jag": "flows away by more than two grid steps; the grid hides the way down",
    "chart edge": "flows away, and lies within a grid step of where the chart ends",
    "does not close": "no vertex at the stated sector angle, repeated rows included",
    "wrong side": "a sheet of paper with these facets has the other sign of +-pi, and another energy",
    "not admissible": "facets cross, or no order of the layers exists, whatever the signs of +-pi",
    "isolated": "no symmetric motion leaves it, and it is no listed minimum",
    "undecided": "none of these",
}


def cells(panel: PanelAudit) -> list[str]:
    """Return the numbers of one panel in the order of `HEADS`."""
    # repeated fold angles are tested once: their `paper_test` is empty
    strict = sum(a.paper_test == "strict minimum" for a in panel.audited)
    return [
        str(len(panel.audited)),
        *(str(panel.count(cause)) for cause in CAUSES),
        str(len(panel.result.minima)),
        str(len(panel.represented)),
        str(len(panel.reached)),
        str(strict),
    ]


def totals(panels: Sequence[PanelAudit]) -> list[str]:
    """Return the sums of `cells` over panels."""
    columns = zip(*(cells(p) for p in panels), strict=True)
    return [str(sum(int(c) for c in column)) for column in columns]


def _with_totals(panels: Sequence[PanelAudit]) -> list[tuple[str, list[str], bool]]:
    """Return (title, cells, is a total) of every line of the summary."""
    lines: list[tuple[str, list[str], bool]] = []
    for degree in sorted({p.degree for p in panels}):
        own = [p for p in panels if p.degree == degree]
        lines += [(p.title, cells(p), False) for p in own]
        if len(own) > 1:
            lines.append((f"degree {degree} in all", totals(own), True))
    if len({p.degree for p in panels}) > 1:
        lines.append(("all", totals(panels), True))
    return lines


def summary_table(panels: Sequence[PanelAudit]) -> Table:
    """Return one row a panel: published candidates, what they are, exact minima they belong to."""
    count = sum(len(p.audited) for p in panels)
    table = Table(title=f"{count} published candidates", title_justify="left")
    table.add_column("panel", no_wrap=True)
    for head in HEADS:
        table.add_column(head, justify="right")
    for title, row, total in _with_totals(panels):
        short = title.replace("alpha_1 = ", "").replace("r_k = ", "")
        table.add_row(short, *row, style="bold" if total else None, end_section=total)
    return table


def as_markdown(panels: Sequence[PanelAudit]) -> str:
    """Return the summary as a Markdown table with a legend."""
    lines = ["| panel | " + " | ".join(HEADS) + " |", "|---|" + "---:|" * len(HEADS)]
    for title, row, total in _with_totals(panels):
        mark = "**" if total else ""
        lines.append("| " + " | ".join(f"{mark}{cell}{mark}" for cell in (title, *row)) + " |")
    lines += ["", *(f"- **{cause}**: {MEANING[cause]}" for cause in CAUSES)]
    lines += [
        "- **exact minima**: of the panel, found by `origami-nlp minima`; **represented**: by an exact candidate; "
        "**reached**: by a candidate or its descent",
        "- **appendix A strict**: candidates with different fold angles that the paper's own test calls strict minima",
    ]
    return "\n".join(lines) + "\n"


def audit_to_dict(panels: Sequence[PanelAudit]) -> dict[str, Any]:
    """Return the audit as plain JSON data: every candidate with what it is and why."""
    return {
        "schema": SCHEMA,
        "totals": {cause: sum(p.count(cause) for p in panels) for cause in CAUSES},
        "panels": [
            {
                "scene": scene_to_dict(p.result.scene),
                "degree": p.degree,
                "alpha": p.alpha,
                "ratio": p.ratio,
                "grid_step": p.grid_step,
                "counts": {cause: p.count(cause) for cause in CAUSES},
                "minima": [
                    {"energy": m.energy, "fold_angles": list(m.fold_angles), "kind": m.kind}
                    for m in p.result.minima
                ],
                "represented": list(p.represented),
                "reached": list(p.reached),
                "candidates": [_candidate(a) for a in p.audited],
            }
            for p in panels
        ],
    }


def _candidate(a: Audited) -> dict[str, Any]:
    return {
        "number": a.candidate.number,
        "fold_angles": list(a.candidate.fold_angles),
        "branch": a.candidate.branch,
        "cause": a.cause,
        "reason": a.reason,
        "closure_residual": a.closure_residual,
        "closes_at": list(a.closes_at),
        "admissible": a.admissible,
        "admissible_signs": None if a.sides is None else list(a.sides),
        "stationarity": _finite(a.stationarity),
        "appendix_a": a.paper_test,
        "minimum": a.minimum,
        "followed_at": a.followed_at,
        "distance": _finite(a.distance),
        "grid_steps": _finite(a.grid_steps),
        "energy_drop": _finite(a.drop),
        "descent_states": a.steps,
        "twin": a.twin,
    }


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
