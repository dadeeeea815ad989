"""Starts on touches: closed, touching from the side they say, uncrossed, on the stratum that they name, none missed."""

import collections
import itertools
import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, check_admissible
from origami_nlp.errors import SceneError
from origami_nlp.folding import find_crossings, fold_vertex
from origami_nlp.minima import count_strata
from origami_nlp.problem import Model
from origami_nlp.starts import close_pinched, contact_starts, list_strata, model_rows, model_strata
from tests.computed_once import thinned
from tests.independent.admissible import admissible
from tests.independent.arcs import corner_determinants
from tests.independent.neighbours import Problem
from tests.independent.rotations import fold, project, spin_sign
from tests.independent.stationary import Stratum, retract

FLAT = 2 * math.pi


def model_of(rng, n, total=FLAT):
    while True:
        a = rng.dirichlet(np.full(n, 3.0)) * total
        if 0.1 < a.min() and a.max() < 2.9:
            break
    vertex = Vertex(tuple(a.tolist()), flat=total == FLAT)
    return Model(Scene(vertex, (1.0,) * n, (0.5,) * n, symmetry="none", contact="full"))


CASES = [(n, total) for n in (5, 6, 7, 8, 9) for total in (FLAT, 5.0, 7.5)]


@pytest.fixture(
    scope="module",
    params=thinned([(case,) for case in CASES], 4),
    ids=lambda case: f"{case[0]}-{case[1]:.3g}",
)
def drawn(request):
    n, total = request.param
    rng = np.random.default_rng(int(100 * total) + n)
    for _ in range(20):  # in many vertices of degree 5 nothing can touch
        model = model_of(rng, n, total)
        starts = contact_starts(model, rng, 200)
        if len(starts):
            return model, starts
    raise AssertionError("no vertex with touches")


def test_starts_close_and_touch_by_an_independent_fold(drawn):
    model, starts = drawn
    creases, q = fold_vertex(model.scene.vertex, starts.x)
    assert np.abs(q - [1, 0, 0, 0]).max() < 2e-13
    sectors = np.array(model.scene.vertex.sector_angles)
    creases, turn = fold(sectors, starts.x)
    d = corner_determinants(creases)
    assert np.abs(turn - np.eye(3)).max() < 1e-12
    assert (np.abs(starts.x) <= math.pi).all()
    for s, rows in enumerate(starts.touches):
        for (k, j, side), gap in zip(rows, starts.gaps[s], strict=True):
            if side == 0:
                assert gap == -1 and (k, j) == (-1, -1)
                continue
            assert model.structure.gaps[gap].rays == (k, j)
            assert gap == min(i for i, g in enumerate(model.structure.gaps) if g.rays == (k, j))
            assert abs(d[s, j, k]) < 1e-13
            a, b, c = creases[s, j], creases[s, (j + 1) % model.size], creases[s, k]
            normal = np.cross(a, b)
            assert np.cross(a, c) @ normal > 0 and np.cross(c, b) @ normal > 0
            # both facets at the tip lie on the open side
            assert side * d[s, j, k - 1] > -1e-12
            assert side * d[s, j, (k + 1) % model.size] > -1e-12
    assert find_crossings(creases, model.structure.pairs).depth.max() <= 1e-12


def test_starts_are_on_the_stratum_that_they_name(drawn):
    _, starts = drawn
    for s, number in enumerate(starts.stratum):
        rows = [(int(k), int(j)) for k, j, side in starts.touches[s] if side]
        closed = np.flatnonzero(starts.act[s])
        assert (np.abs(starts.x[s, closed]) == math.pi).all()
        assert (np.sign(starts.x[s, closed]) == starts.act[s, closed]).all()
        assert number in starts.strata.numbers(rows, closed)
        assert len(rows) == starts.strata.touches[number]
        assert len(closed) == starts.strata.closed[number]
    assert (np.bincount(starts.stratum, minlength=len(starts.strata)) == starts.started).all()
    assert (starts.started <= 8 * starts.tried).all() and (starts.tried[starts.stratum] > 0).all()


