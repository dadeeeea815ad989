"""Claims of section 5 against independent numbers."""

from itertools import product

import numpy as np
import pytest
import sympy as sp
from origami_nlp.symbolic.catalogue import claim_by_id
from origami_nlp.symbolic.claims.section5 import stiff_even_minima
from origami_nlp.symbolic.left_out import LEFT_OUT

from origami_nlp.closed_forms import cone_contact_elevation, cone_fold_angles, cone_partial_angles


def test_left_out_statements_say_why():
    assert all(entry.where and entry.what and entry.why for entry in LEFT_OUT)


def _rest(degree, v0):
    """Corrected rest angles (odd, even): the waterbomb at elevation v0."""
    return 2 * cone_partial_angles(degree, v0).value[0], -2 * abs(v0)


def test_corrected_rest_state_is_on_the_waterbomb_branch_and_printed_is_not():
    degree, v0 = 8, -0.3
    alpha = 2 * np.pi / degree
    odd, even = _rest(degree, v0)
    state = cone_fold_angles(degree, v0, [1] * 4).value
    assert np.allclose(state[0::2], odd) and np.allclose(state[1::2], even)
    c, s = np.cos(v0), np.sin(alpha)
    printed = 2 * np.arccos(abs(c + s) / (1 + c * s))
    assert abs(printed - odd) > 0.1
    assert -2 * v0 > 0  # printed even rest angle: a valley, where mountains are meant


def _range(degree, flaps):
    """Elevations (low, high) at which neighbouring flaps of one kind touch, else +-pi/2."""
    alike = {f for before, f in zip((flaps[-1], *flaps[:-1]), flaps, strict=True) if before == f}
    contact, axis = cone_contact_elevation(degree), np.pi / 2
    return (-contact if 1 in alike else -axis, contact if -1 in alike else axis)


def _minima(degree, ratio, v0, depth=1e-3):
    """Branches with a minimum off the flat state, relative depth above the paper's threshold."""
    odd, even = _rest(degree, v0)
    flat = degree / 4 * (odd**2 + ratio * even**2)
    count = 0
    for flaps in product((1, -1), repeat=degree // 2):
        for end in _range(degree, flaps):
            v = end * np.concatenate([np.geomspace(1e-9, 1e-2, 400), np.linspace(1e-2, 1, 801)])
            f = cone_fold_angles(degree, v, flaps).value
            u = ((f[:, 0::2] - odd) ** 2).sum(axis=1) / 2
            u = u + ratio * ((f[:, 1::2] - even) ** 2).sum(axis=1) / 2
            lowest = np.argmin(u)
            count += 0 < lowest and flat - u[lowest] > depth * flat
    return count


@pytest.mark.parametrize("v0", [0.4, -0.4])
@pytest.mark.parametrize("degree", [8, 10])
def test_plateau_of_stable_states_at_large_stiffness_ratio(degree, v0):
    assert abs(v0) < cone_contact_elevation(degree)
    assert _minima(degree, 1e6, v0) == stiff_even_minima(degree // 2)


@pytest.mark.parametrize("depth", [0, 0.05])
@pytest.mark.parametrize("degree", [8, 10])
def test_the_plateau_depends_on_the_depth_threshold(degree, depth):
    threshold = sp.Rational(str(depth))
    assert _minima(degree, 1e5, -0.4, depth) == stiff_even_minima(degree // 2, threshold)


def test_printed_plateaus_without_a_threshold_are_false():
    for degree, printed, bare in ((8, 10, 16), (10, 42, 32)):
        claim = claim_by_id(f"s5.plateau-{degree}")
        assert "depth" in claim.title or "deeper" in claim.title
        assert "10^{-3}" in claim.statement_latex
        assert claim.decide((degree, printed, sp.Integer(0))).verdict == "refuted"
        assert claim.decide((degree, bare, sp.Integer(0))).verdict == "proved"


def test_a_depth_that_tends_to_the_threshold_is_left_undecided():
    """N = 10: three valleys of five flaps keep a minimum of relative depth 1/25 in the limit."""
    assert stiff_even_minima(5, sp.Rational(1, 25)) is None
    assert claim_by_id("s5.plateau-10").decide((10, 32, sp.Rational(1, 25))).verdict == "unproved"


def test_no_minimum_off_the_flat_state_without_rest_elevation():
    for ratio in (1e-2, 1.0, 1e2):
        for flaps in product((1, -1), repeat=3):
            for end in _range(6, flaps):
                v = end * np.linspace(0, 1, 201)
                f = cone_fold_angles(6, v, flaps).value
                u = (f[:, 0::2] ** 2).sum(axis=1) + ratio * (f[:, 1::2] ** 2).sum(axis=1)
                assert np.all(np.diff(u) > 0)


@pytest.mark.parametrize("degree", [6, 8, 10])
def test_half_branches_leave_the_flat_state_in_distinct_directions(degree):
    rays = set()
    for flaps in product((1, -1), repeat=degree // 2):
        for v in (1e-6, -1e-6):
            rays.add(tuple(np.round(cone_fold_angles(degree, v, flaps).value / abs(v), 4)))
    assert len(rays) == 2 ** (degree // 2 + 1)
