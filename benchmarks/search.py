"""Speed against error: how much of what there is a search finds, how fast, and how exactly.

Everything known of a scene is what the main job with all its seeds, `KNOWN` thorough runs of it and the rivals found
together: each end polished, classified, and farther than `APART` from the others.  Seconds are processor time of one
thread (set OMP_NUM_THREADS=1), functions built before.
"""

from __future__ import annotations

import math
import time
from bisect import bisect_right
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from benchmarks.families import family_scene
from benchmarks.reference import Unsolved, solve_reference
from benchmarks.rivals import Ends, rivals, run_rival
from origami_nlp import find_minima
from origami_nlp.display import Table
from origami_nlp.io import Unbounded, from_plain, save_figure, to_plain
from origami_nlp.kkt import Solve, State, classify, exact_beside, polish
from origami_nlp.minima import MinimaResult
from origami_nlp.numerics import ANSWERED, CLOSURE_TOL, ENDPOINT_TOL
from origami_nlp.pattern import Scene
from origami_nlp.pattern_problem import PatternProblem, pose

SCHEMA = "origami-nlp/coverage/1"
RECORD = Path(__file__).with_name("records") / "search.json"
APART = ENDPOINT_TOL
"""Two minima whose fold angles differ by no more [rad] are one."""
FOUND, EXACT = 1e-3, 1e-10
"""An answer within this [rad] of a minimum found it; it is right without a polish."""
KNOWN, SEEDS = 2, 2
"""Thorough runs of the main job behind what is known, and seeds that are measured."""
TIMES = (0.05, 0.1, 0.2, 0.3, 0.5, 1.0)
"""Processor seconds at which searches are compared."""
OURS, RIVAL = "this package", "SLSQP"
STYLES = ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1)), (0, (1, 2)), (0, (3, 2)), (0, (6, 1)))


@dataclass(frozen=True)
class Searched:
    """What one run found.

    seed, seconds: of it.  found: numbers of known minima.  curve: (seconds, how many were known).
    attempts, rejected, false: of rivals: local solves; those that ended at no state; distinct states that were claimed
    and are no minima.  exact, exact_seconds: minima that they found to `EXACT`, and when the last of these.
    error: largest error of a fold angle [rad], median of what rivals claimed near a minimum; of the main job, against
    50 digits, the largest.
    """

    seed: int
    seconds: float
    found: tuple[int, ...]
    curve: tuple[tuple[float, int], ...]
    attempts: int = 0
    rejected: int = 0
    false: int = 0
    exact: int = 0
    exact_seconds: Unbounded = math.inf
    error: Unbounded = math.inf


@dataclass
class Covered:
    """All runs on one scene, by the name of the searcher; minima: how many are known."""

    family: str
    name: str
    degree: int
    minima: int = 0
    runs: dict[str, list[Searched]] = field(default_factory=dict)


def minimum_near(problem: PatternProblem, x: np.ndarray) -> np.ndarray | None:
    """Polish and classify the end [n] of any search: the minimum there, or None.

    The bound forces that the polish starts from balance the pull of the springs at x.
    """
    local = problem.local(x)
    free = np.abs(x) < problem.bound - ANSWERED
    lam = np.linalg.lstsq(local.closure_jacobian.T[free], local.gradient[free], rcond=None)[0]
    pull = np.where(free, 0.0, local.gradient - local.closure_jacobian.T @ lam)
    residual = float(np.abs(local.closure).max())
    state = polish(problem, Solve(x, "Solve_Succeeded", 0, residual, pull))
    if not state.converged:
        state = exact_beside(problem, state)
    if state.closure_residual > CLOSURE_TOL:
        return None
    what = classify(State(problem, state.x), polished=state.converged)
    return state.x if what.verdict == "minimum" else None


