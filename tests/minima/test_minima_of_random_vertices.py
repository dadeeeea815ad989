"""Random vertices: nothing crashes, and every minimum that is reported is one.

Random groups and mirrors (through creases and facets), stiffness ratios up to 1e4 and 1e-4, every
contact mode; and vertices of rational sector angles with folded rest angles, where layers stack.
"""

import math

import numpy as np
import pytest

from origami_nlp import find_minima
from origami_nlp.pattern_problem import pose
from tests.computed_once import thinned
from tests.independent.admissible import admissible
from tests.independent.neighbours import Problem, look_around
from tests.independent.pockets import look_along_contacts
from tests.independent.rotations import fold, project, spin_sign
from tests.independent.scenes import SHAPES, build, degree

RIGID = [("D", 1, 2, (False, False)), ("D", 2, 1, (False, False)), ("D", 3, 1, (False, False))]
"""As many equations as fold angles: only the flat state."""
MOVING = [s for s in SHAPES if s not in RIGID and degree(s) <= 9]
SMALL = np.array([1e-3, 1e-4])


def random_scene(seed):
    rng = np.random.default_rng(seed)
    contact = ("full", "full", "full", "fold-limits", "none")[rng.integers(5)]
    return build(rng, MOVING[seed % len(MOVING)], contact, decades=float(rng.choice([0.3, 1, 2])))


def check(scene, count, max_starts):
    """Check every minimum of a scene; returns how many there are."""
    result = find_minima(scene, max_starts=max_starts, prove=False, escape=False)
    p, rng = Problem.of(scene), np.random.default_rng(1)
    for m in result.minima:
        phi, x = np.array(m.fold_angles), p.reduce(m.fold_angles)
        assert (x[p.orbit] == phi).all()  # symmetric to the last bit
        assert math.isclose(m.energy, float(p.energy(x)), rel_tol=1e-12, abs_tol=1e-25)
        product = fold(p.sectors, phi)[1][0]
        # angles of many turns (contact "none") are known to eps times their size only
        rounding = 3e-14 + 4 * np.finfo(float).eps * np.abs(phi).sum()
        assert np.abs(product - np.eye(3)).max() <= rounding
        assert spin_sign(p.sectors, phi)[0] > 0
        assert admissible(p.sectors, phi, scene.contact)[0]
        assert m.kkt_residual <= 1e-12 or m.kind == "degenerate"
        around = look_around(p, x, count, rng)
        assert not len(around.lower), (scene, m, around)
        near = look_around(p, x, 60, rng, radii=SMALL)
        caught = 0
        if m.contacts and scene.contact == "full":
            caught, lower = look_along_contacts(p, x, 12, rng)
            assert not len(lower), (scene, m, lower)
        # only sets that keep facets touching may be missed by a look that keeps fold limits
        same = near.dimension == m.local_dimension
        assert same or (near.dimension < m.local_dimension and caught), (scene, m, near)
    return len(result.minima)


@pytest.mark.parametrize("seed", thinned(range(22), 8))
def test_every_minimum_of_a_random_vertex_is_one(seed):
    assert check(random_scene(seed), 200, 60)


@pytest.mark.parametrize("shape", RIGID, ids=str)
def test_a_vertex_too_stiff_for_its_symmetry_stays_flat(shape):
    for seed in range(1):
        scene = build(np.random.default_rng(seed), shape)
        assert pose(scene).dof == 0
        (flat,) = find_minima(scene, prove=False, escape=False).minima
        assert flat.local_dimension == 0 and not any(flat.fold_angles)
        # own look: from anywhere near, closure leads back to the flat state, or nowhere
        p, rng = Problem.of(scene), np.random.default_rng(seed)
        x, residual = project(p.sectors, p.orbit, rng.uniform(-0.5, 0.5, (40, p.size)), steps=400)
        closed = (residual <= 1e-13) & (np.abs(x) <= math.pi).all(axis=1)
        closed[closed] = admissible(p.sectors, x[closed][:, p.orbit])
        assert (np.abs(x[closed]) <= 1e-4).all()
