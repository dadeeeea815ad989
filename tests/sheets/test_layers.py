"""Orders of layers: the exact test of one vertex, and all orders of strips one after the other."""

import itertools
import math

import numpy as np
import pytest

from origami_nlp import Vertex, examine
from origami_nlp.sheets import Sheet, judge, order_layers
from tests.sheets.patterns import grid, miura, miura_angles, wheel


@pytest.mark.parametrize("degree", [4, 6])
def test_one_vertex_as_the_exact_test_says(degree):
    """Random flat-foldable vertices (Kawasaki), every assignment."""
    rng, ordered, count = np.random.default_rng(degree), 0, 0
    for _ in range(4):
        sectors = np.full(degree, 3.0)
        while sectors.max() > 2.8 or sectors.min() < 0.15:
            sectors = rng.uniform(0.3, 1.6, degree)
            for half in (sectors[0::2], sectors[1::2]):
                half *= math.pi / half.sum()
        sheet, vertex = Sheet(wheel(sectors)), Vertex(tuple(sectors.tolist()))
        for signs in itertools.product((1.0, -1.0), repeat=degree):
            phi = math.pi * np.array(signs)
            if sheet.residual(phi) > 1e-12 or not sheet.closure.on_sheet(phi):
                continue
            admissible = examine(vertex, phi).admissible
            assert (order_layers(sheet, phi).verdict == "ordered") == admissible
            ordered, count = ordered + admissible, count + 1
    assert 0 < ordered < count


def _some_order(lengths, signs):
    """Go through all orders of the layers of a folded strip: heights of its facets, 0 lowest."""
    n = len(lengths)
    ends = [0.0]
    for k, length in enumerate(lengths):
        ends.append(ends[-1] + (length if k % 2 == 0 else -length))
    low, high = np.minimum(ends[:-1], ends[1:]), np.maximum(ends[:-1], ends[1:])

    def good(height):
        for k in range(n - 1):
            # facets with even numbers lie face up: their valley brings the next one on top
            above = (signs[k] > 0) == (k % 2 == 0)
            if (height[k + 1] > height[k]) != above:
                return False
            a, b = sorted((height[k], height[k + 1]))
            x = ends[k + 1]
            if any(
                a < height[m] < b and low[m] + 1e-9 < x < high[m] - 1e-9
                for m in range(n)
                if m not in (k, k + 1)
            ):
                return False
            for m in range(n - 1):
                if m == k or abs(ends[m + 1] - x) > 1e-9 or {m, m + 1} & {k, k + 1}:
                    continue
                if (m - k) % 2:  # the facets of the other crease lie on its other side
                    continue
                if (a < height[m] < b) != (a < height[m + 1] < b):
                    return False
        return True

    return any(good(h) for h in itertools.permutations(range(n)))


@pytest.mark.parametrize("equal", [True, False])
def test_strips_as_all_their_orders_say(equal):
    """Of facets as long as each other (creases lie on creases), and of others."""
    rng, found = np.random.default_rng(0), []
    for n in (4, 5, 6):
        lengths = np.ones(n) if equal else rng.choice([1.0, 1.3, 1.7, 2.0], n)
        x = np.concatenate([[0.0], np.cumsum(lengths)])
        sheet = Sheet(grid(np.stack(np.meshgrid(x, [0.0, 1.0], indexing="ij"), axis=2)))
        for signs in itertools.islice(itertools.product((1.0, -1.0), repeat=n - 1), 0, None, 2):
            verdict = order_layers(sheet, math.pi * np.array(signs)).verdict
            assert verdict == ("ordered" if _some_order(lengths, signs) else "crosses")
            found.append(verdict)
    assert "ordered" in found
    assert equal or "crosses" in found  # stamps of one size fold with any signs


def test_a_miura_sheet_folds_flat_and_large_ones_are_refused_by_name():
    pattern = miura(4, 4)
    folded = math.pi * np.sign(miura_angles(pattern, 4, 1.0))
    held = pattern.with_springs(1.0, list(folded))
    state = judge(Sheet(held), folded)
    assert order_layers(Sheet(pattern), folded).verdict == "ordered"
    assert state.verdict in ("minimum", "undecided")
    assert state.energy == 0.0
    large = miura(14, 14)
    far = order_layers(Sheet(large), math.pi * np.sign(miura_angles(large, 14, 1.0)))
    assert far.verdict == "not decided"
    assert "pairs" in far.reason
