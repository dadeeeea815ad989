"""Where the regions of section 3.1 meet: the claims against states judged by the package."""

import numpy as np
import pytest
import sympy as sp
from origami_nlp.symbolic.catalogue import claim_by_id
from origami_nlp.symbolic.claims.section3_topology import derived_segments

from origami_nlp import examples
from origami_nlp.closed_forms import degree6
from origami_nlp.pattern_problem import check_admissible

PART = {"s3.flat-point": (1, 4), "s3.handle-joints": (1, 3), "s3.corner-points": (5, 12)}
VERTEX = {name: examples.degree6(f"{p}*pi/{q}").vertex for name, (p, q) in PART.items()}


def spread(phi_1, phi_2, phi_3, phi_4):
    """All six fold angles of a state with the mirror."""
    return np.array([phi_1, phi_2, phi_3, phi_4, phi_3, phi_2])


def test_two_regions_meet_in_a_point_at_pi_4_as_the_paper_says():
    verdict = claim_by_id("s3.flat-point").decide()
    assert verdict.verdict == "proved"
    assert "book fold" in verdict.remark  # the remark on the chart point stays


@pytest.mark.parametrize("claim_id", ["s3.handle-joints", "s3.corner-points"])
def test_other_joints_are_joints_of_the_picture_only(claim_id):
    verdict = claim_by_id(claim_id).decide()
    assert verdict.verdict == "convention" and verdict.corrected_proved
    assert "picture" in verdict.evidence


@pytest.mark.parametrize("claim_id", PART)
def test_the_book_fold_over_the_middle_lies_on_both_sides(claim_id):
    """The segment over the chart point (0, 0) is no joint: only t = 0 belongs to both regions."""
    for t in (1e-3, 0.5, 2.0, np.pi):
        for side in (1, -1):
            state = spread(side * t, 0, 0, side * t)
            assert check_admissible(VERTEX[claim_id], state).admissible
            assert np.sign(state.sum()) == side


def test_the_corners_hold_one_state_of_each_region_from_pi_3_on():
    pi = np.pi
    for claim_id, admissible in (
        ("s3.flat-point", False), ("s3.handle-joints", True), ("s3.corner-points", True)
    ):  # fmt: skip
        for side in (1, -1):
            for state in (spread(pi, -pi, pi, pi), spread(-pi, -pi, pi, -pi)):
                assert check_admissible(VERTEX[claim_id], side * state).admissible is admissible
    assert spread(pi, -pi, pi, pi).sum() > 0 > spread(-pi, -pi, pi, -pi).sum()


@pytest.mark.parametrize("points", [((1, 1),), ((-1, 1), (1, -1)), ((0, 0), (1, 1), (-1, -1))])
@pytest.mark.parametrize("part", [sp.Rational(1, 4), sp.Rational(1, 3), sp.Rational(5, 12)])
def test_any_other_set_of_joints_is_refuted(part, points):
    assert claim_by_id("s3.flat-point").decide((part, points)).verdict == "refuted"


def test_the_derived_handles_are_admissible_and_have_no_states_beside_them():
    vertex, pi = VERTEX["s3.handle-joints"], np.pi
    segments = derived_segments()
    assert len(segments) == 4
    for name, value, low, high in segments:
        for x in np.linspace(float(low), float(high), 7)[1:-1] * pi:
            closed, fan = int(value) * pi, -int(value) * pi - 2 * x
            beside = closed * (1 - 1e-4)
            if name == "phi_2":
                state, chart = spread(fan, closed, x, closed), (beside, x)
            else:
                state, chart = spread(closed, x, closed, fan), (x, beside)
            assert check_admissible(vertex, state).admissible
            point = degree6(pi / 3, pi / 3, *chart)
            assert not np.isfinite(point.value).all()  # no sheet of paper closes there
