"""Contact reports with stops and hinge laws: linear laws are springs, stops are no layers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.pattern import double_well, linear


def test_a_margin_at_a_stop_is_where_the_state_leaves_it():
    """A load as large as the margin, and as preload beside laws: the stop carries before, and not beyond."""
    scene = Scene(
        Vertex.from_degrees((70, 80, 120, 90)), (1.0, 0.5, 2.0, 1.0), (2.0, -1.0, 1.5, 0.5), "none",
        limits=(-1.0, 1.0), laws=(double_well(0.5, 2.0), None, linear(2.0, 1.5), None),
    )  # fmt: skip
    found = o.find_minima(scene, escape=False)
    assert "stop 3: " in str(found) and "fold limit" not in str(found)
    report = o.find_contacts(found)
    words = str(report) + report.report(verbose=True)
    assert "(stop)" in words and "folded flat" not in words
    state = next(s for s in report.states if s.margin.norm > 0)
    tight = min(
        (
            (abs(v), i, v)
            for m in state.margin.creases
            for i in m.creases
            for v in (m.positive, -m.negative)
        ),
        key=lambda row: row[0],
    )
    _, crease, torque = tight
    at = np.abs(np.array(state.minimum.fold_angles)).max()
    assert at == pytest.approx(1.0)
    for share in (0.98, 1.02):
        preload = [0.0] * 4
        preload[crease - 1] = share * torque
        loaded = o.find_minima(replace(scene, preload=tuple(preload)), escape=False)
        apart = [
            np.abs(np.array(m.fold_angles) - state.minimum.fold_angles).max() for m in loaded.minima
        ]
        assert (min(apart) < 1e-6) == (share < 1)
