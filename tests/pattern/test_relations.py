"""Special relations of sector angles: found, made exact or kept apart, once a scene."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, strategies as st

import origami_nlp
from origami_nlp.kkt import classify
from origami_nlp.minima import result_from_dict, result_to_dict
from origami_nlp.minima.find import Rejected
from origami_nlp.minima.hinges import hinge_minima
from origami_nlp.pattern.relations import NEAR, RESOLVED, find_relations
from origami_nlp.programme import Model


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
        for one, two in ((found.made_exact, first.made_exact), (found.different, first.different)):
            assert sorted(abs(r.miss) for r in one) == pytest.approx(
                sorted(abs(r.miss) for r in two), abs=1e-14
            )


def test_relations_that_miss_by_more_are_kept_apart() -> None:
    d = 1e-6
    h = math.pi / 2
    found = find_relations((h + d, h - d, h + d, h - d))
    assert found.moved == 0.0 and found.sector_angles == (h + d, h - d, h + d, h - d)
    assert found.exact == 6 and not found.made_exact  # both pairs of creases on one line
    assert {round(abs(r.miss) / d) for r in found.different} == {2, 4}
    assert all(RESOLVED < abs(r.miss) <= NEAR for r in found.different)
    assert any("coincide while 2 is shut" in r.text for r in found.different)
    assert any("folds flat with creases 1, 2, 3, 4 shut" in r.text for r in found.different)


def test_thousand_creases() -> None:
    found = find_relations((2 * math.pi / 1000,) * 1000)
    assert found.exact and found.moved == 0.0


def test_a_scene_says_what_it_made_exact() -> None:
    a = math.pi / 3 + 1e-9
    sectors = (a, math.pi - 2 * a, a, a, math.pi - 2 * a, a)
    k, rest = (0.025,) * 6, (math.pi / 2, math.pi / 2, -math.pi, math.pi / 2, -math.pi, math.pi / 2)
    scene = origami_nlp.Scene(origami_nlp.Vertex(sectors), k, rest, symmetry="none")
    assert scene.vertex.sector_angles == pytest.approx((math.pi / 3,) * 6, abs=1e-15)
    printed = repr(Model(scene))
    assert "made exact, sectors moved by up to 2.0e-09 rad" in printed
    made = {r.text for r in scene.relations.made_exact}
    assert "creases 1 and 3 coincide while 2 is shut" in made


def test_a_report_says_what_was_made_exact() -> None:
    d, h = 1e-9, math.pi / 2
    vertex = origami_nlp.Vertex((h + d, h - d, h + d, h - d))
    scene = origami_nlp.Scene(vertex, (1.0,) * 4, (1.0, 0.3, 0.4, -0.2), symmetry="none")
    result = origami_nlp.find_minima(scene, max_starts=4, fewest_starts=4)
    assert "sector angles moved by up to 1.0e-09 rad" in repr(result)
    data = result_to_dict(result)
    assert data["model"]["geometry"]["made_exact"] and data["search"]["undecided"] == []
    assert result_to_dict(result_from_dict(data)) == data


def rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


@pytest.mark.parametrize(
    "parts", [(1, 1, 1, 1, 1, 1), (1, 1, 1, 1), (1, 2, 1, 1, 2, 1), (2, 1, 1, 2, 2)]
)
def test_hinge_sets_hold_the_lowest_states_along_them(parts: tuple[int, ...]) -> None:
    """Each state closes by rotation matrices, and moves that keep it on its line of hinges lead up."""
    rng = np.random.default_rng(len(parts))
    n = len(parts)
    vertex = origami_nlp.Vertex(sectors_of(list(parts)))
    scene = origami_nlp.Scene(
        vertex,
        rng.uniform(0.1, 2, n).tolist(),
        rng.uniform(-2.5, 2.5, n).tolist(),
        symmetry="none",
    )
    model = Model(scene)
    states = hinge_minima(model)
    assert states

    def misses(phi: np.ndarray) -> float:
        product = np.eye(3)
        for b, angle in zip(vertex.creases, phi, strict=True):
            product = product @ rotation(b, angle)
        return float(np.abs(product - np.eye(3)).max())

    moved = 0
    for x in states:
        assert misses(x) < 1e-12 and model.on_sheet(x)
        hinges = np.flatnonzero((np.abs(x) < math.pi) & (np.abs(x) > 1e-9))
        for i, j in itertools.combinations(hinges, 2):
            for si, sj in itertools.product((1e-2, -1e-2), repeat=2):
                y = x.copy()
                y[[i, j]] += si, sj
                if misses(y) < 1e-12 and np.abs(y).max() <= math.pi:
                    moved += 1
                    assert scene.energy(y) > scene.energy(x)
    assert moved


@pytest.mark.parametrize("ulps", [(0, 0, 0, 0), (3, -2, -2, 3), (1, 0, -1, 0), (-4, 4, 3, -3)])
def test_rounding_of_the_sectors_makes_no_states(ulps: tuple[int, ...]) -> None:
    """Where two sets of states of the cross almost meet, doubles see a state in the gap between them."""
    sectors = tuple(math.pi / 2 + u * 2.0**-52 for u in ulps)
    rest = (math.pi, -math.pi, -math.pi, -math.pi)
    scene = origami_nlp.Scene(origami_nlp.Vertex(sectors), (1.0,) * 4, rest)
    result = origami_nlp.find_minima(scene)
    flat = math.pi * np.round(np.array([m.fold_angles for m in result.minima]) / math.pi)
    assert np.array([m.fold_angles for m in result.minima]) == pytest.approx(flat, abs=1e-12)
    assert [m.energy for m in result.minima] == pytest.approx([0.0, 4 * math.pi**2], abs=1e-12)


def test_what_is_not_polished_is_undecided_and_told_by_name() -> None:
    scene = origami_nlp.examples.degree6("pi/4", 1.0)
    result = origami_nlp.find_minima(scene, max_starts=8, fewest_starts=8)
    state = result.minima[0]
    what = classify(result.model, result.model.reduce(state.fold_angles), polished=False)
    assert what.verdict == "undecided" and what.kind is None and "not polished" in what.reason
    named = Rejected(what.verdict, what.reason, state.fold_angles, state.energy, 1)
    told = replace(result, search=replace(result.search, undecided=(named,)))
    assert "not decided: energy" in repr(told) and what.reason in repr(told)
    assert result_from_dict(result_to_dict(told)).search.undecided == (named,)
