"""Tables of phase diagrams and full-space verdicts of cones."""

from __future__ import annotations

import re
from collections import Counter

import numpy as np
from rich.console import Console
from rich.text import Text

from origami_nlp.cone.branches import direction_name
from origami_nlp.cone.flaps import write_flaps
from origami_nlp.cone.full_space import BranchVerdict, ConeFullSpace
from origami_nlp.cone.phase import PhaseDiagram
from origami_nlp.show import folding_table

FULL_HEADS = ("flaps", "copies", "kind", "|v|", "depth", "slope", "verdict", "why")


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
