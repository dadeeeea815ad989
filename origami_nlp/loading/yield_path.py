"""A load path with hinges that yield: stage by stage, each followed as a path of elastic hinges."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from origami_nlp.bifurcation import PathEvent, branches_of, chains_of, parts_of
from origami_nlp.continuation import START
from origami_nlp.errors import OptionError
from origami_nlp.loading.driver import Driver
from origami_nlp.loading.job import FollowedLoad, Run
from origami_nlp.loading.records import COLLAPSE, Leg, Snap
from origami_nlp.loading.result import LoadPath
from origami_nlp.loading.yielding import HOLDS, YIELDS, YieldingHinges
from origami_nlp.numerics import SETTLED

MOST_STAGES = 100
"""Of one path, one way: more are taken for a mistake."""


@dataclass
class YieldPath:
    """A load path while it is followed.

    Attributes
    ----------
    driver
        What the load is; every crease is a variable.
    low, high
        Range of the load.
    options
        Of the continuation.
    until
        When following ends (`time.monotonic`).
    """

    driver: Driver
    low: float
    high: float
    options: Any
    until: float
    legs: list[Leg] = field(default_factory=list)
    snaps: list[Snap] = field(default_factory=list)
    events: list[PathEvent] = field(default_factory=list)
    alarms: list[str] = field(default_factory=list)
    work: float = 0.0
    steps: int = 0
    evaluations: int = 0

    def go(
        self, x: np.ndarray, t: float, end: float, hinges: YieldingHinges
    ) -> tuple[np.ndarray, YieldingHinges] | None:
        """Load the state x from t to `end`, hinges all elastic at first; return where it arrives, None before that."""
        toward = 1.0 if end > t else -1.0
        for _ in range(MOST_STAGES):
            begun = self._begin(x, t, toward, hinges)
            if begun is None:
                return None
            job, hinges = begun
            job.go(x, t, end, once=True)
            self.alarms += job.alarms
            self.steps += job.web.tally.steps
            self.evaluations += job.web.tally.evaluations
            if not job.ways:
                return None
            run = self._cut(job.ways[0], hinges)
            frames, why = run.segment.frames, run.segment.why
            x, t = frames[-1].state, frames[-1].s
            self._keep(job, run, hinges)
            self.work += hinges.work(x)
            hinges = hinges.at(x)
            if why == "range":
                return x, hinges
            if why not in (YIELDS, HOLDS):
                return None
        self.alarms.append(f"more than {MOST_STAGES} times a hinge yields or turns back")
        return None

    def _job(self, hinges: YieldingHinges) -> FollowedLoad:
        low, high = self.low, self.high
        return FollowedLoad(self.driver, low, high, False, self.options, self.until, hinges=hinges)

    def _begin(
        self, x: np.ndarray, t: float, toward: float, hinges: YieldingHinges
    ) -> tuple[FollowedLoad, YieldingHinges] | None:
        """Return what is followed from a state on, with the hinges that go on yielding; None where it collapses."""
        full = hinges.full(x)
        yielding, seen = full != 0, set[bytes]()
        while yielding.tobytes() not in seen:
            seen.add(yielding.tobytes())
            trial = replace(hinges, since=np.where(yielding, x, np.nan))
            job = self._job(trial)
            job.begin(x, t, toward, follow=False)
            ahead = [
                h.frame
                for node in job.web.nodes
                for h in node.halves
                if h.frame.ahead * toward > 0 and not h.frame.index
            ]
            if not ahead:
                if not full.any():
                    return job, trial  # the path itself says why
                break
            rates = full * ahead[0].tangent[:-1]
            # a hinge that stays neither yields nor falls: it is left as it was taken
            onward = np.where(np.abs(rates) <= SETTLED, yielding, rates > 0) & (full != 0)
            if (onward == yielding).all():
                return job, trial
            yielding = onward
        numbers = ", ".join(str(i + 1) for i in np.flatnonzero(full))
        words = (
            f"creases {numbers} yield" if np.count_nonzero(full) > 1 else f"crease {numbers} yields"
        )
        if self.legs:
            self.legs[-1] = replace(self.legs[-1], why=COLLAPSE)
        self.alarms.append(
            f"at load {t:.6g} {words} and no stable state goes on: the state collapses; how far hinges yield then "
            "is decided by its speed, and is not followed"
        )
        return None

    def _cut(self, run: Run, hinges: YieldingHinges) -> Run:
        """Cut a run where a hinge turns back at a contact, which no function of the states between shows."""
        frames = run.segment.frames
        on = np.flatnonzero(hinges.yielding)
        side = np.sign(hinges.torque(frames[0].state))[on]
        for k, frame in enumerate(frames):
            crease = hinges.beyond_law(frame.state)
            if crease is not None:
                self.alarms.append(
                    f"the law of crease {crease}, whose rest angle has moved, is not known at load {frame.s:.6g}: give "
                    "extrapolate = 'linear' in the law, or stops"
                )
                return run._replace(
                    segment=replace(
                        run.segment, frames=frames[: max(k, 1)], why="stopped: law not known"
                    ),
                    snap=None,
                )
            rates = side * frame.tangent[:-1][on] * np.sign(frame.ahead * run.toward)
            if k > 1 and (rates < -SETTLED).any() and frame.ahead:
                return run._replace(
                    segment=replace(run.segment, frames=frames[:k], why=HOLDS), snap=None
                )
        return run

    def _keep(self, job: FollowedLoad, run: Run, hinges: YieldingHinges) -> None:
        """Pack the states of a stage, and what happens along it."""
        web = job.web
        parts = {k: parts_of(arc, False) for k, arc in enumerate(web.arcs)}
        _, found = branches_of(web, job.parameter, chains_of(web), parts, job.across)
        leg = job.leg(run)
        points = []
        for p in leg.points:
            stored = float(hinges.stored(np.array(p.fold_angles)))
            points.append(replace(p, energy=p.energy + stored))
        moved = tuple(hinges.moved_at(run.segment.frames[-1].state).tolist())
        passed = {p.fold_angles for p in points}
        kept = {e.id: e for e in found if e.fold_angles in passed}
        if run.snap is not None:
            snap = job._snap(run.snap - 1, found, None)
            kept |= {e.id: e for e in found if e.id == snap.event}
            over = np.abs(hinges.torque(np.array(snap.after))) > hinges.most * (1 + SETTLED)
            if over.any():
                numbers = ", ".join(str(i + 1) for i in np.flatnonzero(over))
                self.alarms.append(
                    f"after the snap at load {snap.t:.6g} creases {numbers} would bear more than they yield at: where "
                    "it ends is not known"
                )
        numbers_of = {}
        for e in kept.values():
            known = [o.id for o in self.events if _one(o, e)]
            numbers_of[e.id] = known[0] if known else len(self.events) + 1
            if not known:
                contact = self._creases(e, hinges) if e.type in (YIELDS, HOLDS) else e.contact
                self.events.append(replace(e, id=numbers_of[e.id], branches=(), contact=contact))
        if run.snap is not None:
            kind = next(e.type for e in found if e.id == snap.event)
            type_ = kind if snap.type == START else snap.type
            event = numbers_of[snap.event]
            self.snaps.append(replace(snap, event=event, type=type_, restabilises=None))
        number = len(self.snaps) if run.snap is not None else None
        self.legs.append(replace(leg, points=tuple(points), snap=number, moved=moved))

    @staticmethod
    def _creases(event: PathEvent, hinges: YieldingHinges) -> str:
        """Name the creases that an event is of."""
        phi = np.array(event.fold_angles)
        which = (
            hinges.yielding if event.type == HOLDS else (hinges.full(phi) != 0) & ~hinges.yielding
        )
        numbers = (np.flatnonzero(which) + 1).tolist()
        return ("crease " if len(numbers) == 1 else "creases ") + ", ".join(map(str, numbers))

    def path(self, state: int) -> LoadPath:
        """Pack what was followed."""
        return LoadPath(
            self.driver, state, self.low, self.high, tuple(self.legs), tuple(self.snaps), (), tuple(self.events),
            tuple(dict.fromkeys(self.alarms)), self.steps, self.evaluations, self.work,
        )  # fmt: skip


def _one(a: PathEvent, b: PathEvent) -> bool:
    """Whether two events are one, met twice."""
    apart = np.abs(np.subtract(a.fold_angles, b.fold_angles)).max()
    return a.type == b.type and max(abs(a.t - b.t), float(apart)) <= SETTLED


def follow_yielding(
    driver: Driver,
    x: np.ndarray,
    state: int,
    ends: list[float],
    given: Any,
    unload: bool,
    options: Any,
    until: float,
) -> LoadPath:
    """Follow a stable state x [N] under a load to some ends, each from where nothing has yielded.

    given: yield torques, see `load_path`.

    Raises
    ------
    OptionError
        If a hinge bears more than its yield torque at load 0.
    """
    hinges = YieldingHinges.of(driver, given)
    torque = hinges.torque(x)
    if (over := np.flatnonzero(np.abs(torque) > hinges.most)).size:
        i = int(over[0])
        raise OptionError(
            f"yield_torque of crease {i + 1} = {hinges.most[i]:.6g} N m: the crease bears {abs(torque[i]):.6g} N m in "
            f"state {state or 'given'} at load 0 already; load another state, or give the rest angles "
            "that hinges have after yielding"
        )
    path = YieldPath(driver, min(0.0, *ends), max(0.0, *ends), options, until)
    for end in ends:
        arrived = path.go(x, 0.0, end, hinges)
        if unload and arrived is not None:
            path.go(arrived[0], end, 0.0, arrived[1])
    return path.path(state)
