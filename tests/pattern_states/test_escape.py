"""What it takes to leave a state: exact barriers against a dense scan, bounds never below them, a noisy waterbomb."""

import math

import numpy as np
import pytest

from origami_nlp import Scene, Vertex, examples, find_minima
from origami_nlp.escapes import ALONE, TRACED, Terrain, escape_paths
from origami_nlp.pattern_problem import pose
from origami_nlp.pattern_states.curves import TracedCurves
from origami_nlp.pattern_states.escape import with_escapes
from tests.independent.rotations import fold
from tests.kernels.answers import generic


def escapes(scene, minima):
    """The minima with what it takes to leave them where no curve is known."""
    return with_escapes(TracedCurves(pose(scene).arranged()), minima, 1e9)


def four(seed, contact="fold-limits"):
    """A random vertex of degree 4."""
    rng = np.random.default_rng(seed)
    sectors = np.zeros(1)
    while not (sectors.max() < 0.9 * math.pi and sectors.min() > 0.2):
        sectors = rng.dirichlet(np.full(4, 4.0)) * 2 * math.pi
    k, rest = 10 ** rng.uniform(-1, 1, 4), rng.uniform(-2.5, 2.5, 4)
    return Scene(Vertex(tuple(sectors)), tuple(k), tuple(rest), "none", contact)


def scanned(scene, x, spacing=1e-2):
    """Energies along the curve through a state, both ways to a fold limit, in steps that least squares closes."""
    sectors, k, rest = (
        np.array(v) for v in (scene.vertex.sector_angles, scene.stiffness, scene.rest_angles)
    )

    def misses(phi):
        r = fold(sectors, phi)[1][0]
        return np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])

    def jacobian(phi):
        h = 1e-6
        unit = np.eye(len(phi)) * h
        return np.array([(misses(phi + e) - misses(phi - e)) / (2 * h) for e in unit]).T

    out = []
    for sign in (1.0, -1.0):
        phi, d = x.copy(), sign * np.linalg.svd(jacobian(x))[2][-1]
        energies = [0.5 * float(k @ (phi - rest) ** 2)]
        while np.abs(phi).max() < math.pi and len(energies) < 20_000:
            new = phi + spacing * d
            for _ in range(3):
                new = new - np.linalg.lstsq(jacobian(new), misses(new), rcond=1e-6)[0]
            t = np.linalg.svd(jacobian(new))[2][-1]
            d, phi = t * (1.0 if t @ d > 0 else -1.0), new
            energies.append(0.5 * float(k @ (phi - rest) ** 2))
        out.append(np.array(energies))
    return out


def climb(energies):
    """What a way climbs before it is lower than where it began; inf where it never is."""
    below = np.flatnonzero(energies < energies[0] - 1e-9)
    return float(energies[: below[0]].max() - energies[0]) if len(below) else math.inf


@pytest.mark.parametrize("seed", [0])
def test_traced_barriers_are_those_of_a_dense_scan(seed):
    """Crossings are jumped straight over by the scan; other branches there can only be lower."""
    scene = four(seed)
    result = find_minima(scene, prove=False)
    assert all(m.escape.method in (TRACED, ALONE) for m in result.minima)
    flat = 0.5 * float(np.array(scene.stiffness) @ np.array(scene.rest_angles) ** 2)
    higher = [m for m in result.minima[1:] if m.escape.known and m.kind == "interior"]
    for m in higher:
        ways = [climb(e) for e in scanned(scene, np.array(m.fold_angles))]
        assert m.escape.barrier <= min(ways) * (1 + 1e-3) + 1e-9
        # the flat state joins all branches: where the way is lower than that, no other is lower still
        if min(ways) < flat - m.energy:
            assert m.escape.barrier == pytest.approx(min(ways), rel=1e-3)
    assert result.minima[0].escape.barrier > 0


@pytest.mark.parametrize("seed", [0, 1])
def test_bounds_from_descents_are_never_below_exact_barriers(seed):
    scene = four(seed, ("full", "fold-limits")[seed % 2])
    result = find_minima(scene, prove=False)
    bounds = escapes(scene, result.minima)
    for m, bound in zip(result.minima, bounds, strict=True):
        assert bound.escape.method != TRACED
        if m.escape.known and bound.escape.known:
            assert bound.escape.barrier >= m.escape.barrier * (1 - 1e-9)


def terrain_of(scene, minima):
    """States of a scene with descents between them."""
    problem = pose(scene)
    states = np.array([problem.reduce(np.array(m.fold_angles)) for m in minima])
    return Terrain(problem, states)


def test_each_escape_path_is_one_state_by_state():
    """By matrices of its own, energies by their definition: it climbs no higher than is said, and ends lower."""
    scene = generic(5, 1, "fold-limits")
    result = find_minima(scene, prove=False, escape=False)
    some = [m for m in result.minima if m.local_dimension != 0][:8]
    x, terrain = np.array([m.fold_angles for m in some]), terrain_of(scene, some)
    k, rest = np.array(scene.stiffness), np.array(scene.rest_angles)
    found = escape_paths(terrain, range(len(x)))
    assert len(found) >= 6
    for number, way in found.items():
        path = terrain.problem.expand(way.states)
        energies = 0.5 * ((path - rest) ** 2 @ k)
        here = 0.5 * float(k @ (x[number] - rest) ** 2)
        assert np.abs(path[0] - x[number]).max() < 1e-8
        assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() <= 0.1 + 1e-9
        _, products = fold(scene.vertex.sector_angles, path)
        assert np.abs(products - np.eye(3)).max() < 1e-9
        assert np.abs(path).max() <= math.pi + 1e-12
        assert energies.max() - here <= way.height * (1 + 1e-12)
        assert energies[-1] < here or (number == 0 and way.to > 0)


def test_isolated_flat_foldings_are_known_as_such():
    result = find_minima(examples.degree6("pi/4", ratio=1, contact="fold-limits"), prove=False)
    alone = [m for m in result.minima if m.local_dimension == 0]
    assert len(alone) == 10 and all(m.escape.method == ALONE for m in alone)
    assert len(result.to_dict()["minima"]) == 12
