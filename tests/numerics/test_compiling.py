"""What is compiled is kept in a folder, and loaded from it only where nobody else can have put it there."""

import os
import shutil

import pytest

from origami_nlp.numerics import compiling

SOURCE = "int answer(void) { return 42; }"
needs_compiler = pytest.mark.skipif(
    not compiling._compiler(), reason="no C compiler on this machine"
)
needs_owners = pytest.mark.skipif(not hasattr(os, "getuid"), reason="files have no owners here")


def library(cache, source=SOURCE):
    built = []
    made = compiling._library("test", source, compiling._compiler(), cache, lambda: built.append(1))
    return made, len(built)


@needs_compiler
def test_it_is_built_once(tmp_path):

    cache = tmp_path / "cache"
    (first, built), (second, again) = library(cache), library(cache)
    assert first.answer() == second.answer() == 42 and (built, again) == (1, 0)


@needs_compiler
@pytest.mark.parametrize("change", ["cut", "other", "unsigned"])
def test_what_was_changed_is_built_anew(tmp_path, change):
    cache = tmp_path / "cache"
    library(cache)
    (made,) = cache.glob("*.so")
    if change == "cut":  # in another file: a library that is open must not shrink
        data = made.read_bytes()[:100]
        made.unlink()
        made.write_bytes(data)
    elif change == "other":
        made.unlink()
        made.write_bytes(b"not a library at all")
    else:
        made.with_suffix(".sha256").unlink()
    made, built = library(cache)
    assert made.answer() == 42 and built == 1


@needs_compiler
@needs_owners
def test_a_folder_that_others_may_write_to_is_not_used(tmp_path):
    cache = tmp_path / "cache"
    library(cache)
    os.chmod(cache, 0o777)
    made, built = library(cache)
    assert made.answer() == 42 and built == 1
    (known,) = cache.glob("*.so")
    assert os.path.dirname(made._name) != str(cache) and known.exists()


@needs_compiler
@needs_owners
def test_a_library_that_others_may_write_to_is_built_anew(tmp_path):
    cache = tmp_path / "cache"
    library(cache)
    (known,) = cache.glob("*.so")
    os.chmod(known, 0o666)
    _, built = library(cache)
    assert built == 1 and not known.stat().st_mode & 0o022


def test_zig_compiles_where_the_machine_has_no_compiler(monkeypatch):
    compiling._compiler.cache_clear()
    monkeypatch.setattr(shutil, "which", lambda name: None)
    monkeypatch.setattr(compiling, "find_spec", lambda name: object())
    monkeypatch.setattr(compiling.sys, "platform", "linux")
    assert compiling._compiler().endswith("-m ziglang cc")
    compiling._compiler.cache_clear()
