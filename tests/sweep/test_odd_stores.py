"""A folder that holds what no sweep writes is named in one line."""

import shutil
import sqlite3
import tomllib

import pytest

from origami_nlp.errors import SweepError
from origami_nlp.sweep import draw_sweep, load_states, load_sweep, parse_sweep, run_sweep
from tests.computed_once import thinned
from tests.sweep.test_sweep import FEW, Inline


@pytest.fixture(scope="module")
def store(tmp_path_factory):
    folder = tmp_path_factory.mktemp("store")
    run_sweep(parse_sweep(tomllib.loads(FEW)), folder, executor=Inline())
    return folder


@pytest.mark.parametrize(
    "change",
    thinned(
        [
            "DELETE FROM sweep",
            "UPDATE sweep SET value = '[]' WHERE key = 'sweep'",
            "UPDATE sweep SET value = '{\"axes\": 1}' WHERE key = 'sweep'",
            "UPDATE sweep SET value = 1e9 WHERE key = 'sweep'",
            "UPDATE sweep SET value = x'ff' WHERE key = 'shape'",
            "UPDATE states SET kind = '[]'",
            "UPDATE states SET scene = 1000000 WHERE rowid = 1",
            "UPDATE states SET energy = 'null'",
            "UPDATE states SET fold_angles = 'x'",
            "UPDATE scenes SET scene = 1000000 WHERE rowid = 1",
            "ALTER TABLE scenes DROP COLUMN starts",
            "DROP TABLE states",
        ],
        3,
    ),
)
def test_a_changed_store_is_named(store, tmp_path, change):
    shutil.copytree(store, tmp_path, dirs_exist_ok=True)
    load_sweep(tmp_path)
    with sqlite3.connect(tmp_path / "sweep.sqlite") as database:
        database.execute(change)
    database.close()
    failed = 0
    for read in (load_sweep, load_states, draw_sweep):
        try:
            read(tmp_path)
        except SweepError as error:
            failed += 1
            assert "store of a sweep" in str(error)
    assert failed
