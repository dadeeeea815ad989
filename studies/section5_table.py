"""Tables of the printed numbers of section 5 and of the limits of cones."""

from __future__ import annotations

import numpy as np

from studies.cone_limits import Limit
from studies.section5 import READINGS, Finding

FINDING_HEADS = ("printed", "N", "of", "exact", "deep", "deep, interior", "verdict")


SHORT_HEADS = ("printed", "of", "exact", "verdict")


LIMIT_HEADS = ("quantity", "order p", "series", "c", "series")


SHOWN_READINGS = ("exact", "depth", "depth, interior")


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
