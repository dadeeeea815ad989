"""Special relations of sector angles: found, made exact or kept apart, once a scene."""

from __future__ import annotations

import itertools
import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, strategies as st

import origami_nlp
from origami_nlp.pattern.relations import RESOLVED, find_relations


def count_by_fractions(parts: list[int]) -> int:
    """Count the relations of sectors 2 pi parts / sum(parts), in whole numbers only."""
    n, whole = len(parts), sum(parts)
    count = 0
    for length in range(2, n + 1):
        for first in range(1 if length == n else n):
            run = [parts[(first + k) % n] for k in range(length)]
            for signs in itertools.product((1, -1), repeat=length - 1):
                halves = Fraction(
                    2 * sum(s * p for s, p in zip((1, *signs), run, strict=True)), whole
                )
                if length == n:
                    count += halves % 2 == 0 and -1 in signs
                else:
                    count += halves % 1 == 0
    return count


def sectors_of(parts: list[int]) -> tuple[float, ...]:
    return tuple(2 * math.pi * p / sum(parts) for p in parts)


@given(st.lists(st.integers(1, 5), min_size=4, max_size=8))
def test_exact_relations_are_counted_as_in_whole_numbers(parts: list[int]) -> None:
    found = find_relations(sectors_of(parts))
    assert found.exact == count_by_fractions(parts)
    assert not found.made_exact and found.moved == 0.0


@given(
    st.lists(st.integers(1, 4), min_size=4, max_size=7),
    st.floats(1e-12, 2e-8),
    st.randoms(use_true_random=False),
)
def test_near_relations_are_made_exact_by_small_moves(parts, size, random) -> None:
    exact = np.array(sectors_of(parts))
    noise = np.array([random.uniform(-1, 1) for _ in parts]) * size / len(parts)
    noise -= noise.mean()
    found = find_relations(tuple((exact + noise).tolist()))
    assert found.moved <= RESOLVED
    assert math.fsum(found.sector_angles) == pytest.approx(2 * math.pi, abs=1e-14)
    again = find_relations(found.sector_angles)
    assert again.exact == count_by_fractions(parts) and again.moved == 0.0 and not again.made_exact


@given(
    st.lists(st.integers(1, 4), min_size=4, max_size=7),
    st.integers(0, 6),
    st.sampled_from((0.0, 3e-9, 1e-5)),
)
def test_labels_and_orientation_change_nothing(parts, turn, miss) -> None:
    sectors = list(sectors_of(parts))
    sectors[0] += miss
    sectors[1] -= miss
    first = find_relations(tuple(sectors))
    turned = np.roll(sectors, turn)
    for other in (turned, turned[::-1]):
        found = find_relations(tuple(other.tolist()))
        assert found.exact == first.exact
        assert found.made_exact == first.made_exact
        assert found.moved == pytest.approx(first.moved, abs=1e-14)


def test_a_scene_says_what_it_made_exact() -> None:
    a = math.pi / 3 + 1e-9
    sectors = (a, math.pi - 2 * a, a, a, math.pi - 2 * a, a)
    k, rest = (0.025,) * 6, (math.pi / 2, math.pi / 2, -math.pi, math.pi / 2, -math.pi, math.pi / 2)
    scene = origami_nlp.Scene(origami_nlp.Vertex(sectors), k, rest, symmetry="none")
    assert scene.vertex.sector_angles == pytest.approx((math.pi / 3,) * 6, abs=1e-15)
    assert scene.relations.made_exact > 0 and scene.relations.moved <= 2e-9
