"""Hinges that yield along a load path: elastic up to a torque, perfectly plastic at it.

A spring k with the yield torque T bears tau = k (phi - rest - p), |tau| <= T.  Where |tau| comes to T it yields: the
torque stays, and the plastic angle p follows phi; where phi turns back it is elastic again about a rest angle that has
moved by p.  Both are problems like any other: moved rest angles, or a constant torque in place of a spring.  Which of
the hinges at their yield torque go on yielding is decided by the rates there (the rate problem of plasticity: one
yields forwards or its torque falls, not both).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from origami_nlp.continuation import Equilibrium, ParameterLine
from origami_nlp.errors import OptionError
from origami_nlp.numerics import SETTLED
from origami_nlp.paths.driver import Driver
from origami_nlp.paths.job import FollowedLoad, Run
from origami_nlp.paths.records import COLLAPSE, HOLDS, YIELDS, PathEvent
from origami_nlp.pattern import read_torque_bounds

MOST_STAGES = 100
"""Of one path, one way: more are taken for a mistake."""


@dataclass(frozen=True, eq=False)
class YieldingHinges:
    """Springs at one stage of a path: some yield, the others are elastic.

    Attributes
    ----------
    most
        Yield torques [N m], inf where a hinge has none, [N].
    stiffness, rest
        The elastic springs, as stated.
    preload
        Torques that act beside them [N m], [N].
    moved
        By how much rest angles had moved when the stage began, [N] [rad].
    since
        Fold angles at which hinges that yield began to, nan of the others, [N] [rad].
    """

    most: np.ndarray
    stiffness: np.ndarray
    rest: np.ndarray
    preload: np.ndarray
    moved: np.ndarray
    since: np.ndarray

    @staticmethod
    def of(driver: Driver, given: Any, phi: np.ndarray, state: int) -> YieldingHinges:
        """Return the hinges of what is loaded before anything has yielded; phi: at load 0, of a number or 0.

        Raises
        ------
        OptionError
            If a hinge bears more than its yield torque there, or has a law in place of a spring.
        """
        stated = driver.origami
        k, none = np.array(stated.stiffness, float), np.zeros(len(stated.stiffness))
        rest, preload = np.array(stated.rest, float), none + np.array(stated.preload or 0.0)
        most = read_torque_bounds(given, len(k), "yield_torque")
        hinges = YieldingHinges(most, k, rest, preload, none, none + np.nan)
        borne = np.abs(hinges.torque(phi))
        for i, law in enumerate(stated.laws or [None] * len(k)):
            if law is not None and np.isfinite(most[i]):
                raise OptionError(f"yield_torque: crease {i + 1} has a hinge law: springs yield")
            if law is None and borne[i] > most[i]:
                why = f"bears {borne[i]:.6g} N m in state {state or 'given'} at load 0 already"
                raise OptionError(f"yield_torque = {most[i]:.6g} N m: crease {i + 1} {why}")
        return hinges

    @property
    def yielding(self) -> np.ndarray:
        """Which hinges yield, [N]."""
        return np.isfinite(self.since)

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Torques of springs at states [..., N], without preload, same shape."""
        return self.stiffness * (np.where(self.yielding, self.since, phi) - self.moved - self.rest)

    def moved_at(self, phi: np.ndarray) -> np.ndarray:
        """Return by how much rest angles have moved at states [..., N]."""
        return self.moved + np.where(self.yielding, phi - self.since, 0.0)

    def stored(self, phi: np.ndarray) -> float:
        """Energy that springs store at a state [N] above what they would without having yielded."""
        elastic = self.stiffness * (phi - self.rest)
        return float((0.5 * (self.torque(phi) ** 2 - elastic**2) / self.stiffness).sum())

    def work(self, phi: np.ndarray) -> float:
        """Plastic work since the stage began, at a state [N]."""
        return float(self.torque(phi) @ (self.moved_at(phi) - self.moved))

    def at(self, phi: np.ndarray) -> YieldingHinges:
        """Return the hinges at a state where a stage ends, all elastic."""
        return replace(self, moved=self.moved_at(phi), since=np.full(len(phi), np.nan))

    def full(self, phi: np.ndarray) -> np.ndarray:
        """Return which hinges are at their yield torque at a state: 1 towards valley, -1 towards mountain, [N]."""
        share = self.torque(phi) / self.most
        return np.where(np.abs(share) >= 1 - SETTLED, np.sign(share), 0.0)

    def over(self, phi: np.ndarray) -> str:
        """Name the creases that would bear more than they yield at, at a state."""
        return creases_named(np.abs(self.torque(phi)) > self.most * (1 + SETTLED))

    def named(self, event: PathEvent) -> PathEvent:
        """Return an event of this stage with the creases that it is of."""
        full = (self.full(np.array(event.fold_angles)) != 0) & ~self.yielding
        which = {HOLDS: self.yielding, YIELDS: full}.get(event.type)
        who = event.contact if which is None else creases_named(which)
        return replace(event, contact=who, branches=())

    @property
    def events(self) -> list[tuple[str, Any]]:
        """Functions of a state that are zero where a hinge begins to yield, or turns back."""
        elastic = np.flatnonzero(np.isfinite(self.most) & ~self.yielding).tolist()
        yields = [(YIELDS, partial(self._room, i)) for i in elastic]
        on = np.flatnonzero(self.yielding).tolist()
        return [*yields, *((HOLDS, partial(_rate, i)) for i in on)]

    def _room(self, i: int, at: Equilibrium) -> float:
        return 1.0 - float((self.torque(at.state)[i] / self.most[i]) ** 2)

    def line(self, driver: Driver) -> ParameterLine:
        """Return the problems over the load in this stage; every crease is a variable."""
        line = driver.line()
        p, on = line.start, self.yielding
        # preload is part of the rest angle
        held = np.where(on, self.preload - self.torque(self.since), 0.0)
        k, load = np.where(on, 0.0, p.stiffness), p.load + held / line.problem.scale
        start = replace(p, stiffness=k, rest=p.rest + self.moved, load=load)
        return replace(line, problem=line.problem.varied(start), start=start)


