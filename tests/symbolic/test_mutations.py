"""The checker can fail: damaged statements are refuted, corrected ones accepted, nonsense is an error."""

import pytest
import sympy as sp
from origami_nlp.symbolic.claims import section3_branches8 as s38b, section3_degree8 as s38
from origami_nlp.symbolic.statement import StatementError

from origami_nlp.errors import OrigamiError
from origami_nlp.symbolic import catalogue
from tests.computed_once import thinned

CLAIMS = catalogue.claims()
DAMAGED = [(c.id, i) for c in CLAIMS for i in range(len(c.damaged))]
FIRST = [d for d in DAMAGED if not d[1]]
"""Every day the first damage of each sixth claim; the others with the long studies."""
CORRECTED = [c.id for c in CLAIMS if c.corrected is not None]
"""That the whole run proves each is asserted of its verdicts (`test_catalogue`); a ninth is decided once more."""

NONSENSE = (
    "no statement",
    "",
    None,
    object(),
    3.14,
    True,
    (),
    {},
    ["no statement"],
    {"no statement": "no statement"},
    sp.Symbol("nonsense"),
    sp.nan,
    ("no statement", "no statement"),
    lambda *_: "no statement",
    lambda a, b, c, d, e, f, g: a,  # of more arguments than any claim gives
)


@pytest.mark.parametrize("claim_id", [c.id for c in CLAIMS])
def test_every_claim_can_be_damaged(claim_id):
    claim = catalogue.claim_by_id(claim_id)
    assert claim.damaged
    for statement in (claim.statement, *claim.damaged):
        claim.read(statement)


@pytest.mark.parametrize(
    ("claim_id", "which"),
    [
        pytest.param(*d, id=f"{d[0]}-{d[1]}", marks=[] if d in FIRST[::6] else [pytest.mark.slow])
        for d in DAMAGED
    ],
)
def test_a_damaged_statement_is_refuted(claim_id, which):
    claim = catalogue.claim_by_id(claim_id)
    verdict = claim.decide(claim.damaged[which])
    assert verdict.verdict == "refuted", verdict.evidence


@pytest.mark.parametrize("claim_id", thinned(CORRECTED[::-1], 9))
def test_the_corrected_statement_is_accepted(claim_id):
    claim = catalogue.claim_by_id(claim_id)
    assert claim.decide(claim.statement).verdict in ("refuted", "convention")
    assert claim.decide(claim.corrected).verdict == "proved"


def refuses(claim, statement):
    """The claim ends with one line that names it, instead of an answer."""
    with pytest.raises(StatementError, match=claim.id) as caught:
        claim.decide(statement)
    assert isinstance(caught.value, OrigamiError)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("claim_id", [c.id for c in CLAIMS])
def test_a_nonsense_statement_is_an_error(claim_id):
    for nonsense in NONSENSE:
        refuses(catalogue.claim_by_id(claim_id), nonsense)


def test_the_short_form_of_the_radicand_is_accepted():
    assert catalogue.claim_by_id("s3.J").decide(s38.J_SQUARED_SHORT).verdict == "proved"
    assert s38b.J_SQUARED_SHORT is s38.J_SQUARED_SHORT
