"""Reports on decided claims: JSON, LaTeX snippets and the errata page.

``python -m origami_nlp.symbolic.report docs/validation/errata.md`` regenerates the committed page of errata.
"""

from __future__ import annotations

import json
import re
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from .catalogue import Result, claims, decide_all

SCHEMA = "origami-nlp/paper/1"
PAPER = (
    "Grasinger, Gillman, Buskohl, *Lagrangian approach to origami vertex analysis: Multistability*"
)
VERDICTS = ("proved", "refuted", "convention", "unproved")


def summary(results: Sequence[Result]) -> dict[str, Any]:
    """Counts per verdict, how many are decided, and the seconds spent on claims in total."""
    counts: Counter[str] = Counter(r.verdict.verdict for r in results)
    return {
        "total": len(results),
        **{name: counts.get(name, 0) for name in VERDICTS},
        "decided": sum(r.verdict.decided for r in results),
        "seconds": round(sum(r.verdict.seconds for r in results), 3),
    }


def tally(results: Sequence[Result]) -> dict[str, int]:
    """What the verdicts say about the paper, counted from the fields of the claims.

    statements: claims that state what the paper states, of which `true` as printed, `false`, true in
    `another_reading` only, or `undecided`; findings: roots of those that fail (`Claim.finding`).
    derivations: our own; decimals: printed decimals against their fractions.
    """
    paper = [r for r in results if r.claim.origin == "paper"]
    kinds = Counter(r.verdict.verdict for r in paper)
    origins = Counter(r.claim.origin for r in results)
    return {
        "statements": len(paper),
        "true": kinds["proved"],
        "false": kinds["refuted"],
        "another_reading": kinds["convention"],
        "undecided": kinds["unproved"],
        "findings": len({r.claim.finding for r in paper if r.verdict.fails}),
        "derivations": origins["own derivation"],
        "decimals": origins["decimals"],
    }


def tally_text(results: Sequence[Result]) -> str:
    """`tally` in a sentence or two."""
    count = tally(results)
    return (
        f"Statements of the paper: {count['statements']} checked, {count['true']} true as printed, "
        f"{count['false']} false, {count['another_reading']} true only in another reading "
        f"(sense, order, picture, generic choice or tolerance), {count['undecided']} undecided; "
        f"independent causes of what fails: {count['findings']}.  Besides, derivations and rewritings "
        f"of our own: {count['derivations']}; checks of printed decimals: {count['decimals']}."
    )


def as_json(results: Sequence[Result]) -> str:
    """The JSON report, schema ``origami-nlp/paper/1``."""
    rows = [
        {
            "id": r.claim.id,
            "where": r.claim.where,
            "statement_latex": r.claim.statement_latex,
            "verdict": r.verdict.verdict,
            "method": r.verdict.method,
            "evidence": r.verdict.evidence,
            "corrected_latex": r.verdict.corrected_latex,
            "remark": r.verdict.remark,
            "origin": r.claim.origin,
            "finding": r.claim.finding if r.verdict.fails else None,
            "seconds": round(r.verdict.seconds, 3),
        }
        for r in results
    ]
    return (
        json.dumps(
            {"schema": SCHEMA, "claims": rows, "summary": {**summary(results), **tally(results)}},
            indent=1,
        )
        + "\n"
    )


def errata_page(results: Sequence[Result]) -> str:
    """The page ``docs/validation/errata.md``: what is wrong in the paper, corrected, and how it was proved."""
    errata = [r for r in results if r.verdict.fails]
    lines = [
        "# Errata of the source paper",
        "",
        tally_text(results),
        "",
        f"{PAPER}.  Each entry: place and verdict; what is printed; why it fails; what holds instead, proved in one "
        "run. **refuted**: false as printed; **convention**: true in another reading.",
        "",
        "`origami-nlp paper verify --only ID -o FILE.json` repeats one, with all evidence.  Made by "
        "`python -m origami_nlp.symbolic.report FILE`.",
        "",
        *_shared_roots(errata),
    ]
    for i, r in enumerate(errata, start=1):
        v = r.verdict
        lines += [
            f"## {i}. {plain(r.claim.title)}",
            "",
            f"`{r.claim.id}`, {plain(r.claim.where)}: **{v.verdict}**",
            "",
            *_display(r.claim.statement_latex),
            "",
            plain(_reason(v.evidence)),
            "",
        ]
        if v.corrected_latex is not None:
            state = "Corrected:" if v.corrected_proved else "Corrected, NOT proved:"
            lines += [state, "", *_display(v.corrected_latex), ""]
    return "\n".join(lines)


def _reason(evidence: str) -> str:
    """The first sentence of what is wrong, without what holds instead."""
    return re.split(r"(?<=[a-z)\]0-9]\.)\s+(?=[A-Z])", evidence.split("Corrected: ")[0].strip())[0]


def _shared_roots(errata: Sequence[Result]) -> list[str]:
    """Which failures are one finding: a line for each cause that several claims share."""
    groups: dict[str, list[str]] = {}
    for r in errata:
        groups.setdefault(r.claim.finding, []).append(f"`{r.claim.id}`")
    shared = [f"- {root}: {', '.join(ids)}" for root, ids in groups.items() if len(ids) > 1]
    return ["One cause each:", "", *shared, ""] if shared else []


def plain(text: str) -> str:
    """Text that Markdown shows as it is: no emphasis, no HTML, no table columns."""
    for mark in ("*", "<", "|"):
        text = text.replace(mark, "\\" + mark)
    return text


def _display(tex: str) -> list[str]:
    r"""Displayed formula: a fenced block, whose backslashes no Markdown reader touches.

    GitHub refuses ``\operatorname``, so operators are set upright by hand.
    """
    return ["```math", re.sub(r"\\operatorname\{(\w+)\}", r"\\mathrm{\1}\\,", tex), "```"]


def as_latex(results: Sequence[Result]) -> str:
    """Snippets ready to paste (amsmath): the corrected statement, or the printed one if it holds."""
    lines = [f"% origami-nlp paper verify: {len(results)} claims; needs amsmath"]
    for r in results:
        v = r.verdict
        good = r.claim.statement_latex if v.corrected_latex is None else v.corrected_latex
        lines += [
            "",
            f"% {r.claim.id} ({r.claim.where}): {v.verdict}, {v.method}",
            f"% {r.claim.title}",
            r"\begin{equation}",
            f"  {good}",
            r"\end{equation}",
        ]
    return "\n".join(lines) + "\n"


def write_errata(path: Path) -> None:
    """Decide every claim and write the errata page."""
    path.write_text(errata_page(decide_all(claims())), encoding="utf-8")


if __name__ == "__main__":
    write_errata(Path(sys.argv[1]))
