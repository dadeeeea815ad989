"""The fast paths give the same bits as the slow ones they replace."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from origami_nlp import Scene, Vertex, examples
from origami_nlp.numerics import cross
from origami_nlp.problem import Model

SCENES = [
    examples.degree6("pi/3", 1.0),
    examples.degree8("pi/6", 1.0),
    examples.degree8("pi/6", 1.0, symmetry="none"),
    Scene(Vertex(("pi/2",) * 4), (1.0,) * 4, (0,) * 4, "none", "none"),
]


@pytest.mark.parametrize("scene", SCENES, ids=lambda s: f"{s.degree} {s.group.name} {s.contact}")
def test_evaluators_return_what_the_functions_return(scene):
    model, rng = Model(scene), np.random.default_rng(0)
    f = model.functions
    kept = []
    for _ in range(10):
        x = rng.normal(size=model.size)
        lam, mu = rng.normal(size=model.equation_count), rng.normal(size=len(model.structure.gaps))
        for name in ("closure", "local", "hessian", "rays", "lift"):
            extra = (1.5, lam, mu) if name == "hessian" else ()
            slow = getattr(f, name)(x, model.parameters.vector, *extra)
            slow = slow if isinstance(slow, tuple) else (slow,)
            fast = f.evaluators[name](x, model.parameters.vector, *extra)
            assert len(fast) == len(slow)
            for a, b in zip(fast, slow, strict=True):
                assert a.shape == b.shape and (a == np.asarray(b)).all()
                kept.append((a, a.copy()))
    for a, b in kept:  # no output is overwritten by a later call
        assert (a == b).all()


vectors = st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3)


@given(a=vectors, b=vectors, c=vectors, d=vectors)
def test_cross_products_have_the_bits_of_numpy(a, b, c, d):
    assert (cross(a, b) == np.cross(a, b)).all()
    left, right = np.array([a, c]), np.array([b, d])
    assert (cross(left, right) == np.cross(left, right)).all()
    assert (cross(left[:, None], right[None]) == np.cross(left[:, None], right[None])).all()
