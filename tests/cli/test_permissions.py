"""Files that may not be read or written: one line that names the file, exit code 2."""

import errno
import os

import pytest

from tests.command_line import run

READ = (
    ("minima", "a.toml"),
    ("inspect", "a.toml"),
    ("inspect", "a.fold"),
    ("minima", "a.fold", "--vertex", "0"),
    ("load", "a.toml", "--crease", "1"),
    ("design", "a.toml"),
    ("sweep", "a.toml", "--folder", "swept"),
    ("check-proof", "a.toml"),
)
WRITE = (
    ("minima", "miura.toml", "-o", "a.json"),
    ("minima", "miura.toml", "--certificate", "a.json"),
    ("example", "miura", "-o", "a.toml"),
    ("inspect", "miura.toml", "-o", "a.png"),
    ("inspect", "miura:1x2", "-o", "a.svg"),
)


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a scene and two files that are only named."""
    monkeypatch.chdir(tmp_path)
    assert run("example", "miura", "-o", "miura.toml").code == 0
    for name in ("a.toml", "a.fold"):
        (tmp_path / name).write_text("never read")
    return tmp_path


def refuse(file, *more, **options):
    raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(file))


def is_refused(words, named):
    code, out, err = run(*words)
    assert (code, out, err.count("\n")) == (2, "", 1), (words, out, err)
    assert err.startswith("origami-nlp: ") and "ermission" in err and named in err, err


@pytest.mark.parametrize("words", READ, ids=" ".join)
def test_a_file_that_may_not_be_read(here, monkeypatch, words):
    monkeypatch.setattr("origami_nlp.io.reading.open", refuse, raising=False)
    is_refused(words, words[1])


@pytest.mark.parametrize("words", WRITE, ids=" ".join)
def test_a_file_that_may_not_be_written_is_refused_before_the_work(here, monkeypatch, words):
    monkeypatch.setattr("os.access", lambda *asked, **more: False)
    is_refused(words, words[-1])


@pytest.mark.parametrize(
    "words",
    [
        ("inspect", "IN", "-o", "IN"),
        ("convert", "IN", "IN"),
        ("minima", "IN", "-o", "IN"),
        ("load", "IN", "--crease", "1", "--to", "0.01", "-o", "IN"),
        ("minima", "IN", "--certificate", "IN", "--contact", "fold-limits"),
    ],
    ids=lambda words: " ".join(words),
)
def test_what_is_read_is_not_written_over(words, tmp_path):
    file = tmp_path / "m.fold"
    assert run("example", "miura:2x2", "-o", file)[0] == 0
    before = file.read_bytes()
    beside = tmp_path / "." / "m.fold"
    code, _, err = run(
        *(file if w == "IN" and k < 2 else beside if w == "IN" else w for k, w in enumerate(words))
    )
    assert code == 2 and "m.fold" in err and file.read_bytes() == before
    assert [f.name for f in tmp_path.iterdir()] == ["m.fold"]
