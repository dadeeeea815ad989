"""The checker can fail: damaged statements are refuted, corrected ones accepted, nonsense is an error."""

import pytest
import sympy as sp
from origami_nlp.symbolic.claims import section3_branches8 as s38b, section3_degree8 as s38
from origami_nlp.symbolic.rotations import Quaternion
from origami_nlp.symbolic.statement import StatementError, form_of

from origami_nlp.errors import OrigamiError
from origami_nlp.symbolic import catalogue
from tests.computed_once import thinned

CLAIMS = catalogue.claims()
DAMAGED = [(c.id, i) for c in CLAIMS for i in range(len(c.damaged))]
FIRST = [d for d in DAMAGED if not d[1]]
"""Every day the first damage of each sixth claim; the others with the long studies."""
CORRECTED = [c.id for c in CLAIMS if c.corrected is not None]
"""That the whole run proves each is asserted of its verdicts (`test_catalogue`); a ninth is decided once more."""
LABELS = (
    "s2.ratio-condition",
    "s3.flat-point",
    "s3.morse",
    "s3.domain-8",
    "s3.range-8",
    "s3.branches-8",
    "s3.critical-unconstrained",
    "s3.branch-6",
)
"""Claims whose statement used to be a bare label, to which any other text was 'refuted'."""

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
PARTS = ("no statement", sp.Symbol("nonsense"), None, 3.14)


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


@pytest.mark.parametrize("claim_id", thinned(LABELS, 3))
def test_a_claim_that_was_a_label_answers_what_it_is_asked(claim_id):
    claim = catalogue.claim_by_id(claim_id)
    right = claim.statement if claim.corrected is None else claim.corrected
    assert claim.decide(right).verdict == "proved"
    answers = {claim.decide(d).verdict for d in claim.damaged}
    assert answers == {"refuted"}
    with pytest.raises(StatementError, match=claim_id):
        claim.decide("any text")


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


def _with_nonsense(statement, word):
    """The statement with one part, at any depth, replaced by `word`; once for every part."""
    if isinstance(statement, tuple):
        for i, part in enumerate(statement):
            yield (*statement[:i], word, *statement[i + 1 :])
            for inner in _with_nonsense(part, word):
                yield (*statement[:i], inner, *statement[i + 1 :])
    elif isinstance(statement, dict):
        for key, part in statement.items():
            yield {**statement, key: word}
            yield {**statement, word: part}
            for inner in _with_nonsense(part, word):
                yield {**statement, key: inner}
    elif isinstance(statement, Quaternion):
        yield Quaternion(word, statement.x, statement.y, statement.z)
    elif isinstance(statement, sp.MatrixBase) and isinstance(word, sp.Symbol):
        yield statement.subs(statement[0, 0], word)
    elif isinstance(statement, sp.Expr) and isinstance(word, sp.Symbol):
        yield statement + word
    elif callable(statement) and not isinstance(statement, sp.Basic):
        yield lambda *args: word


@pytest.mark.parametrize("claim_id", [c.id for c in CLAIMS])
def test_nonsense_in_any_part_of_the_statement_is_an_error(claim_id):
    claim = catalogue.claim_by_id(claim_id)
    for word in PARTS:
        for statement in _with_nonsense(claim.statement, word):
            refuses(claim, statement)


def test_a_statement_without_a_form_of_its_own_needs_one():
    with pytest.raises(TypeError, match="must give one"):
        form_of("a label")
    with pytest.raises(TypeError, match="must give one"):
        form_of((1, "a label"))


def test_the_short_form_of_the_radicand_is_accepted():
    assert catalogue.claim_by_id("s3.J").decide(s38.J_SQUARED_SHORT).verdict == "proved"
    assert s38b.J_SQUARED_SHORT is s38.J_SQUARED_SHORT
