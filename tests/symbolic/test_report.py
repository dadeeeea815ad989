"""Reports: the JSON schema, the Markdown and LaTeX texts, and the committed errata page."""

import json
import re
from pathlib import Path

import pytest

from symbolic import report
from symbolic.catalogue import Result
from symbolic.claim import Claim, Verdict

ERRATA = Path(__file__).parents[2] / "docs" / "errata.md"


def test_json_has_the_keys_of_the_schema(run):
    data = json.loads(report.as_json(run.results))
    assert data["schema"] == "origami-nlp/verify/1"
    assert set(data) == {"schema", "claims", "summary"}
    keys = {
        "id", "where", "statement_latex", "verdict", "method", "evidence", "corrected_latex",
        "seconds",
    }  # fmt: skip
    assert all(set(c) == keys for c in data["claims"])
    count = data["summary"]
    assert count["total"] == len(run.results) == count["decided"]
    assert count["proved"] + count["refuted"] + count["convention"] == count["total"]
    assert count["unproved"] == 0
    assert count["seconds"] == pytest.approx(sum(c["seconds"] for c in data["claims"]), abs=0.1)


def test_markdown_has_one_entry_per_claim(run):
    text = report.as_markdown(run.results)
    assert text.count("\n### ") == len(run.results)
    for r in run.results:
        assert f"`{r.claim.id}`" in text
        assert report.plain(r.verdict.evidence) in text
    headings = re.findall(r"^## (.*)$", text, re.M)
    assert len(headings) == len(set(headings))


def test_latex_is_balanced(run):
    text = report.as_latex(run.results)
    assert text.count(r"\begin{equation}") == text.count(r"\end{equation}") == len(run.results)
    for r in run.results:
        for tex in (r.claim.statement_latex, r.verdict.corrected_latex or ""):
            bare = tex.replace(r"\{", "").replace(r"\}", "")
            assert bare.count("{") == bare.count("}"), r.claim.id
            assert tex.count(r"\left") - tex.count(r"\leftarrow") == tex.count(r"\right") - sum(
                tex.count(w) for w in (r"\rightarrow", r"\rightleftarrows")
            ), r.claim.id
            assert "$" not in tex, r.claim.id


def test_the_committed_errata_page_is_current(run):
    fresh = report.errata_page(run.results)
    assert ERRATA.read_text(encoding="utf-8") == fresh, (
        "regenerate with `python -m symbolic.report docs/errata.md`"
    )


def test_the_errata_page_lists_what_fails_and_nothing_else(run):
    page = report.errata_page(run.results)
    for r in run.results:
        listed = f"| `{r.claim.id}` |" in page
        assert listed == (r.verdict.verdict in ("refuted", "convention")), r.claim.id
    for needed in ("s3.J", "s3.phi1-8", "s3.handles", "s2.d2h-count", "s4.table", "s4.crease-3"):
        assert f"`{needed}`" in page


def test_markdown_shows_stars_and_bars_as_they_are():
    assert report.plain("a*b <c> |d|") == r"a\*b \<c> \|d\|"


def test_an_unproved_correction_is_shown_as_such():
    verdict = Verdict("refuted", "m", "e", "y", False)
    result = Result(Claim("a.b", "app. A", "t", None, "x", lambda _: verdict), verdict)
    assert "NOT proved" in report.as_markdown([result])
    assert report.summary([result])["decided"] == 0
