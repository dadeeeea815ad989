"""Stiffness ratios up to 1e8 are solved, in any unit; what double precision cannot order is refused."""

import math

import numpy as np
import pytest

from origami_nlp import OrigamiError, Scene, Vertex, examples, find_minima
from tests.computed_once import panel_result

VERTICES = {
    "flat-foldable": ("pi/3", "2*pi/3", "2*pi/3", "pi/3"),
    "square": ("pi/2",) * 4,
    "no special sectors": (1.2, 1.4, 1.9, 2 * math.pi - 4.5),
}


def scene(sectors, stiffness):
    return Scene(Vertex(sectors), stiffness, (1.0, 0.5, -1.0, 0.5), "none")


@pytest.mark.parametrize(
    ("stiffness", "words"),
    [
        ([1e300, 1e-300, 1, 1], ["stiffness[1] = 1e+300", "1e+08 times stiffness[2]", "merge"]),
        ([1e12, 1, 1, 1], ["stiffness[1] = 1e+12", "1e+08 times stiffness[2]"]),
        ([1, 1, 1.01e-8, 1.02], ["stiffness[4] = 1.02", "stiffness[3] = 1.01e-08"]),
        ([1e301] * 4, ["stiffness[1] = 1e+301"]),
        ([1, 1, 5e-324, 1], ["stiffness[3]"]),
    ],
)
def test_stiffnesses_that_cannot_be_computed_with_are_refused(stiffness, words):
    with pytest.raises(OrigamiError) as raised:
        scene(VERTICES["square"], stiffness)
    assert all(word in str(raised.value) for word in words), raised.value


@pytest.mark.parametrize("factor", [1e-298, 1e298])
def test_any_unit_will_do(factor):
    base = examples.degree6("pi/4", 1)
    scaled = Scene(base.vertex, np.array(base.stiffness) * factor, base.rest_angles, "D1")
    one, other = panel_result(base), find_minima(scaled, prove=False, escape=False)
    for a, b in zip(one.minima, other.minima, strict=True):
        assert b.energy == pytest.approx(a.energy * factor, rel=1e-12)
        assert b.fold_angles == pytest.approx(a.fold_angles, abs=1e-12)
