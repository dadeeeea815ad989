"""The printed numbers of section 5: what is counted for them, and which reading they fit."""

import numpy as np
import pytest

from origami_nlp.paper.cone import Cone, count_map
from studies import section5 as printed


@pytest.mark.parametrize("depth, contact", [(0.0, True), (1e-3, False)])
def test_dense_scan_agrees_with_exact_counts(depth, contact):
    """The scan that stands in for printed roots, run on exact ones."""
    reading = printed.Reading("", "", False, depth, contact, "waterbomb", "exact")
    rng = np.random.default_rng(1)
    nu = rng.uniform(*Cone(8).rest_range, 12)
    ratios = 10 ** rng.uniform(-2, 2, 12)
    scanned = printed.scan_counts(8, ratios, nu, reading)
    exact = count_map(8, ratios, nu, depth=depth)
    wanted = (exact.interior + contact * exact.at_end).T
    assert (scanned != wanted).mean() < 0.02  # a scan of 400 points misses minima within its step


@pytest.mark.slow
def test_findings_are_consistent_with_what_was_counted():
    for finding in printed.check_statements(8, degrees=(6, 8)):
        for reading, share, value, holds in zip(
            printed.READINGS, finding.shares, finding.values, finding.holds, strict=True
        ):
            if holds and finding.statement.kind == "somewhere":
                assert share > 0 and value[0] <= finding.statement.count <= value[1], reading
        assert (finding.first is None) == (not any(finding.holds))
