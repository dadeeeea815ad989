"""All minima of meshes that need not fold flat: against scans that place directions, searches and the check."""

import math
from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import make_pattern
from origami_nlp.proof import certify, check_proof, why_no_sheet
from tests.computed_once import prove_sheet
from tests.independent.quad_scan import scan
from tests.independent.rigid import Rigid


def quads(seed, columns=3, rows=3):
    """Quadrangles whose corners are anywhere, with springs over two decades that rest anywhere."""
    rng = np.random.default_rng(seed)
    at = [
        (i + rng.uniform(-0.25, 0.25), j + rng.uniform(-0.25, 0.25))
        for i in range(columns + 1)
        for j in range(rows + 1)
    ]
    n = rows + 1
    faces = [
        (i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1)
        for i in range(columns)
        for j in range(rows)
    ]
    sheet = make_pattern(at, faces)
    return sheet.with_springs(
        stiffness=10 ** rng.uniform(-1, 1, sheet.creases),
        rest_angles=rng.uniform(-3, 3, sheet.creases),
    )


def half_turns(seed):
    """Nine half-turns of one quadrangle, with springs that rest anywhere."""
    rng = np.random.default_rng(seed)
    sheet = o.examples.pattern("metasheet", 3, 3)
    return sheet.with_springs(
        stiffness=10 ** rng.uniform(-1, 1, sheet.creases),
        rest_angles=rng.uniform(-3, 3, sheet.creases),
    )


def proved(make, seed):
    """A sheet, and its proof."""
    sheet = make(seed)
    return sheet, prove_sheet(sheet, boxes=30_000)


def rigid_states(pattern, steps):
    """Where loops of the scan close between others that do not, both of two mirror images [2 m, n]."""
    theta = np.linspace(0.01, 0.5 * math.pi - 1e-6, steps)
    found = []
    for folds, off in scan(pattern, theta):
        a, b = off[:-1], off[1:]
        with np.errstate(invalid="ignore"):
            turns = (a * b < 0) & (np.abs(a - b) < 1)
        for k in np.flatnonzero(turns):
            share = a[k] / (a[k] - b[k])
            found.append(folds[:, k] + share * (folds[:, k + 1] - folds[:, k]))
    return np.array([s * phi for phi in found for s in (1, -1)])


def same_states(one, two, within):
    """Whether two lists are the same, each state beside one of the other."""
    if len(one) != len(two) or not len(one):
        return len(one) == len(two)
    far = np.abs(np.array(one)[:, None] - np.array(two)[None]).max(axis=2)
    return far.min(axis=0).max() < within and far.min(axis=1).max() < within


@pytest.mark.parametrize(
    "seed",
    [
        28,  # this state is near a fold limit: values beyond it must say nothing of states before it
        *(pytest.param(s, marks=pytest.mark.slow) for s in range(41) if s != 28),
    ],
)
def test_generic_meshes_have_flat_and_rigid_states_alone(seed):
    sheet, proof = proved(quads, seed)
    assert "0 curves" in proof.over and not proof.undecided and all(r.alone for r in proof.regions)
    (flat,) = proof.minima
    beside = [0.5 * (r.lower + r.upper) for r in proof.regions]
    assert not flat.fold_angles.any()
    assert all(np.ptp([r.lower, r.upper], axis=0).max() < 1e-6 for r in proof.regions)
    rigid = Rigid(sheet)
    assert all(np.abs(rigid.open(x)).max() < 1e-6 for x in beside)
    assert same_states(beside, rigid_states(sheet, 60_000 if seed == 37 else 6_000), 1e-3)
    assert not check_proof(certify(sheet, 30_000)).refused


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(s, marks=pytest.mark.slow) for s in range(1, 21))]
)
def test_half_turns_of_a_quadrangle_have_two_curves(seed):
    sheet, proof = proved(half_turns, seed)
    assert "2 curves" in proof.over and not proof.regions
    theta = np.linspace(1e-4, 0.5 * math.pi - 1e-9, 8_000)
    energies = []
    for half, off in scan(sheet, theta):
        inside = ~np.isnan(off)
        if not inside.any() or np.abs(off[inside]).max() > 1e-7:
            continue
        half = half[:, inside]
        folds = np.concatenate([-half[:, ::-1], half], axis=1)
        total = 0.5 * sheet.stiffness @ (folds - sheet.rest[:, None]) ** 2
        wall = np.r_[np.inf, total, np.inf]
        energies += total[(wall[1:-1] < wall[:-2]) & (wall[1:-1] < wall[2:])].tolist()
    listed = sorted(sheet.energy(m.fold_angles) for m in proof.minima)
    assert np.allclose(listed, sorted(energies), rtol=1e-4)
    assert not check_proof(certify(sheet, 30_000)).refused


@pytest.mark.parametrize(
    "sheet",
    [o.examples.pattern("metasheet", 3, 3), pytest.param(quads(28), marks=pytest.mark.slow)],
)
def test_a_search_says_that_its_list_is_proved(sheet):
    result = o.find_minima(sheet, contact="fold-limits", escape=False)
    assert result.completeness.status == "proved", result.completeness.reason
    assert len(result.minima) == 3


def test_a_stop_that_excludes_the_flat_state_excludes_it():
    """It was listed outside its limits, with nothing open: sheets with stops are no longer proved."""
    sheet = quads(0)
    free = ((-math.pi, math.pi),) * sheet.creases
    held = replace(sheet, limits=(*free[:2], (0.3, math.pi), *free[3:]))
    assert "stops" in why_no_sheet(held)
    found = o.find_minima(held, contact="fold-limits", prove=True, starts=4, escape=False)
    assert found.completeness.status == "not-proved"
    assert all(m.fold_angles[2] >= 0.3 - 1e-9 for m in found.minima)
