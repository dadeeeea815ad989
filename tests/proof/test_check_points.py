"""Critical points of the check against 50 digits and finite differences along closed states."""

import itertools

import numpy as np
import pytest
from flint import arb, arb_mat, ctx

from origami_nlp.problem import Model
from origami_nlp.proof import prove
from origami_nlp.proof.check_points import CheckedStratum, Refused, negative
from origami_nlp.proof.check_wedges import piece_of
from tests.proof.balls import closed_states, holds, scene
from tests.proof.chains_mp import axes, mp, mpf, quaternion, unfolded
from tests.proof.slow_prover import proved
from tests.proof.wedges import WEDGES

CASES = [(4, 1), (4, 2), (4, 3), (4, 5)]


@pytest.fixture(autouse=True)
def _bits():
    with ctx.workprec(128):
        yield


def closed(sectors, tied, x, led):
    """Move some variables until the whole vertex closes, by Gauss and Newton with exact slopes."""
    x = list(x)
    for _ in range(9):
        angles = [x[v] for v in tied]
        _, v = quaternion(sectors, angles)
        if max(map(abs, v)) < mpf(10) ** -44:
            return x
        c = axes(sectors, angles)
        slopes = [
            [sum(c[i][r] / 2 for i, w in enumerate(tied) if w == j) for j in led] for r in range(3)
        ]
        for j, d in zip(led, mp.lu_solve(mp.matrix(slopes), mp.matrix(v)), strict=True):
            x[j] -= d
    raise AssertionError("does not close")


def energy(s, tied, x):
    """Of the whole vertex; springs as the piece states them."""
    of = {v: c for v, c in enumerate(r.crease for r in s.group.rays if r.crease is not None)}
    if s.group.is_trivial:
        of = {i: i for i in range(s.degree)}
    springs = ((s.stiffness[of[v]], s.rest_angles[of[v]], x[v]) for v in tied)
    return sum(mpf(k) / 2 * (a - mpf(r)) ** 2 for k, r, a in springs)


def led_of(sectors, tied, x, free, rank):
    """The variables whose slopes of closure span most."""
    c = axes(sectors, [x[v] for v in tied])

    def size(some):
        slopes = [
            [float(sum(c[i][r] for i, w in enumerate(tied) if w == j)) for j in some]
            for r in range(3)
        ]
        return np.linalg.svd(np.array(slopes), compute_uv=False)[-1]

    return max(itertools.combinations(free, rank), key=size)


def middle(ball):
    return mpf(ball.mid().str(45, radius=False))


def located(s, seed, count, pins):
    """Points that Newton's method reaches from random closed states, of a degree that is slow to prove."""
    starts = np.random.default_rng(seed).uniform(-2, 2, (count, s.degree))
    stratum = CheckedStratum(piece_of(s), pins)
    for x in closed_states(s, starts, pins):
        c = np.array([[float(v) for v in axes(s.vertex.sector_angles, x)[i]] for i in stratum.free])
        torque = [s.stiffness[i] * (x[i] - s.rest_angles[i]) for i in stratum.free]
        try:
            yield stratum, stratum.locate(x.tolist(), np.linalg.lstsq(c, torque)[0].tolist())
        except Refused:
            continue


def check_admissible(s, stratum, one):
    """Compare with differences of the energy along closed states of the whole vertex; return the index."""
    sectors, tied = unfolded(s)
    x = [mp.pi * q if q else middle(b) for q, b in zip(stratum.pins, one.x, strict=True)]
    led = led_of(sectors, tied, x, stratum.free, stratum.rank)
    x = closed(sectors, tied, x, led)  # this very vertex, of those meant
    assert all(holds(b, v) for b, v in zip(one.x, x, strict=True))
    h = mpf(10) ** -15
    base = energy(s, tied, x)
    assert abs(base - middle(one.energy)) < 1e-10 * (1 + abs(base))

    def moved(*steps):
        y = list(x)
        for i, d in steps:
            y[i] += d
        return energy(s, tied, closed(sectors, tied, y, led))

    others = [i for i in stratum.free if i not in led]
    for i in others:  # stationary: sectors are known to 1e-16, and so is the point
        assert abs(moved((i, h)) - moved((i, -h))) / (2 * h) < 1e-11
    for i, q in enumerate(stratum.pins):
        if q:
            slope = (moved((i, -q * h)) - base) / h  # into the box
            assert abs(slope) > 1e-10
            assert one.signs[i] == (-1 if slope > 0 else 1)

    def second(i, j):
        four = (moved((i, a * h), (j, b * h)) * a * b for a in (1, -1) for b in (1, -1))
        return float(sum(four) / (4 * h * h))

    hessian = np.array([[second(i, j) for j in others] for i in others])
    index = int((np.linalg.eigvalsh(hessian.reshape(len(others), -1)) < 0).sum()) if others else 0
    assert one.index == index
    pushes = all(t == -1 for t, q in zip(one.signs, stratum.pins, strict=True) if q)
    assert one.is_minimum == (index == 0 and pushes)
    return index


