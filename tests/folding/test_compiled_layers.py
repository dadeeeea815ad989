"""Which creases lie on each other and on facets: in C and in NumPy the same, on states that touch in every way."""

import itertools

import numpy as np
import pytest

from origami_nlp.folding import fold_vertex, layers
from origami_nlp.folding.compiled_layers import arranged_in_c, library
from origami_nlp.numerics import CONTACT_TOL
from origami_nlp.pattern import Vertex

needs_compiler = pytest.mark.skipif(library() is None, reason="no compiler")


def _rotated(creases: np.ndarray, seed: int) -> np.ndarray:
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return creases @ (turn * np.sign(np.linalg.det(turn))).T


@needs_compiler
@pytest.mark.parametrize("degree", [4, 6, 8])
def test_flat_foldings_are_arranged_alike(degree: int) -> None:
    """All creases in one plane: equal sectors put them on few nodes, others let facets lie over several."""
    rng, touching = np.random.default_rng(degree), 0
    halves = [np.ones(degree // 2), *rng.integers(2, 6, (4, degree // 2)).astype(float)]
    for k, half in enumerate(halves):
        sectors = np.pi * np.stack([half, half[::-1]]).ravel() / half.sum()
        for signs in itertools.product((-1, 0, 1), repeat=degree if degree < 8 else 6):
            creases, q = fold_vertex(Vertex(tuple(sectors)), np.pi * np.resize(signs, degree))
            if np.abs(q[1:]).max() > CONTACT_TOL:
                continue
            creases = _rotated(creases, k)
            made = arranged_in_c(creases, CONTACT_TOL)
            assert made == layers._arranged_in_numpy(creases, CONTACT_TOL)
            touching += made is not None
    assert touching > 100


@needs_compiler
def test_nothing_touches_in_general_position() -> None:
    rng = np.random.default_rng(1)
    for degree in (3, 5, 12):
        creases = rng.normal(size=(degree, 3))
        creases /= np.linalg.norm(creases, axis=1)[:, None]
        assert arranged_in_c(creases, CONTACT_TOL) is None
        assert layers._arranged_in_numpy(creases, CONTACT_TOL) is None


@needs_compiler
def test_a_crease_on_a_facet_by_hand() -> None:
    """Crease 4 lies at the middle of the facet from crease 1 to crease 2: three segments meet there."""
    a, b, far = np.eye(3)
    creases = np.array([a, b, far, (a + b) / np.sqrt(2)])
    paths, around = arranged_in_c(creases, CONTACT_TOL)
    assert paths == ((0, 3, 1), (1, 2), (2, 3), (3, 0))
    # seen from outside at crease 4, with the third axis up: crease 2 is right, crease 1 left
    assert dict(around) == {0: (3,), 1: (2, 3), 2: (1, 3), 3: (0, 1, 2)}
    turned = {w: tuple(ends) for w, ends in layers._arranged_in_numpy(creases, CONTACT_TOL)[1]}
    assert turned == dict(around)
