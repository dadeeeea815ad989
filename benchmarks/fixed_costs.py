"""What a first answer costs before anything is searched: imports, commands, stages of the main job as it is called."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path
from statistics import median
from typing import Any

from benchmarks.by_scip import is_installed, solve
from benchmarks.checkout import HERE, Checkout, stamp
from benchmarks.families import family_scene
from benchmarks.judging import Judge
from origami_nlp.io import to_plain
from origami_nlp.minima import find_minima
from origami_nlp.pattern import Scene, examples

PROCESSES = {
    "Python itself": ["-c", "pass"],
    "imports of a plain SLSQP search (casadi, scipy.optimize)": [
        "-c",
        "import casadi, scipy.optimize",
    ],
    "import origami_nlp": ["-c", "import origami_nlp"],
    "from Python: first search of a process, with its imports": [
        "-c",
        "import origami_nlp as o; o.find_minima(o.examples.degree6('pi/3'), prove=False, escape=False)",
    ],
    "in a terminal: origami-nlp --version": ["-m", "origami_nlp", "--version"],
    "in a terminal: origami-nlp minima FILE --prove 0": [
        "-m",
        "origami_nlp",
        "minima",
        "FILE",
        "--prove",
        "0",
    ],
    "in a terminal: origami-nlp minima FILE": ["-m", "origami_nlp", "minima", "FILE"],
    "in a terminal: origami-nlp minima FILE -o PICTURE.png": [
        "-m",
        "origami_nlp",
        "minima",
        "FILE",
        "-o",
        "PICTURE",
    ],
}
"""Whole processes that are timed; FILE: a panel of the paper, PICTURE: a file to be written."""
PANELS = (0, 1, 4, 8, 9, 13)
"""Panels whose stages are timed."""
STAGES = {
    "finish_all": "search",
    "prove_each": "proof",
    "escapes_of_each": "escape barriers",
    "_in_full_space": "without the symmetry",
}
"""Functions of `minima.find`, and what they do."""


def processes(rounds: int = 3) -> dict[str, float]:
    """Return processor seconds of whole processes, the median of some rounds."""
    threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
    out: dict[str, list[float]] = {name: [] for name in PROCESSES}
    environment = {**os.environ, **threads}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    with tempfile.TemporaryDirectory() as folder:
        # as where the package is installed: modules are compiled once, in the round that is not counted
        environment["PYTHONPYCACHEPREFIX"] = folder
        file = Path(folder) / "panel.toml"
        files = {"FILE": str(file), "PICTURE": str(file.with_suffix(".png"))}
        said = subprocess.run(
            [sys.executable, "-m", "origami_nlp", "example", "degree6", "-o", str(file)],
            cwd=HERE,
            capture_output=True,
            check=False,
        )
        if said.returncode:
            raise RuntimeError(said.stderr.decode())
        for _ in range(rounds + 1):
            for name, arguments in PROCESSES.items():
                words = [files.get(a, a) for a in arguments]
                before = _children()
                subprocess.run(
                    [sys.executable, *words],
                    cwd=HERE,
                    env=environment | {"PYTHONPATH": str(HERE)},
                    capture_output=True,
                    check=True,
                )
                out[name].append(_children() - before)
    return {name: median(seconds[1:]) for name, seconds in out.items()}


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def stages(scenes: Sequence[Scene]) -> list[dict[str, Any]]:
    """Return the seconds of each stage of `find_minima` as it is called, of some scenes, the second time."""
    from origami_nlp.minima import find

    spent: dict[str, float] = {}

    def timed(name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def wrapped(*args: Any, **options: Any) -> Any:
            begin = time.process_time()
            try:
                return function(*args, **options)
            finally:
                spent[name] = spent.get(name, 0.0) + time.process_time() - begin

        return wrapped

    out = []
    with ExitStack() as stack:
        for name, stage in STAGES.items():
            original = getattr(find, name)
            stack.callback(setattr, find, name, original)
            setattr(find, name, timed(stage, original))
        for scene in scenes:
            for _ in range(2):
                spent.clear()
                begin = time.process_time()
                result = find_minima(scene)
                spent["whole"] = time.process_time() - begin
            proof = result.completeness
            out.append(
                {
                    "scene": scene.label,
                    "minima": len(result.minima),
                    "says": "not tried" if proof is None else proof.status,
                    **spent,
                }
            )
    return out


CALLS: dict[str, dict[str, Any]] = {
    "as called": {"prove": None, "escape": True},
    "with its proof": {"prove": None, "escape": False},
    "search alone": {},
}
"""What is asked of two checkouts in turn, and how."""


def before_and_after(
    before: Path, scenes: Sequence[Scene], progress: Callable[[str], None]
) -> dict[str, list[dict[str, Any]]]:
    """Ask two checkouts for the minima of scenes in turn, after a first round that is not counted.

    Returns
    -------
    dict
        For each way of asking a row a scene: seconds before and after, minima, largest residual of either, status.
    """
    out: dict[str, list[dict[str, Any]]] = {}
    with Checkout(before) as old, Checkout() as new:
        for name, options in CALLS.items():
            for number, scene in enumerate((scenes[0], *scenes)):
                progress(f"before and after: {name}, {scene.label}")
                one, two = (c.search(scene, 0, **options) for c in (old, new))
                if number:
                    row = {
                        "scene": scene.label,
                        "before": one.seconds,
                        "after": two.seconds,
                        "minima": [len(one.minima), len(two.minima)],
                        "residual": [one.residual, two.residual],
                        "says": [one.status, two.status],
                    }
                    out.setdefault(name, []).append(row)
    return out


def errors(scenes: Sequence[Scene]) -> list[float]:
    """Return the largest error of a fold angle [rad] of each listed minimum that has a solution to 50 digits."""
    known = (k for scene in scenes for k in Judge.of(scene, 0).known)
    return [k.reference.angle_error(k.x) for k in known if k.reference is not None]


def measure_costs(
    progress: Callable[[str], None] = lambda text: None, before: Path | None = None
) -> dict[str, Any]:
    """Measure processes, stages of the main job, and SCIP where it is installed; returns plain data.

    With another checkout, `before`, the panels are searched by both as well.
    """
    progress("whole processes")
    found: dict[str, Any] = {"processes": processes()}
    progress("stages of the main job")
    panels = examples.panels()
    if before is not None:
        found["before"] = {"stamp": stamp(before)} | before_and_after(before, panels, progress)
    found["stages"] = stages(
        [*(panels[k] for k in PANELS), *(family_scene("fold-limits", k) for k in range(5))]
    )
    progress("50 digits")
    found["errors"] = errors([family_scene("fold-limits", k) for k in range(5)])
    found["global"] = []
    if is_installed():
        for number in range(3):
            scene = family_scene("fold-limits", number)
            progress(f"SCIP: {scene.name}")
            begin = time.process_time()
            least = find_minima(scene, prove=True, escape=False).minima[0].energy
            ours = time.process_time() - begin
            one = asdict(solve(scene))
            found["global"].append({**to_plain(one), "least": least, "ours": ours})
    return found
