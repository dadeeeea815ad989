"""Two runs of a sweep at once, a run for a limited time, and workers that Ctrl-C does not reach."""

import os
import signal
import tomllib

import pytest

from origami_nlp.errors import SweepError
from origami_nlp.sweep import parse_sweep, run_sweep
from origami_nlp.sweep.store import Store
from tests.sweep.test_sweep import FEW, Inline


def test_a_second_run_in_one_folder_is_told_so(tmp_path):
    sweep = parse_sweep(tomllib.loads(FEW))
    with Store(tmp_path / "new", sweep):
        with pytest.raises(SweepError, match="another process runs a sweep there"):
            run_sweep(sweep, tmp_path / "new", executor=Inline())
    assert run_sweep(sweep, tmp_path / "new", executor=Inline()).counts == {"done": 4}


def test_a_sweep_whose_time_is_over_goes_on_with_the_same_call(tmp_path):
    sweep = parse_sweep(tomllib.loads(FEW))
    report = run_sweep(sweep, tmp_path, executor=Inline(), seconds=0.0)
    assert report.interrupted and report.ran < 4
    again = run_sweep(sweep, tmp_path, executor=Inline(), seconds=3600.0)
    assert not again.interrupted and again.counts == {"done": 4}


@pytest.mark.skipif(os.name == "nt", reason="needs POSIX signals")
def test_ctrl_c_does_not_reach_workers():
    from origami_nlp.workers import stop_workers, worker_pool

    pool = worker_pool(1)
    blocked = pool.submit(signal.pthread_sigmask, signal.SIG_BLOCK, []).result()
    stop_workers(pool)
    assert signal.SIGINT in blocked
    assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, [])
