"""Follow a minimum under a load: as far as it is stable, through snaps, and back."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.arguments import (
    check_flag,
    check_number,
    check_type,
    check_until,
    check_whole,
    shown,
)
from origami_nlp.atlas import Over, PathEvent, branches_of, chains_of, parts_of
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.kkt import State, classify
from origami_nlp.loading.driver import Driver
from origami_nlp.loading.records import Confirmed, Leg, LoadPoint, Snap
from origami_nlp.loading.result import LoadPath
from origami_nlp.loading.route import Way, let_go, position, restabilises, walk
from origami_nlp.minima import MinimaResult, find_minima, full_scene
from origami_nlp.modes import breaking_stiffness
from origami_nlp.numerics import SETTLED
from origami_nlp.path import LATE, Equilibrium, Steps, Web
from origami_nlp.pattern import Scene

MOST_SNAPS = 20
"""Of one path: more are taken for a mistake."""
STEPS = Steps(first=1e-3, longest=0.1, shortest=1e-9, turn=0.1, sharpest=0.3)
"""Such that curves look smooth."""
SIDE = 0.01
"""Torque over `Model.scale`, or factor over that of the snap, between a snap and the searches beside it."""


def load_path(
    scene: Scene,
    crease: int | None = None,
    *,
    to: float | str = "snap",
    state: int = 1,
    back: bool = False,
    confirm: bool = True,
    full_space: bool = True,
    effort: str = "normal",
    seed: int = 0,
    max_starts: int = 100_000,
    steps: Steps | None = None,
    seconds: float | None = None,
) -> LoadPath:
    """Load a minimum by a torque on a crease, or by the forces that the scene states, and follow it.

    Where the state ends in a fold it snaps: it descends, at the load at which it ends, to the next minimum, from where
    the path goes on.

    Parameters
    ----------
    scene
        What is folded.
    crease
        Number (1-based) of the crease that the torque t [N m] is on, towards valley > 0; its images under the symmetry
        bear the same.  None: t times the forces of the scene's loads.
    to
        Load at which the path ends, from 0; ``"snap"``: both ways to the first snap.
    state
        Number (1-based) of the minimum at load 0; the path keeps its winding round the axis (`Scene.windings`).
    back
        Whether the load then falls back to 0.
    confirm
        Whether both sides of each snap are confirmed by searches.
    full_space
        Whether the path ends where the state loses stability without its symmetry.
    effort, seed, max_starts
        Of the searches.
    steps
        Of the tracer.
    seconds
        Wall time; what was followed by then is returned, with an alarm that says so.  None: no limit.

    Returns
    -------
    LoadPath
        Legs, snaps, branches and events.

    Raises
    ------
    OptionError
        If an argument is not what it must be, or the scene has no such minimum.

    Examples
    --------
    >>> import origami_nlp as o
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=0.05)
    >>> [(event.type, round(event.t, 6)) for event in path.events]
    [('closes', 0.042461)]
    """
    check_type("scene", scene, Scene)
    driver = Driver(scene, crease)
    for name, flag in (("back", back), ("confirm", confirm), ("full_space", full_space)):
        check_flag(name, flag)
    far = driver.farthest
    if (isinstance(to, str) and to != "snap") or to == 0:
        raise OptionError(f"to = {shown(to)} must be a load other than 0, or 'snap'")
    ends = [-far, far] if to == "snap" else [check_number("to", to)]
    until = check_until(seconds)
    searches = _Searches({"effort": effort, "seed": seed, "max_starts": max_starts}, until)
    result = searches.find(driver.scene_at(0.0))
    if result.search.stopped_by == "time":
        raise OptionError(
            f"seconds = {seconds:g}: the time was over before the search for the state at load 0 was through: give more"
        )
    if not result.minima:
        raise OptionError("no minimum was found at load 0")
    check_whole("state", state, 1, len(result.minima))
    start = result.minima[state - 1]
    if len(scene.windings) > 1:  # a path keeps the winding of its first state
        driver = Driver(replace(scene, winding=start.winding), crease)
    job = _Job(driver, min(0.0, *ends), max(0.0, *ends), full_space, steps, until)
    x = job.web.line.programme.reduce(np.array(start.fold_angles))  # type: ignore[attr-defined]
    job.begin(x, 0.0)
    for end in ends:
        arrived = job.go(x, 0.0, end, once=to == "snap")
        if back and arrived is not None:
            job.go(*arrived, 0.0, once=False)
    if not job.ways:
        raise OptionError(
            f"seconds = {seconds:g}: the time was over before a leg of the path was followed: give more"
        )
    return job.path(state, searches if confirm else None)


@dataclass(frozen=True)
class _Searches:
    """Searches for minima with what is left of the time; options: of `find_minima`."""

    options: dict[str, Any]
    until: float

    def find(self, scene: Scene) -> MinimaResult:
        """Search for the minima of a scene."""
        left = None if math.isinf(self.until) else max(self.until - time.monotonic(), 0.0)
        return find_minima(scene, prove=False, escape=False, seconds=left, **self.options)


class _Job:
    """One load path while it is followed."""

    def __init__(
        self,
        driver: Driver,
        low: float,
        high: float,
        full_space: bool,
        steps: Steps | None,
        until: float,
    ) -> None:
        self.driver, scene = driver, driver.scene
        self.over = Over(driver.name, low, high, driver.unit, False)
        line = driver.line(scene)
        self._full = None
        if full_space and not scene.group.is_trivial:
            self._full = driver.line(full_scene(scene))
        self._known: dict[int, tuple[Equilibrium, float]] = {}
        functions = [("breaks-symmetry", self.across)] if self._full else []
        self.web = Web(line, low, high, steps=steps or STEPS, functions=functions, until=until)
        self.ways: list[tuple[Way, float, int | None]] = []
        self.falls: list[tuple[int, float, np.ndarray, str, str]] = []
        self.alarms: list[str] = []

    def across(self, frame: Equilibrium) -> float:
        """Return the smallest eigenvalue across the symmetry; nan where it is not asked for."""
        if self._full is None:
            return math.nan
        if id(frame) not in self._known:
            value = breaking_stiffness(self._in_full_space(frame), self.driver.scene)
            self._known[id(frame)] = frame, value
        return self._known[id(frame)][1]

    def _in_full_space(self, frame: Equilibrium) -> State:
        assert self._full is not None
        return State(self._full.at(frame.s), frame.programme.expand(frame.state))

    def _judged(self, way: Way) -> tuple[str, float | None]:
        """Say what the states of a way are without the symmetry, and from which load on; it may snap at its end."""
        if self._full is None:
            return "", None
        last = max(len(way.frames) - 1 - (way.why != "range"), 0)

        def verdict(k: int) -> str:
            return classify(self._in_full_space(way.frames[k])).verdict

        good = -1
        for k in sorted({0, last // 2, last}):
            bad = verdict(k)
            if bad == "minimum":
                good = k
                continue
            while k - good > 1:
                middle = (k + good) // 2
                found = verdict(middle)
                good, k, bad = (middle, k, bad) if found == "minimum" else (good, middle, found)
            return "unstable" if bad == "not stationary" else "undecided", way.frames[k].s
        return "stable", None

    def begin(self, x: np.ndarray, s: float) -> None:
        """Follow all that comes of the minimum x at s."""
        if position(self.web, x, s) is None:
            self.web.add(x, s, "minimum")

    def go(
        self, x: np.ndarray, s: float, end: float, *, once: bool
    ) -> tuple[np.ndarray, float] | None:
        """Load the minimum x from s to `end`, through snaps unless `once`; returns where it arrives."""
        toward = 1.0 if end > s else -1.0
        for _ in range(MOST_SNAPS):
            way = walk(self.web, x, s, toward, end, self.across)
            if self.web.interrupted and (way is None or way.why in (LATE, "snap")):
                if way is not None and len(way.frames) > 1:
                    self.ways.append((replace(way, why=LATE), toward, None))
                self.alarms.append(f"{OUT_OF_TIME}: the path goes on from where it ends here")
                return None
            if way is None:
                self.alarms.append(f"no stable states lead on from load {s:.9g}")
                return None
            if way.why != "snap":
                self.ways.append((way, toward, None))
                last = way.frames[-1]
                return (last.state, last.s) if way.why == "range" else None
            landed = let_go(self.web, way.node, toward)
            if landed is None:
                self.ways.append((way, toward, None))
                where = self.web.nodes[way.node].s
                self.alarms.append(f"no certified minimum was reached from the end at {where:.9g}")
                return None
            x, s, what = landed
            self.falls.append((way.node, s, x, str(what.kind), what.reason))
            self.ways.append((way, toward, len(self.falls)))
            if not self.web.low <= s <= self.web.high:
                return None
            self.begin(x, s)
            if once:
                return None
        self.alarms.append(f"more than {MOST_SNAPS} snaps")
        return None

    def path(self, state: int, searches: _Searches | None) -> LoadPath:
        """Judge what was followed, and pack it."""
        web = self.web
        parts = {k: parts_of(arc) for k, arc in enumerate(web.arcs)}
        branches, events = branches_of(web, self.over, chains_of(web), parts, self.across)
        for branch in branches:
            for r in branch.kind_ranges:
                if not r.stable and r.kind != "saddle":
                    words = f"branch {branch.id}, {r.t[0]:.6g} to {r.t[1]:.6g}: {r.kind}"
                    self.alarms.append(f"{words}: {r.certificate}")
        snaps = tuple(self._snap(k, events, searches) for k in range(len(self.falls)))
        legs = tuple(self._leg(way, toward, snap) for way, toward, snap in self.ways)
        return LoadPath(
            self.driver, state, web.low, web.high, legs, snaps, branches, events,
            tuple(dict.fromkeys(self.alarms)), web.tally.steps, web.tally.evaluations, self.driver.scene,
        )  # fmt: skip

    def _leg(self, way: Way, toward: float, snap: int | None) -> Leg:
        points = []
        for frame in way.frames:
            phi = frame.programme.expand(frame.state) + 0.0
            low = (
                frame.programme.scale * float(frame.eigenvalues[0])
                if len(frame.eigenvalues)
                else math.nan
            )
            points.append(
                LoadPoint(
                    frame.s,
                    float(self.driver.conjugate(phi)),
                    tuple(phi.tolist()),
                    float(self.driver.unloaded.energy(phi)),
                    low,
                )
            )
        return Leg(int(toward), tuple(points), way.why, snap, *self._judged(way))

    def _snap(self, k: int, events: tuple[PathEvent, ...], searches: _Searches | None) -> Snap:
        node, s, landed, kind, certificate = self.falls[k]
        web, found = self.web, self.web.nodes[node]
        before = found.point[:-1]
        programme = web.line.at(found.s)
        after, on_path = landed, position(web, landed, s)
        if on_path is not None:  # the same state at the load of the snap itself
            same = web.arcs[on_path[0]].at(found.s, web.tally)
            after = landed if same is None else same.state
        phi = programme.expand(before)
        event = min(
            events, key=lambda e: abs(e.t - found.s) + float(np.abs(e.fold_angles - phi).max())
        )
        again = restabilises(web, node)
        one, two = (programme.expand(x) + 0.0 for x in (before, after))
        return Snap(
            event.id,
            found.s,
            found.type,
            tuple(one.tolist()),
            tuple(two.tolist()),
            (float(self.driver.conjugate(one)), float(self.driver.conjugate(two))),
            -float(programme.energy_change(before, after)),
            kind,
            certificate,
            None if again is None else web.nodes[again].s,
            None if searches is None else self._confirmed(k, landed, s, searches),
        )

    def _confirmed(
        self, k: int, landed: np.ndarray, s: float, searches: _Searches
    ) -> Confirmed | None:
        """Search on both sides of a snap for the states that the path has there; None where the time is over."""
        way, toward = next((w, d) for w, d, snap in self.ways if snap == k + 1)
        at = self.web.nodes[way.node].s
        scale = self.web.line.programme.scale if self.driver.crease else abs(at)
        loads = (at - toward * SIDE * scale, at + toward * SIDE * scale)
        onward = walk(self.web, landed, s, toward, loads[1])
        after = None if onward is None else self._nearest(onward, loads[1])
        known = self._nearest(way, loads[0]), after
        minima, found = [], []
        for t, state in zip(loads, known, strict=True):
            result = searches.find(self.driver.scene_at(t))
            if result.search.stopped_by == "time":
                self.alarms.append(f"{OUT_OF_TIME}: snap {k + 1} was not confirmed by searches")
                return None
            minima.append(len(result.minima))
            angles = np.array([m.fold_angles for m in result.minima])
            apart = np.abs(angles - state).max(axis=1, initial=0.0) if state is not None else []
            found.append(bool(len(apart)) and float(min(apart)) <= SETTLED)
        return Confirmed(loads, (minima[0], minima[1]), (found[0], found[1]))

    def _nearest(self, way: Way, t: float) -> np.ndarray | None:
        """All fold angles of the stable state at load t that a way passes; None where none is near."""
        near = min(way.frames, key=lambda f: abs(f.s - t), default=None)
        states = [f for _, f in self.web.states_at(t) if not f.index]
        if near is None or not states:
            return None
        best = min(states, key=lambda f: float(np.abs(f.state - near.state).max()))
        return np.asarray(best.programme.expand(best.state))
