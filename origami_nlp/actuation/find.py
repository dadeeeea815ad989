"""Actuate a vertex or a pattern: torques on creases, from the flat state or from another, one load after the other."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from os import PathLike
from typing import Any

import numpy as np

from origami_nlp.actuation.branches import (
    driven_alone,
    driven_by_signs,
    flat_branches,
    released,
    torque_of,
)
from origami_nlp.actuation.cones import FlatMotion
from origami_nlp.actuation.driving import DrivenSet
from origami_nlp.actuation.result import Actuation, FlatBranch, StateTransition
from origami_nlp.arguments import check_flag, check_number, check_until, check_whole, shown
from origami_nlp.errors import OptionError, OutOfTime
from origami_nlp.loading import LoadPath, load_path
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import CONTACT_TOL, NEAR_SINGULAR_TOL, SETTLED
from origami_nlp.pattern import Pattern, Scene, as_origami, scene_pattern
from origami_nlp.pattern_problem import PatternProblem, Torque
from origami_nlp.pattern_states import find_states, judge_end

Torques = Mapping[int, float | str]
SIGNS = {"+": 1, "-": -1}
"""Torques of which only the sign is stated."""
MOST_DRIVEN = 12
"""Branches for which the fewest driven creases are looked for."""


def actuate(
    origami: Scene | Pattern | str | PathLike[str],
    torques: Torques | Sequence[Torques] | None = None,
    *,
    start: str | int | JudgedState = "flat",
    relaxed: bool = False,
    effort: str = "normal",
    seed: int = 0,
    seconds: float | None = None,
) -> Actuation:
    """Put torques on creases: which states are reached, is the fold unique, and which few creases would make it so.

    From the flat state a sheet goes along a branch if torques and springs work on it to first order.  The fold is
    unique if they do so on exactly one branch, of one degree of freedom (Tachi and Hull, 2017).  What is reached is the
    first minimum along each branch that is started, the torques constant.

    Parameters
    ----------
    origami
        A scene or a pattern, as `find_minima` takes it; facets may not cross, and no symmetry is imposed.
    torques
        On creases by their numbers (1-based) [N m], towards valley > 0; several of these: loads that are put on and
        taken off one after the other.  None: branches of the flat state, and the fewest creases that start one alone.
        Signs alone, "+" or "-" on each crease: which branches torques of some sizes start alone (`relaxed` only).
    start
        ``"flat"``; a stable state without torques: its number (1-based), by energy, or itself; ``"all"``: all of them,
        with the graph of where each load leads from each.
    relaxed
        Whether springs are at rest in the flat state, whatever rest angles are stated: what torques do by themselves.
    effort, seed
        Of the search for stable states, see `find_minima`.
    seconds
        Wall time, to a second or two; what was left out is named.  None: no limit.

    Returns
    -------
    Actuation
        Branches, states and transitions.

    Raises
    ------
    OptionError
        If an argument is not what it must be, or there is no such stable state.

    Examples
    --------
    One Miura vertex is folded uniquely by torques on creases 2 and 3; no torques do so with a sheet of four:

    >>> import origami_nlp as o
    >>> o.actuate("miura:2x2", {2: 0.01, 3: 0.01}, relaxed=True).unique, o.actuate("miura:3x3").can_be_unique
    (True, False)
    """
    until, pattern = check_until(seconds), _sheet(origami)
    check_flag("relaxed", relaxed)
    if relaxed:
        pattern = pattern.with_springs(pattern.stiffness.tolist(), 0.0)
    signs = _signs(pattern, torques, relaxed)
    given = [torques] if isinstance(torques, Mapping) else torques or ()
    loads = () if signs else tuple(_load(pattern, t) for t in given)
    if signs and start != "flat":
        raise OptionError("torques: signs alone act on the flat state, start = 'flat'")
    if not loads and start != "flat":
        raise OptionError("torques is missing: say what is to act on that state, {crease: torque}")
    if isinstance(start, str) and start not in ("flat", "all"):
        raise OptionError(f"start = {shown(start)} must be 'flat', 'all', or a stable state")
    graph, left_out = TransitionGraph(pattern, loads, until), list[str]()
    branches, reached, driven, reason = (
        list[FlatBranch](),
        list[JudgedState](),
        list[DrivenSet](),
        "",
    )
    if start == "flat" or start == "all":
        if not pattern.is_flat and start == "flat":
            raise OptionError(
                "start = 'flat': the sheet cannot lie flat; give the number of a stable state"
            )
        low, high = pattern.limit_angles
        beyond = np.flatnonzero((low > CONTACT_TOL) | (high < -CONTACT_TOL))
        if len(beyond) and start == "flat":
            raise OptionError(
                f"start = 'flat': the flat state is beyond the stop of crease {beyond[0] + 1}; give the number of a "
                "stable state"
            )
        if pattern.is_flat and not len(beyond):
            try:
                found, reason = graph.flat
                if loads and start == "flat":
                    branches, reached = graph.released(1)
                else:
                    none = np.zeros(pattern.creases)
                    branches, reached = released(pattern, none, found, until, release=False)
                driven = _driven_sets(found, branches, signs)
            except OutOfTime:
                left_out.append(
                    "seconds: the time was over before branches of the flat state were followed"
                )
                reason = reason or "the time was over"
    if start != "flat" or len(loads) > 1:
        _go(graph, start, {"effort": effort, "seed": seed})
    return Actuation(
        pattern, loads, tuple(branches), tuple(reached), tuple(driven),
        tuple(graph.states), tuple(graph.found), tuple(graph.walk), reason, (*left_out, *graph.left_out),
        signs,
    )  # fmt: skip


def _go(graph: TransitionGraph, start: Any, asked: dict[str, Any]) -> None:
    """Apply loads: one after the other from one state, or each from all."""
    if start == "flat":
        graph.go(0)
        return
    number = 1
    if isinstance(start, JudgedState):
        graph.states = [start]
    else:
        limit: dict[str, Any] = (
            {} if graph.until == math.inf else {"seconds": max(graph.until - time.monotonic(), 0.0)}
        )
        found = find_states(graph.pattern, escape=False, prove=False, **asked, **limit).minima
        graph.states = [m for m in found if np.any(m.phi)]
        if start == "all":
            graph.all(len(graph.states) < len(found))
            return
        if not found:
            raise OptionError("no stable state was found without torques")
        chosen = found[check_whole("start", start, 1, len(found)) - 1]
        number = 1 + graph.states.index(chosen) if np.any(chosen.phi) else 0
    graph.go(number)


def _sheet(origami: Any) -> Pattern:
    stated = as_origami(origami)
    if isinstance(stated, Scene):
        if stated.contact != "full":
            raise OptionError(
                f"contact = {stated.contact!r} of the scene must be 'full': facets are not to cross"
            )
        stated = replace(scene_pattern(stated), name=stated.title)
    stated.check_alone("actuation")
    return stated


def _load(pattern: Pattern, torques: Any) -> np.ndarray:
    if not isinstance(torques, Mapping) or not torques:
        raise OptionError(
            f"torques = {shown(torques)} must be {{crease: torque}}, or several of these"
        )
    out = np.zeros(pattern.creases)
    for crease, torque in torques.items():
        out[check_whole("crease", crease, 1, pattern.creases) - 1] = check_number(
            f"torque on crease {crease}", torque
        )
    if not out.any():
        raise OptionError("torques: all of them are 0")
    return out


def _signs(pattern: Pattern, torques: Any, relaxed: bool) -> tuple[int, ...]:
    """Return the signs of torques on all creases; none where sizes are stated, or nothing is."""
    if not isinstance(torques, Mapping) or not any(isinstance(t, str) for t in torques.values()):
        return ()
    if not all(isinstance(t, str) and t in SIGNS for t in torques.values()):
        raise OptionError(
            f"torques = {shown(torques)} must be numbers, or '+' or '-' on each crease"
        )
    if not relaxed and pattern.rest.any():
        raise OptionError(
            "torques: beside springs that work signs alone say nothing: springs at rest when flat (relaxed)"
        )
    out = [0] * pattern.creases
    for crease, sign in torques.items():
        out[check_whole("crease", crease, 1, pattern.creases) - 1] = SIGNS[sign]
    return tuple(out)


def _driven_sets(
    found: Sequence[FlatMotion], branches: Sequence[FlatBranch], signs: Sequence[int]
) -> list[DrivenSet]:
    """Find the fewest creases that start a branch alone, of those that are started first; or sizes of torques."""
    if signs:
        return driven_by_signs(found, signs)
    order = sorted(range(len(found)), key=lambda k: branches[k].work <= 0)
    some = [
        driven_alone(found, k) for k in [k for k in order if branches[k].drivable][:MOST_DRIVEN]
    ]
    return sorted((d for d in some if d is not None), key=lambda d: d.branch)


MOST_STATES = 40
"""From which transitions are looked for."""
MOST_SECONDS = 600.0
"""For one transition, of wall time."""
Released = tuple[list[FlatBranch], list[JudgedState]]


class TransitionGraph:
    """Stable states without loads, and where loads lead from them.

    Parameters
    ----------
    pattern
        The sheet.
    loads
        Torques of each, [n] [N m].
    until
        Value of `time.monotonic` at which the time is over.
    """

    def __init__(self, pattern: Pattern, loads: tuple[np.ndarray, ...], until: float) -> None:
        self.pattern, self.loads, self.until = pattern, loads, until
        self.problem = PatternProblem(pattern)
        self.states: list[JudgedState] = []
        self.found: list[StateTransition] = []
        self.walk: list[int] = []
        self.left_out: list[str] = []
        self._released: dict[int, Released] = {}

    @cached_property
    def flat(self) -> tuple[list[FlatMotion], str]:
        """Branches of the flat state, or why they were not enumerated: see `flat_branches`."""
        return flat_branches(self.pattern, self.until)

    def released(self, load: int) -> Released:
        """Go from the flat state along each branch under a load (1-based): see `released`."""
        if load not in self._released:
            self._released[load] = released(
                self.pattern, self.loads[load - 1], self.flat[0], self.until
            )
        return self._released[load]

    def go(self, number: int) -> None:
        """Apply the loads one after the other, from a state (0: the flat one)."""
        self.walk = [number]
        for load in range(1, len(self.loads) + 1):
            led = self.apply(self.walk[-1], load)
            if len({t.end for t in led}) != 1 or led[0].end < 0:
                return
            self.walk.append(led[0].end)

    def all(self, flat: bool) -> None:
        """Apply each load to each state, and to those that are reached; to the flat one where that is stable."""
        todo = [*([0] if flat else []), *range(1, len(self.states) + 1)]
        for number in todo:  # which grows
            if number > MOST_STATES:
                self.left_out.append(f"transitions of states beyond the first {MOST_STATES}")
                return
            for load in range(1, len(self.loads) + 1):
                todo += [t.end for t in self.apply(number, load) if t.end > max(todo)]

    def apply(self, number: int, load: int) -> list[StateTransition]:
        """Put a load on a state (0: the flat one) and take it off again; both by their numbers (1-based)."""
        known = [t for t in self.found if (t.start, t.load) == (number, load)]
        if known:
            return known
        work = torque_of(self.pattern, self.loads[load - 1])
        assert work is not None
        torque, size = work
        try:
            if number:
                some = [self._path(torque, size, self.states[number - 1], unload=True)]
            else:
                some = self._from_flat(torque, size, load)
        except OutOfTime:
            some = [(-1, (), "seconds: the time was over")]
        self.found += [StateTransition(number, end, load, snaps, why) for end, snaps, why in some]
        return [t for t in self.found if (t.start, t.load) == (number, load)]

    def _from_flat(
        self, torque: Torque, size: float, load: int
    ) -> list[tuple[int, tuple[float, ...], str]]:
        if reason := self.flat[1]:
            return [(-1, (), reason)]
        branches, reached = self.released(load)
        out: list[tuple[int, tuple[float, ...], str]] = [
            (-1, (), b.why) for b in branches if b.work > 0 and not b.reached
        ]
        back = Torque(torque.loaded(size), torque.creases, tuple(-s for s in torque.shares))
        out += [self._path(back, size, state, unload=False) for state in reached]
        return out or [(0, (), "")]

    def _path(
        self, torque: Torque, size: float, state: JudgedState, *, unload: bool
    ) -> tuple[int, tuple[float, ...], str]:
        """Follow a state under a torque, and back: where it ends, at which shares it snaps, why that is not known."""
        left = min(self.until - time.monotonic(), MOST_SECONDS)
        if left <= 0:
            return -1, (), "seconds: the time was over"
        try:
            path = load_path(
                torque.pattern,
                torque,
                to=size,
                state=state,
                unload=unload,
                confirm=False,
                seconds=left,
            )
        except OptionError as refused:
            return -1, (), str(refused)
        snaps = tuple(snap.t / size for snap in path.snaps)
        return self._end(path, 0.0 if unload else size), snaps, self._why(path)

    def _end(self, path: LoadPath, at: float) -> int:
        """Return the number of the state at which a path ends; -1 where it does not come to its end."""
        last = path.legs[-1].points[-1]
        phi, span = np.array(last.fold_angles), path.high - path.low
        near = abs(last.t - at) <= NEAR_SINGULAR_TOL * span
        if near and self.pattern.is_flat and np.abs(phi).max() <= NEAR_SINGULAR_TOL:
            flat = judge_end(self.problem, np.zeros(self.pattern.creases))
            return 0 if flat.verdict == "minimum" else -1
        if abs(last.t - at) > SETTLED * span:
            return -1
        state = judge_end(self.problem, phi)
        if state.verdict != "minimum":
            return -1
        for k, known in enumerate(self.states, start=1):
            if np.abs(known.phi - state.phi).max() <= SETTLED:
                return k
        self.states.append(state)
        return len(self.states)

    def _why(self, path: LoadPath) -> str:
        """Say why a path did not come to its end."""
        last = path.legs[-1]
        return "; ".join(path.alarms) or (last.why if last.why not in ("range", "snap") else "")
