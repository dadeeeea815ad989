"""Results that several test modules read, computed once per run, whichever process asks first.

They are of the code under test: the folder belongs to one run of pytest and ends with it.
"""

import dataclasses
import functools
import hashlib
import inspect
import math
import pickle
import re
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import pytest
from filelock import FileLock

from origami_nlp import MinimaResult, Scene, examples, find_minima, proof
from origami_nlp.barriers import Barriers, find_barriers
from origami_nlp.chart import Boundary, trace_boundary
from origami_nlp.contact import find_contacts
from origami_nlp.minima import JudgedState
from origami_nlp.paper import find_critical_points
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_states import find_states
from origami_nlp.proof import Proof, ReducedVertex, prove_sheet

T = TypeVar("T")
PANELS = examples.panels()
SEARCH = find_states
"""The true one: where this module imports it nothing stands in its place yet."""
DEFAULTS = {name: p.default for name, p in inspect.signature(SEARCH).parameters.items()}
FAR = 100.0
"""Seconds to a limit of time that says nothing of what takes a few."""
folder: Path | None = None
"""Where the processes of this run share results; set by `conftest.py` before the first test."""


def once(name: str, compute: Callable[[], T]) -> T:
    """Return `compute()`, or what another process of this run computed under the same name."""
    assert folder is not None, "results are shared among tests, not at import"
    path = folder / f"{name}.pickle"
    with FileLock(path.with_suffix(".lock")):  # a process that asks meanwhile waits for the result
        if path.exists():
            return pickle.loads(path.read_bytes())
        value = compute()
        path.write_bytes(pickle.dumps(value))
    return value


def shared(compute: Callable[..., T]) -> Callable[..., T]:
    """Compute a function of words and numbers once per run; each process reads what it needs once."""

    @functools.wraps(compute)
    def ask(*arguments: str | float) -> T:
        words = "-".join((compute.__module__, compute.__name__, *map(str, arguments)))
        return once(re.sub(r"[^\w.,+-]", "_", words), lambda: compute(*arguments))

    return functools.cache(ask)


def by_scene(compute: Callable[..., T]) -> Callable[..., T]:
    """Compute a function of a scene (or of its model) once per run for each scene; its name does not count.

    What depends on time, or is asked to keep a record, is computed each time.
    """

    @functools.wraps(compute)
    def ask(stated: Scene | ReducedVertex, *arguments: Any, **options: Any) -> T:
        if {"seconds", "record"} & set(options):
            return compute(stated, *arguments, **options)
        name = _question(compute, stated, arguments, options)
        return once(name, lambda: compute(stated, *arguments, **options))

    return ask


def _question(compute: Callable[..., Any], stated: Scene | ReducedVertex, *what: Any) -> str:
    """A name of what a function is asked of a scene, or of its model."""
    scene = stated if isinstance(stated, Scene) else stated.scene
    numbers = [] if stated is scene else stated.problem.parameters.vector.tolist()
    asked = repr((dataclasses.asdict(scene) | {"name": ""}, numbers, *what))
    return f"{compute.__name__}-{hashlib.sha256(asked.encode()).hexdigest()}"


def by_pattern(compute: Callable[..., T]) -> Callable[..., T]:
    """Compute a proof of a pattern once per run for each, the same to the last bit, if its limit of time is far."""

    @functools.wraps(compute)
    def ask(pattern: Pattern, *, until: float = math.inf, **options: Any) -> T:
        if until < time.monotonic() + FAR:
            return compute(pattern, until=until, **options)
        asked = inspect.signature(compute).bind(pattern, **options)
        asked.apply_defaults()  # what is said and what goes without saying is one question
        name = f"{compute.__name__}-{_digest(pattern, asked.kwargs | {'until': None})}"
        return once(name, lambda: compute(pattern, until=until, **options))

    return ask


def prove(*vertices: ReducedVertex, until: float = math.inf, **options: Any) -> Proof:
    """Prove the list of a vertex once per run, if its limit of time is far."""
    if until < time.monotonic() + FAR:
        return proof.prove(*vertices, until=until, **options)
    names = "".join(_question(proof.prove, one, options) for one in vertices)
    name = hashlib.sha256(names.encode()).hexdigest()
    return once(f"proof-{name}", lambda: proof.prove(*vertices, **options))


