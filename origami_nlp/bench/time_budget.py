"""Where the time of the main job goes: one search of each panel, stage by stage, and what share is the floor.

The stage functions of the search are wrapped by stopwatches for the time of one `find_minima`; a stage that runs
inside another counts for itself only.  Inside an IPOPT solve CasADi reports the time in functions and derivatives;
linear algebra is estimated as one dense factorisation (LAPACK) of the KKT matrix an iteration, the rest is
IPOPT's own.  The floor is the function evaluations of the solves alone.  CPU time of one thread, which other
processes of the machine disturb less than wall time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from origami_nlp.files import save_figure
from origami_nlp.pattern import Scene
from origami_nlp.programme import Model
from origami_nlp.show import rows_markdown, rows_table

STAGES = (
    "building",
    "function evaluation",
    "linear algebra",
    "IPOPT overhead",
    "starts",
    "polish",
    "thin sets and foldings",
    "classification",
    "other",
)
FACTORISATIONS_TIMED = 200


@dataclass(frozen=True)
class TimeBudget:
    """Seconds of one search by stage (`STAGES`), with its numbers of solves and IPOPT iterations."""

    name: str
    seconds: dict[str, float]
    solves: int
    iterations: int

    @property
    def total(self) -> float:
        """CPU time of the search, solver building included."""
        return sum(self.seconds.values())

    @property
    def solving(self) -> float:
        """Seconds inside IPOPT."""
        return sum(self.seconds[s] for s in STAGES[1:4])

    @property
    def over_floor(self) -> float:
        """Total time over the floor, the function evaluations of the solves."""
        return self.total / self.seconds["function evaluation"]


class _Stopwatch:
    """Exclusive times of nested stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = dict.fromkeys((*STAGES, "IPOPT"), 0.0)
        self._inside: list[float] = []

    def timed(self, stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """Wrap a function so that its time, less that of stages inside it, counts for `stage`."""

        def wrapped(*args: Any, **options: Any) -> Any:
            self._inside.append(0.0)
            begin = time.process_time()
            try:
                return function(*args, **options)
            finally:
                spent = time.process_time() - begin
                self.seconds[stage] += spent - self._inside.pop()
                if self._inside:
                    self._inside[-1] += spent

        return wrapped


@contextmanager
def _wrapped(owner: Any, name: str, wrap: Callable[[Any], Any]) -> Iterator[None]:
    original = getattr(owner, name)
    setattr(owner, name, wrap(original))
    try:
        yield
    finally:
        setattr(owner, name, original)


def measure(scene: Scene, seed: int = 0) -> TimeBudget:
    """Search a scene once, with everything built anew, and return where the time went."""
    from origami_nlp.kkt import starts
    from origami_nlp.minima import find as minima, ipopt, search
    from origami_nlp.programme import compiled as structure

    watch, inside = _Stopwatch(), {"evaluation": 0.0}
    for cached in (
        structure.compile_structure,
        ipopt.build_solver,
    ):
        cached.cache_clear()

    def asked(programme: Any) -> Any:
        """Let a built programme report CasADi's own times after each solve."""

        class Solver:
            def __call__(self, **arguments: Any) -> Any:
                out = programme.solver(**arguments)
                stats = programme.solver.stats()
                inside["evaluation"] += sum(
                    v for k, v in stats.items() if k.startswith("t_proc_nlp_")
                )
                return out

            def stats(self) -> Any:
                return programme.solver.stats()

        return type(programme)(Solver(), programme.lower, programme.upper)

    def builder(original: Any) -> Any:
        build = watch.timed("building", original)
        return lambda *args: asked(build(*args))

    with ExitStack() as stack:
        for owner, name, stage in (
            (minima, "classify", "classification"),
            (minima, "handle_minima", "thin sets and foldings"),
            (minima, "flat_foldings", "thin sets and foldings"),
            (search, "polish", "polish"),
            (search, "solve", "IPOPT"),
            (search, "solve_on_boundary", "IPOPT"),
            (starts.StartStream, "__next__", "starts"),
        ):
            stack.enter_context(_wrapped(owner, name, partial(watch.timed, stage)))
        stack.enter_context(_wrapped(ipopt, "build_solver", builder))
        begin = time.process_time()
        model = Model(scene)
        watch.timed("building", lambda: model.functions.evaluators)()
        result = minima.find_minima(scene, seed=seed)
        total = time.process_time() - begin
    seconds = dict.fromkeys(STAGES, 0.0)
    for stage, spent in watch.seconds.items():
        if stage in seconds:
            seconds[stage] = spent
    solving = watch.seconds["IPOPT"]
    algebra = min(
        result.search.iterations * _factorisation(model.size, model.equation_count),
        max(0.0, solving - inside["evaluation"]),
    )
    seconds["function evaluation"] = inside["evaluation"]
    seconds["linear algebra"] = algebra
    seconds["IPOPT overhead"] = solving - inside["evaluation"] - algebra
    seconds["other"] = max(0.0, total - sum(watch.seconds.values()))
    return TimeBudget(scene.name or "", seconds, result.search.solves, result.search.iterations)


def _factorisation(variables: int, equations: int) -> float:
    """Seconds of one dense factorisation and solve of a KKT matrix (median)."""
    size = variables + equations
    matrix = np.eye(size) + np.random.default_rng(0).normal(size=(size, size))
    right, times = np.ones(size), []
    for _ in range(FACTORISATIONS_TIMED):
        begin = time.perf_counter()
        np.linalg.solve(matrix, right)
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


HEADS = ("scene", *STAGES, "total [s]", "solves", "iterations", "total / floor")


def rows(budgets: list[TimeBudget]) -> list[tuple[str, ...]]:
    """One row a panel: share of each stage [%], total [s], total over floor; and the sum of all."""
    names = [b.name.replace("degree ", "N = ").replace("alpha_1 = ", "") for b in budgets]
    total = {s: sum(b.seconds[s] for b in budgets) for s in STAGES}
    solves, steps = sum(b.solves for b in budgets), sum(b.iterations for b in budgets)
    every = [*budgets, TimeBudget("all", total, solves, steps)]
    return [
        (
            name,
            *(f"{100 * b.seconds[s] / b.total:.0f} %" for s in STAGES),
            f"{b.total:.2f}",
            str(b.solves),
            str(b.iterations),
            f"{b.over_floor:.0f}",
        )
        for name, b in zip([*names, "all"], every, strict=True)
    ]


def markdown(budgets: list[TimeBudget]) -> str:
    """Return the table of `rows` as Markdown."""
    return rows_markdown(HEADS, rows(budgets))


def table(budgets: list[TimeBudget]) -> Any:
    """Return the table of `rows` for the terminal."""
    return rows_table(HEADS, rows(budgets), "where the time of one search goes, CPU seconds")


def draw(budgets: list[TimeBudget], target: Any) -> None:
    """Draw the stages of each panel as stacked bars, and write the figure (suffix decides the format)."""
    from matplotlib.figure import Figure

    colours = (
        "#999999",
        "#0072B2",
        "#56B4E9",
        "#CCE5F2",
        "#F0E442",
        "#E69F00",
        "#CC79A7",
        "#009E73",
        "#DDDDDD",
    )
    figure = Figure(figsize=(9, 0.32 * len(budgets) + 1.8), layout="constrained")
    axes = figure.subplots()
    y, left = np.arange(len(budgets)), np.zeros(len(budgets))
    for stage, colour in zip(STAGES, colours, strict=True):
        width = np.array([b.seconds[stage] for b in budgets])
        axes.barh(y, width, left=left, color=colour, edgecolor="white", linewidth=0.4, label=stage)
        left += width
    axes.set_yticks(y, [b.name for b in budgets], fontsize=8)
    axes.set_ylim(len(budgets) - 0.4, -0.6)
    axes.set_xlabel("seconds of one search (CPU time, solver building included)")
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(
        *axes.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=5,
        fontsize=8,
        frameon=False,
    )
    save_figure(figure, target, 150)
