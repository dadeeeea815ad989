"""Layer orders counted: against published numbers of stamp and map foldings, and against every permutation."""

import itertools
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.errors import OptionError
from origami_nlp.pattern import make_pattern

STAMPS = {2: 2, 3: 6, 4: 16, 5: 50, 6: 144, 7: 462}
"""Ways of folding a strip of labelled stamps onto one: https://oeis.org/A000136."""
MAPS = {(2, 2): 8, (2, 3): 60, (2, 4): 320, (3, 3): 1368}
"""Ways of folding a map: https://oeis.org/A001415 and https://oeis.org/A001418."""


def grid(rows, columns, letter="U", letters=None):
    """A map of unit squares; letters by the sides of creases, else one for all."""
    corners = [(x, y) for y in range(rows + 1) for x in range(columns + 1)]
    n = columns + 1
    squares = [
        (y * n + x, y * n + x + 1, (y + 1) * n + x + 1, (y + 1) * n + x)
        for y in range(rows)
        for x in range(columns)
    ]
    sides = {tuple(sorted((q[i - 1], q[i]))) for q in squares for i in range(4)}
    return make_pattern(
        np.array(corners, float), squares, assignment=letters or dict.fromkeys(sides, letter)
    )


@pytest.mark.parametrize("stamps", STAMPS)
def test_strips_of_stamps_fold_in_as_many_ways_as_published(stamps):
    found = o.layer_orders(grid(1, stamps), most=1000)
    assert (found.count, found.whole, found.unassigned) == (STAMPS[stamps], True, stamps - 1)
    assert len(set(found.orders)) == STAMPS[stamps]


@pytest.mark.parametrize("size", MAPS)
def test_maps_fold_in_as_many_ways_as_published(size):
    assert o.layer_orders(grid(*size), most=0).count == MAPS[size]


def passes(below, letters):
    """Whether a strip whose stamps lie on each other in this order, the lowest first, has no stamp through a crease."""
    place = {stamp: k for k, stamp in enumerate(below)}
    n = len(below)
    for k in range(n - 1):
        up = place[k + 1] > place[k]
        # stamps of even number are the right way up: there a valley brings the next one above
        if up != ((letters[k] == "V") == (k % 2 == 0)):
            return False
    for a, b in itertools.combinations(range(n - 1), 2):
        if (a - b) % 2:
            continue  # creases at different ends
        low, high = sorted((place[a], place[a + 1]))
        if (low < place[b] < high) != (low < place[b + 1] < high):
            return False
    return True


@pytest.mark.parametrize("letters", ["MMM", "MVMV", "MVVM", "VVMM", "MMVMM", "MVMVV"])
def test_orders_of_a_strip_are_those_permutations_that_do_not_cross(letters):
    n = len(letters) + 1
    strip = grid(1, n, letters={(k, k + n + 1): a for k, a in enumerate(letters, start=1)})
    found = o.layer_orders(strip, most=1000)
    good = [p for p in itertools.permutations(range(n)) if passes(p, letters)]
    listed = set()
    for order in found.orders:
        above = np.zeros(n, int)
        for f, g, s in order:
            # by the normal of g, which points up where g has an even number
            over = (s > 0) == (g % 2 == 0)
            above[f if over else g] += 1
        listed.add(tuple(np.argsort(above).tolist()))
    assert found.count == len(good) and listed == set(good)


def test_components_are_chosen_freely():
    """Two pleats in one strip, far apart: each has its own orders, and listing goes up to the cap."""
    corners = [(x, y) for y in (0, 1) for x in (0, 4, 5, 6, 9, 10, 11, 15)]
    polygons = [(k, k + 1, k + 9, k + 8) for k in range(7)]
    strip = make_pattern(np.array(corners, float), polygons)
    found = o.layer_orders(strip, most=3)
    assert found.count == math.prod(c.orders for c in found.components) and found.whole
    assert len(found.orders) == min(3, found.count)


def test_orders_are_written_as_frames_that_a_check_accepts(tmp_path):
    found = o.layer_orders(grid(2, 2, letters=None, letter="U"), most=8)
    data = found.to_fold()
    assert len(data["file_frames"]) == 8
    letters = data["file_frames"][0]["edges_assignment"]
    assert set(letters) <= set("MVBJF")
    assert o.layer_orders("miura:2x2").to_frame().empty
    path = tmp_path / "orders.json"
    found.save(path)
    again = o.read_result(path)
    assert (again.count, again.components) == (found.count, found.components)


def test_a_search_that_is_given_up_says_so(monkeypatch):
    monkeypatch.setattr("origami_nlp.validity.counting.GUESSES", 5)
    found = o.layer_orders(grid(3, 3), most=0)
    assert not found.whole and found.count <= MAPS[3, 3]
    assert "at least" in found.verdict or "guesses" in found.reason


def test_what_has_no_order_says_why():
    crossed = grid(2, 2, letters={(1, 4): "M", (3, 4): "M", (4, 5): "M", (4, 7): "M"})
    found = o.layer_orders(crossed)
    assert found.count == 0 and found.reason and "no layer order" in found.verdict
    with pytest.raises(OptionError):
        found.to_fold()
    open_ = o.layer_orders(crossed, [1.0, 0.0, 0.0, 0.5])
    assert not open_.decided and "does not close" in open_.reason


@pytest.mark.parametrize("most", [5, 60])
def test_more_than_fits_into_memory_is_not_decided(monkeypatch, most):
    monkeypatch.setattr("origami_nlp.validity.counting.MOST_LAYERS", most)
    flat = o.examples.crease_pattern("miura", 3, 3)
    del flat["edges_foldAngle"]
    assert o.check(flat).verdict == "not decided"
    found = o.layer_orders("miura:3x3")
    assert not found.decided and "not ordered" in found.reason
