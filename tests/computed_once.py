"""Results that several test modules read, computed once per run, whichever process asks first.

They are of the code under test: the folder belongs to one run of pytest and ends with it.
"""

import dataclasses
import pickle
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from filelock import FileLock

from origami_nlp import Scene, examples, find_minima
from origami_nlp.minima import MinimaResult
from origami_nlp.programme import Model

PANELS = examples.panels()
folder: Path | None = None
"""Where the processes of this run share results; set by `conftest.py` before the first test."""


def once(name: str, compute: Callable[[], Any]) -> Any:
    """Return `compute()`, or what another process of this run computed under the same name."""
    assert folder is not None, "results are shared among tests, not at import"
    path = folder / f"{name}.pickle"
    with FileLock(path.with_suffix(".lock")):  # a process that asks meanwhile waits for the result
        if path.exists():
            return pickle.loads(path.read_bytes())
        value = compute()
        path.write_bytes(pickle.dumps(value))
    return value


def panel_result(scene: Scene, *, full: bool = False) -> MinimaResult:
    """Return `find_minima(scene, full=full)` of one of the paper's 18 panels; all but its seconds are the same."""
    number = PANELS.index(scene)
    minima, search = _searched(number)
    if not full:  # the search in the full space only adds its verdicts
        minima = tuple(dataclasses.replace(m, full_space=None) for m in minima)
    # the model holds compiled functions, which each process keeps for itself
    return MinimaResult(scene, Model(scene), minima, search)


@cache
def _searched(number: int) -> tuple[Any, Any]:
    def search() -> tuple[Any, Any]:
        result = find_minima(PANELS[number], full=True)
        return result.minima, result.search

    return once(f"panel-{number}", search)