class Known:
    """The minima of a scene [K, n] that anything found."""

    def __init__(self, problem: PatternProblem) -> None:
        self.problem, self.states = problem, np.zeros((0, problem.size))

    def nearest(self, x: np.ndarray) -> tuple[int, float]:
        """Return the nearest minimum (-1 without any), and how far it is [rad]."""
        if not len(self.states):
            return -1, math.inf
        far = np.abs(self.states - x).max(axis=1)
        return int(far.argmin()), float(far.min())

    def add(self, minima: Iterable[np.ndarray]) -> tuple[int, ...]:
        """File minima, and return their numbers."""
        out = set()
        for x in minima:
            k, far = self.nearest(x)
            if far > APART:
                k, self.states = len(self.states), np.vstack([self.states, x])
            out.add(k)
        return tuple(sorted(out))

    def claimed(self, ends: Ends) -> tuple[np.ndarray, int]:
        """Return which ends are states and claimed [a], and how many distinct ones are no minima; new are filed."""
        good, false, seen = ends.claims.copy(), 0, np.zeros((0, self.problem.size))
        if good.any():
            good[good] = self.problem.admissible(ends.x[good], ANSWERED)
        for x in ends.x[good]:
            if self.nearest(x)[1] <= FOUND or (np.abs(seen - x).max(axis=1) <= FOUND).any():
                continue
            seen = np.vstack([seen, x])
            minimum = minimum_near(self.problem, x)
            false += minimum is None
            if minimum is not None:
                self.add([minimum])
        return good, false

    def judge(self, ends: Ends, seed: int, good: np.ndarray, false: int) -> Searched:
        """Say when a rival first came to each minimum: near it, and to `EXACT`."""
        first: dict[float, dict[int, float]] = {FOUND: {}, EXACT: {}}
        errors = []
        for t, x in zip(ends.seconds[good].tolist(), ends.x[good], strict=True):
            k, far = self.nearest(x)
            for within, when in first.items():
                if far <= within:
                    when.setdefault(k, t)
            errors += [far] if far <= FOUND else []
        times = sorted(first[FOUND].values())
        return Searched(
            seed,
            float(ends.seconds[-1]),
            tuple(sorted(first[FOUND])),
            tuple((t, n) for n, t in enumerate(times, start=1)),
            len(good),
            int(len(good) - good.sum()),
            false,
            len(first[EXACT]),
            max(first[EXACT].values(), default=math.inf),
            median(errors) if errors else math.inf,
        )


def largest_error(result: MinimaResult) -> float:
    """Return the largest error of a fold angle against 50 digits [rad], of minima that have a reference."""
    problem, errors = pose(result.scene), [0.0]
    for m in result.minima:
        x = problem.reduce(np.array(m.fold_angles))
        try:
            reference = solve_reference(problem, x, State(problem, x).pieces[0])
        except Unsolved:
            continue
        errors.append(reference.angle_error(x))
    return max(errors)


def run_ours(
    scene: Scene, problem: PatternProblem, known: Known, seed: int, **options: Any
) -> Searched:
    """Run the main job once, without proof and escapes."""
    curve: list[tuple[float, int]] = []

    def progress(starts: int, found: int, *rest: object) -> None:
        if not curve or found != curve[-1][1]:
            curve.append((time.process_time() - begin, found))

    begin = time.process_time()
    given = {"prove": False, "escape": False, "progress": progress, **options}
    result = find_minima(scene, seed=seed, **given)
    seconds = time.process_time() - begin
    found = known.add(problem.reduce(np.array(m.fold_angles)) for m in result.minima)
    curve.append((seconds, len(result.minima)))
    error = math.inf if options else largest_error(result)
    return Searched(seed, seconds, found, tuple(curve), error=error)


def measure_search(
    scenes: Sequence[tuple[str, int]],
    budget: float = 1.0,
    progress: Callable[[str], object] = lambda text: None,
) -> dict[str, Any]:
    """Measure searches on scenes (family, number 0-based), rivals for `budget` seconds each; returns plain data."""
    out = []
    for family, number in scenes:
        scene = family_scene(family, number)
        problem = pose(scene)
        known = Known(problem)
        progress(scene.name or "")
        find_minima(scene, max_starts=1, prove=False, escape=False)  # warm-up
        runs = {OURS: [run_ours(scene, problem, known, seed) for seed in range(SEEDS)]}
        for seed in range(SEEDS, SEEDS + KNOWN):
            run_ours(scene, problem, known, seed, effort="thorough")
        ends = [run_rival(rival, problem, 1, budget) for rival in rivals()]
        claims = [known.claimed(e) for e in ends]
        for e, (good, false) in zip(ends, claims, strict=True):
            runs[e.name] = [known.judge(e, 1, good, false)]
        one = Covered(family, scene.name or "", scene.degree, len(known.states), runs)
        out.append(to_plain(one))
    return {"schema": SCHEMA, "settings": {"seeds": SEEDS, "budget": budget}, "scenes": out}