def _rate(i: int, at: Equilibrium) -> float:
    return float(at.tangent[i])


def creases_named(which: np.ndarray) -> str:
    """Name some of all creases."""
    numbers = (np.flatnonzero(which) + 1).tolist()
    head = "crease " if len(numbers) == 1 else "creases "
    return head + ", ".join(map(str, numbers)) if numbers else ""


Stage = tuple[np.ndarray, YieldingHinges]


def go_yielding(path: FollowedLoad, begun: Stage, t: float, end: float) -> Stage | None:
    """Load a state [N] from t to `end`, hinges all elastic at first; return where it arrives, None before that."""
    (x, hinges), toward, kept = begun, 1.0 if end > t else -1.0, path.record
    for _ in range(MOST_STAGES):
        job = _begin(path, (x, hinges), t, toward)
        if job is None:
            return None
        kept.stages.append(job)
        ways = len(kept.ways)
        job.go(x, t, end, once=True)
        if len(kept.ways) == ways:
            return None
        kept.ways[ways:] = [run := _cut(kept.ways[ways], job.hinges)]
        x, t = run.frames[-1].state, run.frames[-1].s
        kept.work += job.hinges.work(x)
        hinges = job.hinges.at(x)
        if run.why == "range":
            return x, hinges
        if run.why not in (YIELDS, HOLDS):
            return None
    kept.alarms.append(f"more than {MOST_STAGES} times a hinge yields or turns back")
    return None


def _begin(path: FollowedLoad, begun: Stage, t: float, toward: float) -> FollowedLoad | None:
    """Return what is followed from a state on, with the hinges that go on yielding; None where it collapses."""
    x, hinges = begun
    full = hinges.full(x)
    yielding, seen = full != 0, set[bytes]()
    while yielding.tobytes() not in seen:
        seen.add(yielding.tobytes())
        job = path.stage(replace(hinges, since=np.where(yielding, x, np.nan)))
        job.begin(x, t, toward, follow=False)
        ahead = [h.frame for node in job.nodes for h in node.halves]
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
        path.record.ways[-1] = path.record.ways[-1]._replace(why=COLLAPSE, fall=None)
    why = "no stable state goes on: the state collapses; how far hinges yield then is not followed"
    path.record.alarms.append(f"at load {t:.6g}, where {creases_named(full)} yield, {why}")
    return None


def _cut(run: Run, hinges: YieldingHinges) -> Run:
    """Cut a run where a hinge turns back at a contact, which no function of the states between shows."""
    on = np.flatnonzero(hinges.yielding)
    side = np.sign(hinges.torque(run.frames[0].state))[on]
    for k, frame in enumerate(run.frames):
        rates = side * frame.tangent[:-1][on] * np.sign(frame.ahead * run.toward)
        if k > 1 and (rates < -SETTLED).any() and frame.ahead:
            return run._replace(why=HOLDS, frames=run.frames[:k], fall=None)
    return run
