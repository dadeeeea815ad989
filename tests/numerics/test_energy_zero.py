"""States at rest have energy 0, of a vertex and of a pattern: no digits of rounding are printed."""

import numpy as np
import pytest

import origami_nlp as o

SECTORS = (60, 110, 120, 70)


@pytest.fixture(scope="module")
def at_rest():
    """A vertex whose springs rest, but for rounding, at a folded state."""
    vertex = o.Vertex.from_degrees(SECTORS)
    start = o.Scene(vertex, (1,) * 4, (0.8, 0.5, 0.8, -0.5), symmetry="none")
    phi = o.find_minima(start, prove=False, escape=False).minima[0].fold_angles
    rest = tuple(a * (1 + 3e-15) for a in phi)
    return o.Scene(vertex, (1,) * 4, rest, symmetry="none")


def test_the_energy_of_a_state_at_rest_is_zero(at_rest):
    lowest = o.find_minima(at_rest, prove=False, escape=False).minima[0]
    assert lowest.energy == 0.0
    rest = np.array(at_rest.rest_angles)
    assert at_rest.energy(rest + 1e-12) == 0.0
    assert at_rest.energy(rest + 1e-9) == pytest.approx(0.5 * 4e-18, rel=1e-6)
