"""One load path while it is followed: legs through a web of equilibria, and snaps between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.continuation import (
    LATE,
    START,
    ContinuationOptions,
    Equilibrium,
    EquilibriumCurve,
    SpecialPoint,
    is_equilibrium,
)
from origami_nlp.errors import OUT_OF_TIME
from origami_nlp.kkt import Classification, State, classified, classify, singular_beside
from origami_nlp.numerics import EPS, INPUT_TOL, NEAR_SINGULAR_TOL, SETTLED, coarse, first_largest
from origami_nlp.paths import records as r
from origami_nlp.paths.driver import Driver
from origami_nlp.paths.followed import FollowedDiagram
from origami_nlp.paths.parameter_range import ParameterRange
from origami_nlp.paths.result import LoadPath
from origami_nlp.search import TRUST, descent_path

STEP = EPS ** (1 / 3)
"""Of central differences [rad]: its square is their error."""
CUT = f"{OUT_OF_TIME}: the path goes on from where it ends here"
MOST_SNAPS = 20
"""Of one path: more are taken for a mistake."""
OFF_BRANCH = 1e-3
"""How far beside such a state a descent begins [rad]."""
LEAST_SPAN = 1e-3
"""A snap at a load of less than this share of the whole range is stepped over by shares of that."""
OVER = (1e-5, 1e-4, 1e-3)
"""How far beyond a snap, over the load there or the whole range, the state is let go: the first from which it comes to
rest at a certified minimum."""
UNTOLD = "facets meet at borders or face to face, where no single gap distinguishes them"
"""Why a descent ends at a state that is neither held on every piece nor left on one."""
WALL = ("refused", "singular", "touches", "closes")
"""Where nothing is known of what lies beyond."""

Arrived = tuple[np.ndarray, float]
"""A state, and the load at which it is one."""


class Fall(NamedTuple):
    """Where a snap leads: to a state, known at the load s."""

    state: np.ndarray
    s: float
    what: Classification


class Run(NamedTuple):
    """Stable states that a load passes in one diagram, one way.

    frames: in order.  node: position of the node at its end.  why: ``range``, ``snap``, a type of event beyond which
    nothing is followed, or what stopped it.  fall: the snap that ends them.  branches_off: whether the first of them is
    a bifurcation.
    """

    job: Any
    frames: tuple[Equilibrium, ...]
    node: int
    why: str
    toward: float
    fall: Fall | None = None
    branches_off: bool = False


@dataclass
class PathRecord:
    """What was followed of one load path.

    stages: of hinges that yield.  ways: in order.  alarms: in words.  work: plastic [J].
    """

    stages: list[FollowedLoad] = field(default_factory=list)
    ways: list[Run] = field(default_factory=list)
    alarms: list[str] = field(default_factory=list)
    work: float = 0.0


class FollowedLoad(FollowedDiagram):
    """One load path while it is followed, or one stage of it with hinges that yield."""

    def __init__(
        self,
        driver: Driver,
        over: ParameterRange,
        steps: ContinuationOptions,
        state: int = 0,
        hinges: Any = None,
        record: PathRecord | None = None,
    ) -> None:
        self.driver, self.hinges, self.state = driver, hinges, state
        self.record = record or PathRecord()
        yields, line = (hinges.events, hinges.line(driver)) if hinges else ([], driver.line())
        stops = [type for type, _ in yields]
        super().__init__(line, over, functions=yields, stops=stops, steps=steps, lazy=True)

    def stage(self, hinges: Any) -> FollowedLoad:
        """Return a stage of a path with hinges that yield."""
        return FollowedLoad(
            self.driver, self.parameter, self.steps, self.state, hinges, self.record
        )

    def seen_as(self, frame: Equilibrium, phi: np.ndarray) -> dict[str, Any]:
        """Return what the load works on, and the energy without it."""
        energy = float(self.driver.unloaded.energy(phi))
        energy += float(self.hinges.stored(phi)) if self.hinges else 0.0
        return {"energy": energy, "angle": float(self.driver.conjugate(phi))}

    def known(self, x: np.ndarray, s: float) -> int | None:
        """Return the node at which the stable state x is at s; a state on an arc becomes one.  None of no such."""
        point = np.append(x, s)
        for number, node in enumerate(self.nodes):
            if np.abs(node.point - point).max() <= SETTLED:
                return number
        for k, frame in self.states_at(s):
            if not frame.index and np.abs(frame.state - x).max() <= SETTLED:
                return self.split(k, frame)
        return None

    def begin(self, x: np.ndarray, s: float, toward: float, follow: bool = True) -> int:
        """Return the node of the minimum x at s; what comes of a new one is followed, one way at first."""
        if (number := self.known(x, s)) is not None:
            return number
        number = len(self.nodes)
        self.add(x, s, "minimum", toward, follow)
        return number

    def walk(self, node: int, toward: float, end: float, last: int = -1) -> Run | None:
        """Go from the stable state at a node towards the load `end`, up to the limit point or bifurcation that ends it.

        None where no stable state is known there.  What was left of it (`BifurcationDiagram.resume`) is followed where
        the way goes on there.  last: a node at which the way ends, too.
        """
        frames, k = list[Equilibrium](), -1
        while True:
            why, onward = self._why(node, end), self._onward(node, k, toward)
            if not onward and (why != "range" or not frames) and self.resume(node, toward):
                onward = self._onward(node, k, toward)
            stops = why == "range" or node == last or self._leaves_flat(node)
            if not onward or (frames and stops):
                break
            k = onward[0]
            arc = self.arcs[k]
            forward = arc.start == node
            frames += arc.frames[:: 1 if forward else -1][bool(frames) :]
            node = arc.end if forward else arc.start
        meet = [a.frames[-(a.start != node)] for a in self.arcs if node in (a.start, a.end)]
        frames = frames or [f for f in meet if not f.index][:1]
        return Run(self, tuple(frames), node, why, toward) if frames else None

    def _leaves_flat(self, node: int) -> bool:
        """Return whether a node is the flat state, and the load pulls from there along another branch than the one that
        comes there: stable states that lead on beyond are not reached."""
        found = self.nodes[node]
        if found.type != "singular" or found.point[:-1].any():
            return False
        return classify(State(self.line.at(found.s), found.point[:-1])).verdict != "minimum"

    def _onward(self, node: int, arc: int, toward: float) -> list[int]:
        """Return the arcs of stable states that lead on from a node, but for the one that comes there."""
        at, found = self.nodes[node].s, list[int]()
        for k, a in enumerate(self.arcs):
            if k != arc and not a.index and node in (a.start, a.end):
                found += [k] if ((a.high if toward > 0 else a.low) - at) * toward > 0 else []
        return found

    def _why(self, node: int, end: float) -> str:
        found = self.nodes[node]
        if abs(found.s - end) <= SETTLED * (1 + abs(end)):
            return "range"
        if found.type in (LATE, *self.stops):
            return found.type
        if found.type in WALL or (found.type == "slides" and not found.located):
            return f"stopped: {found.why or 'closure or contacts lose rank'}"
        return "snap"

    def release(self, node: SpecialPoint, toward: float) -> Fall | str:
        """Descend from the end of a way, a little beyond its load: where to, or why to no minimum."""
        phi, why = node.point[:-1], ""
        posed: Any = self.line.problem
        span = max(abs(node.s), LEAST_SPAN * (self.high - self.low))
        slides, forks = node.type == "slides", node.type == "branching"
        # lower states are beside where a facet ends, unless others hold
        lower = classify(State(self.line.at(node.s), phi)).lower if slides else phi
        posed.until = self.steps.until
        try:
            # states that branch off are distinguished from those that do not by the square root of the share
            for share in OVER[forks:]:
                s = node.s + toward * share * span
                problem: Any = self.line.at(s)
                starts = [] if lower is None else [lower]
                if forks:  # balanced: the energy falls to second order, to either side
                    state = State(problem, phi)
                    soft = state.on(state.pieces[0]).softest
                    if soft is not None:
                        aside = OFF_BRANCH * soft * np.sign(soft[first_largest(np.abs(soft))])
                        starts = [phi + aside, phi - aside]
                for start in starts:
                    end, lost = _downhill(problem, start)
                    if np.abs(end - phi).max() <= 10 * share:
                        continue
                    what = classified(problem, end)
                    minimum = not lost and what.verdict == "minimum"
                    if minimum and singular_beside(problem, end) is None:
                        return Fall(end, s, what)
                    why = lost or what.reason
        finally:
            posed.until = math.inf
        return why or "no lower state was reached"

    def go(self, x: np.ndarray, s: float, end: float, *, once: bool) -> Arrived | None:
        """Load the minimum x from s to `end`, through snaps unless `once`; returns where it arrives."""
        toward, ways, alarms = 1.0 if end > s else -1.0, self.record.ways, self.record.alarms
        far = self.parameter.high if toward < 0 else self.parameter.low
        before: tuple[Equilibrium, ...] = ()  # stable states that branched off and led to x
        number = self.begin(x, s, toward)
        for _ in range(MOST_SNAPS):
            # the node is stable, and the load runs on from there
            way = self.walk(number, toward, end)
            if self.interrupted and (way is None or way.why in (LATE, "snap")):
                if way is not None and len(way.frames) > 1:
                    ways.append(way._replace(why=LATE, branches_off=bool(before)))
                if not self.stopped:
                    alarms.append(CUT)
                return None
            if way is None:
                alarms.append(f"no stable states lead on from load {s:.9g}")
                return None
            way = way._replace(frames=(*before, *way.frames), branches_off=bool(before))
            ways.append(way._replace(why=LATE))  # until it is known how it ends
            before, node, last = (), self.nodes[way.node], way.frames[-1]
            # at the flat state branches cross: from there the energy falls along another one
            flat = node.type == "singular" and node.located and not node.point[:-1].any()
            landed = self.release(node, toward) if flat or way.why == "snap" else ""
            if isinstance(landed, str):
                ways[-1] = way
                if way.why == "snap":
                    alarms.append(f"no certified minimum was reached from {last.s:.9g}: {landed}")
                return (last.state, last.s) if way.why == "range" else None
            x, s = self._chosen(landed.state, node), landed.s
            if node.type == "branching":
                number = self.begin(x, s, toward)
                led = self.walk(number, -toward, far, last=way.node)
                if led is not None and led.node == way.node:
                    # stable states branch off there: the load goes on along them
                    ways[-1], before = way._replace(why=r.PITCHFORK), led.frames[:0:-1]
                    continue
                # a snap loses energy at the end already; along states that branch off it is lost by and by, less than
                # the same two states lose by the change of the load
                lost, there = (self._released(t, node.point[:-1], x) for t in (s, node.s))
                if lost <= 2 * abs(lost - there):
                    ways[-1] = way
                    alarms.append(f"what branches off at load {node.s:.9g} was not followed")
                    return None
            ways[-1] = way._replace(why="snap", fall=landed._replace(state=x))
            if not self.low <= s <= self.high:
                return None
            number = self.begin(x, s, toward, follow=not once)
            if once:
                return x, s
        alarms.append(f"more than {MOST_SNAPS} snaps")
        return None

    def _chosen(self, x: np.ndarray, node: SpecialPoint) -> np.ndarray:
        """Return the image of a state under what keeps the state at a node that is the same whatever rounding is."""
        if self.driver.keeps:
            return x
        images = self.driver.images(x, node.point[:-1])
        return max(images, key=lambda y: tuple(coarse(y).tolist()))

    def _released(self, t: float, one: np.ndarray, two: np.ndarray) -> float:
        """Energy of a state less that of another one, at a load."""
        return -float(self.line.at(t).energy_change(one, two))

    def pack(self) -> LoadPath:
        """Judge what was followed, and pack it.

        Of hinges that yield other states than those of the path belong to no path.
        """
        kept, falls = self.record, [run for run in self.record.ways if run.fall]
        branches, met = list[r.PathBranch](), list[r.PathEvent]()
        for job in kept.stages or [self]:
            job.cut = self.cut
            lines, events = job.records()
            if job.hinges:
                lines, events = (), tuple(map(job.hinges.named, events))
            branches += lines
            met += events
        legs, snapped = [], 0
        for run in kept.ways:
            snapped += run.fall is not None
            legs.append(run.job._leg(run, snapped if run.fall else None))
        on_path = {p.fold_angles for leg in legs for p in leg.points}
        passed = self._each_once(met, on_path)
        snaps = [run.job._snap(run, passed) for run in falls]
        if kept.stages:
            used = {snap.event for snap in snaps}
            passed = [e for e in passed if e.id in used or e.fold_angles in on_path]
        kept.alarms += [branch.alarm for branch in branches if branch.alarm]
        kept.alarms += [r.STOPPED] * self.stopped
        alarms = tuple(dict.fromkeys(kept.alarms))
        return LoadPath(
            self.parameter, tuple(branches), tuple(passed), alarms,
            sum(job.steps_made for job in kept.stages or [self]),
            any(line.startswith((OUT_OF_TIME, r.STOPPED)) for line in alarms),
            self.driver, self.state, tuple(legs), tuple(snaps), kept.work,
        )  # fmt: skip

    def _each_once(self, found: list[r.PathEvent], on_path: set[Any]) -> list[r.PathEvent]:
        """Return one of each event and its images under the symmetry, that of the path if one is, numbered anew."""

        def order(e: r.PathEvent) -> tuple[Any, ...]:
            images = (-coarse(np.array(e.fold_angles))).tolist()
            return not e.located, e.fold_angles not in on_path, *images

        groups: list[list[r.PathEvent]] = []
        for e in sorted(found, key=order):
            same = next((group for group in groups if self._one(group[0], e)), None)
            groups.append([e]) if same is None else same.append(e)
        groups.sort(key=lambda group: group[0].t)
        return [
            replace(group[0], id=k, branches=tuple(sorted({b for e in group for b in e.branches})))
            for k, group in enumerate(groups, start=1)
        ]

    def _one(self, a: r.PathEvent, b: r.PathEvent) -> bool:
        """Whether two events are images under the symmetry."""
        if a.type != b.type or abs(a.t - b.t) > SETTLED * (
            self.parameter.high - self.parameter.low
        ):
            return False
        near = NEAR_SINGULAR_TOL if a.type == "branching" else SETTLED
        images = self.driver.images(np.array(a.fold_angles))
        return any(np.abs(x - b.fold_angles).max() <= near for x in images)

    def _leg(self, run: Run, snap: int | None) -> r.Leg:
        """Pack the states of a run."""
        first = run.frames[0]
        points, node = [self.point(frame) for frame in run.frames], self.nodes[run.node]
        if snap is not None and node.type == "singular":
            phi = self.line.problem.expand(node.point[:-1])
            more = {"multipliers": (), **self.seen_as(first, phi)}
            more |= dict.fromkeys(("eigenvalue", "full_space_eigenvalue"), math.nan)
            points.append(r.PathPoint(node.s, tuple(phi.tolist()), **more))
        starts = not run.branches_off and len(run.frames) > 1
        stiff = self._stiffness(first) if starts else math.nan
        moved = self.hinges.moved_at(run.frames[-1].state).tolist() if self.hinges else ()
        a, b = points[0], points[-1]
        how: Any = {"why": run.why, "snap": snap, "stiffness": stiff, "moved": tuple(moved)}
        return r.Leg(int(run.toward), tuple(points), (a.t, b.t), (a.angle, b.angle), **how)

    def _stiffness(self, frame: Equilibrium) -> float:
        """Return the derivative of the load by what it works on, along the tangent; inf where that stays."""
        along, driver = frame.tangent / self.root, self.driver
        ahead, behind = (frame.problem.expand(frame.state + h * along[:-1]) for h in (STEP, -STEP))
        moved = float(driver.conjugate(ahead) - driver.conjugate(behind)) / (2 * STEP)
        return math.inf if abs(moved) <= INPUT_TOL * driver.work.arm else float(along[-1]) / moved

    def _snap(self, run: Run, events: Sequence[r.PathEvent]) -> r.Snap:
        found, fall, alarms = self.nodes[run.node], run.fall, self.record.alarms
        assert fall is not None
        before, after = found.point[:-1], self._at_the_snap(fall.state, fall.s, found.s)
        one, two = (self.line.problem.expand(x) + 0.0 for x in (before, after))
        far = [abs(e.t - found.s) + float(np.abs(e.fold_angles - one).max()) for e in events]
        event = events[far.index(min(far))]
        if self.hinges and (over := self.hinges.over(two)):
            why = f"{over} would bear more than they yield at: where it ends is not known"
            alarms.append(f"after the snap at load {found.s:.6g} {why}")
        type = {"singular": "flat state", START: event.type}.get(found.type, found.type)
        angle = float(self.driver.conjugate(one)), float(self.driver.conjugate(two))
        states = tuple(one.tolist()), tuple(two.tolist())
        lost, kind = self._released(found.s, before, after), str(fall.what.kind)
        return r.Snap(event.id, found.s, type, *states, angle, lost, kind, fall.what.reason)

    def _at_the_snap(self, landed: np.ndarray, s: float, at: float) -> np.ndarray:
        """Return the state that a snap lands on, known at s, at the load of the snap itself if it is one there."""
        if (number := self.known(landed, s)) is None:
            return landed
        arcs = [arc for arc in self.arcs if number in (arc.start, arc.end)]
        same = next(filter(None, (arc.at(at) for arc in arcs)), None)
        begun = [half.frame for half in self.nodes[number].halves]
        frame = [*begun, *(f for arc in arcs for f in (arc.frames[0], arc.frames[-1]))][0]
        if same is None and begun and frame.ahead:
            # where closure loses rank Newton at a load needs a state nearer than the last one
            curve = EquilibriumCurve(self.line, frame.hold)
            near = curve.beside(frame, (at - frame.s) * self.line.weight / frame.ahead) or frame
            same = curve.at(near.x, at, frame.tangent)
        return landed if same is None or not is_equilibrium(same) else same.state


def _downhill(problem: Any, start: np.ndarray) -> tuple[np.ndarray, str]:
    """Follow the energy downhill along states in which no facets cross; where to, and why that is no minimum."""
    try:
        found = descent_path(problem, start, longest=TRUST)
    except ValueError as refused:
        if isinstance(refused, np.linalg.LinAlgError):
            raise
        return start, str(refused)
    return found.end, "" if found.arrives else UNTOLD
