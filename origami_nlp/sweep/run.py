"""Run a sweep on any executor of `concurrent.futures`: processes, a Dask cluster, MPI.

Every scene is searched by itself; so the answers depend on neither workers, nor interruptions, nor the order of
completion.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from origami_nlp.arguments import check_callback, check_number, check_path, check_type, check_whole
from origami_nlp.errors import SweepError
from origami_nlp.sweep.spec import Sweep
from origami_nlp.sweep.store import Outcome, Store, attempted
from origami_nlp.workers import stop_workers, worker_pool

Progress = Callable[[int, int, int], None]
"""Called with scenes finished, scenes in all, and minima found since the run began."""


@dataclass(frozen=True)
class SweepReport:
    """How a run ended.

    Attributes
    ----------
    counts
        Number of scenes of each status.
    ran
        Scenes run now.
    seconds
        Of wall time.
    interrupted
        Whether Ctrl-C, or the time limit, ended it.
    """

    counts: dict[str, int]
    ran: int
    seconds: float
    interrupted: bool


def run_scene(sweep: Sweep, index: int) -> Outcome:
    """Find the states of one scene; errors become its outcome (this is what a worker does)."""
    return attempted(index, sweep.scene, sweep.minima)


def run_sweep(
    sweep: Sweep,
    folder: str | Path,
    *,
    executor: Executor | None = None,
    workers: int | None = None,
    seconds: float | None = None,
    progress: Progress | None = None,
) -> SweepReport:
    """Run what is left of a sweep, adding to the store in a folder.

    Ctrl-C ends the run in order: scenes in flight are lost, everything else is in the store, and the same call
    goes on from there.  In a script, call it under ``if __name__ == "__main__":``: workers import the script anew.

    Parameters
    ----------
    sweep
        Of `read_sweep`.
    folder
        Made if there is none.
    executor
        Any `concurrent.futures.Executor`: a process pool of `workers` by default; `dask.distributed`'s
        ``Client.get_executor()``, `mpi4py.futures.MPIPoolExecutor` and others have the same interface.  Not
        threads: CasADi's solvers are not for two of them at once.
    workers
        Processes; one a core by default.
    seconds
        Wall time after which the run ends as after Ctrl-C; None: no limit.
    progress
        Called after each scene, as progress(scenes finished, scenes in all, minima found).

    Returns
    -------
    SweepReport
        How the run ended.

    Raises
    ------
    SweepError
        If the folder holds another sweep, or a worker died.
    OptionError
        If an argument is not what it must be.
    """
    check_type("sweep", sweep, Sweep)
    check_path("folder", folder)
    if executor is not None:
        check_type("executor", executor, Executor)
    if workers is not None:
        check_whole("workers", workers, 1)
    if seconds is not None:
        check_number("seconds", seconds, 0.0)
    check_callback("progress", progress)
    begin = time.perf_counter()
    until = math.inf if seconds is None else time.monotonic() + seconds
    own = executor is None
    with Store(folder, sweep) as store:
        pool = worker_pool(workers) if executor is None else executor
        interrupted = True
        try:
            ran, interrupted = _walk(sweep, store, pool, workers or _size(pool), progress, until)
        finally:
            if own and interrupted:
                stop_workers(pool)
            elif own:
                pool.shutdown(wait=False, cancel_futures=True)
        return SweepReport(store.counts(), ran, time.perf_counter() - begin, interrupted)


def _size(pool: Any) -> int:
    """Scenes to keep in flight: the workers of the pool where it says, else as many as there are processors."""
    import os

    count = getattr(pool, "_max_workers", None) or getattr(pool, "num_workers", None)
    return int(count or os.cpu_count() or 1)


def _walk(
    sweep: Sweep,
    store: Store,
    pool: Executor,
    workers: int,
    progress: Progress | None,
    until: float = math.inf,
) -> tuple[int, bool]:
    done = frozenset(store.done())
    waiting = (index for index in range(sweep.count) if index not in done)
    running: set[Future[Any]] = set()
    finished, ran, states = len(done), 0, 0

    try:
        while True:
            while len(running) < 2 * workers:  # one in work, one at hand
                index = next(waiting, None)
                if index is None:
                    break
                running.add(pool.submit(run_scene, sweep, index))
            if not running:
                return ran, False
            left = None if until == math.inf else max(until - time.monotonic(), 0.0)
            ended = wait(running, left, return_when=FIRST_COMPLETED).done
            if not ended or time.monotonic() > until:
                for future in running:
                    future.cancel()
                return ran, True
            for future in ended:
                running.remove(future)
                outcome = future.result()
                store.add(outcome, sweep.parameters(outcome.scene))
                finished, ran, states = finished + 1, ran + 1, states + len(outcome.states)
                if progress:
                    progress(finished, sweep.count, states)
    except BrokenExecutor:
        raise SweepError(
            f"a worker died after {ran:,} scenes (killed, or out of memory): what finished is stored, "
            "the same command goes on; fewer --workers need less memory"
        ) from None
    except KeyboardInterrupt:
        for future in running:
            future.cancel()
        return ran, True
