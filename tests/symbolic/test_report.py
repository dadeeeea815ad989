"""Reports: the JSON schema, the Markdown and LaTeX texts, and the committed errata page."""

from pathlib import Path

import pytest
from origami_nlp.symbolic.catalogue import Result
from origami_nlp.symbolic.claim import Claim, Verdict

from origami_nlp.symbolic import report

ERRATA = Path(__file__).parents[2] / "docs" / "validation" / "errata.md"


@pytest.mark.slow  # the whole catalogue
def test_the_committed_errata_page_is_current(run):
    fresh = report.errata_page(run)
    assert ERRATA.read_text(encoding="utf-8") == fresh, (
        "regenerate with `python -m origami_nlp.symbolic.report docs/validation/errata.md`"
    )


def _result(claim_id, verdict, **fields):
    answer = Verdict(verdict, "m", "e", None if verdict == "proved" else "y", True)
    return Result(Claim(claim_id, "sec. 2", "t", 0, "x", lambda _: answer, **fields), answer)


def test_the_tally_counts_statements_readings_and_shared_causes():
    results = [
        _result("a", "proved"),
        _result("b", "refuted", root="one cause"),
        _result("c", "convention", root="one cause"),
        _result("d", "refuted"),
        _result("e", "unproved", root="one cause"),
        _result("f", "proved", origin="own derivation"),
        _result("g", "refuted", origin="own derivation"),
        _result("h", "proved", origin="decimals"),
    ]
    assert report.tally(results) == {
        "statements": 5, "true": 1, "false": 2, "another_reading": 1, "undecided": 1,
        "findings": 2, "derivations": 2, "decimals": 1,
    }  # fmt: skip


def test_an_unproved_correction_counts_as_not_decided():
    verdict = Verdict("refuted", "m", "e", "y", False)
    result = Result(Claim("a.b", "app. A", "t", 0, "x", lambda _: verdict), verdict)
    assert report.summary([result])["decided"] == 0
