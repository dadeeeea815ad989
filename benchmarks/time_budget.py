"""Where the time of the main job goes: one search of each panel, stage by stage.

The stage functions of the search are wrapped by stopwatches for the time of one `find_minima`; a stage that runs
inside another counts for itself only.  CPU time of one thread, which other processes of the machine disturb less
than wall time.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from origami_nlp.display import label_text, rows_markdown, rows_table
from origami_nlp.io import save_figure
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model

STAGES = (
    "building",
    "starts",
    "descents",
    "foldings and hinges",
    "polish",
    "judging",
    "IPOPT confirms",
    "escape barriers",
    "without symmetry",
    "other",
)


@dataclass(frozen=True)
class TimeBudget:
    """Seconds of one search by stage (`STAGES`), its starts, and what IPOPT did to confirm the minima."""

    name: str
    seconds: dict[str, float]
    starts: int
    solves: int
    iterations: int

    @property
    def total(self) -> float:
        """CPU time of the search, solver building included."""
        return sum(self.seconds.values())


class _Stopwatch:
    """Exclusive times of nested stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = dict.fromkeys(STAGES, 0.0)
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
    from origami_nlp.minima import descents, find, ipopt, job, record
    from origami_nlp.problem import compiled as structure
    from origami_nlp.starts import rounds

    watch = _Stopwatch()
    for cached in (structure.compile_structure, ipopt.build_solver, ipopt.build_warm):
        cached.cache_clear()
    with ExitStack() as stack:
        for owner, name, stage in (
            (record, "classify", "judging"),
            (job.FlatFoldings, "states", "foldings and hinges"),
            (job.HingeSets, "states", "foldings and hinges"),
            (job, "polish", "polish"),
            (record, "polish", "polish"),
            (find, "confirm", "IPOPT confirms"),
            (find, "escapes_of_each", "escape barriers"),
            (find, "_in_full_space", "without symmetry"),
            (ipopt, "build_warm", "building"),
            (descents.Descents, "run", "descents"),
            (rounds.Rounds, "_round", "starts"),
            (rounds.Corners, "draw", "starts"),
        ):
            stack.enter_context(_wrapped(owner, name, partial(watch.timed, stage)))
        begin = time.process_time()
        model = Model(scene)
        watch.timed("building", lambda: model.functions.evaluators)()
        result = find.find_minima(scene, seed=seed, prove=False)
        total = time.process_time() - begin
    seconds = dict(watch.seconds)
    seconds["other"] = max(0.0, total - sum(watch.seconds.values()))
    s = result.search
    return TimeBudget(scene.name or "", seconds, s.starts, s.solves, s.iterations)


HEADS = ("scene", *STAGES, "total [s]", "starts", "solves", "iterations")


def rows(budgets: list[TimeBudget]) -> list[tuple[str, ...]]:
    """One row a panel: share of each stage [%], total [s]; and the sum of all."""
    names = [b.name.replace("degree ", "N = ").replace("alpha_1 = ", "") for b in budgets]
    total = {s: sum(b.seconds[s] for b in budgets) for s in STAGES}
    counts = [sum(getattr(b, f) for b in budgets) for f in ("starts", "solves", "iterations")]
    every = [*budgets, TimeBudget("all", total, *counts)]
    return [
        (
            name,
            *(f"{100 * b.seconds[s] / b.total:.0f} %" for s in STAGES),
            f"{b.total:.2f}",
            str(b.starts),
            str(b.solves),
            str(b.iterations),
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
        "#F0E442",
        "#0072B2",
        "#CC79A7",
        "#E69F00",
        "#009E73",
        "#56B4E9",
        "#D55E00",
        "#000000",
        "#DDDDDD",
    )
    figure = Figure(figsize=(9, 0.32 * len(budgets) + 1.8), layout="constrained")
    axes = figure.subplots()
    y, left = np.arange(len(budgets)), np.zeros(len(budgets))
    for stage, colour in zip(STAGES, colours, strict=True):
        width = np.array([b.seconds[stage] for b in budgets])
        axes.barh(y, width, left=left, color=colour, edgecolor="white", linewidth=0.4, label=stage)
        left += width
    axes.set_yticks(y, [label_text(b.name) for b in budgets], fontsize=9)
    axes.set_ylim(len(budgets) - 0.4, -0.6)
    axes.set_xlabel("seconds of one search (CPU time, solver building included)")
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(
        *axes.get_legend_handles_labels(),
        loc="outside lower center",
        ncols=4,
        fontsize=8,
        frameon=False,
    )
    save_figure(figure, target, 150)
