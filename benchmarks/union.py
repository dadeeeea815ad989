"""Everything that anything found: the minima of a scene against which searches are measured.

A union is one JSON file in a folder of the user's (not of this repository): the scene, its minima, each polished and
classified by the package and apart from the others by `APART`, and what has been run.  A run that is interrupted goes
on where it stopped; a further seed or method adds to the file.
"""

from __future__ import annotations

import inspect
import json
import math
import os
import re
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.foreign import Ends, Foreign, distinct, foreign_methods, run_foreign
from origami_nlp.errors import OptionError
from origami_nlp.io import write_whole
from origami_nlp.kkt import Polished, Solve, State, classify, exact_beside, polish
from origami_nlp.minima import Record, find_minima, solve_without_crossing
from origami_nlp.numerics import ANSWERED, CLOSURE_TOL, ENDPOINT_TOL
from origami_nlp.pattern import Scene, scene_from_dict, scene_to_dict
from origami_nlp.problem import Model

SCHEMA = "origami-nlp/union/1"
APART = ENDPOINT_TOL
"""Two minima whose fold angles differ by no more [rad] are one."""
FOUND = 1e-3
"""An answer within this [rad] of a minimum in every fold angle found it: what a bare solver's tolerance leaves."""
FEW = 6
"""Facet pairs that get a plane from the start where an answer is solved on from."""
SCATTERED = 200
"""Distinct ends of one search that are solved on from, at most: ends that never repeat are no states."""


Progress = Callable[[str], None]
Folder = str | os.PathLike[str]
FEW_DOF = 2
"""Degrees of freedom up to which a union is proved."""
UNION_SEEDS = 10
"""Thorough runs of the main job behind a union."""
SECONDS = {4: 1.0, 5: 4.0, 6: 8.0, 7: 14.0, 8: 20.0}
MOST_SECONDS = 30.0
"""Processor seconds of a foreign search behind a union, by degree; some take a share of them."""


@dataclass
class Member:
    """A minimum: fold angles [N] [rad], energy [scene's units], kind, and the runs that found it."""

    fold_angles: tuple[float, ...]
    energy: float
    kind: str
    found_by: list[str]


@dataclass(frozen=True)
class Task:
    """A run that is done: its name, processor seconds, and how many minima it found, and found first."""

    name: str
    seconds: float
    found: int
    new: int


