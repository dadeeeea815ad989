"""The checker can fail: every damaged statement is refuted, and every corrected one is accepted."""

import pytest
import sympy as sp

from symbolic import catalogue
from symbolic.claims import section2_dihedral as s2d
from symbolic.claims import section3_branches8 as s38b
from symbolic.claims import section3_degree8 as s38
from symbolic.claims import section3_topology as s3t
from symbolic.symbols import upsilon

DAMAGED = [(c.id, i) for c in catalogue.claims() for i in range(len(c.damaged))]

CORRECTED = {
    "s2.elevation": -sp.sin(upsilon),
    "s2.d2h-count": s2d._N / (2 * s2d._M),
    "s3.branch-6": "both",
    "s3.critical-unconstrained": "regular interior",
    "s3.pinned-criticality": ("smooth gaps, all images", "nonnegative"),
    "s3.remaining-question": ("regular interior", "smooth gaps"),
    "s3.flat-point": "segment",
    "s3.handles": (s3t.FIRST_HANDLE, s3t.SECOND_HANDLE_RIGHT),
    "s3.morse": "almost all rest angles",
    "s3.J": s38.J_SQUARED_RIGHT,
    "s3.phi1-8": (s38.BRANCH_1, s38.BRANCH_2, "xy", 1),
    "s3.range-8": "wrapped",
    "s3.domain-8": "phi_2 != 0, |phi_2| < pi",
    "s3.branches-8": "outer",
    "s3.odd-symmetry": (s38.BRANCH_2, s38.BRANCH_2),
    "a.criterion": sp.Integer(0),
}


def test_enough_claims_are_mutated():
    assert len({claim_id for claim_id, _ in DAMAGED}) >= 30


@pytest.mark.parametrize(("claim_id", "which"), DAMAGED, ids=[f"{c}-{i}" for c, i in DAMAGED])
def test_a_damaged_statement_is_refuted(claim_id, which):
    claim = catalogue.claim_by_id(claim_id)
    verdict = claim.decide(claim.damaged[which])
    assert verdict.verdict == "refuted", verdict.evidence


@pytest.mark.parametrize("claim_id", CORRECTED)
def test_the_corrected_statement_is_accepted(claim_id):
    claim = catalogue.claim_by_id(claim_id)
    assert claim.decide().verdict in ("refuted", "convention")
    assert claim.decide(CORRECTED[claim_id]).verdict == "proved"


def test_the_short_form_of_the_radicand_is_accepted():
    assert catalogue.claim_by_id("s3.J").decide(s38.J_SQUARED_SHORT).verdict == "proved"
    assert s38b.J_SQUARED_SHORT is s38.J_SQUARED_SHORT
