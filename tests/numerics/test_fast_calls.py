"""The fast paths give the same bits as the slow ones they replace."""

import numpy as np
from hypothesis import given, strategies as st

from origami_nlp.numerics import cross

vectors = st.lists(st.floats(-1e3, 1e3), min_size=3, max_size=3)


@given(a=vectors, b=vectors, c=vectors, d=vectors)
def test_cross_products_have_the_bits_of_numpy(a, b, c, d):
    assert (cross(a, b) == np.cross(a, b)).all()
    left, right = np.array([a, c]), np.array([b, d])
    assert (cross(left, right) == np.cross(left, right)).all()
    assert (cross(left[:, None], right[None]) == np.cross(left[:, None], right[None])).all()
