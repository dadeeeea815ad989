"""Critical points of many scenes in one table: a row a panel."""

from __future__ import annotations

from origami_nlp.critical.result import CriticalPoints
from origami_nlp.display import short_label

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
    same = "-"
    if found.comparison is not None:
        lists = found.comparison
        same = (
            "yes" if lists.agree else f"no: +{len(lists.only_critical)} -{len(lists.only_search)}"
        )
    return (
        short_label(scene.label),
        *(str(sum(p.kind == k for p in essential)) for k in ("minimum", "saddle", "maximum")),
        *(f"{v:+d}" if v else "0" for v in sums),
        str(len(found.points) - len(essential)),
        str(verdict.morse_sum),
        str(verdict.euler_characteristic),
        "yes" if verdict.closes and not found.doubts else "no" if not verdict.closes else "doubt",
        same,
    )