def test_nearly_all_starts_are_admissible(drawn):
    model, starts = drawn
    good = np.array([check_admissible(model.scene.vertex, x).admissible for x in starts.x])
    assert good.mean() > 0.8
    flat = np.array([bool(starts.strata.find(int(r))[0].pinched[0].flat) for r in starts.stratum])
    at_limit = starts.act != 0
    deep = (at_limit & np.roll(at_limit, 1, axis=1)).any(
        axis=1
    )  # closed creases in a row: three layers at least
    assert good[~flat & ~deep].all()  # only stacks of more layers than the tests see are refused
    if model.scene.vertex.flat:
        own = admissible(np.array(model.scene.vertex.sector_angles), starts.x)
        assert (own == good).all()


def test_beside_a_touch_states_are_admissible_on_the_open_side_only():
    rng = np.random.default_rng(11)
    sides = collections.Counter()
    for n in (5, 6, 7):
        model = model_of(rng, n)
        sectors = np.array(model.scene.vertex.sector_angles)
        starts = contact_starts(model, rng, 60)
        free = (starts.act == 0).all(axis=1) & (starts.touches[:, 1, 2] == 0)
        for x, touch in zip(starts.x[free], starts.touches[free], strict=True):
            k, j, side = touch[0]
            y, residual = project(sectors, np.arange(n), x + 1e-5 * rng.normal(size=(20, n)))
            y = y[residual < 1e-14]
            creases, _ = fold(sectors, y)
            opening = side * corner_determinants(creases)[:, j, k]
            verdict = admissible(sectors, y)
            for o, v in zip(opening, verdict, strict=True):
                if abs(o) > 1e-8:
                    sides[o > 0, bool(v)] += 1
    assert sides[False, True] == 0  # never admissible on the closed side
    assert sides[True, True] > 0.98 * (sides[True, True] + sides[True, False]) > 100
    assert sides[False, False] > 100


@pytest.mark.slow
def test_every_admissible_touch_of_a_vertex_of_degree_5_and_6_is_a_pinch():
    # states on a determinant by Gauss-Newton from anywhere; where the ray lies on the arc and the state is admissible,
    # the pinch with the same position and free turns must have it among its solutions
    rng = np.random.default_rng(12)
    rebuilt = collections.Counter()
    for n in (5, 5, 5, 6):
        model = model_of(rng, n)
        sectors = np.array(model.scene.vertex.sector_angles)
        p = Problem(sectors, np.arange(n), np.ones(n), np.zeros(n), "full")
        strata, rows = model_strata(model), model_rows(model)
        for j in range(n):
            for k in ((j + step) % n for step in range(3, n - 1)):
                x, residual = retract(p, Stratum(gaps=((j, k),)), rng.uniform(-3, 3, (150, n)))
                x = x[(residual < 1e-13) & (np.abs(x) < math.pi).all(axis=1)]
                x = x[spin_sign(sectors, x) > 0]
                creases, _ = fold(sectors, x)
                a, b, c = creases[:, j], creases[:, (j + 1) % n], creases[:, k]
                normal = np.cross(a, b)
                on = (np.cross(a, c) * normal).sum(axis=1) > 1e-6
                on &= (np.cross(c, b) * normal).sum(axis=1) > 1e-6
                x, a, c, normal = x[on], a[on], c[on], normal[on]
                good = admissible(sectors, x) if len(x) else np.zeros(0, bool)
                if not good.any():
                    continue
                assert (k, j) in rows
                x, a, c = x[good], a[good], c[good]
                position = np.arctan2(np.linalg.norm(np.cross(a, c), axis=1), (a * c).sum(axis=1))
                (number,) = (
                    r for r in strata.numbers([(k, j)], []) if not strata.find(r)[0].pinched[0].flat
                )
                family, r = strata.find(number)
                turns = np.concatenate([x, np.zeros((len(x), 2))], axis=1)
                rank = np.concatenate([rng.random(x.shape), -np.ones((len(x), 2))], axis=1)
                y, sign, row = close_pinched(
                    sectors, family, np.full(len(x), r), position[:, None], turns, rank
                )
                assert (sign[:, 0] == -np.sign(y[:, k])).all()
                for s in range(len(x)):
                    assert np.abs(y[row == s] - x[s]).max(axis=1).min(initial=9) < 1e-7
                    rebuilt[n] += 1
    assert rebuilt[5] > 20 and rebuilt[6] > 20


