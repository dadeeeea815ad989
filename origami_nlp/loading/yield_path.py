"""A load path with hinges that yield: stage by stage, each followed as a path of elastic hinges."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from origami_nlp.loading.job import FollowedLoad, Run
from origami_nlp.loading.records import COLLAPSE
from origami_nlp.loading.yielding import HOLDS, YIELDS, YieldingHinges, creases_named
from origami_nlp.numerics import SETTLED

MOST_STAGES = 100
"""Of one path, one way: more are taken for a mistake."""


def go_yielding(
    path: FollowedLoad, x: np.ndarray, t: float, end: float, hinges: YieldingHinges
) -> tuple[np.ndarray, YieldingHinges] | None:
    """Load the state x [N] from t to `end`, hinges all elastic at first; return where it arrives, None before that."""
    toward, kept = 1.0 if end > t else -1.0, path.record
    for _ in range(MOST_STAGES):
        job = _begin(path, x, t, toward, hinges)
        if job is None:
            return None
        assert job.hinges is not None
        kept.jobs.append(job)
        ways, falls = len(kept.ways), len(kept.falls)
        job.go(x, t, end, once=True)
        if len(kept.ways) == ways:
            return None
        run = _cut(kept.ways[ways], job.hinges, kept.alarms)
        kept.ways[ways:] = [run]
        del kept.falls[falls + (run.snap is not None) :]
        x, t = run.segment.frames[-1].state, run.segment.frames[-1].s
        kept.work += job.hinges.work(x)
        hinges = job.hinges.at(x)
        if run.segment.why == "range":
            return x, hinges
        if run.segment.why not in (YIELDS, HOLDS):
            return None
    kept.alarms.append(f"more than {MOST_STAGES} times a hinge yields or turns back")
    return None


def _begin(
    path: FollowedLoad, x: np.ndarray, t: float, toward: float, hinges: YieldingHinges
) -> FollowedLoad | None:
    """Return what is followed from a state on, with the hinges that go on yielding; None where it collapses."""
    full = hinges.full(x)
    yielding, seen = full != 0, set[bytes]()
    while yielding.tobytes() not in seen:
        seen.add(yielding.tobytes())
        job = path.stage(replace(hinges, since=np.where(yielding, x, np.nan)))
        job.begin(x, t, toward, follow=False)
        ahead = [h.frame for node in job.web.nodes for h in node.halves]
        ahead = [frame for frame in ahead if frame.ahead * toward > 0 and not frame.index]
        if not ahead:
            if not full.any():
                return job  # the path itself says why
            break
        rates = full * ahead[0].tangent[:-1]
        # a hinge that stays neither yields nor falls: it is left as it was taken
        onward = np.where(np.abs(rates) <= SETTLED, yielding, rates > 0) & (full != 0)
        if (onward == yielding).all():
            return job
        yielding = onward
    if path.record.ways:
        path.record.ways[-1] = path.record.ways[-1].ending(COLLAPSE)
    path.record.alarms.append(
        f"at load {t:.6g} {creases_named(full)} yield{'' if np.count_nonzero(full) > 1 else 's'} and no stable "
        "state goes on: the state collapses; how far hinges yield then is decided by its speed, and is not followed"
    )
    return None


def _cut(run: Run, hinges: YieldingHinges, alarms: list[str]) -> Run:
    """Cut a run where a hinge turns back at a contact, which no function of the states between shows."""
    frames = run.segment.frames
    on = np.flatnonzero(hinges.yielding)
    side = np.sign(hinges.torque(frames[0].state))[on]
    for k, frame in enumerate(frames):
        crease = hinges.beyond_law(frame.state)
        if crease is not None:
            alarms.append(
                f"the law of crease {crease}, whose rest angle has moved, is not known at load {frame.s:.6g}: give "
                "extrapolate = 'linear' in the law, or stops"
            )
            return run.ending("stopped: law not known", max(k, 1))
        rates = side * frame.tangent[:-1][on] * np.sign(frame.ahead * run.toward)
        if k > 1 and (rates < -SETTLED).any() and frame.ahead:
            return run.ending(HOLDS, k)
    return run
