"""One run of the whole benchmark, as plain data (schema ``origami-nlp/bench/1``)."""

from __future__ import annotations

import json
import os
import platform
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, replace
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.attempt import Method
from benchmarks.grids import SIZES, run_grid
from benchmarks.hessians import compare_hessians
from benchmarks.interleave import Plan, run_problem
from benchmarks.judging import Judge
from benchmarks.methods_casadi import LEFT_OUT, ipopt_alone, others
from benchmarks.methods_closure import FORMS, closures, evaluation_time, wedge_against_tied
from benchmarks.methods_ours import OURS, ours
from benchmarks.methods_scipy import scipy_methods
from benchmarks.problems import Problem, panel_problems, quick_problems, random_problems
from benchmarks.scaling import run_scaling
from benchmarks.tally import FEWEST_STARTS, Attempts, summary
from benchmarks.union import complete
from origami_nlp.arguments import check_path
from origami_nlp.errors import OptionError
from origami_nlp.io import write_whole
from origami_nlp.minima import FEW_PAIRS, find_minima
from origami_nlp.problem import Model

SCHEMA = "origami-nlp/bench/1"
FULL = Plan(rounds=5, starts=26, sweep=2, budget=0.6)
QUICK = Plan(rounds=5, starts=4, sweep=2, budget=0.8)
JOB_ROUNDS = 2
"""Runs of the whole main job on each problem."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")

Progress = Callable[[str], None]


def run_bench(
    *,
    quick: bool = False,
    seed: int = 0,
    progress: Progress = lambda text: None,
    plan: Plan | None = None,
    unions: str | os.PathLike[str] | None = None,
) -> dict[str, Any]:
    """Run every method on every problem; returns plain data.

    Parameters
    ----------
    quick
        A few problems and methods, fewer starts.
    seed
        Of the random vertices and of all starts.
    progress
        Called with what is being done.
    plan
        How many rounds and starts, if not the usual ones.
    unions
        Folder of unions (`union`), built where they are missing; without one the reference is what one run of the main
        job lists, and what any method finds.
    """
    plan = plan or (QUICK if quick else FULL)
    jobs = 1 if quick else min(JOB_ROUNDS, plan.rounds)
    problems = quick_problems(seed) if quick else [*panel_problems(), *random_problems(seed)]
    methods = [*ours(), *ipopt_alone(), *scipy_methods(), *others()]
    if quick:
        methods = [m for m in methods if m.name in QUICK_METHODS and m.accuracy in QUICK_ACCURACIES]
    data: dict[str, Any] = {
        "schema": SCHEMA,
        "machine": machine(),
        "settings": {"seed": seed, "quick": quick, "job_rounds": jobs, **asdict(plan)},
        "left_out": dict(LEFT_OUT),
    }
    search, judges = run_search(problems, methods, plan, seed, progress, jobs, unions)
    data |= search
    for key, make, of_closure in (
        ("closure", closures, _without_symmetry),
        ("wedge", wedge_against_tied, _with_limits_only),
    ):
        chosen = [p for p in panel_problems() if p.name.endswith("r_k = 1")]
        chosen = of_closure(chosen[:1] if quick else chosen)
        part = replace(plan, rounds=min(3, plan.rounds))
        data[key], _ = run_search(chosen, make(), part, seed, progress)
        if key == "closure":
            model = Model(chosen[0].scene)
            data[key]["evaluation"] = {f: evaluation_time(f, model) for f in FORMS}
    panels = [(p, judges[p.name]) for p in problems if p.family == "panel"]
    data["grid"] = []
    for problem, judge in panels:
        for size in SIZES[:2] if quick else SIZES:
            progress(f"grid of {size} x {size}: {problem.name}")
            found = run_grid(problem, judge, size, min(3, plan.rounds) if size < 500 else 1)
            data["grid"] += [found] if found else []
    progress("appendix A against the exact Hessian")
    states = [[j.model.expand(k.x) for k in j.known if k.kind == "interior"] for _, j in panels]
    data["hessian"] = compare_hessians([p for p, _ in panels], states, max(plan.rounds, 3))
    data["scaling"] = run_scaling(quick, seed, progress)
    return data


QUICK_ACCURACIES = (0.0, 1e-4, 1e-8, 1e-12, 1e-15)
QUICK_METHODS = (
    OURS,
    "IPOPT alone",
    "IPOPT L-BFGS",
    "SLSQP",
    "trust-constr",
    "sqpmethod",
    "fatrop",
)


def run_search(
    problems: Sequence[Problem],
    methods: Sequence[Method],
    plan: Plan,
    seed: int,
    progress: Progress,
    job_rounds: int = 0,
    unions: str | os.PathLike[str] | None = None,
) -> tuple[dict[str, Any], dict[str, Judge]]:
    """Run methods on problems; the first method is what the others are compared with.

    Returns problems, methods and cells as plain data, and the judge of each problem by its name.
    """
    runnable = [m for m in methods if not m.missing]
    judges: dict[str, Judge] = {}
    raw: dict[str, dict[str, Attempts]] = {}
    job = []
    for problem in problems:
        progress(f"references: {problem.name}")
        named = replace(problem.scene, name=problem.name)
        union = complete(named, unions, progress) if unions is not None else None
        judge = judges[problem.name] = Judge.of(problem.scene, seed, union)
        suited = [m for m in runnable if suits(m, judge)]
        progress(f"{len(suited)} methods: {problem.name}")
        raw[problem.name] = run_problem(suited, plan, seed, judge)
        if job_rounds:
            progress(f"whole job: {problem.name}")
            job.append(_whole_job(problem, judge, seed, job_rounds))
    fewest = min(FEWEST_STARTS, plan.rounds * plan.starts)
    cells = [
        {
            "problem": problem.name,
            "method": label,
            **summary(attempts, raw[problem.name][methods[0].label], fewest),
        }
        for problem in problems
        for label, attempts in raw[problem.name].items()
    ]
    data = {
        "problems": [_problem(p, judges[p.name]) for p in problems],
        "methods": [_method(m) for m in methods],
        "cells": cells,
    }
    if job_rounds:
        for record in job:  # judged at the end: any method may have added a minimum
            record["missed"] = len(judges[record["problem"]].known) - len(record["found"])
        data["job"] = job
    return data, judges


def suits(method: Method, judge: Judge) -> bool:
    """Return whether a method is run on a problem.

    The wheel's other solvers are not where more than a few facet pairs have planes: one start then takes seconds to
    minutes, and a compiled solver cannot be interrupted.
    """
    other = method.family in {m.family for m in others()}
    return not other or len(judge.model.structure.pairs) <= FEW_PAIRS


def _whole_job(problem: Problem, judge: Judge, seed: int, rounds: int) -> dict[str, Any]:
    """Time the whole main job: listing, boundaries, starts until the rule, classification."""
    seconds: list[float] = []
    found: dict[str, float | None] = {}
    for r in range(rounds):
        begin = time.process_time()
        result = find_minima(problem.scene, seed=seed + r, prove=False, escape=False)
        seconds.append(time.process_time() - begin)
        for m in result.minima:
            x = judge.model.reduce(np.array(m.fold_angles))
            distance = [float(np.abs(x - k.x).max()) for k in judge.known]
            if not distance or min(distance) > 1e-3:
                index = judge.learn(x, m.kind, "main job, another seed", m.polished)
            else:
                index = int(np.argmin(distance))
            exact = judge.known[index].reference
            error = exact.angle_error(x) if exact else None
            found.setdefault(str(index), error)
    return {"problem": problem.name, "seconds": seconds, "found": found}


def _problem(problem: Problem, judge: Judge) -> dict[str, Any]:
    model = judge.model
    return {
        "name": problem.name,
        "family": problem.family,
        "degree": problem.scene.degree,
        "variables": model.size,
        "contact": problem.scene.contact,
        "symmetry": problem.scene.group.name,
        "pairs": len(model.structure.pairs),
        "minima": [
            {
                "kind": k.kind,
                "source": k.source,
                "energy": k.reference.energy if k.reference else model.energy(k.x),
                "digits": list(k.reference.digits) if k.reference else [],
                "residual": k.reference.residual if k.reference else None,
                "no_reference": k.problem,
            }
            for k in judge.known
        ],
    }


def _method(m: Method) -> dict[str, Any]:
    return {
        "label": m.label,
        "name": m.name,
        "setting": m.setting,
        "family": m.family,
        "accuracy": m.accuracy,
        "missing": m.missing,
        "sweep": m.sweep,
    }


def _without_symmetry(problems: list[Problem]) -> list[Problem]:
    return [
        replace(
            p,
            scene=replace(
                p.scene, symmetry="none", mirror=None, contact="fold-limits", name=p.name
            ),
        )
        for p in problems
    ]


def _with_limits_only(problems: list[Problem]) -> list[Problem]:
    return [replace(p, scene=replace(p.scene, contact="fold-limits")) for p in problems]


def machine() -> dict[str, Any]:
    """Return what the numbers depend on: system, processors, versions, threads."""
    versions = {}
    for name in ("casadi", "numpy", "scipy", "mpmath"):
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    return {
        "system": platform.system(),
        "processor": platform.machine(),
        "processors": os.cpu_count(),
        "python": platform.python_version(),
        "versions": versions,
        "threads": {name: os.environ.get(name, "unset") for name in THREADS},
    }


def write_bench(data: dict[str, Any], target: str | os.PathLike[str]) -> None:
    """Write a run as JSON, whole or not at all, or to standard output for ``"-"``; numbers with six digits."""
    text = json.dumps(_shorter(data), separators=(",", ":"), allow_nan=False) + "\n"
    write_whole(target, text.encode())


def read_bench(source: str | os.PathLike[str]) -> dict[str, Any]:
    """Read a run back.

    Raises
    ------
    OptionError
        If the file is not a run of this schema.
    """
    check_path("source", source)
    try:
        data = json.loads(Path(source).read_text())
    except (OSError, ValueError) as error:
        raise OptionError(f"cannot read benchmark {str(source)!r}: {error}") from None
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise OptionError(f"{str(source)!r} is not a benchmark of schema {SCHEMA}")
    return data


def _shorter(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _shorter(v) for key, v in value.items()}
    if isinstance(value, list | tuple):
        return [_shorter(v) for v in value]
    return float(f"{value:.6g}") if isinstance(value, float) else value
