"""The main job of any checkout of the package, in a process of its own: how two versions are measured side by side."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np

from benchmarks.union import Member
from origami_nlp.errors import OptionError
from origami_nlp.pattern import Scene, Vertex, scene_to_dict

HERE = Path(__file__).parents[1]
WORKER = Path(__file__).with_name("worker.py")


@dataclass(frozen=True)
class Job:
    """One run of the main job.

    seconds: of processor time.  minima: what it lists.  curve: (seconds, minima known), whenever that changes, and at
    the end.  residual: the largest of closure and stationarity of these.  status: of a proof, if one was made.
    """

    seconds: float
    minima: tuple[Member, ...]
    curve: tuple[tuple[float, int], ...]
    residual: float = 0.0
    status: str = ""


class Checkout:
    """A process that runs the main job of the package in a folder (`HERE`: this one).

    Raises
    ------
    OptionError
        If there is no package in the folder.
    """

    def __init__(self, folder: str | Path = HERE) -> None:
        if not (Path(folder) / "origami_nlp" / "__init__.py").is_file():
            raise OptionError(f"{str(folder)!r} holds no checkout of origami_nlp")
        threads = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
        self._process = subprocess.Popen(
            [sys.executable, "-P", str(WORKER)],
            env={**os.environ, **threads, "PYTHONPATH": str(Path(folder).resolve())},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def warm_up(self, scene: Scene) -> None:
        """Build what every scene of this form shares, by a short search of a cousin whose answers help nobody."""
        cousin = scene
        if scene.group.is_trivial:
            sectors = np.array(scene.vertex.sector_angles)
            moved = sectors * np.linspace(0.99, 1.01, scene.degree)
            vertex = Vertex(tuple((moved * (sectors.sum() / moved.sum())).tolist()))
            cousin = replace(scene, vertex=vertex)
        self.search(cousin, 0, max_starts=1, fewest_starts=1)

    def search(self, scene: Scene, seed: int, **options: Any) -> Job:
        """Run the main job once.

        Raises
        ------
        RuntimeError
            If the process has ended.
        """
        asked = {"scene": scene_to_dict(scene), "seed": seed, "options": options}
        assert self._process.stdin is not None and self._process.stdout is not None
        try:
            self._process.stdin.write(json.dumps(asked) + "\n")
            self._process.stdin.flush()
            line = self._process.stdout.readline()
        except BrokenPipeError:
            line = ""
        if not line:
            raise RuntimeError(f"the search of {scene.name} ended with code {self._process.wait()}")
        said = json.loads(line)
        minima = tuple(
            Member(tuple(m["fold_angles"]), m["energy"], m["kind"], []) for m in said["minima"]
        )
        curve = tuple((t, int(n)) for t, n in said["curve"])
        return Job(said["seconds"], minima, curve, said["residual"], said["status"])

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End the process: it stops when nothing more can be asked."""
        assert self._process.stdin is not None and self._process.stdout is not None
        with suppress(BrokenPipeError):  # what was not sent to a process that has ended
            self._process.stdin.close()
        self._process.wait()
        self._process.stdout.close()


def stamp(folder: Path = HERE) -> str:
    """Return the commit of a checkout that is measured, with "+" where files differ from it."""
    words = ["git", "-C", str(folder)]
    commit = subprocess.run(
        [*words, "rev-parse", "--short=10", "HEAD"], capture_output=True, text=True, check=True
    )
    changed = subprocess.run(
        [*words, "status", "--porcelain", "origami_nlp", "benchmarks"],
        capture_output=True,
        check=True,
    )
    return commit.stdout.strip() + "+" * bool(changed.stdout.strip())
