"""Sheets within 1e-13 to 1e-10 of one that folds flat.

A proof is of the special sheet and says how far it is, of the sheet as it stands, or refused by name; and two proofs of
one sheet do not contradict each other.
"""

import numpy as np
import pytest

import origami_nlp as o
from origami_nlp.pattern import make_pattern
from origami_nlp.proof import as_sheet, certify, check_proof, prove_sheet
from tests.folding_rows import folding_row


def moved(sheet, by):
    """A sheet with all corners moved in its plane by this much at most."""
    rng = np.random.default_rng(0)
    points = sheet.corners[:, :2] + by * rng.uniform(-1, 1, (len(sheet.corners), 2))
    return make_pattern(points, sheet.polygons).with_springs(
        stiffness=sheet.stiffness.tolist(), rest_angles=sheet.rest.tolist()
    )


@pytest.mark.parametrize("sheet", [o.examples.pattern("miura", 2, 3), folding_row(0)])
def test_to_rounding_it_is_the_special_sheet_and_says_how_far(sheet):
    near = moved(sheet, 1e-13)
    proof, meant = prove_sheet(near), prove_sheet(moved(sheet, 0.0))
    assert 1e-15 < as_sheet(near)[0].deviation < 1e-12 and not proof.undecided
    assert "as the file's are to" in proof.over
    one, two = (np.array([m.fold_angles for m in p.minima]) for p in (proof, meant))
    far = np.abs(one[:, None] - two[None]).max(axis=2)
    assert len(one) == len(two) and far.min(axis=0).max() < 1e-9
    assert not check_proof(certify(near, 10_000)).refused
