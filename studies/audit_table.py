"""The audit of published states as a terminal table, Markdown and JSON (schema ``origami-nlp/audit/1``)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import compress
from typing import Any

from origami_nlp.display import Table, Words
from origami_nlp.io import pick
from origami_nlp.pattern import scene_to_dict
from studies.audit import CAUSES, PanelAudit

SCHEMA = "origami-nlp/audit/1"
HEADS = ("published", *CAUSES, "exact minima", "represented", "reached", "appendix A strict")
CANDIDATE = (
    "number=candidate.number",
    "fold_angles=candidate.fold_angles",
    "branch=candidate.branch",
    "cause",
    "reason",
    "closure_residual",
    "closes_at",
    "admissible",
    "admissible_signs=sides",
    "stationarity",
    "appendix_a=paper_test",
    "minimum",
    "followed_at",
    "distance",
    "grid_steps",
    "energy_drop=drop",
    "descent_states=steps",
    "twin",
)
"""What is written of a candidate."""
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
    """Return one row a panel: published candidates, what they are, exact minima they belong to.

    Causes that no candidate has are left out.
    """
    lines = _with_totals(panels)
    sums = dict(zip(HEADS, totals(panels), strict=True))
    shown = [head not in CAUSES or sums[head] != "0" for head in HEADS]
    rows = []
    for title, row, total in lines:
        name = title.replace("alpha_1 = ", "").replace("r_k = ", "")
        said = (name, *compress(row, shown))
        rows.append([Words(cell, "bold" if total else "") for cell in said])
    count = sum(len(p.audited) for p in panels)
    ends = [k for k, (_, _, total) in enumerate(lines) if total]
    heads = ("panel", *compress(HEADS, shown))
    return Table(
        heads, rows, f"{count} published candidates", "l" + "R" * (len(heads) - 1), ends=ends
    )


def as_markdown(panels: Sequence[PanelAudit]) -> str:
    """Return the summary as a Markdown table with a legend."""
    table = summary_table(panels)
    lines = [
        *(f"- **{cause}**: {MEANING[cause]}" for cause in CAUSES if cause in table.heads),
        "- **exact minima**: of the panel, found by `origami-nlp minima`; **represented**: by an exact candidate; "
        "**reached**: by a candidate or its descent",
        "- **appendix A strict**: candidates with different fold angles that the paper's own test calls strict minima",
    ]
    return "\n".join([table.markdown(), *lines]) + "\n"


def audit_to_dict(panels: Sequence[PanelAudit]) -> dict[str, Any]:
    """Return the audit as plain JSON data: every candidate with what it is and why."""
    return {
        "schema": SCHEMA,
        "totals": {cause: sum(p.count(cause) for p in panels) for cause in CAUSES},
        "panels": [
            {
                "scene": scene_to_dict(p.result.scene),
                **pick(p, "degree", "alpha", "ratio", "grid_step"),
                "counts": {cause: p.count(cause) for cause in CAUSES},
                "minima": [pick(m, "energy", "fold_angles", "kind") for m in p.result.minima],
                **pick(p, "represented", "reached"),
                "candidates": [pick(a, *CANDIDATE) for a in p.audited],
            }
            for p in panels
        ],
    }
