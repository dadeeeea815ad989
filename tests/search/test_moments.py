"""The search from moments: what it finds is certified, is what other searches find, and does not depend on labels."""

from origami_nlp import find_minima
from tests.search.test_moment_map import draw


def test_same_seed_same_answer():
    a, b = (
        find_minima(draw(28), effort="quick", max_starts=60, seed=3, prove=False, escape=False)
        for _ in range(2)
    )
    assert [m.fold_angles for m in a.minima] == [m.fold_angles for m in b.minima]
    assert a.search.by_source == b.search.by_source
    assert a.search.by_source["moments"] > 0
