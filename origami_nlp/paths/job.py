"""One load path while it is followed: legs through a web of equilibria, and snaps between them."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from typing import Any

import numpy as np

from origami_nlp.continuation import (
    LATE,
    START,
    ContinuationOptions,
    Equilibrium,
    EquilibriumCurve,
    Line,
    SpecialPoint,
    is_equilibrium,
)
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.kkt import State, classify
from origami_nlp.numerics import EPS, INPUT_TOL, NEAR_SINGULAR_TOL, SETTLED, coarse
from origami_nlp.paths import records as r
from origami_nlp.paths.driver import IDENTITY, Driver, image_of, kept_by
from origami_nlp.paths.followed import Across, joined
from origami_nlp.paths.load_result import LoadPath
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.ways import BRANCHES, Fall, Run, Ways
from origami_nlp.pattern_problem import PopSigns

STEP = EPS ** (1 / 3)
"""Of central differences [rad]: its square is their error."""
MOST_SNAPS = 20
"""Of one path: more are taken for a mistake."""


@dataclass
class PathRecord:
    """What was followed of one load path.

    jobs: spaces, or stages of hinges that yield, in which something was.
    ways: in order.  alarms: in words.  work: plastic [J].
    """

    jobs: list[FollowedLoad] = field(default_factory=list)
    ways: list[Run] = field(default_factory=list)
    alarms: list[str] = field(default_factory=list)
    work: float = 0.0


class FollowedLoad(Ways):
    """One load path while it is followed: with the symmetry of a scene, or (of an `origin`) with less; or one stage."""

    def __init__(
        self,
        driver: Driver,
        over: ParameterRange,
        full: bool,
        steps: ContinuationOptions | None,
        until: float,
        hinges: Any = None,
        of: FollowedLoad | None = None,
        state: int = 0,
    ) -> None:
        self.driver, self.hinges, self.state = driver, hinges, state
        self._given, self.origin = (over, full, steps, until), of or self
        self.record: PathRecord = of.record if of else PathRecord([] if hinges else [self])
        symmetric = full and driver.elements != IDENTITY
        across = Across(driver.keeping(IDENTITY).line() if symmetric else None, driver.origami)
        yields, line = (hinges.events, hinges.line(driver)) if hinges else ([], driver.line())
        options: Any = {"steps": driver.steps(steps), "lazy": True, "until": until}
        stops = [type for type, _ in yields]
        super().__init__(line, over, across, functions=yields, stops=stops, **options)

    @property
    def problem(self) -> Any:
        """Of the line that is followed."""
        return self.line.problem

    @property
    def full(self) -> Line | None:
        """Problems without the symmetry, of a path that looks at them; None elsewhere."""
        return self.origin.across.line

    def keeping(self, elements: Sequence[tuple[int, bool]]) -> FollowedLoad:
        """Return the same path in the space of states that keep some of the symmetries of the scene."""
        origin, jobs = self.origin, self.record.jobs
        if origin.full is None or set(elements) == set(origin.driver.elements):
            return origin
        driver = origin.driver.keeping(elements)
        if driver.elements not in [job.driver.elements for job in jobs]:
            jobs.append(FollowedLoad(driver, *self._given, of=origin))
        return next(job for job in jobs if job.driver.elements == driver.elements)

    def stage(self, hinges: Any) -> FollowedLoad:
        """Return a stage of a path with hinges that yield."""
        made = FollowedLoad(self.driver, *self._given, hinges, self)
        made.origin = made
        return made

    def seen_as(self, frame: Equilibrium, phi: np.ndarray) -> dict[str, Any]:
        """Return what the load works on, and the energy without it."""
        energy = float(self.driver.unloaded.energy(phi))
        energy += float(self.hinges.stored(phi)) if self.hinges else 0.0
        return {"energy": energy, "angle": float(self.driver.conjugate(phi))}

    def begin(self, x: np.ndarray, s: float, toward: float, follow: bool = True) -> None:
        """Follow what comes of the minimum x at s, at first what leads in one direction of the load."""
        if not self.holding(x, s) and self.given(x, s) is None:
            self.add(x, s, "minimum", toward, follow)

    def go(
        self,
        x: np.ndarray,
        s: float,
        end: float,
        *,
        once: bool,
        before: tuple[Equilibrium, ...] = (),
    ) -> tuple[FollowedLoad, np.ndarray, float] | None:
        """Load the minimum x from s to `end`, through snaps unless `once`; returns where it arrives.

        before: stable states that led to x.
        """
        toward, ways, alarms = 1.0 if end > s else -1.0, self.record.ways, self.record.alarms
        self.begin(x, s, toward)
        for _ in range(MOST_SNAPS):
            # x is stable at s, and the load runs on from there
            way = self.walk(x, s, toward, end)
            if self.interrupted and (way is None or way.why in (LATE, "snap")):
                if way is not None and len(way.frames) > 1:
                    ways.append(way._replace(why=LATE, branches_off=bool(before)))
                if not self.stopped:
                    alarms.append(f"{OUT_OF_TIME}: the path goes on from where it ends here")
                return None
            if way is None:
                alarms.append(f"no stable states lead on from load {s:.9g}")
                return None
            way = way._replace(frames=(*before, *way.frames), branches_off=bool(before))
            ways.append(way._replace(why=LATE))  # until it is known how it ends
            before, lost = (), self._lost(way)
            landed = lost and lost[0].release(lost[1], toward)
            if lost is None or landed is None or isinstance(landed, str):
                ways[-1], last = way, way.frames[-1]
                if way.why == "snap":
                    words = f"no certified minimum was reached from the end at {last.s:.9g}"
                    alarms.append(f"{words}: {landed}")
                return (self, last.state, last.s) if way.why == "range" else None
            (into, node), (x, s, what) = lost, landed
            x, into = into.chosen(x, node)
            if node.type in BRANCHES:
                into.begin(x, s, toward)
                far = self.parameter.high if toward < 0 else self.parameter.low
                led = into.walk(x, s, -toward, far, kept=False)
                if led is not None and into.meets(led, self.nodes[way.node], self):
                    # stable states branch off there: the load goes on along them
                    ways[-1] = way._replace(why=r.PITCHFORK)
                    return into.go(x, s, end, once=once, before=led.frames[:0:-1])
                if self._continuous(way, into, x, s):
                    ways[-1] = way
                    alarms.append(f"what branches off at load {node.s:.9g} was not followed")
                    return None
            ways[-1] = way._replace(why="snap", fall=Fall(into, x, s, what))
            if not self.low <= s <= self.high:
                return None
            into.begin(x, s, toward, follow=not once)
            if once:
                return into, x, s
            if into is not self:
                return into.go(x, s, end, once=once)
        alarms.append(f"more than {MOST_SNAPS} snaps")
        return None

    def _lost(self, way: Run) -> tuple[FollowedLoad, SpecialPoint] | None:
        """Return where a way ends because its states lose stability, and in which space that is seen; None elsewhere.

        At the flat state branches cross: from there the energy falls along another one.
        """
        node = self.nodes[way.node]
        if way.why == "snap":
            return self, node
        flat = node.type == "singular" and node.located and not node.point[:-1].any()
        if way.why == "breaks-symmetry" or flat:
            into = self.keeping(IDENTITY)
            return into, replace(node, point=into.seen_from(self, node))
        return None

    def seen_from(self, other: FollowedLoad, node: SpecialPoint) -> np.ndarray:
        """Return the point (x, s) of a node of another space."""
        return np.append(self.problem.reduce(other.problem.expand(node.point[:-1])), node.s)

    def chosen(self, x: np.ndarray, node: SpecialPoint) -> tuple[np.ndarray, FollowedLoad]:
        """Return an image of a state under what keeps the state at a node, and the space of what symmetry it has.

        The image is the same whatever rounding is.
        """
        elements = self.origin.driver.elements
        phi, at = self.problem.expand(x), self.problem.expand(node.point[:-1])
        images = (phi[image_of(len(phi), e)] for e in kept_by(elements, at))
        image = max(images, key=lambda y: tuple(coarse(y).tolist()))
        into = self.keeping(kept_by(elements, image))
        return into.problem.reduce(image), into

    def meets(self, led: Run, node: SpecialPoint, of: FollowedLoad) -> bool:
        """Whether stable states lead back to a node of another space, or this, where they branch off."""
        apart = self.root * (self.nodes[led.node].point - self.seen_from(of, node))
        return bool(np.abs(apart).max() <= NEAR_SINGULAR_TOL)

    def _continuous(self, way: Run, into: FollowedLoad, x: np.ndarray, s: float) -> bool:
        """Whether a state x at s, beyond the end of a way at s0, lies on states that branch off there.

        A snap loses energy at s0 already; along states that branch off it is lost by and by, less than the same two
        states lose by the change of the load from s0 to s.
        """
        node = self.nodes[way.node]
        one, two = self.problem.expand(node.point[:-1]), into.problem.expand(x)
        lost, at_the_node = (self._released(t, one, two) for t in (s, node.s))
        return lost <= 2 * abs(lost - at_the_node)

    def _released(self, t: float, one: np.ndarray, two: np.ndarray) -> float:
        """Energy of a state of all fold angles less that of another one, at a load."""
        problem: Any = (self.full or self.line).at(t)
        return -float(problem.energy_change(problem.reduce(one), problem.reduce(two)))

    def pack(self) -> LoadPath:
        """Judge what was followed, and pack it.

        Of hinges that yield other states than those of the path belong to no path.
        """
        kept, falls = self.record, [run for run in self.record.ways if run.fall]
        diagrams = []
        for job in kept.jobs:
            job.cut = self.cut
            lines, met = job.records()
            diagrams.append((lines, [job.hinges.named(e) for e in met] if job.hinges else met))
        legs, snapped = [], 0
        for run in kept.ways:
            snapped += run.fall is not None
            legs.append(run.job._leg(run, snapped if run.fall else None))
        on_path = {p.fold_angles for leg in legs for p in leg.points}
        if self.driver.scene is None:
            pops = PopSigns(self.driver.problem.pattern)
            for number, leg in enumerate(legs, start=1):
                found = pops.alarms(np.array([p.fold_angles for p in leg.points]))
                kept.alarms += [f"leg {number}: {line}" for line in found]
        branches, events = joined(
            diagrams,
            self._one,
            lambda e: (e.fold_angles not in on_path, *(-coarse(np.array(e.fold_angles))).tolist()),
        )
        snaps = [run.job._snap(run, events) for run in falls]
        if self.hinges:
            used = {snap.event for snap in snaps}
            events = [e for e in events if e.id in used or e.fold_angles in on_path]
            branches, events = [], [replace(e, branches=()) for e in events]
        kept.alarms += [line for branch in branches for line in branch.alarms()]
        kept.alarms += [r.STOPPED] * self.stopped
        alarms, steps = tuple(dict.fromkeys(kept.alarms)), sum(job.tally.steps for job in kept.jobs)
        return LoadPath(
            self.parameter, tuple(branches), tuple(events), alarms, steps,
            any(line.startswith((OUT_OF_TIME, r.STOPPED)) for line in alarms),
            self.driver, self.state, tuple(legs), tuple(snaps), kept.work,
        )  # fmt: skip

    def _one(self, a: r.PathEvent, b: r.PathEvent) -> bool:
        """Whether two events are images under the symmetry, or one bifurcation as it is seen in two spaces."""
        branching = {a.type, b.type} <= set(BRANCHES)
        apart = abs(a.t - b.t) > SETTLED * (self.parameter.high - self.parameter.low)
        if apart or not (branching or a.type == b.type):
            return False
        x, y = np.array(a.fold_angles), np.array(b.fold_angles)
        near = NEAR_SINGULAR_TOL if branching else SETTLED
        return any(np.abs(x[image_of(len(x), e)] - y).max() <= near for e in self.driver.elements)

    def _leg(self, run: Run, snap: int | None) -> r.Leg:
        """Pack the states of a run."""
        first = run.frames[0]
        points, node = [self.point(frame) for frame in run.frames], self.nodes[run.node]
        if snap is not None and node.type == "singular":
            phi, none = self.problem.expand(node.point[:-1]), (math.nan,) * 2
            more = self.seen_as(first, phi)
            at = tuple(phi.tolist())
            points.append(r.PathPoint(node.s, at, more["energy"], (), *none, more["angle"]))
        judged = ("", None) if self.cut else self._judged(run)
        keeps = self.driver.scene.group.name if self.driver.scene else ""
        starts = not run.branches_off and len(run.frames) > 1
        stiff = self._stiffness(first) if starts else math.nan
        moved = self.hinges.moved_at(run.frames[-1].state).tolist() if self.hinges else ()
        whole = run.why, snap, *judged, keeps, stiff, tuple(moved)
        return r.Leg(int(run.toward), tuple(points), *whole)

    def _judged(self, run: Run) -> tuple[str, float | None]:
        """Describe the states of a run, but for a bifurcation, without the symmetry, and from which load on.

        It may snap at its end.
        """
        if self.full is None:
            return "", None
        frames, first, full = run.frames, int(run.branches_off), self.full
        last = max(len(frames) - 1 - (run.why != "range"), first)

        @cache
        def verdict(k: int) -> str:
            frame = frames[k]
            return classify(State(full.at(frame.s), frame.problem.expand(frame.state))).verdict

        # asked at three places, then bisected: between two of them the verdict is taken to change once
        good = first - 1
        for k in sorted({first, (first + last) // 2, last}):
            if (bad := verdict(k)) != "minimum":
                lost = bisect_left(range(k), True, good + 1, key=lambda i: verdict(i) == bad)
                return "unstable" if bad == "not stationary" else "undecided", frames[lost].s
            good = k
        return "stable", None

    def _stiffness(self, frame: Equilibrium) -> float:
        """Return the derivative of the load by what it works on, along the tangent; inf where that stays."""
        along, driver = frame.tangent / self.root, self.driver
        ahead, behind = (frame.problem.expand(frame.state + h * along[:-1]) for h in (STEP, -STEP))
        moved = float(driver.conjugate(ahead) - driver.conjugate(behind)) / (2 * STEP)
        return math.inf if abs(moved) <= INPUT_TOL * driver.work.arm else float(along[-1]) / moved

    def _snap(self, run: Run, events: Sequence[r.PathEvent]) -> r.Snap:
        found, fall, alarms = self.nodes[run.node], run.fall, self.record.alarms
        assert fall is not None
        one = self.problem.expand(found.point[:-1]) + 0.0
        landed = fall.into.at_the_snap(fall.state, fall.s, found.s)
        two = fall.into.problem.expand(landed) + 0.0
        far = [abs(e.t - found.s) + float(np.abs(e.fold_angles - one).max()) for e in events]
        event = events[far.index(min(far))]
        if self.hinges and (over := self.hinges.over(two)):
            why = f"{over} would bear more than they yield at: where it ends is not known"
            alarms.append(f"after the snap at load {found.s:.6g} {why}")
        type = {"singular": "flat state", START: event.type}.get(found.type, found.type)
        angle = float(self.driver.conjugate(one)), float(self.driver.conjugate(two))
        states, lost = (tuple(one.tolist()), tuple(two.tolist())), self._released(found.s, one, two)
        kind = str(fall.what.kind), fall.what.reason
        return r.Snap(event.id, found.s, type, *states, angle, lost, *kind)

    def at_the_snap(self, landed: np.ndarray, s: float, at: float) -> np.ndarray:
        """Return the state that a snap lands on, known at s, at the load of the snap itself if it is one there."""
        begun, on_path = self.given(landed, s), self.holding(landed, s)
        if not on_path and begun is None:
            return landed
        same = self.arcs[on_path[0][0]].at(at, self.tally) if on_path else None
        frame = on_path[0][1] if on_path else self.nodes[begun or 0].halves[0].frame
        curve = EquilibriumCurve(self.line, frame.hold, self.tally)
        if same is None and frame.ahead:
            # where closure loses rank Newton at a load needs a state nearer than the last one
            near = curve.beside(frame, (at - frame.s) * self.line.weight / frame.ahead) or frame
            same = curve.at(near.x, at, frame.tangent)
        return landed if same is None or not is_equilibrium(same) else same.state