@pytest.mark.parametrize("case", CASES[1:3])
def test_points_signs_and_indices_agree_with_differences_of_the_energy(case):
    s, found = scene(*case), proved(*case).points
    assert len(found) > 3
    for p in found:
        stratum = CheckedStratum(piece_of(s), p.stratum)
        check_admissible(s, stratum, stratum.locate(p.x, p.moment))


@pytest.mark.slow
def test_indices_of_degree_6_agree_with_differences_of_the_energy():
    s, seen, indices = scene(6, 1), set(), []
    for pins in ((0,) * 6, (0, 1, 0, 0, 0, 0)):
        for stratum, one in located(s, 0, 100, pins):
            place = (pins, round(float(one.x[0].mid()), 6))
            if place not in seen and indices.count(one.index) < 2:
                seen.add(place)
                indices.append(check_admissible(s, stratum, one))
    assert len(set(indices)) > 1


@pytest.mark.parametrize("name", WEDGES)
def test_points_of_wedges_agree_with_differences_of_the_energy_of_the_whole_vertex(name):
    s, seen = WEDGES[name], set()
    for p in prove(Model(s)).points:
        if p.stratum in seen:
            continue
        stratum = CheckedStratum(piece_of(s), p.stratum)
        one = stratum.locate(p.x, p.moment)
        if 0 not in [t for t, q in zip(one.signs, p.stratum, strict=True) if q]:
            seen.add(p.stratum)
            check_admissible(s, stratum, one)
        if len(seen) == 4:
            return
    assert len(seen) > 1


def test_no_box_with_two_points_is_said_to_hold_one():
    tried = 0
    for case in CASES:
        points = proved(*case).points
        for p, q in itertools.combinations(points, 2):
            if p.stratum != q.stratum:
                continue
            tried += 1
            between = [0.5 * (a + b) for a, b in zip(p.x, q.x, strict=True)]
            reach = max(abs(a - b) for a, b in zip(p.x, q.x, strict=True)) / 2 + 1e-9
            stratum = CheckedStratum(piece_of(scene(*case)), p.stratum)
            for point, radius in ((p.x, 2.01 * reach), (between, reach)):
                try:
                    assert not stratum.alone(point, radius, [arb(m) for m in p.moment])
                except Refused:
                    pass
    assert tried > 2


def test_points_are_alone_near_themselves_and_there_are_none_elsewhere():
    s, p = scene(4, 1), proved(4, 1).points[0]
    stratum = CheckedStratum(piece_of(s), p.stratum)
    assert stratum.alone(p.x, 1e-6, [arb(m) for m in p.moment])
    off = [v if q else v + 0.5 for v, q in zip(p.x, p.stratum, strict=True)]
    try:
        far = stratum.locate(off, p.moment)
    except Refused:
        return
    assert any(
        all(
            holds(a, mpf(v)) or abs(float(a.mid()) - v) < 1e-9
            for a, v in zip(far.x, o.x, strict=True)
        )
        for o in proved(4, 1).points
    )


def test_the_moment_is_refused_where_axes_may_be_dependent():
    stratum = CheckedStratum(piece_of(scene(4, 1)), (0, 0, 0, 0))
    with pytest.raises(Refused, match="dependent"):
        stratum.moments([0.0] * 4, 1e-3, [arb(0)] * 3)


def test_moments_of_all_points_lie_in_the_bounds():
    for case in CASES:
        for p in proved(*case).points:
            stratum = CheckedStratum(piece_of(scene(*case)), p.stratum)
            bounds = stratum.moments(p.x, p.unique_radius, [arb(0.9 * m) for m in p.moment])
            assert all(b.contains(arb(m)) for b, m in zip(bounds, p.moment, strict=True))


def test_negative_eigenvalues_are_counted():
    rng = np.random.default_rng(0)
    for size in (1, 2, 3, 5):
        for _ in range(20):
            a = rng.integers(-3, 4, (size, size))
            a = a + a.T
            values = np.linalg.eigvalsh(a.astype(float))
            found = negative(arb_mat(a.tolist()))
            if abs(values).min() < 1e-9:
                assert found is None
            else:
                assert found == (values < 0).sum()
    assert negative(arb_mat([[0, 1], [1, 0]])) == 1
    assert negative(arb_mat([[arb(0, 1)]])) is None
