"""Run a sweep on any executor of `concurrent.futures`: processes, a Dask cluster, MPI.

Every scene is searched by itself; so the answers depend on neither workers, nor interruptions, nor the order of
completion.
"""

from __future__ import annotations

import itertools
import math
import os
import time
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from pathlib import Path
from typing import Any, NamedTuple

from origami_nlp.arguments import check_callback, check_path, check_type, check_until, check_whole
from origami_nlp.errors import OrigamiError, OutOfTime, SweepError
from origami_nlp.sweep.spec import Sweep
from origami_nlp.sweep.store import Store
from origami_nlp.workers import stop_workers, worker_pool

Progress = Callable[[int, int, int], None]
"""Called with scenes finished, scenes in all, and minima found since the run began."""


class SweepReport(NamedTuple):
    """How a run ended.

    Attributes
    ----------
    counts
        Number of scenes of each status.
    ran
        Scenes run now.
    interrupted
        Whether Ctrl-C, or the time limit, ended it.
    """

    counts: dict[str, int]
    ran: int
    interrupted: bool


def run_scene(sweep: Sweep, index: int) -> dict[str, Any]:
    """Find the states of one scene; errors become its outcome, a line of the store (this is what a worker does)."""
    begin = time.perf_counter()
    outcome: dict[str, Any] = {"scene": index, "parameters": sweep.parameters(index)}
    outcome |= {"status": "done", "reason": "", "seconds": 0.0, "starts": 0, "states": []}
    try:
        made = sweep.scene(index)
    except OrigamiError as error:
        return outcome | {"status": "invalid", "reason": str(error)}
    try:
        found = sweep.minima(made)
    except Exception as error:  # whatever it is: it is reported, by name
        reason = f"{type(error).__name__}: {error}".splitlines()[0]
        outcome |= {"status": "failed", "reason": reason}
    else:
        # JSON has nothing that is not finite
        finite = lambda v: None if isinstance(v, float) and not math.isfinite(v) else v  # noqa: E731
        states = [{k: finite(v) for k, v in row.items() if k != "scene"} for row in found._rows()]
        outcome |= {"starts": found.search.starts, "states": states}
    return outcome | {"seconds": time.perf_counter() - begin}


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
    check_callback("progress", progress)
    until = check_until(seconds)
    with Store(folder, sweep) as store:
        pool = worker_pool(workers) if executor is None else executor
        # as many scenes in flight as the pool says it has workers, or as there are processors
        own = getattr(pool, "_max_workers", 0) or getattr(pool, "num_workers", 0)
        flying = int(workers or own or os.cpu_count() or 1)
        before = sum(status != "failed" for status in store.status.values())
        ran, interrupted = 0, True
        try:
            for ran, states in _walk(store, pool, flying, until):
                if progress:
                    progress(before + ran, sweep.count, states)
            interrupted = False
        except BrokenExecutor:
            died = f"a worker died after {ran:,} scenes (killed, or out of memory)"
            raise SweepError(f"{died}: the same command goes on; fewer --workers may do") from None
        except (KeyboardInterrupt, OutOfTime):
            pass
        finally:
            if executor is None and interrupted:
                stop_workers(pool)
            elif executor is None:
                pool.shutdown(wait=False, cancel_futures=True)
    return SweepReport(dict(Counter(store.status.values())), ran, interrupted)


def _walk(store: Store, pool: Executor, workers: int, until: float) -> Iterator[tuple[int, int]]:
    """Run what is left, and give after each scene how many were run, and how many minima they have."""
    sweep = store.sweep
    waiting = (k for k in range(sweep.count) if store.status.get(k, "failed") == "failed")
    running, ran, states = set[Future[Any]](), 0, 0
    try:
        while True:
            for index in itertools.islice(waiting, 2 * workers - len(running)):
                running.add(pool.submit(run_scene, sweep, index))  # one in work, one at hand
            if not running:
                return
            left = None if until == math.inf else max(until - time.monotonic(), 0.0)
            ended = wait(running, left, return_when=FIRST_COMPLETED).done
            if not ended or time.monotonic() > until:
                raise OutOfTime
            for future in ended:
                running.remove(future)
                store.add(outcome := future.result())
                ran, states = ran + 1, states + len(outcome["states"])
                yield ran, states
    finally:
        for future in running:
            future.cancel()
