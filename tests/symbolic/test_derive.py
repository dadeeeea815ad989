"""Derived closed forms against the full loop closure at 10,000 random points per family."""

import numpy as np
import pytest
import sympy as sp
from origami_nlp.symbolic.derive import (
    cyclic_form,
    dihedral_fold_form,
    dihedral_form,
    dihedral_inner_form,
    reflection_form,
)

from tests.computed_once import thinned
from tests.symbolic.closed_forms_reference import loop_quaternion

POINTS = 10_000
TOLERANCE = 1e-13
PI = np.pi


def product(azimuths, folds):
    """Scalar and vector part of the full vertex's quaternion, of arrays of shape (N, points)."""
    q = loop_quaternion(np.array(azimuths).T, np.array(folds).T).T
    return q[0], q[1:]


def wrap(angle):
    return (angle + PI) % (2 * PI) - PI


def mirror_vertex(azimuths, folds, last):
    """Azimuths and folds of the whole D_1 vertex from the half (first .. last crease at pi)."""
    a = [*azimuths, np.full_like(azimuths[0], PI), *(2 * PI - x for x in azimuths[:0:-1])]
    return a, [*folds, last, *folds[:0:-1]]


def dihedral_vertex(n, azimuths, folds):
    """Whole D_n vertex from one wedge, creases 1 .. k."""
    a, f = [], []
    for j in range(n):
        a += [2 * PI / n * j + x for x in azimuths[:-1]]
        a += [2 * PI / n * (j + 1) - x for x in azimuths[:0:-1]]
        f += [*folds[:-1], *folds[:0:-1]]
    return a, f


