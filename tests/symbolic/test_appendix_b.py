"""Claims of appendix B against an independent projection of facets."""

import numpy as np
import pytest

from origami_nlp.closed_forms import cone_fold_angles, cone_partial_angles


def _facet_normal(degree, v):
    """Unit normal of facet 1 of the waterbomb folding, from F_1 = Q(e2, v) Q(e1, rho)."""
    rho = cone_partial_angles(degree, v).value[0]
    n = np.array([0.0, -np.sin(rho), np.cos(rho)])
    c, s = np.cos(v), np.sin(v)
    return np.array([c * n[0] + s * n[2], n[1], -s * n[0] + c * n[2]])


@pytest.mark.parametrize("v", [0.2, 0.9, -0.2])
@pytest.mark.parametrize("degree", [8, 12, 200])
def test_visible_area_is_the_cosine_of_the_half_fold_angle(degree, v):
    """Small patch of facet 1 at crease 1, projected along the cone's normal there."""
    cone = np.array([np.sin(v), 0.0, np.cos(v)])  # normal to c_1 = (cos v, 0, -sin v) and e2
    shrink = abs(_facet_normal(degree, v) @ cone)
    phi = cone_fold_angles(degree, v, [1] * (degree // 2)).value[0]
    assert shrink == pytest.approx(abs(np.cos(phi / 2)), rel=1e-12)
    assert abs(shrink - abs(np.sin(phi / 2))) > 1e-2 or abs(phi - np.pi / 2) < 0.1


def test_visible_fraction_tends_to_the_cosine_of_the_elevation():
    v = 0.7
    gaps = []
    for degree in (100, 200, 400):
        phi = cone_fold_angles(degree, v, [1] * (degree // 2)).value[0]
        gaps.append(abs(abs(np.cos(phi / 2)) - np.cos(v)))
    assert gaps[0] / gaps[1] == pytest.approx(2, rel=0.1)  # first order in 1/N
    assert gaps[1] / gaps[2] == pytest.approx(2, rel=0.1)
