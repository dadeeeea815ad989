"""The contract of `origami-nlp paper verify`: exit codes, one line per claim, files, messages."""

import json

import pytest
from origami_nlp.symbolic.claim import Claim, Verdict

from origami_nlp.symbolic import catalogue
from tests.command_line import run

QUICK = ("s2.valley", "s3.J", "s2.elevation")


def only(*ids):
    return [a for i in ids for a in ("--only", i)]


def test_single_claims_print_one_line_each_and_the_evidence():
    done = run("paper", "verify", *only(*QUICK))
    assert done.code == 0, done.err
    lines = done.out.splitlines()
    for claim_id, word in zip(QUICK, ("proved", "refuted", "convention"), strict=True):
        row = [line for line in lines if line.startswith(f"{claim_id} ") and word in line]
        assert len(row) == 1
    assert "3 claims: 1 proved, 1 refuted, 1 convention, 0 unproved; 3 decided" in done.out
    assert r"\cos 2\upsilon" in done.out


def test_reports_are_written(tmp_path):
    files = {kind: tmp_path / f"out.{kind}" for kind in ("json", "tex")}
    done = run("paper", "verify", *only(*QUICK), *(x for f in files.values() for x in ("-o", f)))
    assert done.code == 0, done.err
    data = json.loads(files["json"].read_text(encoding="utf-8"))
    assert [c["id"] for c in data["claims"]] == list(QUICK)
    assert files["tex"].read_text(encoding="utf-8").count(r"\begin{equation}") == 3


@pytest.mark.parametrize(
    ("verdict", "code"),
    [
        (Verdict("proved", "m", "e"), 0),
        (Verdict("refuted", "m", "e", "x", True), 0),
        (Verdict("convention", "m", "e", "x", True), 0),
        (Verdict("refuted", "m", "e", "x", False), 1),
        (Verdict("unproved", "m", "e"), 1),
    ],
)
def test_exit_code_follows_the_verdicts(verdict, code, monkeypatch):
    claim = Claim("x.y", "sec. 2", "title [bold]", 0, "x=y", lambda _: verdict)
    monkeypatch.setattr(catalogue, "claims", lambda: (claim,))
    done = run("paper", "verify")
    assert done.code == code, done.err
    assert "title [bold]" in done.out  # not taken for markup


def test_an_unknown_claim_is_one_line_and_code_2():
    done = run("paper", "verify", "--only", "s3.nothing")
    assert (done.code, done.out, done.err.count("\n")) == (2, "", 1)
    assert "--only" in done.err and "s3.nothing" in done.err
