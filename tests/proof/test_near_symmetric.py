"""Regular vertices, and vertices near them: proofs are true or refused, in bounded work, with full contact as well."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from origami_nlp import Scene, Vertex, find_minima
from origami_nlp.proof import ProofOptions
from tests.computed_once import thinned
from tests.independent.sheet import product_of_folds

pi = math.pi
APART = (0.0, 1e-3, 1e-6, 1e-10)


def near(degree, apart, seed, springs="random", contact="full"):
    """A vertex whose sectors are equal to `apart`, with random springs, or springs equal to as much."""
    rng = np.random.default_rng([28, degree, seed])
    k, rest = np.exp(rng.uniform(-1, 1, degree)), rng.uniform(-pi, pi, degree)
    if springs == "equal":
        k, rest = 1 + apart * k, rest[0] * (1 + apart * rest)
    sectors = 2 * pi / degree * (1 + apart * rng.uniform(-1, 1, degree))
    sectors[-1] = 2 * pi - sectors[:-1].sum()
    vertex = Vertex(tuple(sectors) if apart else (f"2 pi/{degree}",) * degree)
    return Scene(vertex, k, rest, "none", contact)


@cache
def proved(*scene):
    return find_minima(near(*scene), prove=True, escape=False)


def is_listed(result, angles):
    return any(np.abs(np.subtract(m.fold_angles, angles)).max() < 1e-6 for m in result.minima)


def check(scene, seeds):
    """Decided or refused with a reason, in bounded work; a list that is proved has all that other searches find."""
    result = proved(*scene)
    known = result.completeness
    assert known.boxes < 2_000_000
    assert known.status in ("proved", "proved-except-singular") or known.reason
    if known.status == "not-proved":
        return
    for seed in seeds:
        for m in find_minima(near(*scene), seed=seed, prove=False, escape=False).minima:
            assert is_listed(result, m.fold_angles), (scene, seed, m.energy)


@pytest.mark.parametrize("springs", thinned(["equal", "random"], 2))
def test_squares_and_a_hexagon(springs):
    for apart in APART:
        check((4, apart, 1, springs), seeds=(1,))
    check((6, 1e-3, 1, springs), seeds=())


def test_a_hexagon_nearly_regular_is_refused():
    """With every other crease fully folded the other three lie nearly on one line: nearly closed states fill a surface.

    The product of rotations shows it: to 1e-6 it closes wherever the three others sum to pi.
    """
    scene = near(6, 1e-6, 1, "random", "fold-limits")
    for a, b in np.random.default_rng(3).uniform(-1, 1, (20, 2)):
        turned = product_of_folds(scene.vertex.sector_angles, [pi, a, pi, b, pi, pi - a - b])
        assert np.abs(turned - np.eye(3)).max() < 1e-5
    options = ProofOptions(boxes=100_000)
    known = find_minima(scene, prove=options, max_starts=16, escape=False).completeness
    assert 100_000 <= known.boxes < 110_000 and known.status == "not-proved"
    assert "the number of boxes" in known.reason


@pytest.mark.slow
def test_a_pentagon_apart_from_the_regular_one_by_a_thousandth_is_proved():
    check((5, 1e-3, 0), seeds=())
    assert proved(5, 1e-3, 0).completeness.proved


@pytest.mark.slow
@pytest.mark.parametrize("contact", ["full", "fold-limits"])
@pytest.mark.parametrize("springs", ["random", "equal"])
@pytest.mark.parametrize("degree", [4, 5])
@pytest.mark.parametrize("apart", APART)
def test_proofs_near_regular_vertices_lack_nothing(degree, apart, springs, contact):
    for seed in range(2):
        check((degree, apart, seed, springs, contact), seeds=(1, 2))


def rays(sectors, phi):
    """Folded creases c_0 .. c_5 by rotation matrices, facet after facet; c_5 is c_0 where it closes."""
    frame, out = np.eye(3), []
    for turn, sector in zip([0.0, *phi[1:]], sectors, strict=True):
        frame = frame @ Rotation.from_euler("x", turn).as_matrix()
        out.append(frame[:, 0])
        frame = frame @ Rotation.from_euler("z", sector).as_matrix()
    return np.array(out), frame @ Rotation.from_euler("x", phi[0]).as_matrix()


@pytest.mark.parametrize("sectors", thinned(["two equal", "regular", "random"], 3))
def test_two_touches_of_rays_on_each_others_facets_hold_only_where_a_crease_is_shut_or_all_is_flat(
    sectors,
):
    """What the proof leaves out, by least squares from random states, with rotation matrices of its own."""
    rng = np.random.default_rng([5, len(sectors)])
    a = rng.dirichlet(np.full(5, 8.0)) * 2 * pi
    if sectors == "regular":
        a = np.full(5, 2 * pi / 5)
    if sectors == "two equal":
        a[:2] = a[:2].mean()
    assert a[0] + a[1] < pi

    def miss(phi):
        c, whole = rays(a, phi)
        touch = (np.linalg.det(c[[2, 3, 0]]), np.linalg.det(c[[4, 0, 2]]))
        return np.concatenate([(whole - np.eye(3)).ravel(), touch])

    kinds = set()
    for start in rng.uniform(-pi, pi, (25, 5)):
        found = least_squares(miss, start, xtol=1e-15, ftol=1e-15, gtol=1e-15, max_nfev=100)
        if np.abs(found.fun).max() > 1e-9:
            continue
        c, _ = rays(a, found.x)
        s = np.abs(np.sin(found.x / 2))  # 1 where a crease is fully folded
        straight = np.abs(np.sin(found.x)).max() < 1e-3
        if np.abs(c[0] - c[2]).max() < 1e-3:
            kinds.add("rays on each other")
            assert abs(a[0] - a[1]) < 1e-9
            assert s[1] > 1 - 1e-5
        else:
            kinds.add("flat" if s.max() < 1e-2 else "fully folded")
            assert np.abs(np.sin(found.x[[3, 4]])).max() < 1e-3
            assert straight or s[[3, 4]].max() > 1 - 1e-5
    assert ("rays on each other" in kinds) == (sectors != "random")
