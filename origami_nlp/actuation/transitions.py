"""Where loads lead that are put on and taken off one after the other: the graph of stable states under them."""

from __future__ import annotations

import time
from functools import cached_property

import numpy as np

from origami_nlp.actuation.branches import flat_branches, released, torque_of
from origami_nlp.actuation.cones import FlatMotion
from origami_nlp.actuation.result import FlatBranch, StateTransition
from origami_nlp.errors import OptionError, OutOfTime
from origami_nlp.loading import LoadPath, load_path
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import NEAR_SINGULAR_TOL, SETTLED
from origami_nlp.pattern import Pattern
from origami_nlp.pattern_problem import PatternProblem, Torque
from origami_nlp.pattern_states import judge_end

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
