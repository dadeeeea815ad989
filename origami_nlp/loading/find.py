"""Follow a stable state under a load: as far as it is stable, through snaps, and back."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from os import PathLike

import numpy as np

from origami_nlp.arguments import (
    check_flag,
    check_number,
    check_type,
    check_until,
    check_whole,
    refuse,
    shown,
)
from origami_nlp.bifurcation import ParameterRange, PathEvent, branches_of, chains_of, parts_of
from origami_nlp.continuation import (
    LATE,
    BifurcationDiagram,
    ContinuationOptions,
    Equilibrium,
    EquilibriumCurve,
    is_equilibrium,
)
from origami_nlp.errors import OUT_OF_TIME, OptionError, OutOfTime
from origami_nlp.kkt import State, classify
from origami_nlp.loading.driver import LoadSearch, VertexDriver
from origami_nlp.loading.pattern_driver import PatternDriver, work_on
from origami_nlp.loading.records import ConfirmedSnap, Leg, LoadPoint, Snap
from origami_nlp.loading.result import LoadPath
from origami_nlp.loading.stable_path import (
    StableSegment,
    given,
    position,
    release,
    restabilises,
    walk,
)
from origami_nlp.minima import JudgedState
from origami_nlp.modes import breaking_stiffness
from origami_nlp.numerics import SETTLED
from origami_nlp.pattern import Pattern, Scene, as_origami
from origami_nlp.pattern_problem import Work

MOST_SNAPS = 20
"""Of one path: more are taken for a mistake."""
_OF_A_PATTERN = {"starts": "the effort says how many starts a vertex gets"}
_OF_A_SCENE = {"full": "states of a pattern keep no symmetry"}
"""What only the one or the other takes, and why."""


def load_path(
    origami: Scene | Pattern | str | PathLike[str],
    load: int | Sequence[int] | Work | None = None,
    *,
    to: float | str = "snap",
    state: int | JudgedState = 1,
    unload: bool = False,
    confirm: bool = True,
    full: bool | None = None,
    effort: str = "normal",
    seed: int = 0,
    max_starts: int | None = None,
    starts: int | None = None,
    options: ContinuationOptions | None = None,
    seconds: float | None = None,
) -> LoadPath:
    """Load a stable state of a vertex or of a pattern by a torque or a force, and follow it.

    At a limit point it snaps: it descends, at the load there, to the next minimum, from where the path goes on.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it.
    load
        Number (1-based) of the crease that the torque t [N m] is on, towards valley > 0, and on its images under the
        symmetry of a scene; None: t times the forces of the scene's loads.  Of a pattern also several numbers, or a
        `Torque`, `Pull` or `DeadForce`.
    to
        Load at which the path ends, from 0; ``"snap"``: both ways to the first snap.
    state
        Number (1-based) of the stable state at load 0, by energy; of a pattern also a state of `find_minima`.
    unload
        Whether the load then falls back to 0; of a pattern also from where it snapped.
    confirm
        Whether both sides of each snap are confirmed by searches; of patterns under torques only.
    full
        Whether the path ends where the state loses stability without its symmetry; of scenes, where None is True.
    effort, seed, max_starts
        Of the searches, see `find_minima`.
    starts
        Of the searches of patterns, see `find_minima`.
    options
        Of the continuation; of a pattern lengths are root mean squares over creases.
    seconds
        Wall time, to a second or two: what was followed by then is returned, and what was left out named.  None: no
        limit.

    Returns
    -------
    LoadPath
        Legs, snaps, branches and events.

    Raises
    ------
    OptionError
        If an argument is not what it must be, there is no such stable state, or the time was over before it began.

    Examples
    --------
    >>> import origami_nlp as o
    >>> path = o.load_path(o.examples.degree6("5*pi/12"), 1, to=0.05)
    >>> [(event.type, round(event.t, 6)) for event in path.events]
    [('closes', 0.042461)]
    """
    driver: VertexDriver | PatternDriver
    stated = as_origami(origami)
    if isinstance(stated, Scene):
        refuse("scene", _OF_A_PATTERN, starts=starts)
        driver = VertexDriver(stated, load)  # type: ignore[arg-type]
    else:
        refuse("pattern", _OF_A_SCENE, full=full)
        driver = PatternDriver(work_on(stated, load))
    given = {"max_starts": max_starts, "starts": starts}
    for name, count in {"seed": seed, **given}.items():
        if count is not None:
            check_whole(name, count, int(name == "max_starts"))
    asked = {"effort": effort, "seed": seed, **{k: v for k, v in given.items() if v is not None}}
    full = True if full is None else full
    defaults = ContinuationOptions()
    check_type("options", defaults if options is None else options, ContinuationOptions)
    for name, flag in (("unload", unload), ("confirm", confirm), ("full", full)):
        check_flag(name, flag)
    far = driver.farthest
    if (isinstance(to, str) and to != "snap") or to == 0:
        raise OptionError(f"to = {shown(to)} must be a load other than 0, or 'snap'")
    ends = [-far, far] if to == "snap" else [check_number("to", to)]
    search = LoadSearch(asked, check_until(seconds))
    driver, number, x = driver.begin(state, search)
    job = _Job(driver, min(0.0, *ends), max(0.0, *ends), full, options, search.until)
    try:
        for end in ends:
            arrived = job.go(x, 0.0, end, once=to == "snap")
            if unload and arrived is not None:
                job.between(0.0, end)
                job.go(*arrived, 0.0, once=False)
                job.between(*ends)
    except OutOfTime:  # of a descent
        job.alarms.append(f"{OUT_OF_TIME}: the path goes on from where it ends here")
    if not job.ways:
        raise OptionError(
            f"seconds = {seconds or 0:g}: the time was over before a leg of the path was followed: give more"
        )
    return job.path(number, search if confirm else None)


class _Job:
    """One load path while it is followed."""

    def __init__(
        self,
        driver: VertexDriver | PatternDriver,
        low: float,
        high: float,
        full: bool,
        steps: ContinuationOptions | None,
        until: float,
    ) -> None:
        self.driver, self.low, self.high = driver, low, high
        self.parameter = ParameterRange(driver.name, low, high, driver.unit, False)
        self._full = driver.full_line() if full else None
        self._known: dict[int, tuple[Equilibrium, float]] = {}
        functions = [("breaks-symmetry", self.across)] if self._full else []
        self.web = BifurcationDiagram(
            driver.line(),
            low,
            high,
            steps=driver.steps(steps),
            functions=functions,
            lazy=driver.lazy,
            until=until,
        )
        self.ways: list[tuple[StableSegment, float, int | None]] = []
        self.falls: list[tuple[int, float, np.ndarray, str, str]] = []
        self.alarms: list[str] = []

    def across(self, frame: Equilibrium) -> float:
        """Return the smallest eigenvalue across the symmetry; nan where it is not asked for."""
        if self._full is None:
            return math.nan
        if id(frame) not in self._known:
            value = breaking_stiffness(self._in_full_space(frame), self.driver.scene)  # type: ignore[union-attr]
            self._known[id(frame)] = frame, value
        return self._known[id(frame)][1]

    def _in_full_space(self, frame: Equilibrium) -> State:
        assert self._full is not None
        return State(self._full.at(frame.s), frame.problem.expand(frame.state))

    def _judged(self, way: StableSegment) -> tuple[str, float | None]:
        """Describe the states of a segment without the symmetry, and from which load on; it may snap at its end."""
        if self._full is None:
            return "", None
        last = max(len(way.frames) - 1 - (way.why != "range"), 0)

        def verdict(k: int) -> str:
            return classify(self._in_full_space(way.frames[k])).verdict

        # asked at three places, then bisected: between two of them the verdict is taken to change once
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

    def between(self, *ends: float) -> None:
        """Follow in the range of load that these and 0 span."""
        if self.driver.lazy:
            self.web.low, self.web.high = min(0.0, *ends), max(0.0, *ends)

    def begin(self, x: np.ndarray, s: float, toward: float, follow: bool = True) -> None:
        """Follow what comes of the minimum x at s: all of it, or what leads in one direction of the load at first."""
        if position(self.web, x, s) is None and given(self.web, x, s) is None:
            self.web.add(x, s, "minimum", toward if self.driver.lazy else 0.0, follow)

    def go(
        self, x: np.ndarray, s: float, end: float, *, once: bool
    ) -> tuple[np.ndarray, float] | None:
        """Load the minimum x from s to `end`, through snaps unless `once`; returns where it arrives."""
        toward = 1.0 if end > s else -1.0
        self.begin(x, s, toward)
        for _ in range(MOST_SNAPS):
            # x is stable at s, and the load runs on from there
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
            landed = release(self.web, way.node, toward, self.driver)
            if isinstance(landed, str):
                self.ways.append((way, toward, None))
                where = self.web.nodes[way.node].s
                self.alarms.append(
                    f"no certified minimum was reached from the end at {where:.9g}: {landed}"
                )
                return None
            x, s, what = landed
            self.falls.append((way.node, s, x, str(what.kind), what.reason))
            self.ways.append((way, toward, len(self.falls)))
            if not self.web.low <= s <= self.web.high:
                return None
            self.begin(x, s, toward, follow=not (once and self.driver.lazy))
            if once:
                return (x, s) if self.driver.lazy else None
        self.alarms.append(f"more than {MOST_SNAPS} snaps")
        return None

    def path(self, state: int, search: LoadSearch | None) -> LoadPath:
        """Judge what was followed, and pack it; that takes as long as it takes."""
        web = self.web
        parts = {k: parts_of(arc, not self.driver.lazy) for k, arc in enumerate(web.arcs)}
        branches, events = branches_of(web, self.parameter, chains_of(web), parts, self.across)
        for branch in branches:
            for r in branch.kind_ranges:
                if not r.stable and r.kind != "saddle":
                    words = f"branch {branch.id}, {r.t[0]:.6g} to {r.t[1]:.6g}: {r.kind}"
                    self.alarms.append(f"{words}: {r.certificate}")
        snaps = tuple(self._snap(k, events, search) for k in range(len(self.falls)))
        legs = tuple(self._leg(way, toward, snap) for way, toward, snap in self.ways)
        return LoadPath(
            self.driver, state, self.low, self.high, legs, snaps, branches, events,
            tuple(dict.fromkeys(self.alarms)), web.tally.steps, web.tally.evaluations,
        )  # fmt: skip

    def _leg(self, way: StableSegment, toward: float, snap: int | None) -> Leg:
        points = []
        for frame in way.frames:
            phi = frame.problem.expand(frame.state) + 0.0
            low = (
                frame.problem.scale * float(frame.eigenvalues[0])
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

    def _snap(self, k: int, events: tuple[PathEvent, ...], search: LoadSearch | None) -> Snap:
        node, s, landed, kind, certificate = self.falls[k]
        web, found = self.web, self.web.nodes[node]
        before = found.point[:-1]
        problem = web.line.at(found.s)
        after = self._at_the_snap(landed, s, found.s)
        phi = problem.expand(before)
        event = min(
            events, key=lambda e: abs(e.t - found.s) + float(np.abs(e.fold_angles - phi).max())
        )
        again = restabilises(web, node)
        one, two = (problem.expand(x) + 0.0 for x in (before, after))
        return Snap(
            event.id,
            found.s,
            found.type,
            tuple(one.tolist()),
            tuple(two.tolist()),
            (float(self.driver.conjugate(one)), float(self.driver.conjugate(two))),
            -float(problem.energy_change(before, after)),
            kind,
            certificate,
            None if again is None else web.nodes[again].s,
            None if search is None else self._confirmed(k, landed, s, search),
        )

    def _at_the_snap(self, landed: np.ndarray, s: float, at: float) -> np.ndarray:
        """Return the state that a snap lands on, known at s, at the load of the snap itself if it is one there."""
        web, on_path = self.web, position(self.web, landed, s)
        begun = given(web, landed, s)
        same: Equilibrium | None = None
        if on_path is not None:
            frame = on_path[1]
            same = web.arcs[on_path[0]].at(at, web.tally)
        elif begun is not None:
            frame = web.nodes[begun].halves[0].frame
        else:
            return landed
        curve = EquilibriumCurve(web.line, frame.hold, web.tally)
        same = same or curve.at(frame.x, at, frame.tangent)
        return landed if same is None or not is_equilibrium(same) else same.state

    def _confirmed(
        self, k: int, landed: np.ndarray, s: float, search: LoadSearch
    ) -> ConfirmedSnap | None:
        """Search on both sides of a snap for the states that the path has there."""
        way, toward = next((w, d) for w, d, snap in self.ways if snap == k + 1)
        at = self.web.nodes[way.node].s
        side = toward * self.driver.beside(at)
        loads = (at - side, at + side)
        onward = walk(self.web, landed, s, toward, loads[1])
        after = None if onward is None else self._nearest(onward, loads[1])
        known = self._nearest(way, loads[0]), after
        minima, found = [], []
        for t, state in zip(loads, known, strict=True):
            states = self.driver.states_at(t, search)
            if states is None:
                return None
            if search.cut:
                self.alarms.append(f"{OUT_OF_TIME}: snap {k + 1} was not confirmed by searches")
                return None
            minima.append(len(states))
            apart = [float(np.abs(x - state).max()) for x in states] if state is not None else []
            found.append(min(apart, default=math.inf) <= SETTLED)
        return ConfirmedSnap(loads, (minima[0], minima[1]), (found[0], found[1]))

    def _nearest(self, way: StableSegment, t: float) -> np.ndarray | None:
        """All fold angles of the stable state at load t that a way passes; None where none is near."""
        near = min(way.frames, key=lambda f: abs(f.s - t), default=None)
        states = [f for _, f in self.web.states_at(t) if not f.index]
        if near is None or not states:
            return None
        best = min(states, key=lambda f: float(np.abs(f.state - near.state).max()))
        return np.asarray(best.problem.expand(best.state))
