"""States closed in closed form: they close, none is lost, and the corners of the state space are all listed."""

import itertools
import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex
from origami_nlp.kkt import project
from origami_nlp.numerics import OUTSIDE, ROUNDED
from origami_nlp.problem import CreaseChain, Model, close_by, vertices
from origami_nlp.starts import flat_foldings
from tests.computed_once import thinned
from tests.independent import rotations
from tests.independent.scenes import SHAPES, build

PI = math.pi
SHAPES = [*SHAPES, ("C", 1, 8), ("C", 1, 9)]
CROSS = (PI / 2,) * 4
MIURA = (1.0, PI - 1.0, PI - 1.0, 1.0)
SPECIAL = {
    "90 degrees": CROSS,
    "90 degrees, nearly": (PI / 2 + 3e-7, PI / 2 - 5e-7, PI / 2, PI / 2 + 2e-7),
    "Miura": MIURA,
    "flat-foldable": (0.7, 1.9, PI - 0.7, PI - 1.9),
    "collinear": (0.7, PI - 0.7, 1.2, PI - 1.2),
    "45 degrees": (PI / 4,) * 8,
    "60 degrees": (PI / 3,) * 6,
    "60 degrees, nearly": (*(PI / 3 + 1e-6 * np.array([1, -2, 3, 1, -4])), PI / 3 + 1e-6),
}
NOT_FLAT = {"cone": (0.9, 1.0, 1.1, 0.8, 1.2), "saddle": (1.5, 1.7, 1.9, 1.6, 1.4)}


def plain(sectors, contact="fold-limits", flat=True):
    n = len(sectors)
    vertex = Vertex(tuple(float(a) for a in sectors), flat=flat)
    return Model(Scene(vertex, (1.0,) * n, (0.0,) * n, "none", contact))


def random_subsets(rng, model, count):
    order = rng.permuted(np.tile(np.arange(model.size), (count, 1)), axis=1)
    return order[:, : model.equation_count]


def check_closed(model, states, given, solve):
    """States close by CasADi's closure, within limits, on the sheet, and keep what was given."""
    assert np.abs(model.closure(states)[0]).max(initial=0.0) <= ROUNDED
    assert model.lifts_to_one(states).all()
    assert (np.abs(states) <= model.bound + OUTSIDE).all()
    kept = np.ones(states.shape, dtype=bool)
    np.put_along_axis(kept, solve, False, axis=1)
    assert (states == given)[kept].all()


def completed(model, x, solve):
    """Both completions, and which exist."""
    return close_by(CreaseChain(model), model.has_limits, x, solve)[:2]


@pytest.mark.parametrize("contact", ["fold-limits", pytest.param("none", marks=pytest.mark.slow)])
@pytest.mark.parametrize("shape", thinned([(s,) for s in SHAPES], 3), ids=str)
def test_completed_states_close(shape, contact):
    rng = np.random.default_rng(1)
    model = Model(build(rng, shape, contact))
    if model.size < model.equation_count:
        return
    x = rng.uniform(-model.bound, model.bound, (2000, model.size))
    solve = random_subsets(rng, model, len(x))
    states, exists = completed(model, x, solve)
    assert exists.mean() > 0.1
    rows, _ = np.nonzero(exists)
    check_closed(model, states[exists], x[rows], solve[rows])
    one = tuple(solve[0].tolist())  # the same variables for all, in any order
    states, exists = completed(model, x, one)
    again, there = completed(model, x, np.tile(one[::-1], (len(x), 1)))
    assert (states[exists] == again[there]).all() and (exists == there).all()


@pytest.mark.parametrize("contact", ["fold-limits", "none"])
@pytest.mark.parametrize("shape", thinned([(s,) for s in SHAPES], 3), ids=str)
def test_every_closed_state_is_one_of_the_two_completions(shape, contact):
    rng = np.random.default_rng(2)
    model = Model(build(rng, shape, contact))
    if model.dof < 1:
        return
    x, residual = project(model, rng.uniform(-PI, PI, (400, model.size)))
    good = (residual <= ROUNDED) & (np.abs(x) <= PI).all(axis=1)
    x = x[good]
    x = x[model.lifts_to_one(x)]
    assert len(x) > 20
    solve = random_subsets(rng, model, len(x))
    given = x.copy()
    np.put_along_axis(given, solve, np.nan, axis=1)
    states, exists = completed(model, np.where(np.isnan(given), 9.0, given), solve)
    off = states - x[:, None]
    if not model.has_limits:  # principal angles: the same state after whole turns
        off -= 2 * PI * np.round(off / (2 * PI))
    off = np.where(exists, np.abs(off).max(axis=2), np.inf).min(axis=1)
    jacobian = np.take_along_axis(model.closure(x)[1], solve[:, None, :], axis=2)
    firm = np.linalg.svd(jacobian, compute_uv=False)[:, -1]
    # near a double root the residual of the projection is a distance of its square root
    assert (off * firm)[firm > 1e-3].max() <= 1e-12
    assert (off[firm > 1e-7] <= 1e-6).all()  # (creases on each other: a family)
    assert (firm > 1e-7).sum() > 20


