"""What is written: whole or not at all, in place of what it should replace only, complained about early."""

import json
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

import origami_nlp
from origami_nlp import OrigamiError
from origami_nlp.io import (
    check_outputs,
    check_writable,
    make_folder,
    write_whole,
    writing as files,
)
from tests.command_line import run

ROOT = Path(origami_nlp.__file__).parents[1]
needs_linux = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full: not Linux")


def command(line, folder):
    """Run a shell line in which $NLP is our command; return exit code, output and errors."""
    nlp = f"{sys.executable} -c 'from origami_nlp.cli import main; main()'"
    done = subprocess.run(
        ["bash", "-c", line.replace("$NLP", nlp)],
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=300,
    )
    return done.returncode, done.stdout, done.stderr


def one_line(errors):
    return errors.count("\n") == 1 and errors.startswith("origami-nlp: ")


# ---------------------------------------------------------------- regular files


def test_a_new_file_has_the_mode_of_the_umask(tmp_path):
    for mask, mode in ((0o022, 0o644), (0o077, 0o600), (0o002, 0o664)):
        before = os.umask(mask)
        try:
            write_whole(tmp_path / f"{mask}", b"x")
        finally:
            os.umask(before)
        assert stat.S_IMODE((tmp_path / f"{mask}").stat().st_mode) == mode


def test_an_old_file_keeps_its_mode_and_is_replaced_whole(tmp_path):
    file = tmp_path / "a"
    file.write_bytes(b"old")
    file.chmod(0o640)
    with file.open("rb") as reader:
        write_whole(file, b"new")
        assert reader.read() == b"old"  # who reads sees one or the other
    assert file.read_bytes() == b"new" and stat.S_IMODE(file.stat().st_mode) == 0o640
    assert os.listdir(tmp_path) == ["a"]


@pytest.mark.parametrize("exists", [True, False])
def test_links_stay_and_their_target_is_written(tmp_path, exists):
    (tmp_path / "far").mkdir()
    target = tmp_path / "far" / "real"
    if exists:
        target.write_bytes(b"old")
    (tmp_path / "second").symlink_to("far/real")
    (tmp_path / "first").symlink_to("second")
    write_whole(tmp_path / "first", b"new")
    assert target.read_bytes() == b"new"
    assert (tmp_path / "first").is_symlink() and (tmp_path / "second").is_symlink()


def test_a_failure_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch):
    file = tmp_path / "a"
    file.write_bytes(b"old")
    for name in ("fsync", "replace"):

        def fail(*_):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(files.os, name, fail)
        with pytest.raises(OrigamiError, match="No space left on device"):
            write_whole(file, b"new")
        monkeypatch.undo()
        assert file.read_bytes() == b"old" and os.listdir(tmp_path) == ["a"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("folder", "is a folder"),
        ("new/", "is a folder"),
        ("", "folder"),
        ("none/a", "does not exist"),
        ("loop", "cannot be written"),
        ("nul\0", "cannot be written"),
        ("file/a", "Not a directory"),
    ],
)
def test_complaints_name_option_and_value(tmp_path, monkeypatch, name, words):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder").mkdir()
    (tmp_path / "file").write_text("")
    (tmp_path / "loop").symlink_to("loop")
    for attempt in (lambda: check_writable(name, "-o"), lambda: write_whole(name, b"x")):
        with pytest.raises(OrigamiError, match=words) as caught:
            attempt()
        assert "\n" not in str(caught.value) and "\0" not in str(caught.value)
    with pytest.raises(OrigamiError, match="-o"):
        check_writable(name, "-o")


def test_what_may_not_be_written_is_found_out_early(tmp_path):
    if os.geteuid() == 0:
        pytest.skip("root may write anywhere")
    (tmp_path / "shut").mkdir(mode=0o500)
    with pytest.raises(OrigamiError, match="permission"):
        check_writable(tmp_path / "shut" / "a", "-o")
    (tmp_path / "fixed").touch(0o400)
    with pytest.raises(OrigamiError, match="permission"):
        check_writable(tmp_path / "fixed", "-o")


@needs_linux
@pytest.mark.parametrize("name", ["/proc/a.json", "/proc/version", "/sys/a.json"])
def test_virtual_file_systems_are_found_out_early(name):
    with pytest.raises(OrigamiError, match="-o"):
        check_writable(name, "-o")


def test_no_result_overwrites_another(tmp_path):
    (tmp_path / "link").symlink_to("a")
    with pytest.raises(OrigamiError, match=r"--markdown.*is the file of --json"):
        check_outputs(("--json", tmp_path / "a"), ("--markdown", tmp_path / "link"))
    check_outputs(("-o", "-"), ("-o", None), ("-o", os.devnull), ("-o", os.devnull))


def test_folders_that_cannot_be_made(tmp_path):
    assert make_folder(tmp_path / "a" / "b", "--folder").is_dir()
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "a", tmp_path / ("a" * 300)):
        with pytest.raises(OrigamiError, match="--folder"):
            make_folder(folder, "--folder")


@needs_linux
def test_devices_stay_devices():
    before = os.stat("/dev/null")
    write_whole("/dev/null", b"x" * 100_000)
    assert os.stat("/dev/null").st_ino == before.st_ino
    assert stat.S_ISCHR(os.stat("/dev/null").st_mode)
    with pytest.raises(OrigamiError, match="No space left on device"):
        write_whole("/dev/full", b"x")


@needs_linux
def test_pipes_are_written_straight(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    reader = subprocess.Popen(["cat", tmp_path / "pipe"], stdout=subprocess.PIPE)
    write_whole(tmp_path / "pipe", b"x" * 100_000)
    assert reader.communicate(timeout=300)[0] == b"x" * 100_000
    assert stat.S_ISFIFO((tmp_path / "pipe").stat().st_mode)


ONE_SCENE = """
[scene]
example = "degree6"
alpha = "pi/4"
[[axes]]
set = "ratio"
values = [1, 2]
"""
COUNT = "paper cone count --degree 6 --ratio 1 --rest-elevation 0.3"


@needs_linux
@pytest.mark.parametrize(
    "line",
    [
        "$NLP COUNT -o /dev/stdout",
        "echo '' > a; $NLP COUNT -o /dev/stdout >> a; cat a",
    ],
)
def test_json_reaches_every_kind_of_output(tmp_path, line):
    code, out, err = command(line.replace("COUNT", COUNT), tmp_path)
    assert code == 0, err
    assert json.loads(out)["schema"] == "origami-nlp/paper/1", out


@needs_linux
@pytest.mark.parametrize(
    "line",
    [
        f"$NLP {COUNT} -o /dev/full",
        f"$NLP {COUNT} -o /proc/a.json",
        f"$NLP {COUNT} -o {'a' * 300}.json",
        "$NLP example degree6 > /dev/full",
        f"$NLP paper demo --folder {'a' * 300}",
        f"$NLP sweep s.toml --folder {'a' * 300}",
    ],
)
def test_faults_of_the_system_are_one_line(tmp_path, line, monkeypatch):
    (tmp_path / "s.toml").write_text(ONE_SCENE)
    if ">" in line:
        code, _, err = command(line, tmp_path)
    else:  # needs no shell
        monkeypatch.chdir(tmp_path)
        code, _, err = run(*line.split()[1:])
    assert code == 2 and one_line(err), err
    option = next((word for word in line.split() if word in ("-o", "--folder")), "")
    assert option in err or "file = " in err, err  # a full disk shows when the file is written
