"""Follow a stable state of a sheet under a load: as far as it is stable, through snaps, and back."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from origami_nlp.arguments import check_flag, check_number, check_until, check_whole, shown
from origami_nlp.errors import OUT_OF_TIME, OptionError
from origami_nlp.facets import OutOfTime, Sheet
from origami_nlp.kkt import State, classify
from origami_nlp.loading import Confirmed, Leg, LoadPoint, Snap
from origami_nlp.numerics import SAME, SETTLED
from origami_nlp.path import Steps
from origami_nlp.pattern import Pattern, as_pattern
from origami_nlp.sheet_loading.branch import STEPS, Branch, Follower
from origami_nlp.sheet_loading.curve import LoadedState
from origami_nlp.sheet_loading.events import Found
from origami_nlp.sheet_loading.held import touches_of
from origami_nlp.sheet_loading.loaded import LoadedSheet
from origami_nlp.sheet_loading.packing import Packed, pack_branches
from origami_nlp.sheet_loading.result import SheetLoadPath
from origami_nlp.sheet_loading.work import DeadForce, Pull, Torque, Work
from origami_nlp.sheets import (
    Descended,
    SheetState,
    descend,
    find_states,
    judge,
    press,
)

MOST_CREASES = 600
"""Of a sheet: the kernel of closure is decomposed at every step."""
MOST_SNAPS = 20
"""Of one path: more are taken for a mistake."""
OVER = (1e-5, 1e-4, 1e-3)
"""How far beyond a snap, over the load there, a state is let go: the first from which it comes to rest at a certified
minimum."""
FLAT = 1e-3
"""Largest fold angle of a state that is called flat in words [rad]."""
SECONDS = 300.0
"""For a path and its searches, of wall time."""
SIDE = 0.01
"""Torque over the mean stiffness between a snap and the searches beside it."""
MEETS = ("touches", "slides")
"""Events at which facets meet so that no single gap keeps them apart."""
SNAPS = ("fold", "nonsmooth-fold", "branching")
"""Events at which a stable state ends."""


def find_load_path(
    pattern: Pattern | str | Path,
    load: int | Sequence[int] | Work,
    *,
    to: float | str = "snap",
    state: int | SheetState = 1,
    back: bool = False,
    confirm: bool = True,
    starts: int = 40,
    seed: int = 0,
    steps: Steps | None = None,
    seconds: float = SECONDS,
) -> SheetLoadPath:
    """Load a stable state of a sheet, and follow it.

    Where the state ends in a fold it snaps: it descends, at the load at which it ends, to the next minimum, from where
    the path goes on.

    Parameters
    ----------
    pattern
        What is folded; the name of an example such as ``"miura:4x4"``, or a FOLD file.
    load
        Number (1-based) of the crease that the torque t [N m] is on, towards valley > 0; several numbers: t on each of
        them; or a `Torque`, `Pull` or `DeadForce` of this pattern.
    to
        Load at which the path ends, from 0; ``"snap"``: both ways to the first snap.
    state
        Number (1-based) of the stable state at load 0, by energy, of `find_states`; or one of its states.
    back
        Whether the load then falls back to 0, from where it came to or snapped.
    confirm
        Whether both sides of each snap are confirmed by searches; of torques only.
    starts, seed
        Of the searches.
    steps
        Of the tracer, lengths as root mean squares over creases.
    seconds
        Wall time for all of it, give or take a second or two: what was followed by then is kept, and what was left
        out is named.

    Returns
    -------
    SheetLoadPath
        Legs, snaps, branches and events.

    Raises
    ------
    OptionError
        If an argument is not what it must be, the sheet has no such state, or the time was over before the path began.

    Examples
    --------
    >>> import origami_nlp as o
    >>> sheet = o.examples.pattern("metasheet", 3, 3)
    >>> path = o.find_load_path(sheet, [1, 2], to=0.05)
    >>> [round(leg.points[-1].t, 6) for leg in path.legs]
    [0.05]
    """
    pattern = as_pattern(pattern)
    if pattern.creases > MOST_CREASES:
        raise OptionError(
            f"the pattern has {pattern.creases:,} creases: load paths are followed up to {MOST_CREASES}"
        )
    work = _work(pattern, load)
    for name, flag in (("back", back), ("confirm", confirm)):
        check_flag(name, flag)
    if (isinstance(to, str) and to != "snap") or to == 0:
        raise OptionError(f"to = {shown(to)} must be a load other than 0, or 'snap'")
    far = 2 * math.pi * float(pattern.stiffness.sum()) / work.arm
    ends = [-far, far] if to == "snap" else [check_number("to", to)]
    until = check_until(seconds)
    searches = _Searches(check_whole("starts", starts, 0), check_whole("seed", seed, 0), until)
    number, begun = _state(pattern, state, searches)
    if isinstance(work, Pull) and work.conjugate(begun.fold_angles) <= SAME * work.arm:
        a, b = work.corners
        raise OptionError(
            f"pull = {a}, {b}: these vertices lie on each other in the state that is loaded: no line leads from one to "
            "the other"
        )
    job = _Job(pattern, work, min(0.0, *ends), max(0.0, *ends), steps or STEPS)
    job.sheet.until = until
    try:
        for end in ends:
            arrived = job.go(begun.fold_angles, 0.0, end, once=to == "snap")
            if back and arrived is not None:
                job.between(0.0, end)
                job.go(*arrived, 0.0, once=False)
                job.between(*ends)
    except OutOfTime:
        if not job.ways:
            raise OptionError(
                f"seconds = {seconds:g}: the time was over before a leg of the path was followed: give more"
            ) from None
        job.alarms.append(
            f"{OUT_OF_TIME} ({seconds:g} s): the path goes on from where it ends here"
        )
    job.sheet.until = math.inf
    return job.path(number, searches, confirm)


def _work(pattern: Pattern, load: Any) -> Work:
    if isinstance(load, Torque | Pull | DeadForce):
        if load.pattern is not pattern:
            raise OptionError("load is one of another pattern: make it of the one that is loaded")
        return load
    several = isinstance(load, Sequence) and not isinstance(load, str)
    return Torque(pattern, tuple(load) if several else (load,))


@dataclass(eq=False)
class _Searches:
    """Searches for stable states with what is left of the time; `cut` where one of them ended for it."""

    starts: int
    seed: int
    until: float
    cut: bool = False

    def find(self, pattern: Pattern) -> tuple[SheetState, ...]:
        """Return the stable states."""
        left = max(self.until - time.monotonic(), 0.0)
        found = find_states(pattern, self.starts, self.seed, seconds=left, escape=False)
        self.cut = bool(found.search.left_out)
        return found.minima


def _state(pattern: Pattern, state: Any, searches: _Searches) -> tuple[int, SheetState]:
    """Return the number of the state that is loaded, and the state."""
    number = 0
    if not isinstance(state, SheetState):
        number = check_whole("state", state, 1)
        found = searches.find(pattern)
        if searches.cut:
            raise OptionError(
                "seconds: the time was over before the search for the state at load 0 was through: give more"
            )
        if not found:
            raise OptionError("no stable state was found at load 0")
        state = found[check_whole("state", state, 1, len(found)) - 1]
    which = f"state = {number}" if number else "state"
    if state.verdict != "minimum" or len(state.fold_angles) != pattern.creases:
        raise OptionError(f"{which} is no stable state of this pattern: {state.certificate}")
    if not np.any(state.fold_angles):
        raise OptionError(
            f"{which} is the flat state, from which many branches go on: load a folded one (rest angles other than 0)"
        )
    return number, state


@dataclass(frozen=True, eq=False)
class _Way:
    """Stable states of a branch that the load passes one way: the first `count`, and why they end."""

    branch: int
    count: int
    toward: float
    why: str
    event: Found
    snap: int | None


@dataclass(frozen=True, eq=False)
class _Fall:
    """Where a state ends, and the state it descends to: its T, fold angles, and what they are."""

    event: Found
    load: float
    landed: SheetState
    restabilises: float | None


class _Job:
    """One load path while it is followed."""

    def __init__(self, pattern: Pattern, work: Work, low: float, high: float, steps: Steps) -> None:
        self.pattern, self.work, self.low, self.high = pattern, work, low, high
        self.sheet = Sheet(pattern)
        scale = self.sheet.scale
        self.follower = Follower(self.sheet, work, low / scale, high / scale, steps)
        self.branches: list[Branch] = []
        self.ways: list[_Way] = []
        self.falls: list[_Fall] = []
        self.alarms: list[str] = []

    def between(self, *ends: float) -> None:
        """Follow in the range of load that these and 0 span."""
        scale = self.sheet.scale
        low, high = min(0.0, *ends) / scale, max(0.0, *ends) / scale
        self.follower = replace(self.follower, low=low, high=high)

    def go(
        self, phi: np.ndarray, load: float, end: float, *, once: bool
    ) -> tuple[np.ndarray, float] | None:
        """Load the stable state phi from T = load to the load `end`, through snaps unless `once`; where it arrives."""
        toward = 1.0 if end / self.sheet.scale > load else -1.0
        for _ in range(MOST_SNAPS):
            branch = self.follower.follow(phi, load, toward)
            self.branches.append(branch)
            position, event = next(
                (k, e) for k, e in branch.events if e.type not in ("closes", "leaves")
            )
            slips = event.type == "slides" and bool(event.contacts)
            fall = self._let_go(branch, event, toward) if slips or event.type in SNAPS else None
            if fall is None and event.type not in SNAPS:
                told = (event.contact, event.why) if event.type in MEETS else (event.why,)
                named = ": ".join(part for part in told if part)
                why = "range" if event.type == "range" else f"stopped: {named}"
                self._add(position, toward, why, event, None)
                last = branch.states[position]
                return (last.phi, float(last.x[-1])) if why == "range" else None
            if fall is None:
                self._add(position, toward, "snap", event, None)
                return None
            self.falls.append(fall)
            self._add(position, toward, "snap", event, len(self.falls))
            phi, load = fall.landed.fold_angles, fall.load
            if not self.follower.low <= load <= self.follower.high:
                return None
            if once:
                return phi, load
        self.alarms.append(f"more than {MOST_SNAPS} snaps")
        return None

    def _add(self, position: int, toward: float, why: str, event: Found, snap: int | None) -> None:
        number = len(self.branches) - 1
        self.ways.append(_Way(number, position + 1, toward, why, event, snap))

    def _let_go(self, branch: Branch, event: Found, toward: float) -> _Fall | None:
        """Descend from the end of a way, a little beyond its load."""
        at = float(event.state.x[-1])
        why = "no lower state was reached"
        phi, touching = event.state.phi, bool(touches_of(event.state.held))
        begun: np.ndarray | None = phi
        if event.type == "slides":  # lower states are beside where a facet ends, unless others hold
            begun = classify(State(event.state.system.sheet, phi)).lower
        if begun is None:
            return None
        for share in OVER:
            load = at + toward * share * max(
                abs(at), 1e-3 * (self.follower.high - self.follower.low)
            )
            loaded = LoadedSheet(self.sheet, self.work, load * self.sheet.scale)
            end = self._down(loaded, begun, touching)
            if np.abs(end.phi - phi).max() <= 10 * share:
                # of equilibria that stay ones no torque leads away
                lower = classify(State(loaded, phi)).lower if not self.sheet.sparse else None
                end = end if lower is None else press(loaded, lower)
                if np.abs(end.phi - phi).max() <= 10 * share:
                    continue
            if not end.arrived:
                flat = "beside the flat state" if np.abs(end.phi).max() < FLAT else end.why
                why = f"the descent does not come to rest, {flat}"
                continue
            found = judge(loaded, end.phi)
            if found.verdict == "minimum":
                return _Fall(event, load, found, self._again(branch, event))
            why = found.certificate
        where = event.state.t
        self.alarms.append(f"no certified minimum was reached from the end at {where:.9g}: {why}")
        return None

    def _down(self, loaded: LoadedSheet, phi: np.ndarray, touching: bool) -> Descended:
        """Descend from a state: where facets touch, or would come to cross, along states that do not cross."""
        if not touching:
            end = descend(loaded, phi)
            if not any(self.sheet.crossings.find(phi) for phi in (*end.path, end.phi)):
                return end
        return press(loaded, phi)

    @staticmethod
    def _again(branch: Branch, event: Found) -> float | None:
        """Return the load at which the unstable states that begin at a snap become stable again."""
        types = [e.type for _, e in branch.events]
        if types[-1] != "stable again":
            return None
        turns = [e for _, e in branch.events if e.type in SNAPS and e is not event]
        return turns[-1].state.t if turns else None

    def path(self, state: int, searches: _Searches, confirm: bool) -> SheetLoadPath:
        """Judge what was followed, and pack it."""
        packed = pack_branches(self.sheet, self.work, self.branches)
        self.alarms += packed.alarms
        only = searches if confirm else None
        snaps = tuple(self._snap(k, packed, only) for k in range(len(self.falls)))
        legs = tuple(self._leg(way) for way in self.ways)
        tally = self.follower.tally
        return SheetLoadPath(
            self.work, state, self.low, self.high, legs, snaps, packed.branches, packed.events,
            tuple(dict.fromkeys(self.alarms)), tally.steps, tally.evaluations, self.pattern,
        )  # fmt: skip

    def _leg(self, way: _Way) -> Leg:
        states = self.branches[way.branch].states[: way.count]
        points = [
            LoadPoint(
                s.t,
                float(self.work.conjugate(s.phi)),
                tuple(s.phi.tolist()),
                float(self.pattern.energy(s.phi)),
                s.lowest * self.sheet.scale if math.isfinite(s.lowest) else math.nan,
            )
            for s in states
        ]
        return Leg(int(way.toward), tuple(points), way.why, way.snap, "", None)

    def _snap(self, k: int, packed: Packed, searches: _Searches | None) -> Snap:
        fall = self.falls[k]
        event, landed = fall.event, fall.landed
        at = event.state
        after = self._at(landed, fall.load, float(at.x[-1]))
        phi = landed.fold_angles if after is None else after.phi
        loaded = at.system.sheet
        if after is None:  # it begins there: both are compared at the load at which it was let go
            loaded = LoadedSheet(self.sheet, self.work, fall.load * self.sheet.scale)
        return Snap(
            packed.number[id(event)],
            at.t,
            event.type,
            tuple(at.phi.tolist()),
            tuple(phi.tolist()),
            (float(self.work.conjugate(at.phi)), float(self.work.conjugate(phi))),
            (loaded.scaled_energy(at.phi) - loaded.scaled_energy(phi)) * self.sheet.scale,
            str(landed.kind),
            landed.certificate,
            fall.restabilises,
            self._confirmed(k, searches) if searches is not None else None,
        )

    def _at(self, landed: SheetState, load: float, other: float) -> LoadedState | None:
        """Return the landed state at another load, by Newton with what pushes held."""
        toward = math.copysign(1.0, other - load)
        begun = self.follower.begin(landed.fold_angles, load, toward)
        if begun is None:
            return None
        return self.follower.curve(begun.held).where(begun.x, -1, other, begun.tangent)

    def _confirmed(self, k: int, searches: _Searches) -> Confirmed | None:
        """Search on both sides of a snap for the states that the path has there."""
        if not isinstance(self.work, Torque):
            return None
        fall, scale = self.falls[k], self.sheet.scale
        way = next(w for w in self.ways if w.snap == k + 1)
        at = float(fall.event.state.x[-1])
        loads = (at - way.toward * SIDE, at + way.toward * SIDE)
        stable = self.branches[way.branch].states[: way.count]
        near = min(stable, key=lambda s: abs(float(s.x[-1]) - loads[0]))
        before = self.follower.curve(near.held).where(near.x, -1, loads[0], near.tangent)
        after = self._at(fall.landed, fall.load, loads[1])
        minima, found = [], []
        for load, state in zip(loads, (before, after), strict=True):
            states = searches.find(self.work.loaded(load * scale))
            if searches.cut:
                self.alarms.append(f"{OUT_OF_TIME}: snap {k + 1} was not confirmed by searches")
                return None
            minima.append(len(states))
            far = [
                float(np.abs(m.fold_angles - state.phi).max()) for m in states if state is not None
            ]
            found.append(bool(far) and min(far) <= SETTLED)
        return Confirmed(
            (loads[0] * scale, loads[1] * scale), (minima[0], minima[1]), (found[0], found[1])
        )