@pytest.mark.parametrize("name", [*SPECIAL, *NOT_FLAT])
def test_special_vertices_and_states_beside_singular_ones(name):
    rng = np.random.default_rng(3)
    model = plain({**SPECIAL, **NOT_FLAT}[name], flat=name not in NOT_FLAT)
    x = rng.uniform(-PI, PI, (4000, model.size))
    kind = rng.integers(4, size=x.shape)
    beside = PI * np.round(x / PI) + 10.0 ** rng.uniform(-16, -3, x.shape) * rng.normal(
        size=x.shape
    )
    x = np.select([kind == 0, kind == 1, kind == 2], [0.0, np.copysign(PI, x), beside], x)
    x = np.clip(x, -PI, PI)
    solve = random_subsets(rng, model, len(x))
    states, exists = completed(model, x, solve)
    rows, _ = np.nonzero(exists)
    check_closed(model, states[exists], x[rows], solve[rows])
    turned, there = completed(model, -x, solve)  # the vertex turned over
    assert (there == exists[:, ::-1]).all()
    off = np.abs(turned + states[:, ::-1])[there]
    off = np.minimum(off, np.abs(2 * PI - off)).max(axis=1)  # (+pi and -pi where both close)
    jacobian = model.closure(turned[there])[1]
    jacobian = np.take_along_axis(jacobian, solve[np.nonzero(there)[0]][:, None, :], axis=2)
    assert (off * np.linalg.svd(jacobian, compute_uv=False)[:, -1]).max() <= 1e-12


def test_double_roots_are_found_from_both_sides():
    """Where the two completions meet, both close however near they are, and beyond none does."""
    model = plain((1.1, 1.9, 1.4, 2 * PI - 4.4), "none")
    solve = (0, 1, 3)
    drive = np.linspace(-PI, PI, 4001)

    def there(drive):
        x = np.zeros((len(drive), 4))
        x[:, 2] = drive
        states, exists = completed(model, x, solve)
        assert np.abs(model.closure(states[exists])[0]).max(initial=0.0) <= ROUNDED
        return states, exists.all(axis=1)

    _, ok = there(drive)
    ends = np.flatnonzero(ok[1:] != ok[:-1])
    assert len(ends) >= 2
    for k in ends:
        inside, outside = (drive[k], drive[k + 1]) if ok[k] else (drive[k + 1], drive[k])
        for _ in range(60):
            middle = 0.5 * (inside + outside)
            inside, outside = (
                (middle, outside) if there(np.array([middle]))[1][0] else (inside, middle)
            )
        way = 1.0 if ok[k + 1] else -1.0
        distance = 10.0 ** np.arange(-15.0, -5.0)
        states, exists = there(inside + way * distance)
        assert exists.all()
        apart = np.abs(np.angle(np.exp(1j * (states[:, 0] - states[:, 1])))).max(axis=1)
        grows = np.polyfit(np.log10(distance[3:]), np.log10(apart[3:]), 1)[0]
        assert abs(grows - 0.5) < 0.05  # as the square root of the distance
        assert not there(inside - way * distance[2:])[1].any()


def corners_by_newton(sectors, rng, numbers, tries):
    """Closed states at which creases, `numbers` of them, are not at +-pi and cannot move, by Newton with matrices."""
    n = len(sectors)
    found = [np.zeros((0, n))]
    for many in numbers:
        for free in itertools.combinations(range(n), many):
            held = ~np.isin(np.arange(n), free)
            signs = np.array(list(itertools.product((-PI, PI), repeat=n - many)))
            count = tries if many else 1
            x = rng.uniform(-PI, PI, (len(signs) * count, n))
            x[:, held] = np.repeat(signs, count, axis=0)
            x, residual = rotations.project(np.array(sectors), np.arange(n), x, held)
            good = (residual <= 1e-12) & (np.abs(x) <= PI).all(axis=1)
            good[good] = rotations.spin_sign(np.array(sectors), x[good]) > 0
            axes, _ = rotations.fold(np.array(sectors), x[good])
            spread = np.linalg.svd(axes[:, list(free)], compute_uv=False)
            found.append(x[good][(spread > 1e-5).all(axis=1)])
    return distinct_rows(np.concatenate(found))


