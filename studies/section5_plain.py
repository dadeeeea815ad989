"""The printed numbers of section 5 and the limits of cones as JSON."""

from __future__ import annotations

from typing import Any

from origami_nlp.io import pick
from studies.cone_limits import DEGREES, Limit
from studies.section5 import READINGS, Finding


def findings_to_dict(findings: list[Finding]) -> dict[str, Any]:
    """Return the table of printed numbers as plain data."""
    stated = ("degree", "fraction", "where", "claim=kind")
    found = ("shares", "smallest_largest_most_frequent=values", "holds", "verdict")
    return {
        "schema": "origami-nlp/cone-fractions/1",
        "readings": [r.name for r in READINGS],
        "statements": [pick(f.statement, *stated) | pick(f, *found) for f in findings],
    }


def limits_to_dict(found: list[Limit]) -> dict[str, Any]:
    """Return limits for N -> infinity as plain data; an exact quantity has no order."""
    keys = ("name", "claim", "limit", "values", "order", "coefficient")
    expected = ("expected_order", "expected_coefficient")
    return {
        "schema": "origami-nlp/cone-limits/1",
        "degrees": list(DEGREES),
        "quantities": [pick(q, *keys, *expected, claim=q.claim or None) for q in found],
    }
