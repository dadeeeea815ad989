"""The catalogue is complete, every claim is decided, and the whole run is quick enough."""

from pathlib import Path

import origami_nlp.symbolic.claims
import pytest
from origami_nlp.symbolic.claim import Verdict

from origami_nlp.errors import OptionError
from origami_nlp.symbolic import catalogue


def test_every_module_of_claims_is_listed():
    folder = Path(origami_nlp.symbolic.claims.__file__).parent
    defining = {
        p.stem
        for p in folder.glob("*.py")
        if "CLAIMS: list[Claim]" in p.read_text(encoding="utf-8")
    }
    assert defining == set(catalogue.MODULES)


def test_ids_are_unique_and_places_are_given():
    ids = [c.id for c in catalogue.claims()]
    assert len(ids) == len(set(ids))
    for claim in catalogue.claims():
        assert claim.where and claim.title and claim.statement_latex, claim.id


def test_every_section_and_appendix_of_the_paper_is_covered():
    places = " ".join(c.where for c in catalogue.claims())
    for place in ("sec. 2", "sec. 3", "sec. 4", "sec. 5", "app. A", "app. B"):
        assert place in places


@pytest.mark.slow  # the whole catalogue
def test_every_claim_is_decided(run):
    assert [r.claim.id for r in run if not r.verdict.decided] == []


@pytest.mark.slow  # the whole catalogue
def test_a_refutation_carries_a_correction_proved_in_the_same_run(run):
    for r in run:
        if r.verdict.verdict in ("refuted", "convention"):
            assert r.verdict.corrected_latex, r.claim.id
            assert r.verdict.corrected_proved is True, r.claim.id
            assert r.claim.corrected is not None, r.claim.id
        else:
            assert r.verdict.corrected_latex is None, r.claim.id
            assert r.claim.corrected is None, r.claim.id
        assert r.verdict.evidence and r.verdict.method, r.claim.id


def test_unknown_id_names_its_neighbours():
    with pytest.raises(OptionError, match=r"s3\.J"):
        catalogue.claim_by_id("s3.j")


@pytest.mark.parametrize(
    ("verdict", "corrected", "decided"),
    [
        ("proved", None, True),
        ("refuted", True, True),
        ("refuted", False, False),
        ("refuted", None, False),
        ("convention", True, True),
        ("convention", None, False),
        ("unproved", None, False),
    ],
)
def test_what_counts_as_decided(verdict, corrected, decided):
    assert Verdict(verdict, "", "", corrected_proved=corrected).decided is decided
