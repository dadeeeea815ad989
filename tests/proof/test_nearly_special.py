"""Sheets within 1e-13 to 1e-10 of one that folds flat.

A proof is of the special sheet and says how far it is, of the sheet as it stands, or refused by name; and two proofs of
one sheet do not contradict each other.
"""

import numpy as np
import pytest
from origami_nlp.proof.check_lists import Refused
from origami_nlp.proof.check_mesh import MeshCheck

import origami_nlp as o
from origami_nlp.pattern import make_pattern
from origami_nlp.proof import (
    certificate_of_mesh,
    check_proof,
    prove_mesh,
)
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
    proof, meant = prove_mesh(near), prove_mesh(moved(sheet, 0.0))
    assert 1e-15 < proof.deviation < 1e-12 and not proof.undecided
    one, two = (np.array([m.fold_angles for m in p.minima]) for p in (proof, meant))
    far = np.abs(one[:, None] - two[None]).max(axis=2)
    assert len(one) == len(two) and far.min(axis=0).max() < 1e-9
    assert check_proof(certificate_of_mesh(near, proof)).lines[0].startswith("checked: complete")


class ShiftedCheck(MeshCheck):
    """A check whose statement is wrong: in states that move, by this much in the first fold."""

    by = 0.0

    def _closes(self, folds):
        first, *others = folds
        super()._closes([first + (self.by if first.rad() > 1e-13 else 0.0), *others])


@pytest.mark.parametrize(
    ("by", "verdict"),
    [(0.0, "closes"), (1e-12, "closes"), (4e-11, "open"), (1e-9, "refused"), (1e-7, "refused")],
)
def test_no_state_passes_that_closes_to_within_its_ball_alone(by, verdict):
    """Balls of products are up to 6.8e-11 wide here: a state off by less is not taken for one that closes."""
    near = moved(folding_row(0), 3e-13)
    check = ShiftedCheck(certificate_of_mesh(near, prove_mesh(near)), lambda done, total: None)
    check.by = by
    if verdict == "refused":
        with pytest.raises(Refused, match="do not close"):
            check.run()
    else:
        check.run()
        assert any("closes" in why for why in check.open) == (verdict == "open")
