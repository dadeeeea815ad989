"""A square twist drawn with noise is rigid: no state beside the flat one is listed, and the flat one is not lost.

By the ratios of fold angles at each vertex, from sector angles alone, no state is beside the flat one; closure misses
that by noise times the square of fold angles, which near the flat state is less than rounding.
"""

import dataclasses
import itertools
import json
import math

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.kkt import State, classify
from origami_nlp.pattern_problem import PatternProblem
from origami_nlp.pattern_states import judge
from tests.computed_once import thinned


def drawn(tmp_path, noise):
    """The sheet from a file with corners off by noise, over its size."""
    data = o.examples.crease_pattern("squaretwist")
    points = np.array(data["vertices_coords"], float)
    size = np.ptp(points, axis=0).max()
    points[:, :2] += noise * size * np.random.default_rng(0).normal(size=(len(points), 2))
    file = tmp_path / "noisy.fold"
    file.write_text(json.dumps({**data, "vertices_coords": points.tolist()}))
    return o.read_pattern(file)


def ratios(sheet, v, before, after):
    """Fold angles of one crease of a vertex over another's, on the two curves that leave the flat state there."""
    sides = {frozenset(side) for p in sheet.polygons for side in itertools.pairwise((*p, p[0]))}
    ends = {w for side in sides if v in side for w in side} - {v, before, after}
    u = sheet.corners[[before, after, *sorted(ends)], :2] - sheet.corners[v, :2]
    u /= np.linalg.norm(u, axis=1)[:, None]
    order = sorted(range(4), key=lambda i: math.atan2(u[i, 1], u[i, 0]))
    # to first order sum c_i u_i = 0; to second, over pairs of creases in their order, sum c_i c_j u_i x u_j = 0
    q = np.zeros((4, 4))
    for i, j in itertools.combinations(order, 2):
        q[i, j] = u[i, 0] * u[j, 1] - u[i, 1] * u[j, 0]
    a, b = np.linalg.svd(u.T)[2][2:]
    roots = np.roots([b @ q @ b, a @ q @ b + b @ q @ a, a @ q @ a]).real
    return [(a + t * b)[1] / (a + t * b)[0] for t in roots]


def misses(sheet):
    """By how much ratios of fold angles round the square miss 1, at best: 0 where curves leave the flat state."""
    inner = {loop.vertex for loop in sheet.vertices}
    (square,) = (list(p) for p in sheet.polygons if set(p) == inner)
    each = [ratios(sheet, v, square[k - 1], square[k - 3]) for k, v in enumerate(square)]
    return min(abs(math.prod(of) - 1) for of in itertools.product(*each))


@pytest.mark.parametrize("noise", thinned([1e-7, 3e-8, 1e-5], 3))
def test_only_the_flat_state_is_listed_or_it_is_undecided(tmp_path, noise):
    sheet = drawn(tmp_path, noise)
    assert misses(o.examples.pattern("squaretwist")) < 1e-14 < 1e-10 < misses(sheet)
    found = o.find_minima(sheet, starts=2, escape=False)
    assert not any(np.abs(s.phi).max() for s in found.minima)
    stated = (*found.minima, *found.search.undecided)
    assert any(np.abs(s.phi).max() == 0 for s in stated)
    # before, the flat state was refused for a lower one within rounding of closure
    flat = classify(State(PatternProblem(sheet), np.zeros(sheet.creases)))
    assert flat.verdict in ("minimum", "undecided") and flat.lower is None


def test_what_closes_to_rounding_beside_the_flat_state_is_undecided(tmp_path):
    """Along a curve of the sheet that was meant closure is met to 1e-12 as far as some 1e-3 rad."""
    meant = PatternProblem(o.examples.pattern("squaretwist"))
    (curve,) = (s for s in o.find_minima("squaretwist", starts=0, escape=False).minima[1:2])
    beside, _ = meant.project(curve.phi * 2e-3 / np.abs(curve.phi).max())
    sheet = drawn(tmp_path, 1e-6)
    problem = PatternProblem(sheet.with_springs(stiffness=1.0, rest_angles=beside.tolist()))
    phi, residual = problem.project(beside)
    assert residual < 1e-12 and np.abs(phi - beside).max() < 1e-5
    what = judge(problem.with_contact(False), phi)  # at rest, if it were a state
    assert (what.verdict, "exactly" in what.certificate) == ("undecided", True), what


def test_the_sheet_that_was_meant_keeps_its_states(tmp_path):
    assert len(o.find_minima(drawn(tmp_path, 1e-9), starts=2, escape=False).minima) == 8


def test_what_is_folded_flat_but_for_noise_is_undecided():
    """Noise of 1e-12: 180 degrees all round misses closure by more than rounding, angles 3e-6 off do not.

    A state is known to exist beside one where Newton's method converges: by Kantorovich's theorem where closure misses
    by less than the square of the smallest singular value, over twice the second derivatives.
    """
    meant = o.examples.pattern("squaretwist")
    points = meant.corners.copy()
    points[:, :2] += 1e-12 * np.random.default_rng(2).standard_normal((len(points), 2))
    sheet = dataclasses.replace(meant, corners=points)
    found = o.find_minima(sheet, contact="fold-limits", starts=0, escape=False)
    problem = PatternProblem(sheet)
    for s in found.minima:
        least = np.linalg.svd(problem.closure.jacobian(s.phi))[1].min()
        assert least < 1e-13 or s.closure_residual < least**2 / 4, (s.energy, least)