prove_sheet = by_pattern(prove_sheet)
"""As tests of proofs and of their check ask, and searches: each sheet is proved once a run."""


def by_states(compute: Callable[..., list[JudgedState]]) -> Callable[..., list[JudgedState]]:
    """Compute what it takes to leave states of a pattern once per run, likewise for the same curves and states."""

    @functools.wraps(compute)
    def ask(curves: Any, states: Sequence[JudgedState], *asked: Any) -> list[JudgedState]:
        if curves.problem.until < time.monotonic() + FAR:
            return compute(curves, states, *asked)
        known = [(s.verdict, s.fold_angles) for s in states]
        traced = [(t.curve.states, t.curve.ends) for t in curves.found]
        name = f"leave-{_digest(curves.problem.pattern, known, traced, asked)}"
        found = once(name, lambda: [s.escape for s in compute(curves, states, *asked)])
        return [dataclasses.replace(s, escape=e) for s, e in zip(states, found, strict=True)]

    return ask


def _digest(pattern: Pattern, *what: Any) -> str:
    """A name of a pattern, whatever it has computed of itself, and of plain data."""
    fields = [getattr(pattern, field.name) for field in dataclasses.fields(pattern)]
    return hashlib.sha256(pickle.dumps((fields, what))).hexdigest()


def panel_result(scene: Scene, *, full: bool = False) -> MinimaResult:
    """Return `find_minima(scene, full=full)` of one of the paper's 18 panels; all but its seconds are the same."""
    result = _searched(PANELS.index(scene))
    if full:
        return result
    # the search in the full space only adds its verdicts
    minima = tuple(dataclasses.replace(m, full_space=None) for m in result.minima)
    return dataclasses.replace(result, minima=minima)


@shared
def _searched(number: int) -> MinimaResult:
    return SEARCH(PANELS[number], full=True)


_kept = by_scene(SEARCH)


def minima_once(scene: Any, **options: Any) -> MinimaResult:
    """Return `find_states(scene, **options)`, the same for the same question of a vertex; no progress is reported."""
    if not isinstance(scene, Scene):
        return SEARCH(scene, **options)
    asked = {
        k: v for k, v in options.items() if k not in ("progress", "found") and v != DEFAULTS[k]
    }
    if scene in PANELS and set(asked) <= {"full"}:
        found = panel_result(scene, full=asked.get("full") is not False)
        return dataclasses.replace(
            found, origami=scene
        )  # what is asked for has a name and a file of its own
    return _kept(scene, **asked)


@shared
def states(name: str) -> MinimaResult:
    """Return the states of a pattern by name, of few starts, with what it takes to leave each."""
    return find_minima(name, starts=10)


@shared
def touching() -> Any:
    """Return the states of a metasheet of which facets touch, with no proof and no way to leave them."""
    return find_minima("metasheet:4x4", starts=10, prove=False, escape=False)


@shared
def panel_barriers() -> Barriers:
    """Return the barriers of the panel alpha_1 = pi/4, r_k = 0.01."""
    scene = examples.degree6("pi/4", 0.01)
    return find_barriers(scene, panel_result(scene, full=True))


@shared
def panel_contacts() -> Any:
    """Return what holds the states of the panel of degree 8 with alpha_1 = pi/12, r_k = 0.01, with its segments."""
    return find_contacts(panel_result(examples.degree8("pi/12", 0.01)), segments=True)


@shared
def panel_points(number: int) -> Any:
    """Return the critical points of a panel."""
    return find_critical_points(PANELS[number])


@shared
def panel_boundary(number: int) -> Boundary:
    """Return the boundary of a panel's landscape."""
    return trace_boundary(PANELS[number])


def thinned(cases: Sequence[Any], step: int) -> list[Any]:
    """Every `step`-th case; the others wait for the long studies (`pytest -m slow`).

    A tuple is the values of several arguments.
    """
    rows = [case if isinstance(case, tuple) else (case,) for case in cases]
    return [
        pytest.param(*row, marks=[pytest.mark.slow] if k % step else [])
        for k, row in enumerate(rows)
    ]