# ---------------------------------------------------------------- what a measurement says


def scenes_of(data: dict[str, Any]) -> dict[str, list[Covered]]:
    """Return the scenes of a measurement by family."""
    out: dict[str, list[Covered]] = {}
    for plain in data["scenes"]:
        runs = {name: [from_plain(Searched, r) for r in of] for name, of in plain["runs"].items()}
        out.setdefault(plain["family"], []).append(Covered(**{**plain, "runs": runs}))
    return out


def share_at(scenes: Sequence[Covered], name: str, seconds: float) -> float:
    """Return the share of all minima that a searcher knows after so many seconds, mean over its seeds."""
    known = 0.0
    for c in scenes:
        for r in c.runs[name]:
            position = bisect_right([t for t, _ in r.curve], seconds)
            known += (r.curve[position - 1][1] if position else 0) / len(c.runs[name])
    return known / sum(c.minima for c in scenes)


def cost_of_exact(scenes: Sequence[Covered], name: str) -> list[float]:
    """Return, of each scene, seconds a minimum right to `EXACT` of a rival until its last, over ours; sorted."""
    out = []
    for c in scenes:
        ours = sum(r.seconds for r in c.runs[OURS]) / sum(len(r.found) for r in c.runs[OURS])
        out += [r.exact_seconds / r.exact / ours if r.exact else math.inf for r in c.runs[name]]
    return sorted(out)


HEADS = ("search", *(f"{t:g} s" for t in TIMES), "ms a minimum", "error [rad]", "false", "to 1e-10")


def rows(scenes: Sequence[Covered]) -> list[tuple[str, ...]]:
    """Return one row a searcher: share known after `TIMES`, cost, error, false answers, time for exact ones."""
    out = []
    for name in scenes[0].runs:
        runs = [r for c in scenes for r in c.runs[name]]
        seconds, found = sum(r.seconds for r in runs), sum(len(r.found) for r in runs)
        rival = name != OURS
        out.append(
            (
                name,
                *(f"{100 * share_at(scenes, name, t):.1f} %" for t in TIMES),
                f"{1e3 * seconds / found:.3g}" if found else "-",
                f"{median(r.error for r in runs):.0e}" if rival else "rounding",
                str(sum(r.false for r in runs)),
                f"{median(cost_of_exact(scenes, name)):.2g}" if rival else "1",
            )
        )
    return out


def search_tables(data: dict[str, Any]) -> list[Table]:
    """Return the tables of all scenes, and of each family."""
    families = scenes_of(data)
    parts = {"all scenes": [c for of in families.values() for c in of], **families}
    tables = []
    for title, scenes in parts.items():
        minima = sum(c.minima for c in scenes)
        title = f"{title}: {len(scenes)} scenes, {minima} minima"
        tables.append(Table(HEADS, rows(scenes), title))
    return tables


def draw_search(data: dict[str, Any], target: str | Path) -> None:
    """Draw the share of all minima against seconds, a panel a family."""
    from matplotlib.figure import Figure

    families = scenes_of(data)
    figure = Figure(figsize=(4.6 * len(families), 4.2), layout="constrained")
    axes = figure.subplots(1, len(families), squeeze=False, sharey=True)[0]
    times = np.geomspace(0.02, max(1.0, float(data["settings"]["budget"])), 90)
    for ax, (family, scenes) in zip(axes, families.items(), strict=True):
        for k, name in enumerate(scenes[0].runs):
            y = [100 * share_at(scenes, name, t) for t in times]
            style, colour = STYLES[k % len(STYLES)], "black" if name == OURS else f"C{k}"
            ax.plot(times, y, linestyle=style, color=colour, lw=2.5 - (k > 0), label=name)
        ax.set(xscale="log", ylim=(0, 102), xlabel="processor seconds")
        ax.set_xticks(TIMES, [f"{t:g}" for t in TIMES])
        ax.minorticks_off()
        ax.set_title(f"{family}: {sum(c.minima for c in scenes)} minima", fontsize=10)
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("share of all known minima [%]")
    figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    save_figure(figure, target, 150)
