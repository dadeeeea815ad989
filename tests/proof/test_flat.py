"""The lemma of the flat state: its remainders in 50 digits, and what is critical there is never proved away."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from mpmath import mp, mpf

from benchmarks import family_scene
from origami_nlp import Scene
from origami_nlp.pattern import Vertex, examples
from origami_nlp.proof import ReducedVertex, prove
from origami_nlp.proof.flat import ClosedDirections, FlatVertex, flat_lemma, no_minimum
from origami_nlp.proof.pieces import piece_of
from tests.proof.fifty_digits import exact_sectors, fold_quaternion


def posed(scene):
    return FlatVertex(ReducedVertex(scene))


FOLDED = Scene(Vertex.from_degrees((60, 80, 120, 100)), (1, 2, 3, 4), (1, -0.5, 2, 0.3), "none")


@pytest.mark.parametrize("radius", [1e-5, 1e-3, 0.1])
@pytest.mark.parametrize(
    ("scene", "base"),
    [
        *((family_scene("fold-limits", number), None) for number in range(3)),
        (FOLDED, (1, 1, 1, -1)),
        (FOLDED, (-1, 1, -1, -1)),
    ],
)
def test_remainders_hold(scene, base, radius):
    """All rows at phi = base + r u, r at most the radius, differ from those of lowest order by no more than allowed."""
    n = scene.degree
    base = np.zeros(n) if base is None else math.pi * np.array(base)
    vertex = FlatVertex(ReducedVertex(scene), base)
    cone = ClosedDirections(vertex, radius)
    rng = np.random.default_rng(n)
    k_max = mpf(max(vertex.stiffness))
    for _ in range(8):
        u = rng.uniform(-1, 1, n)
        u[rng.integers(n)] = 1.0
        r = radius * rng.choice([1.0, -1.0, rng.random()])
        box = np.append(u, r / radius)[:, None]
        rows = cone.rows(box, box, np.zeros((n + 1, 1), int))[0]
        with mp.workdps(50):
            sectors = exact_sectors(piece_of(ReducedVertex(scene)))
            if scene is FOLDED:  # folds flat exactly
                sectors = [mp.pi * degrees / 180 for degrees in (60, 80, 120, 100)]
            phi = [
                mp.pi * round(b / math.pi) + mpf(r) * mpf(v) for b, v in zip(base, u, strict=True)
            ]
            q, axes = fold_quaternion(sectors, phi)
            q = [v * mp.sign(q[0]) for v in q]
            exact = [q[1] * 2 / mpf(r), q[2] * 2 / mpf(r), q[3] * 4 / mpf(r) ** 2]
            for four in itertools.combinations(range(n), 4):
                matrix = mp.matrix(4, 4)
                for row, i in enumerate(four):
                    k = mpf(vertex.stiffness[i]) / k_max
                    matrix[row, 0] = k * (mpf(r) * mpf(u[i]) - mpf(vertex.rest[i]))
                    matrix[row, 1], matrix[row, 2] = axes[i][0], axes[i][1]
                    matrix[row, 3] = axes[i][2] / mpf(r)
                exact.append(mp.det(matrix))
            for value, centre, error in zip(exact, rows.centre, rows.error, strict=True):
                assert abs(value - mpf(centre[0])) <= mpf(error[0])


def test_flat_foldings_are_alone_but_where_springs_rest_there():
    """Of panels with one mirror at 45 degrees eight were not: creases on one line fold from one to the other."""
    scene = replace(examples.panels()[0], contact="fold-limits")
    proof = prove(ReducedVertex(scene))
    assert len(proof.singular) > 100 and all(r.alone for r in proof.singular)
    base = math.pi * np.array((1, 1, 1, -1))
    for rest, alone in ((FOLDED.rest_angles, True), (base, False)):
        lemma = flat_lemma(FlatVertex(ReducedVertex(replace(FOLDED, rest_angles=rest)), base))
        assert (lemma.radius > 0) is alone
    off = replace(FOLDED, vertex=Vertex.from_degrees((60, 80, 120.001, 99.999)))
    assert not FlatVertex(ReducedVertex(off), base).closes


def test_generic_flat_states_are_isolated_and_no_minimum():
    for number in (0, 1, 2, 5, 6):
        lemma = flat_lemma(posed(family_scene("fold-limits", number)))
        assert lemma.radius >= 1e-4 and lemma.boxes < 50 and lemma.minimum is False


def planted(number):
    """Springs that balance on closed directions that leave the flat state: it is critical to the order that counts."""
    scene = family_scene("fold-limits", number)
    vertex = posed(scene)
    b = vertex.b
    cross = np.triu(b[:, None, 0] * b[None, :, 1] - b[:, None, 1] * b[None, :, 0], 1)
    kernel = np.linalg.svd(b.T)[2][2:]
    values, vectors = np.linalg.eigh(0.5 * kernel @ (cross + cross.T) @ kernel.T)
    # u with Q(u) = 0, and torques that are a combination of the slopes of b' u and Q there
    u = (vectors[:, 0] / math.sqrt(-values[0]) + vectors[:, -1] / math.sqrt(values[-1])) @ kernel
    torque = (cross + cross.T) @ u + b @ np.array([0.3, -0.2])
    k = np.array(scene.stiffness)
    rest = -torque / k
    rest = rest * min(1.0, 3.0 / np.abs(rest).max())
    return Scene(scene.vertex, scene.stiffness, tuple(rest.tolist()), "none", "fold-limits")


@pytest.mark.parametrize("number", [0, 5])
def test_planted_criticality_is_never_proved(number):
    scene = planted(number)
    lemma = flat_lemma(posed(scene))
    assert lemma.radius == 0.0
    proof = prove(ReducedVertex(scene), boxes=200_000)
    assert not proof.complete and proof.undecided


def test_springs_at_rest_in_the_flat_state_are_not_decided_by_the_lemma():
    vertex = Vertex.from_degrees((70, 80, 120, 90))
    scene = Scene(vertex, (1, 2, 3, 2), (0.0,) * 4, "none", "fold-limits")
    assert flat_lemma(posed(scene)).radius == 0.0
    assert no_minimum(posed(scene)) is None
    assert not prove(ReducedVertex(scene), boxes=200_000).complete
