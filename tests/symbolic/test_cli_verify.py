"""The contract of `origami-nlp paper verify`: exit codes, one line per claim, files, messages."""

import json
import subprocess
import sys
from types import SimpleNamespace

import pytest
from origami_nlp.symbolic.claim import Claim, Verdict

from origami_nlp.cli import main
from origami_nlp.symbolic import catalogue
from tests.command_line import run

QUICK = ("s2.valley", "s3.J", "s2.elevation")


MAIN = "from origami_nlp.cli import main; main()"


@pytest.fixture
def verify(monkeypatch, capsys):
    """Run the command in this process, which has SymPy and its caches already."""

    def run(*args):
        monkeypatch.setattr(sys, "argv", ["origami-nlp", "paper", "verify", *map(str, args)])
        with pytest.raises(SystemExit) as stop:
            main()
        reported = capsys.readouterr()
        return SimpleNamespace(
            returncode=stop.value.code or 0, stdout=reported.out, stderr=reported.err
        )

    return run


def only(*ids):
    return [a for i in ids for a in ("--only", i)]


def test_single_claims_print_one_line_each_and_the_evidence():
    command = [sys.executable, "-c", MAIN, "paper", "verify", *only(*QUICK)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    for claim_id, word in zip(QUICK, ("proved", "refuted", "convention"), strict=True):
        row = [line for line in lines if line.startswith(f"{claim_id} ") and word in line]
        assert len(row) == 1
    assert "3 claims: 1 proved, 1 refuted, 1 convention, 0 unproved; 3 decided" in done.stdout
    assert r"\cos 2\upsilon" in done.stdout


def test_reports_are_written(tmp_path, verify):
    files = {kind: tmp_path / f"out.{kind}" for kind in ("json", "tex")}
    done = verify(*only(*QUICK), *(x for f in files.values() for x in ("-o", f)))
    assert done.returncode == 0, done.stderr
    data = json.loads(files["json"].read_text(encoding="utf-8"))
    assert [c["id"] for c in data["claims"]] == list(QUICK)
    assert files["tex"].read_text(encoding="utf-8").count(r"\begin{equation}") == 3


def test_an_unwritable_file_is_refused_before_the_work(tmp_path, monkeypatch):
    monkeypatch.setattr("os.access", lambda *_: False)
    monkeypatch.setattr(catalogue, "decide_all", lambda *_: pytest.fail("the work has begun"))
    done = run("paper", "verify", "-o", tmp_path / "x.json")
    assert done.code == 2 and "no permission" in done.err


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
def test_exit_code_follows_the_verdicts(verdict, code, monkeypatch, capsys):
    from typer.testing import CliRunner

    from origami_nlp.cli import app

    claim = Claim("x.y", "sec. 2", "title [bold]", 0, "x=y", lambda _: verdict)
    monkeypatch.setattr(catalogue, "claims", lambda: (claim,))
    done = CliRunner().invoke(app, ["paper", "verify"])
    assert done.exit_code == code, done.output
    assert "title [bold]" in done.output  # not taken for markup


@pytest.mark.parametrize(
    ("args", "words"),
    [
        (["--only", "s3.nothing"], ["--only", "s3.nothing"]),
        (["-o", "no/such/folder/x.json"], ["-o", "does not exist"]),
        (["-o", "."], ["-o", "folder"]),
    ],
)
def test_bad_options_end_with_one_line_and_code_2(args, words, verify):
    done = verify(*args)
    assert done.returncode == 2
    assert done.stdout.strip() == ""
    assert len(done.stderr.strip().splitlines()) == 1
    assert all(word in done.stderr for word in words)
