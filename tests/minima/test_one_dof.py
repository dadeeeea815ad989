"""Scenes with one degree of freedom: the curves are all there, and no minimum on them is missed."""

import itertools
import math
import time

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.errors import OptionError
from origami_nlp.kkt import Solve, State, classify, polish
from origami_nlp.minima import trace
from origami_nlp.problem import Model
from tests.computed_once import thinned
from tests.independent.scenes import SHAPES, build

PI = math.pi
ONE = [s for s in SHAPES if Model(build(np.random.default_rng(0), s)).dof == 1]
PLANTED = Scene(
    Vertex((0.7784849122786709, 2.291547160916454, 1.0231515757129965, 2.1900016582714645)),
    (0.022816280794769387, 0.03205546964080397, 0.04387824855836886, 0.0012500010060577914),
    (-0.2369412983168271, 1.0889080776221243, 3.141592485901434, 3.1415921923256085),
    "none",
)
WAITUKAITIS = Scene(
    Vertex((1.34035, 1.72886, 1.73407, 2 * PI - 1.34035 - 1.72886 - 1.73407)),
    (0.91922, 0.024246, 0.028457, 2.42197),
    (-2.32067, 1.93939, 2.09308, 1.60176),
    "none",
)
SPECIAL = {
    "90 degrees": (PI / 2,) * 4,
    "90 degrees, nearly": (PI / 2 + 1e-4, PI / 2 - 2e-4, PI / 2, PI / 2 + 1e-4),
    "Miura": (1.0, PI - 1.0, PI - 1.0, 1.0),
    "flat-foldable": (0.7, 1.9, PI - 0.7, PI - 1.9),
    "flat-foldable, nearly": (0.7, 1.9, PI - 0.7 + 1e-5, PI - 1.9 - 1e-5),
    "collinear": (0.7, PI - 0.7, 1.2, PI - 1.2),
    "kite": (1.0, 1.0, PI - 1.0, PI - 1.0),
}


def decided(model, traced):
    """Minima among candidates, polished and classified: states [K, n]."""
    out = []
    for x, contacts, origin in zip(traced.states, traced.contacts, traced.origins, strict=True):
        exact = True
        if origin in ("stationary", "contact"):
            p = polish(model, Solve(x, "traced", 0, 0.0, np.zeros(model.size), None), contacts)
            x, exact = p.x, p.converged
        if classify(State(model, x), polished=exact).verdict == "minimum":
            out.append(x)
    return np.array(out).reshape(-1, model.size)


def test_a_contact_that_ends_a_curve_is_one_that_is_closed_there():
    """Its side too: on it the gap of the state beside is open."""
    sides = []
    for shape, seed in itertools.product(ONE, range(1)):
        model = Model(build(np.random.default_rng(seed), shape))
        traced = trace(model)
        for x, contacts, origin in zip(traced.states, traced.contacts, traced.origins, strict=True):
            if origin == "contact":
                closed = model.closed(x)
                rows = itertools.chain(closed.base, *(r for c in closed.branches for r in c))
                assert {*contacts} <= {*rows}
                sides += [c.side for c in contacts]
    assert {*sides} == {1, -1}


def nearest(x, states):
    return np.abs(states - x).max(axis=1).min(initial=np.inf)


def found_by_starts(scene, seeds=2, starts=64):
    model, out = Model(scene), []
    for seed in range(seeds):
        for m in find_minima(scene, seed=seed, starts=starts, prove=False, escape=False).minima:
            out.append(model.reduce(np.array(m.fold_angles)))
    return out


@pytest.mark.parametrize("contact", thinned(["full", "fold-limits"], 2))
@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in (1, 2, 3))])
@pytest.mark.parametrize("shape", thinned([(s,) for s in ONE], 3), ids=str)
def test_nothing_that_starts_find_is_missing(shape, seed, contact):
    scene = build(np.random.default_rng(seed), shape, contact, decades=1.0)
    model = Model(scene)
    traced = trace(model)
    assert traced.complete, traced.reason
    minima = decided(model, traced)
    for x in found_by_starts(scene, 1):
        assert nearest(x, minima) <= 1e-7


