"""Barriers with one degree of freedom: of vertices, of the patterns that they are, of a Miura by its closed form."""

import numpy as np
import pytest
from scipy.optimize import brentq

import origami_nlp as o
from tests.barriers.test_hinges import quadrilateral
from tests.patterns import scene_pattern


def test_passes_of_a_vertex_are_those_of_its_pattern_and_of_its_escapes():
    scene = quadrilateral()
    result = o.find_minima(scene, prove=False)
    one = o.find_barriers(scene, result)
    found = o.find_minima(scene_pattern(scene), effort="quick")
    same = o.find_barriers(found.pattern, found)
    assert len(result.minima) > 1
    assert [m.energy for m in found.minima] == pytest.approx(
        [m.energy for m in result.minima], rel=1e-12
    )
    assert one.matrix() == pytest.approx(same.matrix(), rel=1e-9)
    assert [p.pass_kind for p in one.passes] == [p.pass_kind for p in same.passes]
    for barriers, minima in ((one, result.minima), (same, found.minima)):
        heights = barriers.matrix()
        for k, m in enumerate(minima):
            if np.isfinite(m.escape.barrier) and m.escape.to:
                rise = heights[k, m.escape.to - 1] - m.energy
                assert rise == pytest.approx(m.escape.barrier, rel=1e-6)
        for p in barriers.passes:
            if len(p.path):
                assert p.path_energy.max() == pytest.approx(p.energy, rel=1e-6)
                assert np.abs(np.diff(p.path, axis=0)).max() < 0.5


def wells(alpha=1.4):
    """A Miura with two wells on one side of flat: its small folds turn over when the large ones are almost closed."""
    plain = o.examples.pattern("miura:2x3", alpha=alpha)
    motion = o.find_motion(plain)
    phi = motion.fold_angles[len(motion.fold_angles) // 2]
    large = np.abs(phi) > 0.9 * np.abs(phi).max()
    rest = np.sign(phi) * np.where(large, 0.6, 2.9)
    stiffness = np.where(large, 0.9, 1.0)
    return plain.with_springs(stiffness.tolist(), rest.tolist()), large, alpha


def test_a_saddle_of_a_miura_is_that_of_its_closed_form():
    pattern, large, alpha = wells()

    def energy(t):
        small = 2 * np.arctan(np.cos(alpha) * np.tan(t / 2))
        return 0.5 * (large.sum() * 0.9 * (t - 0.6) ** 2 + (~large).sum() * (small - 2.9) ** 2)

    def slope(t):
        small = 2 * np.arctan(np.cos(alpha) * np.tan(t / 2))
        rate = np.cos(alpha) / (np.cos(t / 2) ** 2 + (np.cos(alpha) * np.sin(t / 2)) ** 2)
        return large.sum() * 0.9 * (t - 0.6) + (~large).sum() * (small - 2.9) * rate

    grid = np.linspace(0.01, np.pi - 0.01, 2000)
    turns = np.flatnonzero(np.diff(np.sign([slope(t) for t in grid])))
    roots = [brentq(slope, grid[k], grid[k + 1], xtol=1e-14) for k in turns]
    assert len(roots) == 3  # well, top, well
    found = o.find_minima(pattern, effort="quick", escape=False)
    barriers = o.find_barriers(pattern, found)
    ends = [
        next(
            k for k, m in enumerate(found.minima) if m.energy == pytest.approx(energy(t), rel=1e-9)
        )
        for t in (roots[0], roots[2])
    ]
    assert barriers.matrix()[ends[0], ends[1]] == pytest.approx(energy(roots[1]), rel=1e-9)
    (one,) = [p for p in barriers.passes if {p.from_state - 1, p.to_state - 1} == set(ends)]
    assert one.pass_kind == "saddle" and one.residual < 1e-9
    assert len(barriers.to_fold()["file_frames"]) > 5 and barriers.view_content().tracks


def test_what_cannot_fold_has_no_pass():
    rigid = o.Scene(o.Vertex.from_degrees([100, 120, 140]), (1.0,) * 3, (0.4,) * 3, symmetry="none")
    assert not any(len(p.path) for p in o.find_barriers(rigid).passes)
