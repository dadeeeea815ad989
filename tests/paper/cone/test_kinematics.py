"""Branches of the cone: fold angles to 14 digits, where they end, their symmetries and numbers."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from origami_nlp.chart import fold_vertex
from origami_nlp.errors import AngleError, OptionError
from origami_nlp.paper import cone
from origami_nlp.pattern import Vertex
from origami_nlp.pattern_problem import check_admissible


def sheet(degree):
    return Vertex((2 * math.pi / degree,) * degree)


def words(flaps):
    return product((1, -1), repeat=flaps)


# ---------------------------------------------------------------- fold angles


@given(st.integers(3, 10), st.data())
@settings(max_examples=60)
def test_every_branch_closes_and_is_embedded_up_to_its_end(half, data):
    flaps = tuple(data.draw(st.lists(st.sampled_from([1, -1]), min_size=half, max_size=half)))
    direction = data.draw(st.sampled_from([1, -1]))
    branch = cone.ConeBranch(flaps, direction, data.draw(st.sampled_from(["contract", "contact"])))
    share = data.draw(st.floats(0.01, 0.999))
    phi = branch.fold_angles(direction * share * branch.end)
    state = check_admissible(sheet(branch.degree), phi)
    assert state.admissible, state.reason
    assert state.closure_residual < 1e-13
    creases, _ = fold_vertex(sheet(branch.degree), phi)
    odd = creases[::2]
    axis = np.cross(odd[1] - odd[0], odd[2] - odd[0])
    heights = odd @ (axis / np.linalg.norm(axis))  # all odd creases at the same elevation
    np.testing.assert_allclose(np.abs(heights), abs(math.sin(share * branch.end)), atol=1e-12)


@pytest.mark.parametrize("degree", [6, 8, 10, 12])
@pytest.mark.parametrize("direction", [1, -1])
def test_the_contact_rule_is_where_facets_touch(degree, direction):
    """Just before the end every branch is embedded; just after it none is (or the sheet is folded flat)."""
    from origami_nlp.closed_forms import cone_fold_angles

    for folding in cone.foldings(degree):
        branch = cone.ConeBranch(folding.flaps, direction, "contact")
        before = cone_fold_angles(degree, direction * (branch.end - 1e-4), branch.flaps).value
        after = cone_fold_angles(degree, direction * (branch.end + 1e-4), branch.flaps).value
        assert check_admissible(sheet(branch.degree), before).admissible
        assert not check_admissible(sheet(branch.degree), after).admissible


# ---------------------------------------------------------------- assignments


@pytest.mark.parametrize("degree", [6, 8, 10, 12, 14, 16])
def test_classes_and_their_multiplicities_are_those_of_all_words(degree):
    found = {}
    for word in words(degree // 2):
        found[cone.class_of(word)] = found.get(cone.class_of(word), 0) + 1
    every = cone.Branches.of(degree)
    pairs = zip(every.valleys.tolist(), every.changes.tolist(), every.multiplicity, strict=True)
    assert sorted(pairs) == sorted(2 * [(*key, many) for key, many in found.items()])


def orbits(degree, mirrored):
    """Different words by sorting all of them into orbits."""
    seen = set()
    for word in words(degree // 2):
        images = [word[k:] + word[:k] for k in range(len(word))]
        images += [w[::-1] for w in images] if mirrored else []
        seen.add(max(images))
    return seen


@pytest.mark.parametrize("degree", [6, 8, 10, 12, 14, 16])
def test_lists_and_formulas_agree_with_orbits(degree):
    for mirrored, listed, number in (
        (False, cone.foldings(degree), cone.number_of_foldings(degree)),
        (
            True,
            cone.foldings(degree, mirrors_differ=False),
            cone.number_of_foldings(degree, mirrors_differ=False),
        ),
    ):
        theirs = orbits(degree, mirrored)
        assert {cone.parse_flaps(f.flaps) for f in listed} == theirs
        assert len(listed) == len(theirs) == number
        assert sum(f.copies for f in listed) == 2 ** (degree // 2)


# ---------------------------------------------------------------- command line, drawings


def test_numbers_of_foldings():
    """The paper's table holds necklaces, its formula gives bracelets; both for any degree."""
    printed = [4, 6, 8, 14, 20, 36, 60, 108, 188, 352, 632, 1182, 2192]
    assert [cone.number_of_foldings(n) for n in range(6, 31, 2)] == printed
    n, turned = 500, cone.number_of_foldings(1000)
    assert 0 <= n * turned - 2**n < n * n * 2 ** (n // 2)
    # a bracelet is one necklace, or two that mirror each other
    assert turned < 2 * cone.number_of_foldings(1000, mirrors_differ=False) < 2 * turned


def test_wrong_branches_and_elevations_are_named():
    for bad in ("VXM", "VM", "", "V0MM", "2VM", "V99999999M"):
        with pytest.raises(OptionError):
            cone.parse_flaps(bad)
    branch = cone.ConeBranch("V2M", "up")
    for elevation in (0.53, -0.1, math.nan):
        with pytest.raises(AngleError):
            branch.fold_angles([0.1, elevation])
    np.testing.assert_array_equal(branch.fold_angles(0.0), np.zeros(6))
