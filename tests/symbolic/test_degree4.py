"""The closed form of vertices of degree 4 against rotations multiplied in doubles, and against found states."""

import numpy as np
import pytest
import sympy as sp
from origami_nlp.symbolic.degree4 import half_tangent

from tests.independent.scan_four import closed_states
from tests.symbolic.closed_forms_reference import loop_quaternion

T = np.linspace(-1, 1, 11)
_Q, _E, _T = sp.symbols("q e t", positive=True)
TANGENTS = {
    (crease, mode): sp.lambdify((_Q, _E, _T), half_tangent(crease, _Q, _E, _T, mode))
    for crease in (1, 2, 3, 4)
    for mode in (1, 2)
}


def folds(sectors, mode, t):
    """Return fold angles [4, T] of a generic vertex."""
    for shift in range(4):
        a = np.roll(sectors, -shift)
        s = np.sin(a)
        q, p = s[0] * s[3] / (s[1] * s[2]), s[0] * s[1] / (s[2] * s[3])
        if q < 1 and p < 1:
            break
    e = np.exp(np.arctanh(np.sqrt(s[0] * s[2] / (s[1] * s[3]))))
    side = np.sign(np.sin(a[1] + a[2]))
    signs = (1, side, 1, -side) if mode == 1 else (-1, -side, 1, -side)
    tangents = [
        signs[i] * TANGENTS[i + 1, mode]((q, p)[i % 2], e, np.where(abs(t) == 1, t * (1 - 1e-9), t))
        for i in range(4)
    ]
    return np.roll(2 * np.arctan(tangents), shift, axis=0)


def product(sectors, phi):
    """The rotation of the whole loop as a quaternion [T, 4]."""
    azimuths = np.concatenate([[0], np.cumsum(sectors)[:-1]])
    return loop_quaternion(np.broadcast_to(azimuths, phi.T.shape), phi.T)


def random_sectors(rng):
    while True:
        a = rng.dirichlet((3, 3, 3, 3)) * 2 * np.pi
        pairs = abs(np.sin([a[0] + a[1], a[1] + a[2], a[0] + a[2]]))
        if a.max() < 3.0 and a.min() > 0.15 and pairs.min() > 0.02:
            return a


@pytest.mark.parametrize("mode", [1, 2])
def test_the_closed_form_closes_random_vertices_on_the_lift_of_the_sheet(mode):
    rng = np.random.default_rng(mode)
    worst = 0.0
    for _ in range(300):
        sectors = random_sectors(rng)
        quaternion = product(sectors, folds(sectors, mode, T))
        worst = max(worst, abs(quaternion - [1, 0, 0, 0]).max())
    assert worst < 1e-12  # 1 - q loses digits next to flat-foldable vertices


def test_the_two_modes_are_all_closed_states():
    """A scan by spherical triangles finds no state within the limits that is not on the two curves."""
    rng = np.random.default_rng(5)
    fine = np.sin(np.linspace(-np.pi / 2, np.pi / 2, 4001))
    for _ in range(4):
        sectors = random_sectors(rng)
        known = np.concatenate([folds(sectors, mode, fine) for mode in (1, 2)], axis=1).T
        scanned = closed_states(sectors, 201)
        lifted = product(sectors, scanned.T)[:, 0] > 0
        scanned = scanned[lifted]
        apart = [np.linalg.norm(known - state, axis=1).min() for state in scanned]
        assert max(apart) < 0.02