def distinct_rows(x):
    kept = []
    for row in x:
        if all(np.abs(row - k).max() > 1e-6 for k in kept):
            kept.append(row)
    return np.array(kept)


@pytest.mark.parametrize("n", [4, 5, pytest.param(6, marks=pytest.mark.slow)])
def test_all_corners_are_listed(n):
    rng = np.random.default_rng(n)
    for _ in range(7 - n):
        while True:
            sectors = rng.dirichlet(np.full(n, 4.0)) * 2 * PI
            if sectors.max() < 2.5:
                break
        model = plain(sectors)
        listed = vertices(model, 10**6, rng)
        known = corners_by_newton(sectors, rng, (3,), 40)
        apart = np.abs(listed[:, None] - known[None]).max(axis=2)
        assert len(listed) == len(known) and (apart.min(axis=0) <= 1e-6).all()
        check_corners(model, listed)


@pytest.mark.parametrize("shape", thinned([(s,) for s in SHAPES if s[:2] != ("C", 1)], 3), ids=str)
def test_corners_of_symmetric_vertices_are_all_listed(shape):
    """Every state that Newton finds from random starts with all but m variables held at +-pi is listed."""
    rng = np.random.default_rng(6)
    model = Model(build(rng, shape, "fold-limits"))
    n, m = model.size, model.equation_count
    if n < m:
        return
    listed = vertices(model, 10**6, rng)
    for free in itertools.combinations(range(n), m):
        held = ~np.isin(np.arange(n), free)
        for signs in itertools.product((-PI, PI), repeat=n - m):
            x = rng.uniform(-PI, PI, (20, n))
            x[:, held] = signs
            x, residual = project(model, x, frozen=np.broadcast_to(held, x.shape))
            smallest = np.linalg.svd(model.closure(x)[1][:, :, ~held], compute_uv=False)[:, -1]
            inside = (np.abs(x) <= PI).all(axis=1)
            for state in x[(residual <= ROUNDED) & inside & (smallest > 1e-6)]:
                assert np.abs(listed - state).max(axis=1).min() <= 1e-6


def check_corners(model, x):
    assert np.abs(model.closure(x)[0]).max(initial=0.0) <= 2 * ROUNDED
    assert ((np.abs(x) == PI).sum(axis=1) >= model.dof).all()
    assert model.lifts_to_one(x).all()
    assert len(distinct_rows(x)) == len(x)
    for state in x:  # turned over
        assert np.abs(x + state).max(axis=1).min() <= 1e-9


@pytest.mark.parametrize("name", [name for name, a in SPECIAL.items() if "nearly" not in name])
def test_all_corners_of_special_vertices_are_listed(name):
    sectors, rng = SPECIAL[name], np.random.default_rng(0)
    model = plain(sectors)
    listed = vertices(model, 10**6, rng)
    check_corners(model, listed)
    if len(sectors) < 8:
        for state in corners_by_newton(sectors, rng, range(4), 8):
            assert np.abs(listed - state).max(axis=1).min() <= 1e-6
    for state in flat_foldings(model):
        free = np.abs(state) != PI
        columns = model.closure(state)[1][:, free]
        if not free.any() or (free.sum() <= 3 and np.linalg.svd(columns)[1].min() > 1e-6):
            assert np.abs(listed - state).max(axis=1).min() <= 1e-9


def test_a_sample_of_the_corners_is_the_same_turned_over():
    model = plain(np.array([0.5, 0.9, 0.7, 0.8, 1.1, 0.6, 0.9, 2 * PI - 5.5]))
    rng = np.random.default_rng(7)
    everything = vertices(model, 10**6, rng)
    sample = vertices(model, 400, rng)
    check_corners(model, sample)
    assert 0 < len(sample) < len(everything)
    assert (np.abs(everything[:, None] - sample).max(axis=2).min(axis=0) <= 1e-9).all()
    again = vertices(model, 400, np.random.default_rng(7))
    assert (again == vertices(model, 400, np.random.default_rng(7))).all()
    assert len(vertices(plain(CROSS, "none"), 1000, rng)) == 0
