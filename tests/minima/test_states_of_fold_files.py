"""States of every vertex of the FOLD files at hand: found, verified by perturbation, written and read again."""

import json

import numpy as np
import pytest

from origami_nlp import find_minima
from origami_nlp.pattern import fold_vertices, parse_fold, scene_at
from tests.fold_files import closed_state, disc, folded, in_space, miura
from tests.independent.neighbours import Problem, look_around
from tests.independent.rotations import fold, spin_sign

OURS = {
    "degree 4": disc([60, 100, 120, 80], "MVVV", angles=[-40, 60, 70, 80]),
    "degree 4, letters only": disc([60, 100, 120, 80], "MVVV"),
    "degree 5, null angles": disc([60, 70, 80, 70, 80], "MVVVM", angles=[None, 30, None, 60, -20]),
    "degree 6, turned": disc([60] * 6, "MVVMVV", angles=[-60, 50, 50, -60, 50, 50], turn=77),
    "waterbomb in space, noise": in_space(
        disc([45] * 8, "MVMVMVMV", angles=[-60, 60] * 4), 3, 1e-5
    ),
    "miura": miura(),
    "flat and joined edges": disc([60, 50, 50, 120, 40, 40], "MFVVJV"),
    "no assignment": {k: v for k, v in disc([60, 100, 120, 80]).items() if k != "edges_assignment"},
    "folded degree 5": folded((60, 70, 80, 70, 80), closed_state((60, 70, 80, 70, 80), True, 3)),
    "folded, not flat": folded((70, 80, 75, 65), closed_state((70, 80, 75, 65), False, 3), False),
}
QUICK = ("degree 4", "folded, not flat")
LARGEST = 5
"""Larger vertices without symmetry take minutes: they keep theirs (symmetry = auto)."""


def check_states(frame, number, starts):
    """Find the states of a vertex; each must close, be embedded on the right sheet, and have no lower neighbour."""
    degree = next(v.degree for v in fold_vertices(frame)[0] if v.number == number)
    scene = scene_at(frame, number, symmetry="none" if degree <= LARGEST else "auto")
    result = find_minima(scene, max_starts=starts, prove=False, escape=False)
    assert result.minima, scene
    p, rng = Problem.of(scene), np.random.default_rng(0)
    for m in result.minima:
        phi = np.array(m.fold_angles)
        assert np.abs(fold(p.sectors, phi)[1][0] - np.eye(3)).max() < 1e-12
        assert spin_sign(p.sectors, phi)[0] == 1
        around = look_around(p, p.reduce(phi), 100, rng)
        assert not len(around.lower), (scene, m, around)
    again_frame = parse_fold(json.dumps(result.to_fold()))[0]
    (again_vertex,) = fold_vertices(again_frame)[0]
    again = find_minima(
        scene_at(again_frame, 0, symmetry=scene.symmetry),
        max_starts=starts,
        prove=False,
        escape=False,
    )
    assert len(again.minima) == len(result.minima)
    shift = again_vertex.edges.index(0)
    back = [np.roll(m.fold_angles, -shift) for m in again.minima]
    for m in result.minima:
        assert min(np.abs(np.subtract(m.fold_angles, psi)).max() for psi in back) < 1e-9
    return result


@pytest.mark.parametrize(
    "name", [pytest.param(n, marks=() if n in QUICK else pytest.mark.slow) for n in OURS]
)
def test_states_of_our_files(name):
    for frame in parse_fold(json.dumps(OURS[name])):
        seen = set()
        for v in fold_vertices(frame)[0]:
            kind = (v.assignment, tuple(np.round(v.sector_angles, 9)))
            if not v.reason and kind not in seen:
                seen.add(kind)
                check_states(frame, v.number, 60)
        assert seen
