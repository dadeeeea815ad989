"""Crossings of many states, the rows that undo them, stacks and tips, against tests that share no code with them."""

import math

import numpy as np

from origami_nlp import Vertex, check_admissible
from origami_nlp.folding import (
    find_crossings,
    pair_depths,
    pair_rows,
    row_values,
    stack_depths,
    stack_rule,
    tip_depths,
)
from tests.independent.arcs import corner_determinants, crossing_margin, facet_pairs
from tests.independent.neighbours import Problem
from tests.independent.rotations import fold, project, spin_sign


def problem(rng, n):
    while True:
        a = rng.dirichlet(np.full(n, 3.0)) * 2 * math.pi
        if 0.1 < a.min() and a.max() < 3:
            a = np.array(Vertex(tuple(a.tolist())).sector_angles)
            return Problem(a, np.arange(n), np.ones(n), np.zeros(n), "full")


def closed_states(rng, p, count, at_limit=None):
    """Closed states within +-pi, with the creases of `at_limit` [count, n] held at +-pi."""
    x = rng.uniform(-math.pi, math.pi, (count, p.size))
    at_limit = np.zeros(x.shape, int) if at_limit is None else at_limit
    x = np.where(at_limit, at_limit * math.pi, x)
    x, residual = project(p.sectors, p.orbit, x, held=at_limit != 0)
    good = (residual <= 1e-13) & (np.abs(x) <= math.pi).all(axis=1)
    good &= spin_sign(p.sectors, x) > 0
    return x[good], at_limit[good]


def test_depths_are_those_of_the_pairs():
    rng = np.random.default_rng(1)
    for n in range(4, 10):
        p = problem(rng, n)
        rays, _ = fold(p.sectors, closed_states(rng, p, 60)[0])
        pairs = facet_pairs(n)
        found = find_crossings(rays, pairs)
        assert np.abs(found.depth - pair_depths(rays, pairs)).max() < 1e-14
        assert np.abs(found.depth.max(axis=1) - np.maximum(crossing_margin(rays), 0)).max() < 1e-14
        assert (found.depth > 0).any() == (n > 4) and (found.depth == 0).any()
        d = corner_determinants(rays)
        k, j = np.moveaxis(found.row, -1, 0)
        named = k >= 0
        state = np.broadcast_to(np.arange(len(rays))[:, None], k.shape)
        assert (
            np.abs(found.value[named] - d[state[named], j[named], k[named]]).max(initial=0) < 1e-14
        )
        assert (
            np.abs(row_values(rays, k % n, j % n)[named] - found.value[named]).max(initial=0)
            < 1e-14
        )
        assert named.all() == (n > 4)  # a vertex of degree 4 has fold limits only
        assert set(((k - j) % n)[named].tolist()) <= set(range(3, n - 1))


def test_names_of_the_ends_of_a_pair():
    assert pair_rows([(0, 2), (4, 1)], 5).tolist() == [
        [[2, 0], [3, 0], [0, 2], [1, 2]],
        [[1, 4], [2, 4], [4, 1], [0, 1]],
    ]


def test_the_row_of_a_stack_is_where_the_facet_turns():
    # at phi_e = 0 the row vanishes, with its ray on the arc; on the allowed side it has the sign of the fold
    rng = np.random.default_rng(4)
    checked = 0
    for n in range(5, 9):
        p = problem(rng, n)
        rule = stack_rule(p.sectors)
        for i in range(n):
            e, (k, j) = rule.end[i], rule.row[i]
            for side in (-1, 1):
                x = rng.uniform(-1, 1, (1, n))  # an open chain will do: rows are local
                x[0, i] = side * math.pi
                for turn, sign in ((0.0, 0), (-1e-3 * side, side), (1e-3 * side, -side)):
                    x[0, e] = turn
                    rays = chain(p.sectors, x[0], min(i, e) - 2)
                    a, b, c = rays[j], rays[(j + 1) % n], rays[k]
                    value = np.dot(np.cross(a, b), c)
                    if sign == 0:
                        assert abs(value) < 1e-12
                        normal = np.cross(a, b)
                        assert np.cross(a, c) @ normal > -1e-12
                        assert np.cross(c, b) @ normal > -1e-12
                    else:
                        assert np.sign(value) == sign
                    checked += 1
    assert checked == 6 * (5 + 6 + 7 + 8)


def chain(sectors, phi, first):
    """Rays from `first` on, by number mod N, of a polygon that need not close."""
    n = len(sectors)
    order = [(first + m) % n for m in range(n)]
    rays, _ = fold(sectors[order], phi[order][None])
    out = np.empty((n, 3))
    out[order] = rays[0]
    return out


def test_a_facet_that_reaches_through_where_its_tip_lies_has_no_order():
    # crease i closed, the crease at the tip flat: the next facet lies on the wider one, and the one after it may reach
    # through; what is flagged must be refused
    rng = np.random.default_rng(5)
    flagged = fine = seen = 0
    for n in (6, 7):
        for _ in range(24):
            p = problem(rng, n)
            rule = stack_rule(p.sectors)
            i = int(rng.integers(n))
            if rule.end[i] < 0:
                continue
            at_limit = np.zeros((60, n), int)
            others = [m for m in range(n) if m not in (i, rule.end[i])]
            at_limit[:, rng.choice(others, n - 5, replace=False)] = 1
            at_limit[:, i] = 1
            at_limit *= rng.choice([-1, 1], at_limit.shape)
            x = np.where(at_limit, at_limit * math.pi, rng.uniform(-3, 3, at_limit.shape))
            held = at_limit != 0
            x[:, rule.end[i]], held[:, rule.end[i]] = 0.0, True
            x, residual = project(p.sectors, p.orbit, x, held=held)
            good = (residual <= 1e-13) & (np.abs(x) <= math.pi).all(axis=1)
            good &= spin_sign(p.sectors, x) > 0
            x, at_limit = x[good], at_limit[good]
            rays, _ = fold(p.sectors, x)
            good = find_crossings(rays, facet_pairs(n)).depth.max(axis=1, initial=0) <= 1e-12
            good &= stack_depths(rule, x, at_limit).max(axis=1, initial=0) <= 1e-12
            x, at_limit, rays = x[good], at_limit[good], rays[good]
            touches = np.concatenate([np.tile(rule.row[i], (len(x), 1)), at_limit[:, [i]]], axis=1)
            deep = tip_depths(rays, touches[:, None])[:, 0] > 1e-9
            vertex = Vertex(tuple(p.sectors.tolist()))
            verdict = np.array([check_admissible(vertex, state).admissible for state in x], bool)
            assert not verdict[deep].any()
            flagged, fine, seen = (
                flagged + int(deep.sum()),
                fine + int(verdict.sum()),
                seen + len(x),
            )
            assert not tip_depths(rays, touches[:, None] * [1, 1, 0]).any()  # empty slots
    assert flagged > 10 and fine > 10
    assert fine + 2 * flagged > 0.9 * seen
