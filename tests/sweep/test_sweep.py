"""Sweeps: what a file may say, answers that depend on nothing but the sweep, and kill -9 at random times."""

import contextlib
import functools
import os
import signal
import subprocess
import sys
import time
import tomllib
import warnings
from concurrent.futures import Executor, Future

import numpy as np
import psutil
import pytest

from origami_nlp import OrigamiError, examples, find_minima
from origami_nlp.sweep import load_states, parse_sweep, run_sweep
from origami_nlp.sweep.run import run_scene
from origami_nlp.sweep.store import load_sweep, read_store
from tests.command_line import run
from tests.computed_once import panel_result

SMALL = """
[scene]
[scene.vertex]
sector_angles = ["pi/3", "pi/3", "pi/3", "pi/3", "pi/3", "pi/3"]
[scene.creases]
stiffness = [1, 0.5, 1, 0.5, 1, 0.5]
rest_angles = [1, -1, 1, -1, 1, -1]
[scene.model]
symmetry = "D3"
contact = "fold-limits"

[[axes]]
name = "rest"
set = ["creases.rest_angles[1]", "creases.rest_angles[3]", "creases.rest_angles[5]"]
values = ["pi/4", 1.2]

[[axes]]
name = "k"
set = ["creases.stiffness[2]", "creases.stiffness[4]", "creases.stiffness[6]"]
from = 0.1
to = 10
count = 6
scale = "log"

[search]
starts = 4
"""
"""Twelve scenes with one degree of freedom."""
FEW = SMALL.replace("count = 6", "count = 2")

PATTERNS = """
[pattern]
example = "degree6"
stiffness = 0.01
[[axes]]
set = "creases.rest_angles"
values = [0.8, 1.2]
[[axes]]
set = "mountains.stiffness"
from = 0.001
to = 0.1
count = 2
scale = "log"
[search]
starts = 2
"""


class Inline(Executor):
    """Does everything at once, in this process (CasADi's functions are not for two threads)."""

    def submit(self, fn, /, *args, **kwargs):
        future = Future()
        future.set_result(fn(*args, **kwargs))
        return future


def small(text=SMALL):
    return parse_sweep(tomllib.loads(text))


def answers(folder):
    """Everything in a store that is an answer: times apart, and the order of completion."""
    return [
        {k: v for k, v in row.items() if k != "seconds"} for row in read_store(folder)[1].values()
    ]


@pytest.fixture(scope="module")
def stores(tmp_path_factory):
    @functools.cache
    def finished(text):
        folder, count = tmp_path_factory.mktemp("sweep"), small(text).count
        report = run_sweep(small(text), folder, executor=Inline())
        assert report.counts == {"done": count} and report.ran == count and not report.interrupted
        return folder

    return finished


@pytest.fixture(scope="module")
def finished(stores):
    return stores(SMALL)


of_both = pytest.mark.parametrize(
    "text", [SMALL, pytest.param(PATTERNS, marks=pytest.mark.slow)], ids=["scenes", "patterns"]
)


# ---------------------------------------------------------------- what comes out


def test_a_sweep_is_its_scenes(finished):
    states = load_states(finished)
    sweep = small()
    for index in (0, 11):
        alone = find_minima(sweep.scene(index), prove=False, escape=False)
        here = states[states.scene == index]
        assert len(here) == len(alone.minima)
        np.testing.assert_allclose(here.energy_J, [m.energy for m in alone.minima], rtol=1e-9)
        assert list(here.kind) == [m.kind for m in alone.minima]
        assert (here[["rest", "k"]].iloc[0] == list(sweep.parameters(index).values())).all()
    assert {"phi_1_rad", "phi_6_rad", "closure", "kkt"} <= set(states.columns)
    assert states.closure.max() < 1e-13


@pytest.mark.parametrize("full", ["true", "false"])
def test_stable_states_are_counted_as_results_say(tmp_path, full):
    """Minima that a broken symmetry leaves are unstable; where nobody asked that is not known."""
    text = f"""
    [scene]
    example = "degree6"
    alpha = "pi/3"
    [[axes]]
    set = "ratio"
    values = [1.0]
    [search]
    full = {full}
    """
    run_sweep(parse_sweep(tomllib.loads(text)), tmp_path, executor=Inline())
    alone = panel_result(examples.degree6("pi/3", 1.0), full=True)
    here = load_sweep(tmp_path).isel(ratio=0)
    assert here["count"] == len(alone.minima) > len(alone.stable)
    if full == "false":
        assert np.isnan(here["count_stable"]) and np.isnan(here["count_unstable"])
    else:
        assert here["count_stable"] == len(alone.stable)
        assert here["count_unstable"] == len(alone.minima) - len(alone.stable)