@pytest.mark.parametrize(
    "shape", thinned([(s,) for s in (ONE[0], ("C", 2, 2), ("D", 1, 1, (True, True)))], 3), ids=str
)
def test_nothing_is_missing_without_fold_limits(shape):
    scene = build(np.random.default_rng(5), shape, "none")
    model = Model(scene)
    traced = trace(model)
    minima = decided(model, traced)
    assert traced.complete
    for x in found_by_starts(scene, 1):
        assert nearest(x, minima) <= 1e-7


RESTS = [(PI / 2, 0, PI / 2, 0), (-1.0, 2.0, -3.0, 1.0), (1.0,) * 4]


@pytest.mark.parametrize(
    "rest", [RESTS[1], *(pytest.param(r, marks=pytest.mark.slow) for r in RESTS[::2])], ids=str
)
@pytest.mark.parametrize("name", thinned([*SPECIAL], 4))
def test_nothing_is_missing_where_curves_cross(name, rest):
    scene = Scene(Vertex(SPECIAL[name]), (1.0, 1.3, 0.7, 1.1), rest, "none")
    model = Model(scene)
    traced = trace(model)
    assert traced.complete, traced.reason
    minima = decided(model, traced)
    for x in found_by_starts(scene, 1):
        assert nearest(x, minima) <= 1e-7


def test_a_state_that_one_start_in_hundreds_finds():
    for contact in ("full", "fold-limits"):
        model = Model(
            Scene(PLANTED.vertex, PLANTED.stiffness, PLANTED.rest_angles, "none", contact)
        )
        minima = decided(model, trace(model))
        assert nearest(np.radians([-39.56, 169.34, 37.27, 120.3]), minima) < 1e-4


def test_five_states_of_a_degree_4_vertex():
    model = Model(WAITUKAITIS)
    energies = np.sort(model.energies(decided(model, trace(model))))
    assert energies == pytest.approx([1.75371, 1.88391, 1.89567, 3.85321, 13.7429], rel=2e-5)


def test_the_same_turned_over_and_renumbered():
    rng = np.random.default_rng(3)
    for _ in range(2):
        sectors = 0.3 + rng.dirichlet(np.full(4, 4.0)) * (2 * PI - 1.2)
        if sectors.max() > 3:
            continue
        k, rest = 10.0 ** rng.uniform(-1, 1, 4), rng.uniform(-PI, PI, 4)
        first = None
        for shift, sign in ((0, 1), (1, 1), (2, -1), (3, 1)):
            a, s, r = (np.roll(v, shift) for v in (sectors, k, sign * rest))
            model = Model(Scene(Vertex(tuple(a.tolist())), s, r, "none", "full"))
            x = sign * np.roll(decided(model, trace(model)), -shift, axis=1)
            first = x if first is None else first
            assert len(x) == len(first) and all(nearest(y, first) < 1e-8 for y in x)


def test_one_dof_is_counted_in_a_fifth_of_a_second():
    for scene in (PLANTED, WAITUKAITIS):
        model = Model(scene)
        trace(model)  # (compiled functions are made once)
        begin = time.process_time()
        trace(model)
        assert time.process_time() - begin < 2.0  # 0.05 on a quiet machine


def test_more_dof_is_refused():
    with pytest.raises(OptionError, match="2 degrees of freedom"):
        trace(Model(examples.degree6("pi/3", 1.0)))


def test_isolated_states_are_judged_where_they_are_found():
    """Where one facet reaches around by itself: Newton cannot resolve what is isolated, and nothing moves."""
    sectors = (1.2, 0.6, 0.2, 2.0)
    scene = Scene(
        Vertex(sectors, flat=False), (1, 2, 3, 4), (0.3, -0.4, 0.5, 0.6), "none", contact="none"
    )
    model = Model(scene)
    traced = trace(model)
    alone = traced.states[[origin == "crossing" for origin in traced.origins]]
    assert len(alone) == 18
    polished = [
        polish(model, Solve(x, "traced", 0, 0.0, np.zeros(4), None), ()).converged for x in alone
    ]
    assert not any(polished)
    result = find_minima(scene, prove=False, escape=False)
    others = (*result.search.undecided, *result.search.rejected)
    states = np.array([s.fold_angles for s in (*result.minima, *others)])
    assert all(nearest(x, states) == 0 for x in alone)
    assert not any("not polished" in s.reason for s in others)
    assert result.search.stopped_by == "complete" and len(result.minima) >= 12
