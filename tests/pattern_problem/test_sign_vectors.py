"""Which signs can be beside the flat state: refuted ones against branch directions, and against states by chance."""

import itertools
from dataclasses import replace
from fractions import Fraction

import mpmath
import numpy as np
import pytest

from origami_nlp.pattern import as_pattern
from origami_nlp.pattern_problem import PatternProblem, PopSigns, SignConflict, VertexCones
from origami_nlp.pattern_states import list_branches
from origami_nlp.starts import Signed
from tests.patterns import wheel


def words(vertices):
    return map("".join, itertools.product("+-", repeat=vertices))


def refuted(name):
    """Conflicts of all combinations of signs that have one."""
    cones = VertexCones(as_pattern(name))
    return cones, {s: found for s in words(len(cones.vertices)) if (found := cones.conflict(s))}


@pytest.mark.parametrize(
    ("name", "many"),
    [("metasheet:3x3", 12), ("squaretwist", 2), ("yoshimura:3x3", 0), ("resch:1x2", 0)],
)
def test_how_many_are_refuted_and_none_of_them_is_a_branch_direction(name, many):
    pattern = as_pattern(name)
    cones, found = refuted(name)
    assert len(found) == many
    assert all(cones.refutes(why) for why in found.values())
    rows = PopSigns(pattern).rows
    for d in list_branches(pattern).lines:
        sums = rows @ d
        if np.abs(sums).min() > 1e-9:
            here = "".join("+" if s > 0 else "-" for s in sums)
            assert here not in found and here.translate(str.maketrans("+-", "-+")) not in found
            assert cones.direction(here) is not None


@pytest.mark.parametrize("name", ["metasheet:3x3", "squaretwist"])
def test_no_state_beside_the_flat_one_has_refuted_signs(name):
    """States by chance, closed by the package: the numbers of a conflict are positive where its signs are."""
    pattern = as_pattern(name)
    problem, signs, rng = PatternProblem(pattern), PopSigns(pattern), np.random.default_rng(0)
    _, found = refuted(name)
    rounds, held = {*found.values()}, 0
    seen = set()
    for _ in range(150):
        phi, residual = problem.project(rng.uniform(-0.03, 0.03, pattern.creases))
        if residual > 1e-12 or np.abs(phi).max() < 1e-4:
            continue
        seen.add(signs.of(phi))
        for why in rounds:
            z = dict(zip(why.creases, why.weights, strict=True))
            left = set()
            for v, sign in zip(why.vertices, why.signs, strict=True):
                around = signs.around[signs.vertices.index(v)]
                total = 0.0
                for k in around:
                    if k + 1 in z:
                        a, b = pattern.corners[pattern.ends[k]]
                        total += (
                            (-1 if k in left else 1) * z[k + 1] * phi[k] / np.linalg.norm(a - b)
                        )
                        left.add(k)
                if signs.of(phi)[signs.vertices.index(v)] == sign:
                    assert total > 0
                    held += 1
    assert held > 10 and not seen & set(found)


def test_wrong_numbers_refute_nothing():
    cones, found = refuted("metasheet:3x3")
    why = found["++-+"]
    assert cones.refutes(why)
    assert not cones.refutes(replace(why, weights=tuple(-w for w in why.weights)))
    assert not cones.refutes(replace(why, signs="++"))
    assert not cones.refutes(replace(why, creases=(1,) * len(why.creases)))
    assert not cones.refutes(SignConflict(why.vertices, why.signs, (), ()))
    rng = np.random.default_rng(0)
    free = VertexCones(as_pattern("yoshimura:3x3"))  # all its combinations occur
    inner = tuple(k + 1 for k in free._inner(range(4)))
    for signs in ("++++", "+--+", "+-+-"):
        for _ in range(30):
            weights = tuple(rng.normal(size=len(inner)).tolist())
            assert not free.refutes(SignConflict(free.vertices, signs, inner, weights))


def _cone_by_mpmath(sectors):
    """Eigenvalues of Q on what closes to first order, to 40 digits, and the sum on its positive direction."""
    with mpmath.workdps(40):
        at = [mpmath.fsum(sectors[:k]) for k in range(len(sectors))]
        u = mpmath.matrix([[mpmath.cos(a), mpmath.sin(a)] for a in at])
        q = mpmath.zeros(len(at))
        for i in range(len(at)):
            for j in range(i + 1, len(at)):
                q[i, j] = q[j, i] = mpmath.sin(at[j] - at[i]) / 2
        _, _, v = mpmath.svd_r(u.T, full_matrices=True)
        free = v[2:, :].T
        values, vectors = mpmath.eigsy(free.T * q * free)
        one = mpmath.matrix([1] * len(at))
        f = vectors.T * (free.T * one)
        return values, mpmath.fsum(f[k] ** 2 / values[k] for k in range(len(values)))


@pytest.mark.parametrize("degree", [4, 5, 6, 7, 8, 9])
def test_one_positive_direction_and_the_sum_is_of_its_kind(degree):
    """By 40 digits, of sectors by chance; the axes of the package give the same Q."""
    rng = np.random.default_rng(degree)
    for _ in range(12):
        sectors = rng.dirichlet(np.full(degree, 2.0)) * 2 * np.pi
        if sectors.max() > 3.0 or sectors.min() < 0.05:
            continue
        values, kind = _cone_by_mpmath(sectors.tolist())
        assert sum(x > 0 for x in values) == 1 and kind > 0
        (cone,) = VertexCones(wheel(sectors)).cones
        assert cone.axes is not None and cone.axes.shape == (degree - 2, degree)


def test_exact_arithmetic_of_one_vertex():
    """Round a cross the sum over lengths is positive on the half of +, a single crease is not."""
    (cone,) = VertexCones(wheel([np.pi / 2] * 4)).cones
    ones = {k: Fraction(1) for k in range(4)}
    assert cone.positive(ones, 1) and not cone.positive(ones, -1)
    assert not cone.positive({0: Fraction(1)}, 1) and not cone.positive({}, 1)


def test_starts_say_what_is_known():
    pattern = as_pattern("metasheet:3x3")
    problem = PatternProblem(pattern)
    from origami_nlp.pattern_problem import find_labels

    family = Signed(problem, find_labels(pattern), np.zeros((0, pattern.creases)))
    list(family.states())
    known = {v.signs: v for v in family.vectors}
    assert len(known) == 16 and known["++++"].verdict == "state"
    assert sum(v.verdict == "impossible" for v in family.vectors) == 12
    for v in family.vectors:
        if v.fold_angles:
            phi = np.array(v.fold_angles)
            assert PopSigns(pattern).of(phi) == v.signs
            assert problem.residual(phi) < 1e-12 and not problem.crossings.find(phi)
