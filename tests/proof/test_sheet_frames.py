"""Proofs of sheets do not hang on labels, nor on where the sheet lies, how large it is or from where it is seen."""

from dataclasses import replace

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.proof import certify, check_proof, prove_sheet, why_no_contact, why_no_sheet
from tests.proof.test_quads import half_turns, quads
from tests.relabelled import relabelled

slow = pytest.mark.slow
WHY = why_no_sheet, why_no_contact


def same_list(proof, copy, creases, sign):
    """Whether all minima of a proof are those of the copy's, to their radii; and nothing else is said."""
    assert len(proof.minima) == len(copy.minima)
    assert proof.over.split(";")[0] == copy.over.split(";")[0]
    assert len(proof.regions) == len(copy.regions)
    left = list(copy.minima)
    for one in proof.minima:
        phi = sign * one.fold_angles[creases]
        off = [np.abs(phi - m.fold_angles).max() - m.radius - one.radius for m in left]
        assert min(off) < 1e-7
        del left[int(np.argmin(off))]


def strip():
    sheet = o.examples.pattern("metasheet", 2, 3)
    rng = np.random.default_rng(3)
    return sheet.with_springs(
        stiffness=10 ** rng.uniform(-1, 1, sheet.creases),
        rest_angles=rng.uniform(-3, 3, sheet.creases),
    )


CASES = [
    lambda: half_turns(1),
    lambda: quads(28),
    strip,
    lambda: o.examples.pattern("miura", 2, 3),
]


@pytest.mark.parametrize("case", [0, pytest.param(1, marks=slow), 2, 3])
@pytest.mark.parametrize(
    ("seed", "mirror", "over"),
    [
        pytest.param(0, False, True),
        pytest.param(1, True, False, marks=slow),
        pytest.param(2, True, True, marks=slow),
        pytest.param(3, False, False, marks=slow),
    ],
)
def test_labels_and_places_change_nothing(case, seed, mirror, over):
    sheet = CASES[case]()
    copy, creases, sign = relabelled(sheet, seed, mirror, over)
    assert np.ptp(copy.corners[:, 2]) > 0.1
    # corners have other numbers in reasons
    assert [bool(why(copy)) for why in WHY] == [bool(why(sheet)) for why in WHY]
    same_list(prove_sheet(sheet), prove_sheet(copy), creases, sign)
    assert not check_proof(certify(copy, 30_000)).refused


@pytest.mark.parametrize("scale", [1e-3, pytest.param(70.0, marks=slow)])
def test_shifted_and_scaled_sheets_have_the_same_minima(scale):
    sheet = half_turns(1)
    # above the plane z = 0, which is all that is shifted exactly
    copy = replace(sheet, corners=scale * sheet.corners + (0.0, 0.0, 3.0))
    same_list(prove_sheet(sheet), prove_sheet(copy), np.arange(sheet.creases), 1.0)