@dataclass
class Union:
    """The minima of a scene, the runs behind them, and whether they are proved to be all (`Completeness.status`)."""

    scene: Scene
    members: list[Member] = field(default_factory=list)
    tasks: list[Task] = field(default_factory=list)
    proved: str = ""

    @property
    def states(self) -> np.ndarray:
        """Fold angles of all members [M, N]."""
        return np.array([m.fold_angles for m in self.members]).reshape(-1, self.scene.degree)

    def nearest(self, fold_angles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return for states [K, N] the nearest member [K] (-1 without any) and how far it is [K] [rad]."""
        if not self.members:
            return np.full(len(fold_angles), -1), np.full(len(fold_angles), math.inf)
        far = np.abs(fold_angles[:, None] - self.states).max(axis=2)
        return far.argmin(axis=1), far.min(axis=1)

    def done(self, name: str) -> bool:
        """Return whether a run is on record."""
        return any(t.name == name for t in self.tasks)

    def add(self, name: str, minima: Sequence[Member], seconds: float) -> Task:
        """File the minima of a run."""
        new, found = 0, set[int]()
        for m in minima:
            near, far = self.nearest(np.array([m.fold_angles]))
            if far[0] > APART:
                self.members.append(replace(m, found_by=[]))
                near[0], new = len(self.members) - 1, new + 1
            found.add(int(near[0]))
        for k in found:
            self.members[k].found_by.append(name)
        self.tasks.append(Task(name, seconds, len(found), new))
        return self.tasks[-1]


def ours(scene: Scene, seed: int, **options: Any) -> tuple[list[Member], float]:
    """Run the main job; return what it lists, and processor seconds."""
    begin = time.process_time()
    result = find_minima(scene, seed=seed, prove=False, **options)
    seconds = time.process_time() - begin
    return [Member(m.fold_angles, m.energy, m.kind, []) for m in result.minima], seconds


def verified(model: Model, x: np.ndarray) -> tuple[Polished, str, str]:
    """Polish and classify the end [n] of any search; return the state, its kind ("" if no minimum) and the reason.

    The bound forces that the polish starts from balance the pull of the springs at x.
    """
    local = model.local(x)
    free = np.abs(x) < model.bound - ANSWERED
    lam = np.linalg.lstsq(local.closure_jacobian.T[free], local.gradient[free], rcond=None)[0]
    pull = np.where(free, 0.0, local.gradient - local.closure_jacobian.T @ lam)
    residual = float(np.abs(local.closure).max())
    return _judged(model, Solve(x, "Solve_Succeeded", 0, residual, pull, None))


def _judged(model: Model, answer: Solve) -> tuple[Polished, str, str]:
    state = polish(model, answer)
    if not state.converged:
        state = exact_beside(model, state)
    if state.closure_residual > CLOSURE_TOL:
        return state, "", "does not close"
    what = classify(State(model, state.x), polished=state.converged)
    return state, str(what.kind) if what.verdict == "minimum" else "", what.verdict


def minima_of(model: Model, ends: np.ndarray, known: Iterable[np.ndarray] = ()) -> list[Member]:
    """Return the distinct minima near the ends [a, n] of a search, or where IPOPT goes from these."""
    found: list[Member] = []
    near: list[np.ndarray] = [np.asarray(k) for k in known]
    for x in distinct(ends, FOUND)[:SCATTERED]:
        if near and np.abs(np.array(near) - x).max(axis=1).min() <= ENDPOINT_TOL:
            continue
        state, kind, _ = verified(model, x)
        if not kind:
            answer = solve_without_crossing(model, x, Record(), model.structure.pairs[:FEW])
            if not answer.succeeded:
                continue
            state, kind, _ = _judged(model, answer)
        if kind:
            near.append(state.x)
            found.append(member(model, state.x, kind))
    return found


def member(model: Model, x: np.ndarray, kind: str) -> Member:
    """Return a verified minimum x [n] as a member."""
    return Member(tuple(model.expand(x).tolist()), model.energy(x), kind, [])


def admissible_ends(model: Model, ends: Ends) -> np.ndarray:
    """Return the claimed ends that are states at all: on the sheet, and no facets cross by more than 1e-6 [a, n]."""
    x = ends.x[ends.claims]
    return x[model.admissible(x, ANSWERED)] if len(x) else x


def from_foreign(
    model: Model, method: Foreign, seed: int, budget: float
) -> tuple[list[Member], float]:
    """Run a foreign search; return the minima that its ends lead to, and processor seconds of the search."""
    ends = run_foreign(method, model, seed, budget)
    return minima_of(model, admissible_ends(model, ends)), float(ends.seconds[-1])


def build_union(
    scene: Scene,
    folder: Folder,
    tasks: Sequence[tuple[str, Callable[[], tuple[list[Member], float]]]],
    progress: Progress = lambda text: None,
) -> Union:
    """Run what is not yet done of `tasks` (name, run), and write the file after each."""
    union = read_or_begin(scene, folder)
    for name, run in tasks:
        if union.done(name):
            continue
        task = union.add(name, *run())
        write_union(union, folder)
        progress(
            f"{scene.name}: {name}: {task.found} of {len(union.members)}, {task.new} new, {task.seconds:.1f} s"
        )
    return union


def complete(scene: Scene, folder: Folder, progress: Progress = lambda text: None) -> Union:
    """Return the union of a scene; what has not been run for it yet is run now."""
    model = Model(scene)
    longest = SECONDS.get(scene.degree, MOST_SECONDS)
    tasks = []
    for method in foreign_methods():
        if method.share and model.dof > 0 and (not method.aided or model.structure.pairs):
            seconds = longest * method.share
            run = _bound(from_foreign, model, method, 0, seconds)
            tasks.append((f"{method.name}, seed 0", run))
    for seed in range(UNION_SEEDS):
        effort = thorough()
        name = f"find_minima, {effort.get('effort', 'default')}, seed {seed}"
        tasks.append((name, _bound(ours, scene, seed, **effort)))
    union = build_union(scene, folder, tasks, progress)
    if not union.proved and 0 < model.dof <= FEW_DOF:
        _prove(union, folder, progress)
    return union


def _prove(union: Union, folder: Folder, progress: Progress) -> None:
    """Prove that the minima of a union are all; what it lacks joins."""
    begin = time.process_time()
    result = find_minima(union.scene, prove=True)
    found = [Member(m.fold_angles, m.energy, m.kind, []) for m in result.minima]
    task = union.add("proof", found, time.process_time() - begin)
    assert result.completeness is not None
    union.proved = result.completeness.status
    if len(result.minima) < len(union.members):  # a member that the proof does not know
        union.proved = "not-proved"
    write_union(union, folder)
    progress(f"{union.scene.name}: {union.proved}, {task.new} new, {task.seconds:.1f} s")


def thorough() -> dict[str, Any]:
    """Return the options of the most thorough search that this package has."""
    return {"effort": "thorough"} if "effort" in inspect.signature(find_minima).parameters else {}


def _bound(run: Callable[..., Any], *arguments: Any, **options: Any) -> Callable[[], Any]:
    return lambda: run(*arguments, **options)


def union_path(folder: Folder, name: str) -> Path:
    """Return the file of a scene's union."""
    return Path(folder) / f"{re.sub(r'[^A-Za-z0-9.]+', '-', name)}.json"


def read_or_begin(scene: Scene, folder: Folder) -> Union:
    """Read the union of a scene; an empty one where there is none, or where it is another scene's."""
    path = union_path(folder, scene.name or "scene")
    union = read_union(path) if path.exists() else Union(scene)
    return union if union.scene == scene else Union(scene)


def read_union(source: Folder) -> Union:
    """Read a union back.

    Raises
    ------
    OptionError
        If the file is not one of this schema.
    """
    try:
        data = json.loads(Path(source).read_text())
    except (OSError, ValueError) as error:
        raise OptionError(f"cannot read union {str(source)!r}: {error}") from None
    if not isinstance(data, dict) or data.get("schema") != SCHEMA:
        raise OptionError(f"{str(source)!r} is not a union of schema {SCHEMA}")
    members = [Member(**{**m, "fold_angles": tuple(m["fold_angles"])}) for m in data["minima"]]
    return Union(
        scene_from_dict(data["scene"]),
        members,
        [Task(**t) for t in data["tasks"]],
        data.get("proved", ""),
    )


def write_union(union: Union, folder: Folder) -> None:
    """Write a union whole or not at all, its minima in order of energy."""
    data = {
        "schema": SCHEMA,
        "scene": scene_to_dict(union.scene),
        "minima": [asdict(m) for m in sorted(union.members, key=lambda m: m.energy)],
        "tasks": [asdict(t) for t in union.tasks],
        "proved": union.proved,
    }
    path = union_path(folder, union.scene.name or "scene")
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, (json.dumps(data, indent=1) + "\n").encode())
