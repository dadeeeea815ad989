"""No minimum missing, none extra: each panel against an independently written formulation.

Closed states come from spherical trigonometry over grids of every pair of fold angles, or at random;
each goes downhill through admissible states only, and must end at a minimum of the package's list;
every listed minimum must be reached.  Sets that exist only where creases are folded to exactly +-pi
are enumerated apart.  Nothing here shares code with the package's models, solvers or judges.
"""

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from tests.computed_once import panel_result, thinned
from tests.independent.neighbours import Problem
from tests.independent.rotations import project
from tests.independent.search_descent import descend, grid_minima, starts
from tests.independent.search_manifold import Piece
from tests.independent.search_stationary import named_ends
from tests.independent.search_thin import (
    flat_foldings,
    lowest_on_curves,
    truly_minimal,
)

SAME = 1e-4  # distance [rad] within which an end is a listed minimum
PANELS = pytest.mark.parametrize("scene", thinned(examples.panels(), 2), ids=lambda s: s.name)


def listed(scene):
    """Fold angles of the variables and local dimension of every minimum."""
    minima = panel_result(scene).minima
    size = Piece.of(scene).size
    return (
        np.array([m.fold_angles[:size] for m in minima]),
        np.array([m.local_dimension for m in minima]),
    )


def ends_of(piece, x):
    """Go down from x [B, n] and name the ends; what is left without a name goes down again."""
    ends, _ = descend(piece, x)
    named, _ = named_ends(piece, ends)
    for _ in range(4):
        lost = np.isnan(named[:, 0])
        if not lost.any():
            break
        ends[lost], _ = descend(piece, ends[lost])
        named[lost], _ = named_ends(piece, ends[lost])
    return ends, named


def compare(piece, begin, minima):
    """Check that every descent ends at a listed minimum, and that all of full dimension are reached."""
    states, dimensions = minima
    ends, named = ends_of(piece, begin)
    distance = np.abs(named[:, None] - states).max(axis=2)
    missing = ~(distance.min(axis=1) <= SAME)  # nan is missing too
    assert not missing.any(), (
        f"{missing.sum()} of {len(begin)} descents end elsewhere, the first at {ends[missing][0]}, "
        f"named {named[missing][0]}, energy {piece.energy(ends[missing][0]):.9g}"
    )
    reached = np.bincount(distance.argmin(axis=1), minlength=len(states))
    extra = (dimensions == 2) & (reached == 0)
    assert not extra.any(), f"listed, but reached by no descent: {states[extra]}"


@PANELS
def test_descents_from_every_chart_and_at_random_end_at_the_listed_minima(scene):
    piece = Piece.of(scene)
    rng = np.random.default_rng(20)
    begin = np.concatenate([grid_minima(piece, 41), starts(piece, 40, rng)])
    compare(piece, begin, listed(scene))


@pytest.mark.slow
@PANELS
def test_2000_random_descents_and_fine_grids_end_at_the_listed_minima(scene):
    piece = Piece.of(scene)
    rng = np.random.default_rng(21)
    begin = np.concatenate([grid_minima(piece, 201), starts(piece, 2000, rng)])
    compare(piece, begin, listed(scene))


@PANELS
def test_descents_from_around_each_minimum_return_to_it(scene):
    piece = Piece.of(scene)
    rng = np.random.default_rng(22)
    for state, dimension in zip(*listed(scene), strict=True):
        if dimension < 2:
            continue
        near, residual = piece.retract(state + rng.uniform(-0.03, 0.03, (60, piece.size)))
        near = near[(residual <= 1e-12) & (np.abs(near - state).max(axis=1) <= 0.1)]
        near = near[piece.admissible(near)]
        assert len(near) >= 5
        _, named = ends_of(piece, near[:20])
        assert np.abs(named - state).max() <= SAME


def _thin_sets_hold_nothing_else(scene, size):
    piece, problem = Piece.of(scene), Problem.of(scene)
    states, dimensions = listed(scene)
    candidates = np.concatenate([lowest_on_curves(piece, size), flat_foldings(piece)])
    minimal = truly_minimal(piece, problem, candidates, seed=23)
    distance = np.abs(minimal[:, None] - states).max(axis=2)
    missing = ~(distance.min(axis=1) <= SAME)
    assert not missing.any(), f"minima at phi = +-pi that are not listed: {minimal[missing]}"
    # a pinned or touching minimum of full dimension may lie on such a curve too
    for k in np.flatnonzero(dimensions < 2):
        found = len(minimal) > 0 and distance[:, k].min() <= SAME
        assert found, f"listed, but no symmetric set at phi = +-pi has this minimum: {states[k]}"


@pytest.mark.parametrize(
    "scene",
    thinned([examples.panels()[k] for k in (13, 4)], 2),
    ids=lambda s: s.name,  # all of them: slow
)
def test_sets_at_pi_hold_the_listed_minima_and_no_others(scene):
    _thin_sets_hold_nothing_else(scene, 16)


@pytest.mark.slow
@PANELS
def test_fine_sweeps_at_pi_hold_the_listed_minima_and_no_others(scene):
    _thin_sets_hold_nothing_else(scene, 180)


def test_the_state_that_one_seed_missed_is_a_minimum():
    """The example of docs/states.md: lower than its neighbours on the curve of closed states, by Gauss-Newton here."""
    sectors = (0.7784849122786709, 2.291547160916454, 1.0231515757129965, 2.1900016582714645)
    stiffness = (0.022816280794769387, 0.03205546964080397)
    stiffness += (0.04387824855836886, 0.0012500010060577914)
    rest = (-0.2369412983168271, 1.0889080776221243, 3.141592485901434, 3.1415921923256085)
    scene = Scene(Vertex(sectors), stiffness, rest, "none", "full")
    guess = np.radians([-39.56, 169.34, 37.27, 120.30])
    found = find_minima(scene, guesses=[guess], fewest_starts=1, max_starts=1).minima
    state = min(found, key=lambda m: np.abs(np.subtract(m.fold_angles, guess)).max())
    x = np.array(state.fold_angles)
    assert np.abs(x - guess).max() < 1e-3 and state.kind == "interior"
    for radius in (1e-3, 1e-2):
        for side in (1, -1):
            near = x + radius * side * np.array([0, 1, 0, 0])
            y, closure = project(np.array(sectors), np.arange(4), near, np.array([0, 1, 0, 0]))
            assert closure[0] < 1e-13 and scene.energy(y[0]) > state.energy
