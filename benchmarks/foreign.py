"""Searches that a user would write without this package, for as long as they are given: multi-starts of SLSQP (SciPy's
and, where it is installed, NLopt's), trust-constr and IPOPT, and basin hopping.

They get the package's own problem (closure, planes between facets that an answer makes cross) with exact
derivatives, and none of its starts: uniform random fold angles, some of them fully folded at random, or starts that are
handed in.  What they end at is recorded as it comes, with the processor time; nothing is judged here.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.attempt import FEASIBLE, Attempt, Method, StartPoint
from benchmarks.methods_casadi import ipopt_alone, silence
from benchmarks.methods_nlopt import nlopt_slsqp
from benchmarks.methods_scipy import Record, basin_hopping, contacts_held, scipy_methods
from origami_nlp.kkt import project
from origami_nlp.numerics import CLOSURE_TOL, ENDPOINT_TOL
from origami_nlp.problem import Model

DRAWN = 256
"""Vertices of the state space that are drawn and closed together."""
BARREN = 20
"""Draws without a single vertex after which there are taken to be none."""

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


def at_limit(model: Model, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Draw fold angles uniformly, then fully folded (+-pi) a random share of them, for ever."""
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


def vertices(model: Model, rng: np.random.Generator) -> Iterator[np.ndarray]:
    """Close random vertices of the state space for ever: all creases fully folded but as many as closure has equations.

    Newton from random angles of the free creases; nothing of the search's closed forms.  Ends where `BARREN` draws
    give none.
    """
    n, m, barren = model.size, model.equation_count, 0
    while barren < BARREN:
        free = rng.random((DRAWN, n)).argsort(axis=1) < m
        flat = rng.choice([-np.pi, np.pi], (DRAWN, n))
        x = np.where(free, rng.uniform(-np.pi, np.pi, (DRAWN, n)), flat)
        x, residual = project(model, x, frozen=~free)
        x = np.where(free, x, flat)
        x = x[(residual <= CLOSURE_TOL) & (np.abs(x) <= model.bound + CLOSURE_TOL).all(axis=1)]
        x = x[model.lifts_to_one(x)]
        barren = 0 if len(x) else barren + 1
        yield from x


def distinct(states: np.ndarray, apart: float) -> list[np.ndarray]:
    """Return states [a, n] that are farther than `apart` from each other in some entry, in their order."""
    out: list[np.ndarray] = []
    while len(states):
        out.append(states[0])
        states = states[np.abs(states - states[0]).max(axis=1) > apart]
    return out


def vertex_starts(model: Model, count: int = 2000) -> np.ndarray:
    """Return distinct states of `vertices` [K, n], starts to be handed in: of `count`, or until no more are new."""
    stream = vertices(model, np.random.default_rng(0))
    found = np.zeros((0, model.size))
    for _ in range(0, count, DRAWN):
        drawn = np.array(list(itertools.islice(stream, DRAWN))).reshape(-1, model.size)
        known, found = len(found), np.array(distinct(np.vstack([found, drawn]), ENDPOINT_TOL))
        if len(found) == known:
            break
    return found.reshape(-1, model.size)


Run = Callable[[np.ndarray, np.random.Generator, Record], bool]
"""One attempt from a start (for basin hopping, a chain of them), filed; whether there is time for more."""


@dataclass(frozen=True)
class Foreign:
    """A search that shares nothing with the package's but the problem.

    name: for tables.  prepare(model): builds what is needed.  starts: where its attempts begin.
    share: of the time for building a union; 0: it is no part of that.  aided: it holds contacts, for building unions
    only: no user's search.
    """

    name: str
    prepare: Callable[[Model], Run]
    starts: Starts = uniform
    share: float = 0.5
    aided: bool = False


def foreign_methods(starts: np.ndarray | None = None) -> list[Foreign]:
    """Return the foreign searches; with `starts` [K, n] also SLSQP from these."""
    slsqp = _attempts(
        next(m for m in scipy_methods(raw=False) if m.name == "SLSQP" and not m.sweep)
    )
    trust = next(m for m in scipy_methods(raw=False) if m.name == "trust-constr" and not m.sweep)
    ipopt = _attempts(next(m for m in ipopt_alone() if not m.sweep))
    out = [
        Foreign("SLSQP", slsqp),
        Foreign("SLSQP, some fully folded", slsqp, at_limit, 1.0),
        Foreign("SLSQP from vertices", slsqp, vertices, aided=True),
        Foreign("IPOPT", ipopt, share=0.25),
        Foreign("basin hopping", basin_hopping, share=0.25),
        Foreign("SLSQP, contacts held", contacts_held, at_limit, 1.0, aided=True),
        Foreign("trust-constr", _attempts(trust), share=0.0),
    ]
    nlopt = nlopt_slsqp()
    if not nlopt.missing:
        out.append(Foreign(nlopt.name, _attempts(nlopt), share=0.0))
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
