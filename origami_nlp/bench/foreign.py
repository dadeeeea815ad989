"""Searches that a user would write without this package, for as long as they are given: multi-starts of SLSQP and
IPOPT, and basin hopping.

They get the package's own programme (closure, planes between facets that an answer makes cross) with exact
derivatives, and none of its starts: uniform random fold angles, some of them shut at random, or starts that are
handed in.  What they end at is recorded as it comes, with the processor time; nothing is judged here.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.bench.attempt import FEASIBLE, Attempt, Method, StartPoint
from origami_nlp.bench.methods_casadi import ipopt_alone, silence
from origami_nlp.bench.methods_scipy import Record, basin_hopping, contacts_held, scipy_methods
from origami_nlp.programme import Model

Starts = Callable[[Model, np.random.Generator], Iterator[np.ndarray]]


@dataclass(frozen=True)
class Ends:
    """Where the attempts of one search ended.

    method, scene: which.  seed: of its starts.  building: seconds before the first start.
    seconds: processor time at the end of each attempt, from the first start [a].  claims: whether the method says that
    it is a minimum and constraints hold to 1e-6 [a].  x: the state [a, n]; NaN where there is none.
    """

    method: str
    scene: str
    seed: int
    building: float
    seconds: np.ndarray
    claims: np.ndarray
    x: np.ndarray


def uniform(model: Model, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Draw fold angles uniformly for ever."""
    while True:
        yield rng.uniform(-model.bound, model.bound, model.size)


def shut(model: Model, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Draw fold angles uniformly, then shut (+-pi) a random share of them, for ever."""
    for x in uniform(model, rng):
        chosen = rng.random(model.size) < rng.random()
        yield np.where(chosen, np.copysign(np.pi, x), x)


def given(starts: Sequence[np.ndarray] | np.ndarray) -> Starts:
    """Return starts that are handed in [K, n], in random order, each once; then uniform ones."""

    def stream(model: Model, rng: np.random.Generator) -> Iterator[np.ndarray]:
        for k in rng.permutation(len(starts)):
            yield np.asarray(starts[k], dtype=float)
        yield from uniform(model, rng)

    return stream


Run = Callable[[np.ndarray, np.random.Generator, Record], bool]
"""One attempt from a start (for basin hopping, a chain of them), filed; whether there is time for more."""


@dataclass(frozen=True)
class Foreign:
    """A search that shares nothing with the package's but the programme.

    name: for tables.  prepare(model): builds what is needed.  starts: where its attempts begin.
    """

    name: str
    prepare: Callable[[Model], Run]
    starts: Starts = uniform


def foreign_methods(starts: np.ndarray | None = None) -> list[Foreign]:
    """Return the foreign searches; with `starts` [K, n] also SLSQP from these."""
    slsqp = _attempts(
        next(m for m in scipy_methods(raw=False) if m.name == "SLSQP" and not m.sweep)
    )
    ipopt = _attempts(next(m for m in ipopt_alone() if not m.sweep))
    out = [
        Foreign("SLSQP", slsqp),
        Foreign("SLSQP, some shut", slsqp, shut),
        Foreign("IPOPT", ipopt),
        Foreign("basin hopping", basin_hopping),
        Foreign("SLSQP, contacts held", contacts_held, shut),
    ]
    if starts is not None:
        out.append(Foreign("SLSQP, given starts", slsqp, given(starts)))
    return out


def _attempts(method: Method) -> Callable[[Model], Run]:
    def prepare(model: Model) -> Run:
        solver = method.prepare(model)
        return lambda x, rng, record: record(solver(StartPoint(x, x, ())))

    return prepare


def run_foreign(method: Foreign, model: Model, seed: int, budget: float) -> Ends:
    """Run a foreign search for `budget` seconds of processor time (the attempt under way is finished)."""
    rng = np.random.default_rng([seed, 7])
    begin = time.process_time()
    seconds: list[float] = []
    claims: list[bool] = []
    states: list[np.ndarray] = []
    nothing = np.full(model.size, np.nan)
    with silence():
        run = method.prepare(model)
        run(np.zeros(model.size), np.random.default_rng(0), lambda attempt: False)  # warm-up
        first = time.process_time()

        def record(attempt: Attempt) -> bool:
            seconds.append(time.process_time() - first)
            x = nothing if attempt.x is None else np.array(attempt.x)
            limits = bool((np.abs(x) <= model.bound + FEASIBLE).all())
            claims.append(attempt.claims and limits)
            states.append(np.clip(x, -model.bound, model.bound))
            return seconds[-1] < budget

        for x in method.starts(model, rng):
            if not run(x, rng, record):
                break
    return Ends(
        method.name,
        model.scene.name or "",
        seed,
        first - begin,
        np.array(seconds),
        np.array(claims),
        np.array(states),
    )
