"""A load path with hinges that yield: stage by stage, each followed as a path of elastic hinges."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from origami_nlp.errors import OptionError
from origami_nlp.loading.driver import Driver
from origami_nlp.loading.job import FollowedLoad, Record, Run
from origami_nlp.loading.records import COLLAPSE
from origami_nlp.loading.result import LoadPath
from origami_nlp.loading.yielding import HOLDS, YIELDS, YieldingHinges, creases_named
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
    record: Record = field(default_factory=Record)

    def go(
        self, x: np.ndarray, t: float, end: float, hinges: YieldingHinges
    ) -> tuple[np.ndarray, YieldingHinges] | None:
        """Load the state x from t to `end`, hinges all elastic at first; return where it arrives, None before that."""
        toward, kept = 1.0 if end > t else -1.0, self.record
        for _ in range(MOST_STAGES):
            begun = self._begin(x, t, toward, hinges)
            if begun is None:
                return None
            job, hinges = begun
            kept.jobs.append(job)
            ways, falls = len(kept.ways), len(kept.falls)
            job.go(x, t, end, once=True)
            if len(kept.ways) == ways:
                return None
            run = self._cut(kept.ways[ways], hinges)
            kept.ways[ways:] = [run]
            del kept.falls[falls + (run.snap is not None) :]
            x, t = run.segment.frames[-1].state, run.segment.frames[-1].s
            kept.work += hinges.work(x)
            hinges = hinges.at(x)
            if run.segment.why == "range":
                return x, hinges
            if run.segment.why not in (YIELDS, HOLDS):
                return None
        kept.alarms.append(f"more than {MOST_STAGES} times a hinge yields or turns back")
        return None

    def job(self, hinges: YieldingHinges) -> FollowedLoad:
        """Return a stage of the path."""
        given = self.driver, self.low, self.high, False, self.options, self.until
        return FollowedLoad(*given, hinges=hinges, record=self.record)

    def _begin(
        self, x: np.ndarray, t: float, toward: float, hinges: YieldingHinges
    ) -> tuple[FollowedLoad, YieldingHinges] | None:
        """Return what is followed from a state on, with the hinges that go on yielding; None where it collapses."""
        full = hinges.full(x)
        yielding, seen = full != 0, set[bytes]()
        while yielding.tobytes() not in seen:
            seen.add(yielding.tobytes())
            trial = replace(hinges, since=np.where(yielding, x, np.nan))
            job = self.job(trial)
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
        if self.record.ways:
            last = self.record.ways[-1]
            fallen = last._replace(segment=replace(last.segment, why=COLLAPSE))
            self.record.ways[-1] = fallen
        self.record.alarms.append(
            f"at load {t:.6g} {creases_named(full)} yield{'' if np.count_nonzero(full) > 1 else 's'} and no stable state goes "
            "on: the state collapses; how far hinges yield then is decided by its speed, and is not followed"
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
                self.record.alarms.append(
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
    return path.job(hinges).path(state, None)