def test_labelled_arrays(finished):
    data = load_sweep(finished)
    assert data.sizes == {"rest": 2, "k": 6}
    np.testing.assert_allclose(data.k, np.geomspace(0.1, 10, 6))
    states = load_states(finished)
    assert int(data["count"].sum()) == len(states)
    assert int(data.count_interior.sum()) == (states.kind == "interior").sum()
    np.testing.assert_allclose(
        data.lowest_energy.values.ravel(), states.groupby("scene").energy_J.min()
    )
    assert (data.status == "done").all()


def test_the_same_sweep_adds_nothing(finished):
    before = answers(finished)
    assert run_sweep(small(), finished, executor=Inline()).ran == 0
    assert answers(finished) == before


def test_another_sweep_is_not_mixed_in(finished):
    other = parse_sweep(tomllib.loads(SMALL.replace("count = 6", "count = 7")))
    with pytest.raises(OrigamiError, match="another sweep"):
        run_sweep(other, finished)


@of_both
def test_progress_and_interruption(stores, tmp_path, text):
    seen, count = [], small(text).count

    def stop(done, total, states):
        seen.append(done)
        if done == count // 2:
            raise KeyboardInterrupt

    report = run_sweep(small(text), tmp_path, executor=Inline(), workers=1, progress=stop)
    assert report.interrupted and report.ran == count // 2 and seen == [*range(1, count // 2 + 1)]
    assert load_sweep(tmp_path)["count"].min() == -1  # not yet run
    assert run_sweep(small(text), tmp_path, executor=Inline()).ran == count - count // 2
    assert answers(tmp_path) == answers(stores(text))


def test_a_failing_scene_does_not_end_the_sweep(tmp_path, monkeypatch):
    def fail(*args, **kwargs):
        raise RuntimeError("no luck")

    monkeypatch.setattr("origami_nlp.pattern_states.find_states", fail)
    sweep = parse_sweep(tomllib.loads(FEW))
    assert run_scene(sweep, 0)["reason"] == "RuntimeError: no luck"
    report = run_sweep(sweep, tmp_path, executor=Inline())
    assert report.counts == {"failed": 4}
    monkeypatch.undo()
    assert run_sweep(sweep, tmp_path, executor=Inline()).counts == {"done": 4}


# ---------------------------------------------------------------- kill -9


def start(spec, out):
    words = f"-m origami_nlp sweep {spec} --folder {out} --workers 2"
    command = [sys.executable, *words.split()]
    return subprocess.Popen(
        command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, start_new_session=True
    )


def stored(out):
    """How many scenes a store that another process writes holds by now."""
    try:
        return len(read_store(out)[1])
    except OrigamiError:
        return 0  # not made yet, or being made


def alive(numbers):
    """Which of these processes still run (a zombie does not)."""
    found = set()
    for number in numbers:
        with contextlib.suppress(psutil.NoSuchProcess):
            if psutil.Process(number).status() != psutil.STATUS_ZOMBIE:
                found.add(number)
    return found


@pytest.mark.slow  # kills processes of a sweep
def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    spec, out = tmp_path / "sweep.toml", tmp_path / "out"
    spec.write_text(SMALL.replace("count = 6", "count = 50000"))
    process = start(spec, out)
    while process.poll() is None and stored(out) < 5:
        time.sleep(0.05)
    family = {p.pid for p in psutil.Process(process.pid).children(recursive=True)}
    try:
        assert len(family) >= 2
        os.kill(process.pid, signal.SIGKILL)  # the parent alone
        process.wait()
        end = time.monotonic() + 300
        while alive(family) and time.monotonic() < end:
            time.sleep(0.05)
        assert not alive(family)
    finally:
        for number in alive(family):
            os.kill(number, signal.SIGKILL)
        process.communicate()


@pytest.mark.slow
def test_a_local_dask_cluster_gives_the_same(finished, tmp_path):
    distributed = pytest.importorskip(
        "distributed", reason='dask is not installed: pip install "origami_nlp[sweep]"'
    )
    spec = tmp_path / "sweep.toml"
    spec.write_text(SMALL)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of the cluster's own start and end
        with distributed.LocalCluster(
            n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None
        ) as cluster:
            address = cluster.scheduler_address
            done = run("sweep", spec, "--folder", tmp_path / "o", "--dask", address)
    assert done.code == 0, done.err
    assert answers(tmp_path / "o") == answers(finished)
