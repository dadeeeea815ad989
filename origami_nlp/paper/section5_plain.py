"""The printed numbers of section 5 and the limits of cones as JSON."""

from __future__ import annotations

from typing import Any

import numpy as np

from origami_nlp.paper.cone_limits import DEGREES, Limit
from origami_nlp.paper.section5 import READINGS, Finding


def findings_to_dict(findings: list[Finding]) -> dict[str, Any]:
    """Return the table of printed numbers as plain data."""
    return {
        "schema": "origami-nlp/cone-fractions/1",
        "readings": [r.name for r in READINGS],
        "statements": [
            {
                "degree": f.statement.degree,
                "fraction": f.statement.fraction,
                "where": f.statement.where,
                "claim": f.statement.kind,
                "shares": [None if np.isnan(s) else s for s in f.shares],
                "smallest_largest_most_frequent": [list(v) for v in f.values],
                "holds": list(f.holds),
                "verdict": f.verdict,
            }
            for f in findings
        ],
    }


def limits_to_dict(found: list[Limit]) -> dict[str, Any]:
    """Return limits for N -> infinity as plain data."""
    return {
        "schema": "origami-nlp/cone-limits/1",
        "degrees": list(DEGREES),
        "quantities": [
            {
                "name": q.name,
                "claim": q.claim or None,
                "limit": q.limit,
                "values": list(q.values),
                "order": None if q.exact else q.order,
                "coefficient": None if q.exact else q.coefficient,
                "expected_order": q.expected_order,
                "expected_coefficient": q.expected_coefficient,
            }
            for q in found
        ],
    }
