"""A folder that holds what no sweep writes is named in one line."""

import shutil
import tomllib

import pytest

from origami_nlp.errors import SweepError
from origami_nlp.sweep import load_states, load_sweep, parse_sweep, run_sweep
from origami_nlp.sweep.store import FILE, read_store
from tests.computed_once import thinned
from tests.sweep.test_sweep import FEW, Inline, answers


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    folder = tmp_path_factory.mktemp("store")
    run_sweep(parse_sweep(tomllib.loads(FEW)), folder, executor=Inline())
    return folder


@pytest.mark.parametrize(
    ("was", "becomes"),
    thinned(
        [
            ('"schema"', '"scheme"'),
            ('"axes": [', '"axes": [1, '),
            ('"shape": [2, 2]', '"shape": "x"'),
            ('"kind": "interior"', '"kind": "[]"'),
            ('"energy_J": ', '"energy_J": "x", "e": '),
            ('"status": "done"', '"state": "done"'),
            ('"scene": 1', '"scene": "1"'),
            ('"states": [', '"states": 1, "s": ['),
            ("{", "["),
        ],
        3,
    ),
)
def test_a_changed_store_is_named(store, tmp_path, was, becomes):
    text = (store / FILE).read_text()
    assert was in text
    (tmp_path / FILE).write_text(text.replace(was, becomes))
    failed = 0
    for read in (load_sweep, load_states):
        try:
            read(tmp_path)
        except SweepError as error:
            failed += 1
            assert "store of a sweep" in str(error)
    assert failed


def test_a_line_that_was_cut_is_run_again(store, tmp_path):
    shutil.copytree(store, tmp_path, dirs_exist_ok=True)
    whole = (tmp_path / FILE).read_bytes()
    (tmp_path / FILE).write_bytes(whole[:-40])
    assert len(read_store(tmp_path)[1]) == 3
    assert run_sweep(parse_sweep(tomllib.loads(FEW)), tmp_path, executor=Inline()).ran == 1
    assert answers(tmp_path) == answers(store)
