"""What is written: whole or not at all, in place of what it should replace only, complained about early."""

import os
import stat
import subprocess
from pathlib import Path

import pytest

from origami_nlp import OrigamiError
from origami_nlp.io import (
    check_outputs,
    write_whole,
    writing as files,
)

needs_linux = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full: not Linux")


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


def test_no_result_overwrites_another(tmp_path):
    (tmp_path / "link").symlink_to("a")
    with pytest.raises(OrigamiError, match=r"--markdown.*is the file of --json"):
        check_outputs(("--json", tmp_path / "a"), ("--markdown", tmp_path / "link"))
    check_outputs(("-o", "-"), ("-o", None), ("-o", os.devnull), ("-o", os.devnull))


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
