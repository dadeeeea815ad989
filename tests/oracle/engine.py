"""Processes that answer questions (`ask`), and how two states, lists and numbers are held against each other."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

Answer = dict[str, Any]
KERNEL = {"OPENBLAS_CORETYPE": "Haswell", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
"""What the environment of the processes that answer asks for, where it asks for nothing else."""
SAME = 1e-5
"""Largest difference of a fold angle [rad] up to which two states are one: weakly held ones are known to no more."""
LEVEL = 1e-7
"""Largest relative difference of their energies."""


def stated_by_name(folder: Path) -> dict[str, Answer]:
    """What is folded, by the name of the question that states it, or of an entry of ``stated.json``."""
    table: dict[str, Answer] = {}
    for file in sorted(folder.glob("*.json")):
        data = json.loads(file.read_text())
        if file.stem == "stated":
            table.update(data)
            continue
        table.update(
            {r["name"]: r["q"]["stated"] for r in data if isinstance(r["q"].get("stated"), dict)}
        )
    return table


def resolved(question: Answer, table: dict[str, Answer]) -> Answer:
    """A question with what is folded in place of its name."""
    stated = question.get("stated")
    return {**question, "stated": table[stated]} if isinstance(stated, str) else question


class Asked:
    """A process that answers, of this checkout or of another one."""

    def __init__(self, root: Path, **environment: str) -> None:
        self.command = [sys.executable, "-m", "tests.oracle.ask"]
        self.place = {
            "cwd": root,
            "env": {**KERNEL, **os.environ, "PYTHONPATH": str(root), **environment},
        }
        self.process = self._start()

    def _start(self) -> subprocess.Popen[str]:
        pipes: Any = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        return subprocess.Popen(self.command, **pipes, **self.place)

    def __call__(self, question: Answer) -> Answer:
        """Ask; a process that dies is an answer too, and another one takes over."""
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(json.dumps(question) + "\n")
        self.process.stdin.flush()
        line = self.process.stdout.readline()
        if line:
            answer: Answer = json.loads(line)
            return answer
        code = self.process.wait()
        self.process = self._start()
        return {"error": f"the process ended with {code}", "seconds": 0.0, "peak": 0}

    def __enter__(self) -> Asked:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        at: TracebackType | None,
    ) -> None:
        self.process.kill()
        self.process.wait()


def same(one: list[Any], other: list[Any]) -> bool:
    """Whether two states, energy and fold angles each, are one."""
    (e, a), (f, b) = one, other
    level = abs(e - f) <= LEVEL * max(1.0, abs(e), abs(f))
    return level and len(a) == len(b) and float(np.abs(np.subtract(a, b)).max(initial=0.0)) <= SAME


def missing(known: Iterable[list[Any]], found: list[Any]) -> list[int]:
    """Which of the known states are not among those found."""
    return [k for k, state in enumerate(known) if not any(same(state, one) for one in found)]


def joined(*lists: list[Any]) -> list[Any]:
    """States of several lists, each once, by energy."""
    every: list[Any] = []
    for state in sorted((s for states in lists for s in states), key=lambda s: s[0]):
        if not any(same(state, one) for one in every[-64:]):
            every.append(state)
    return every


def unclosed(stated: Answer, angles: list[float]) -> float:
    """How far a state is from closing, by rotations alone; nan where another program would have to be written."""
    if "scene" in stated:
        sectors = stated["scene"]["vertex"]["sector_angles"]
        if not all(isinstance(a, float | int) for a in sectors):
            sectors = [angle_of(a) for a in sectors]
        product = Rotation.identity()
        for alpha, phi in zip(sectors, angles, strict=True):
            # the fold at a crease, then along the facet to the next one
            product = (
                product * Rotation.from_rotvec([phi, 0, 0]) * Rotation.from_rotvec([0, 0, alpha])
            )
        return float(np.abs(product.as_matrix() - np.eye(3)).max())
    if "pattern" in stated and "lattice" not in stated["pattern"]:
        return _torn(stated["pattern"], angles)
    return float("nan")


def angle_of(text: str | float) -> float:
    """An angle that is stated as a product of numbers and pi."""
    if not isinstance(text, str):
        return float(text)
    value, sign = 1.0, -1.0 if text.startswith("-") else 1.0
    for k, part in enumerate(text.lstrip("-").replace("/", "*/").split("*")):
        number = part.lstrip("/")
        factor = np.pi if number == "pi" else float(number)
        value = value / factor if part.startswith("/") and k else value * factor
    return sign * value


def _torn(pattern: Answer, angles: list[float]) -> float:
    """How far apart the copies of a corner are, each facet placed from its neighbour breadth first."""
    corners = np.array(pattern["corners"], float)
    if corners.shape[1] == 2:
        corners = np.column_stack([corners, np.zeros(len(corners))])
    if np.ptp(corners[:, 2]) or any(pattern["reference"]):
        return float("nan")
    rings = pattern["polygons"]
    beside: dict[tuple[int, int], int] = {}
    for f, ring in enumerate(rings):
        beside.update({(a, b): f for a, b in zip(ring, [*ring[1:], ring[0]], strict=True)})
    turn = {tuple(sorted(c)): a for c, a in zip(pattern["creases"], angles, strict=True)}
    placed = {0: (Rotation.identity(), np.zeros(3))}
    queue, apart = [0], 0.0
    while queue:
        f = queue.pop(0)
        rotation, shift = placed[f]
        ring = rings[f]
        for a, b in zip(ring, [*ring[1:], ring[0]], strict=True):
            g = beside.get((b, a))
            if g is None:
                continue
            axis = corners[a] - corners[b]
            fold = Rotation.from_rotvec(
                -turn.get((min(a, b), max(a, b)), 0.0) * axis / np.linalg.norm(axis)
            )
            moved = rotation * fold
            place = moved, rotation.apply(corners[a] - fold.apply(corners[a])) + shift
            if g not in placed:
                placed[g] = place
                queue.append(g)
            points = corners[rings[g]]
            there = placed[g][0].apply(points) + placed[g][1]
            apart = max(apart, float(np.abs(there - place[0].apply(points) - place[1]).max()))
    return apart / float(np.ptp(corners, axis=0).max())