@pytest.mark.parametrize("inner", [1, 2, 3, 4])
def test_reflection_closes(inner):
    rng = np.random.default_rng(inner)
    azimuths = sp.symbols(f"theta_1:{inner + 1}")
    folds = sp.symbols(f"phi_1:{inner + 1}")
    form = reflection_form(azimuths, folds)
    f = sp.lambdify([*azimuths, *folds], [form.phi_first, form.phi_last, form.paper], cse=True)
    theta = np.sort(rng.uniform(0, PI, (inner, POINTS)), axis=0)
    phi = rng.uniform(-2 * PI, 2 * PI, (inner, POINTS))  # beyond the paper's [-pi, pi]
    first, last, paper = f(*theta, *phi)
    first, last = wrap(first), wrap(last)
    a, p = mirror_vertex([np.zeros(POINTS), *theta], [first, *phi], last)
    w, vector = product(a, p)
    assert np.abs(vector).max() < TOLERANCE
    clear = np.abs(paper) > 1e-9
    np.testing.assert_array_equal(np.sign(w)[clear], np.sign(paper)[clear])
    assert (paper > 0).any()
    assert (paper < 0).any() == (inner > 1)  # a mirror vertex of degree 4 never leaves q = +1


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(("n", "inner"), [(2, 1), (2, 2), (3, 1), (4, 0), (3, 0), (6, 0), (5, 1)])
def test_dihedral_closes_on_the_sheet_of_paper(n, inner, branch):
    rng = np.random.default_rng(10 * n + inner)
    azimuths, folds = sp.symbols(f"theta_1:{inner + 1}"), sp.symbols(f"phi_1:{inner + 1}")
    v, t = sp.symbols("upsilon t")
    form = dihedral_form(n, azimuths, folds, v)
    solve = sp.lambdify(
        [*azimuths, *folds, v],
        [form.equation.discriminant, form.equation.solution(branch)],
        cse=True,
    )
    last = sp.lambdify([*azimuths, *folds, v, t], form.last(sp.cos(t), sp.sin(t)), cse=True)
    fold_eq = dihedral_fold_form(n, azimuths, folds, t, "last")
    other = sp.lambdify([*azimuths, *folds, t], [fold_eq.A, fold_eq.B, fold_eq.C], cse=True)
    done, up, down = 0, 0, 0
    while done < POINTS:
        theta = np.sort(rng.uniform(0, PI / n, (inner, POINTS)), axis=0)
        phi = rng.uniform(-1.5 * PI, 1.5 * PI, (inner, POINTS))
        elevation = rng.uniform(-PI, PI, POINTS)  # beyond +-pi/2
        with np.errstate(invalid="ignore"):
            disc, half = solve(*theta, *phi, elevation)
        ok = disc >= 0
        theta, phi, elevation, half = theta[:, ok], phi[:, ok], elevation[ok], half[ok]
        sin_q, cos_q = last(*theta, *phi, elevation, half)
        np.testing.assert_allclose(sin_q**2 + cos_q**2, 1, atol=1e-11)
        q = np.arctan2(sin_q, cos_q)
        end = np.full_like(half, PI / n)
        a, p = dihedral_vertex(n, [np.zeros_like(half), *theta, end], [2 * half, *phi, 2 * q])
        w, vector = product(a, p)
        assert np.abs(vector).max() < TOLERANCE
        assert w.min() > 0  # q = +1, with no wrapping of the two mirror creases
        ca, cb, cc = other(*theta, *phi, 2 * half)
        assert np.abs(ca * np.cos(q) + cb * np.sin(q) - cc).max() < TOLERANCE
        done, up, down = done + half.size, up + (elevation > 0).sum(), down + (elevation < 0).sum()
    assert up > 0 and down > 0


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(
    ("n", "inner", "ends"), thinned([(2, 2, "ff"), (3, 2, "cf"), (2, 2, "cc"), (3, 3, "ff")], 2)
)
def test_dihedral_closes_with_mirrors_through_facets(n, inner, ends, branch):
    """Ends: c for a crease on the mirror, f for a facet (a mirror crease that never folds)."""
    rng = np.random.default_rng(1000 * n + inner)
    azimuths, folds = sp.symbols(f"theta_1:{inner + 1}"), sp.symbols(f"phi_1:{inner + 1}")
    first, last = sp.symbols("first last")
    unknown = inner - 1
    equation = dihedral_inner_form(n, azimuths, folds, first, last, unknown)
    f = sp.lambdify(
        [*azimuths, *folds[:-1], first, last], [equation.discriminant, equation.solution(branch)]
    )
    done = 0
    while done < POINTS:
        theta = np.sort(rng.uniform(0, PI / n, (inner, POINTS)), axis=0)
        phi = rng.uniform(-2 * PI, 2 * PI, (inner - 1, POINTS))
        mirror = [rng.uniform(-PI, PI, POINTS) * (end == "c") for end in ends]
        with np.errstate(invalid="ignore"):
            disc, solved = f(*theta, *phi, *mirror)
        ok = disc >= 0
        edge = np.full(ok.sum(), PI / n)
        a, p = dihedral_vertex(
            n,
            [np.zeros_like(edge), *theta[:, ok], edge],
            [mirror[0][ok], *phi[:, ok], solved[ok], mirror[1][ok]],
        )
        w, vector = product(a, p)
        assert np.abs(vector).max() < TOLERANCE
        assert w.min() > 0
        done += int(ok.sum())


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize(("n", "period", "unknown"), [(2, 3, 0), (3, 2, 1), (4, 3, 2)])
def test_cyclic_closes(n, period, unknown, branch):
    rng = np.random.default_rng(100 * n + period)
    azimuths, folds = sp.symbols(f"theta_1:{period + 1}"), sp.symbols(f"phi_1:{period + 1}")
    equation = cyclic_form(n, azimuths, folds, unknown)
    known = [f for i, f in enumerate(folds) if i != unknown]
    f = sp.lambdify(
        [*azimuths, *known], [equation.discriminant, equation.solution(branch)], cse=True
    )
    done = 0
    while done < POINTS:
        theta = np.sort(rng.uniform(0, 2 * PI / n, (period, POINTS)), axis=0)
        phi = rng.uniform(-2 * PI, 2 * PI, (period - 1, POINTS))
        with np.errstate(invalid="ignore"):
            disc, half = f(*theta, *phi)
        ok = disc >= 0
        p = list(phi[:, ok])
        p.insert(unknown, 2 * half[ok])
        a = [x + 2 * PI / n * j for j in range(n) for x in theta[:, ok]]
        w, vector = product(a, p * n)
        assert np.abs(vector).max() < TOLERANCE
        assert w.min() > 0
        done += int(ok.sum())


def test_wrong_input_is_refused():
    with pytest.raises(ValueError, match="2 inner creases but 1"):
        reflection_form([1, 2], [1])
    with pytest.raises(ValueError, match="first"):
        dihedral_fold_form(2, [1], [1], 1, "middle")