def test_strata_are_started_in_turn():
    rng = np.random.default_rng(13)
    model = model_of(rng, 7)
    first = contact_starts(model, rng, 100)
    second = contact_starts(model, rng, 100, first)
    assert (second.tried >= first.tried).all() and second.tried.sum() > first.tried.sum()
    assert (second.started >= first.started).all()
    assert (second.started > 0).sum() > (first.started > 0).sum()
    counts, elsewhere = count_strata(second)
    assert elsewhere == 0
    assert sum(c.listed for c in counts) == len(np.unique(second.strata.label))
    for c in counts:
        assert 0 <= c.hit <= c.started <= c.tried <= c.listed
    rows = [(int(k), int(j)) for k, j, side in second.touches[0] if side]
    minimum = (rows, np.flatnonzero(second.act[0]))
    counts, elsewhere = count_strata(second, [minimum, minimum, ([(0, 1)], [])])
    assert sum(c.hit for c in counts) == 1 and elsewhere == 1
    (hit,) = (c for c in counts if c.hit)
    assert f"{hit.started} of {hit.listed} strata started" in hit.words


def test_same_seed_same_starts():
    model = model_of(np.random.default_rng(14), 6)
    one, two, other = (contact_starts(model, np.random.default_rng(seed), 50) for seed in (1, 1, 2))
    assert (one.x == two.x).all() and (one.stratum == two.stratum).all()
    assert one.x.shape != other.x.shape or (one.x != other.x).any()


def chord_pairs(n):
    """Pairs of chords from a corner m to a point j + f of a side that do not cross and leave three corners everywhere.

    A chord is a corner of the pieces on both sides of it.
    """
    chords = [(k % n, j, f) for j in range(n) for k in range(j + 3, j + n - 1) for f in (0.3, 0.7)]

    def after(chord):  # corners and side points from the side point up to the corner, both excluded
        k, j, f = chord
        return lambda at: 0 < (at - j - f) % n < (k - j - f) % n

    def corners(chord, first):  # of the piece after, or before, the chord
        inside, k = after(chord), chord[0]
        return 1 + sum(inside(m) == first for m in range(n) if m != k)

    found = set()
    for one, two in itertools.permutations(chords, 2):
        if one[1] != two[1] and (one[2], two[2]) != (0.3, 0.3):
            continue  # the order on a side matters only where both are on it
        if one[1] == two[1] and one[2] == two[2]:
            continue
        inside, also = after(one), after(two)
        first, second = inside(two[1] + two[2]), also(one[1] + one[2])
        if two[0] != one[0] and inside(two[0]) != first:
            continue
        outer = corners(one, not first), corners(two, not second)
        if min(*outer, n + 2 - sum(outer)) >= 3:
            found.add(frozenset((one, two)))
    return found


@pytest.mark.parametrize("n", [6, 7, 8, 9])
def test_two_touches_are_all_pairs_of_chords(n):
    rows = frozenset((k % n, j) for j in range(n) for k in range(j + 3, j + n - 1))
    strata = list_strata(tuple([FLAT / n] * n), rows)
    pairs = [w for f in strata.families for w in f.pinched if len(w.touches) == 2]
    for way in pairs:
        turns = [corner[0] for piece in way.pieces for corner in piece]
        assert len(set(turns)) == len(turns) == n + 2
        assert min(len(piece) for piece in way.pieces) >= 3
    expected = chord_pairs(n)
    assert len(pairs) == len(expected)
    named = collections.Counter(frozenset(w.touches) for w in pairs)
    assert named == collections.Counter(frozenset((k, j) for k, j, _ in c) for c in expected)


def test_a_scene_without_touches_has_no_starts_and_one_with_symmetry_is_refused():
    rng = np.random.default_rng(15)
    assert len(contact_starts(model_of(rng, 4), rng, 10)) == 0
    scene = Scene(Vertex(("pi/3",) * 6), (1.0,) * 6, (0.5,) * 6, symmetry="C2", contact="full")
    with pytest.raises(SceneError):
        contact_starts(Model(scene), rng, 10)
    limits = Scene(
        Vertex(("pi/3",) * 6), (1.0,) * 6, (0.5,) * 6, symmetry="none", contact="fold-limits"
    )
    assert len(contact_starts(Model(limits), rng, 10)) == 0
