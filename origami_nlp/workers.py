"""Worker processes that end with the process that started them."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from concurrent.futures import Executor, ProcessPoolExecutor
from multiprocessing.context import SpawnContext, SpawnProcess


class _Worker(SpawnProcess):
    """A process that Ctrl-C does not reach, from its first instruction on: it is for who started it to say so."""

    def start(self) -> None:
        """Start with the signal blocked, which it inherits; one that comes meanwhile is ours when it is there."""
        if not hasattr(signal, "pthread_sigmask"):  # Windows
            return super().start()
        former = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, former)


class _Context(SpawnContext):
    Process = _Worker


def worker_pool(workers: int | None = None) -> ProcessPoolExecutor:
    """Return a pool of `workers` fresh processes (one a processor by default).

    Fresh, since CasADi's state does not survive a fork of a process with threads.  Workers wait for work on a
    pipe that their siblings keep open: without more, those of a parent that is killed (-9) would wait for ever.
    """
    return ProcessPoolExecutor(workers, mp_context=_Context(), initializer=_end_with_parent)


def stop_workers(pool: Executor) -> None:
    """End the processes of a pool now: nobody waits for what they are at."""
    processes = list((getattr(pool, "_processes", None) or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for process in processes:
        process.terminate()


def _end_with_parent() -> None:
    """End this process as soon as the one that started it is gone, however that ended."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True, name="end with parent").start()
