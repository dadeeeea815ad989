"""Barriers and survival with stops and hinge laws: linear laws are springs, passes against scans and flood fills."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial import cKDTree

import origami_nlp as o
from origami_nlp import Scene, Vertex
from origami_nlp.barriers.find import STOPPED
from origami_nlp.pattern import double_well, linear, sum_of, well
from tests.computed_once import thinned
from tests.independent import scan_four
from tests.independent.admissible import admissible


def quadrilateral(**more):
    """A vertex of degree 4 without symmetry, with several minima on its two curves."""
    vertex = Vertex.from_degrees([70, 110, 80, 100])
    return Scene(vertex, (1.0, 0.6, 1.4, 0.8), (2.2, -0.7, 0.9, 1.6), symmetry="none", **more)


def of_laws(plain):
    return replace(plain, laws=tuple(map(linear, plain.stiffness, plain.rest_angles)))


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(quadrilateral(), marks=pytest.mark.slow),
        quadrilateral(limits=((-1.6, 1.6),) * 4),
        pytest.param(
            replace(o.examples.degree6("5*pi/12", 100), limits=((-2.0, 2.0),) * 6),
            marks=pytest.mark.slow,
        ),
    ],
    ids=["degree 4", "degree 4, stops", "panel, stops"],
)
def test_linear_laws_have_the_barriers_of_springs(scene):
    one, two = (
        o.find_barriers(s, o.find_minima(s, prove=False, escape=False, max_starts=64))
        for s in (scene, of_laws(scene))
    )
    assert len(one.passes) and np.allclose(one.matrix(), two.matrix(), rtol=1e-9, atol=1e-9)
    assert [p.pass_kind for p in one.passes] == [p.pass_kind for p in two.passes]
    assert [p.why for p in one.passes] == [p.why for p in two.passes]
    low, high = scene.limit_angles
    for p in two.passes:
        assert (p.path >= low - 1e-9).all() and (p.path <= high + 1e-9).all()


def flooded(x, energy, ends):
    """Least largest energy over ways along samples, between all of some states, by union and find."""
    pairs = cKDTree(x).query_pairs(3e-3, output_type="ndarray")
    height = np.maximum(energy[pairs[:, 0]], energy[pairs[:, 1]])
    parent = np.arange(len(x))

    def root(k):
        while parent[k] != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    out = np.full((len(ends),) * 2, math.inf)
    for k in np.argsort(height, kind="stable").tolist():
        a, b = root(pairs[k, 0]), root(pairs[k, 1])
        if a == b:
            continue
        here = [[i for i, e in enumerate(ends) if root(e) == side] for side in (a, b)]
        for i in here[0]:
            for j in here[1]:
                out[i, j] = out[j, i] = height[k]
        parent[a] = b
    return out


@pytest.mark.parametrize("seed", thinned([0, 1, 2], 3))
def test_passes_of_a_vertex_are_those_of_a_scan(seed):
    rng = np.random.default_rng(seed)
    scene = quadrilateral(limits=tuple((-a, b) for a, b in rng.uniform(1.5, 3.0, (4, 2))))
    laws = (
        double_well(1.0, rng.uniform(0.6, 1.2)),
        None,
        sum_of([linear(0.5, 0.3), well(0.4, 1.0, 0.3)]),
        double_well(0.6, 0.9, 0.2),
    )
    scene = replace(scene, laws=laws)
    result = o.find_minima(scene)
    found = o.find_barriers(scene, result)
    sectors = np.array(scene.vertex.sector_angles)
    x = scan_four.closed_states(sectors, 12_001)
    low, high = scene.limit_angles
    x = x[((x >= low) & (x <= high)).all(axis=1)]
    x = np.vstack([x[admissible(sectors, x, "full")], [m.fold_angles for m in result.minima]])
    many = len(result.minima)
    energy = scene.energy(x)
    heights = flooded(x, energy, list(range(len(x) - many, len(x))))
    assert many > 2
    for p in found.passes:
        theirs = heights[p.from_state - 1, p.to_state - 1]
        if math.isinf(p.energy):
            assert math.isinf(theirs)
        else:
            assert theirs == pytest.approx(p.energy, abs=2e-3 * energy.max())
    # what it takes to leave each minimum but the lowest for one that is no higher: exact as well
    least = energy[-many:]
    for k, minimum in enumerate(result.minima[1:], start=1):
        climbs = heights[k][least <= least[k] + 1e-9].min() - least[k]
        assert minimum.escape.method == "exact (traced)"
        if math.isinf(climbs):
            assert math.isinf(minimum.escape.barrier)
        else:
            assert climbs == pytest.approx(minimum.escape.barrier, abs=2e-3 * energy.max())


def test_a_stop_before_flat_parts_the_two_sides_of_a_vertex():
    sides = ((0.2, 3.1), *((-3.1, 3.1),) * 5)
    rng = np.random.default_rng(3)
    scene = Scene(
        Vertex.from_degrees([50, 70, 60, 65, 55, 60]), tuple(rng.uniform(0.5, 2, 6)),
        tuple(rng.uniform(-1.5, 1.5, 6)), "none", limits=sides, laws=(double_well(0.3, 1.0), *(None,) * 5),
    )  # fmt: skip
    result = o.find_minima(scene, escape=False, max_starts=64)
    found = o.find_barriers(scene, result)
    side = [np.sign(m.phi.sum()) for m in result.minima]  # of the flat state
    across = [p for p in found.passes if side[p.from_state - 1] * side[p.to_state - 1] < 0]
    assert across and all(p.energy == math.inf and p.why == STOPPED for p in across)
