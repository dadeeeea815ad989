"""Time and memory against the degree N, and against the number of scenes; each size in a process of its own.

What is measured for a degree: posing the model and compiling its functions, and then single solves (start, IPOPT,
polish) of one random vertex without symmetry.  With contact, facet pairs enter when a solve makes them cross, as in
the package; the number of pairs grows with N^2, and so do the compiled functions of all possible gaps.  A size that
takes longer than `LIMIT` is stopped and said so, and larger ones of its kind are not tried.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
import time
from collections.abc import Callable
from typing import Any

from origami_nlp.problem import Model

DEGREES = (4, 6, 8, 12, 16, 20, 24, 30, 40, 50, 60)
QUICK_DEGREES = (4, 8, 12, 20)
SCENES = (1, 4, 16, 64)
SOLVES = 5
LIMIT, QUICK_LIMIT = 120.0, 10.0
"""Seconds after which one size is stopped."""


def run_scaling(quick: bool, seed: int, progress: Callable[[str], None]) -> dict[str, Any]:
    """Measure all sizes; returns records with seconds and megabytes, or the reason why there are none."""
    limit = QUICK_LIMIT if quick else LIMIT
    degrees: list[dict[str, Any]] = []
    for contact in ("none", "full"):
        for n in QUICK_DEGREES if quick else DEGREES:
            progress(f"scaling: degree {n}, contact {contact}")
            record = _child(["degree", str(n), contact, str(seed)], limit)
            degrees.append({"degree": n, "contact": contact, **record})
            if "stopped" in record:
                break
    scenes = []
    for count in SCENES[:3] if quick else SCENES:
        progress(f"scaling: {count} scenes")
        scenes.append({"scenes": count, **_child(["scenes", str(count), "", str(seed)], limit)})
    return {"limit": limit, "solves": SOLVES, "degrees": degrees, "scenes": scenes}


def _child(arguments: list[str], limit: float) -> dict[str, Any]:
    """Run one size in a fresh process."""
    command = [sys.executable, "-m", "benchmarks.scaling", *arguments]
    try:
        out = subprocess.run(command, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return {"stopped": f"took longer than {limit:g} s"}
    if out.returncode:
        lines = out.stderr.strip().splitlines()
        return {"stopped": lines[-1][:100] if lines else f"ended with code {out.returncode}"}
    return dict(json.loads(out.stdout.splitlines()[-1]))


def measure_degree(n: int, contact: str, seed: int) -> dict[str, Any]:
    """Measure one random vertex of degree n in this process."""
    import numpy as np

    from benchmarks.attempt import draw_starts
    from benchmarks.problems import random_vertex
    from origami_nlp.minima import Record, run_one

    scene = random_vertex(
        np.random.default_rng([seed, n]), n, "full" if contact == "full" else "none"
    )
    base = memory()
    begin = time.process_time()
    model = Model(scene)
    model.functions.local(np.zeros(n), model.parameters.vector)
    compiled = time.process_time()
    starts, _ = draw_starts(model, seed, SOLVES + 1)
    record, seconds = Record(), []
    run_one(model, starts[0].x, record)  # builds IPOPT
    built = time.process_time()
    closed = 0
    for start in starts[1:]:
        record = Record()
        before = time.process_time()
        run_one(model, start.x, record)
        seconds.append(time.process_time() - before)
        closed += record.converged
    return {
        "pairs": len(model.structure.pairs),
        "compile_seconds": compiled - begin,
        "first_seconds": built - compiled,
        "solve_seconds": seconds,
        "converged": closed,
        "megabytes": memory() - base,
    }


def measure_scenes(count: int, seed: int) -> dict[str, Any]:
    """Measure the main job's solves on `count` scenes of one structure, a sweep over the stiffness ratio."""
    from benchmarks.attempt import draw_starts
    from origami_nlp.minima import Record, run_one
    from origami_nlp.pattern import degree6

    base = memory()
    begin = time.process_time()
    for k in range(count):
        ratio = 10.0 ** (4 * k / max(1, count - 1) - 2)
        model = Model(degree6("pi/4", ratio))
        starts, _ = draw_starts(model, seed, 8)
        record = Record()
        for start in starts:
            run_one(model, start.x, record)
    return {"seconds": time.process_time() - begin, "megabytes": memory() - base}


def memory() -> float:
    """Return the largest memory this process has used so far [MB]; NaN where the system does not say."""
    try:  # Linux: `ru_maxrss` would begin at the parent's
        with open("/proc/self/status") as status:
            line = next(text for text in status if text.startswith("VmHWM"))
        return float(line.split()[1]) / 1e3
    except (OSError, StopIteration):
        pass
    try:
        import resource
    except ImportError:  # Windows
        return math.nan
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


if __name__ == "__main__":
    what, size, contact, seed = sys.argv[1:5]
    result = (
        measure_degree(int(size), contact, int(seed))
        if what == "degree"
        else measure_scenes(int(size), int(seed))
    )
    print(json.dumps(result))
