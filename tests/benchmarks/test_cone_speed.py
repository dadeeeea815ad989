"""Speed of counting the minima of cones: measured with its errors."""

import pytest

from benchmarks import as_markdown, measure
from benchmarks.cone_speed import scan_branches
from origami_nlp.paper.cone import count


@pytest.mark.slow
def test_speed_is_measured_with_errors():
    rows = measure([6, 30], points=3, maps=(6,))
    assert [r.degree for r in rows] == [6, 30]
    assert rows[0].exact_error < 1e-10 and rows[1].exact_error < 1e-10
    assert rows[0].brute_seconds > 0 and rows[0].map_seconds > 0 and rows[1].brute_seconds is None
    assert "| 65,536 |" in as_markdown(rows)
    # with many nodes the scan finds what the exact count finds
    found = count(8, 0.3, -0.5)
    at_end = found.stable_contact + found.falling_at_cut
    assert scan_branches(8, 0.3, -0.5, 4000) == (found.stable_interior, at_end)
