"""Equilibria over a parameter as a bifurcation diagram: nodes (events and ends) and arcs between them.

From a state every half-branch is followed; where a contact event ends it, one-sided conditions say how it goes on.
Inner events (limit points, branch points) cut arcs too, so that along an arc the parameter runs one way, the contacts
held and the number of unstable directions stay the same.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.continuation.branch_segments import (
    AGAIN,
    EVENT,
    LATE,
    RANGE,
    START,
    BranchSegment,
    SpecialPoint,
)
from origami_nlp.continuation.contact_events import first_contact_event, other_piece_leaves
from origami_nlp.continuation.equilibrium import Equilibrium, EquilibriumCurve
from origami_nlp.continuation.events import (
    Crossed,
    CurveStep,
    Functions,
    LocatedEvent,
    change_of_verdict,
    flat_crossed,
    folds_and_branchings,
    multipliers_pass_infinity,
)
from origami_nlp.continuation.flat import AT_FLAT, beside_flat, flat_roots, passes
from origami_nlp.continuation.line import Line
from origami_nlp.continuation.one_sided_branches import (
    OneSidedBranch,
    balances,
    find_one_sided_branches,
    is_equilibrium,
    one_sided_branches_at,
)
from origami_nlp.continuation.system import BorderedSystem
from origami_nlp.continuation.tracer import (
    ALIGNED,
    CLOSED_CURVE,
    ContinuationOptions,
    End,
    trace_ahead,
)
from origami_nlp.numerics import NEAR_SINGULAR_TOL, RANK, ROUNDED, SETTLED

STEPS = ContinuationOptions(first=1e-2, longest=0.15)
"""Some 20 to 100 steps for a branch; the tangent turns by at most 17 degrees a step."""

Halves = list[tuple[int, int]]
"""Half-branches, as positions of node and half."""


class BifurcationDiagram:
    """Followed equilibria over the range [low, high] of s.

    Parameters
    ----------
    line
        The parameters.
    low, high
        The range of s.
    steps
        Of the tracer.
    functions
        Further functions of a state whose zeros are events, by type.
    stops
        Types of those beyond which nothing is followed.
    lazy
        Whether stable states beyond unstable ones, and what branches off, wait until they are asked for (`resume`).
    until
        When following ends (`time.monotonic`), wherever it is.
    progress
        Called with the number of arcs that are known, and s at the node from which the next one is followed.

    Attributes
    ----------
    nodes, arcs
        In the order in which they were found.
    steps_made
        That the tracer accepted.
    interrupted
        Whether the time was over before all that comes of the states given was followed.
    stopped
        Whether the user (Ctrl-C) ended it, in place of the time.
    """

    def __init__(
        self,
        line: Line,
        low: float,
        high: float,
        *,
        steps: ContinuationOptions = STEPS,
        functions: Functions = (),
        stops: Sequence[str] = (),
        lazy: bool = False,
        until: float = math.inf,
        progress: Callable[[int, float], object] | None = None,
    ) -> None:
        self.lazy, self.progress, self.stops = lazy, progress, stops
        self.line, self.low, self.high = line, low, high
        self.steps = replace(steps, until=min(steps.until, until))
        self.interrupted = self.stopped = False
        self.functions = tuple(functions)
        self.nodes: list[SpecialPoint] = []
        self.arcs: list[BranchSegment] = []
        self.steps_made = 0
        self.root = np.append(line.problem.root, line.weight)

    @property
    def late(self) -> bool:
        """Whether the time is over; then what was to be followed is not."""
        self.interrupted |= time.monotonic() > self.steps.until
        return self.interrupted

    def stop(self) -> None:
        """Follow no further, as the user wants it: what is known stays."""
        self.interrupted = self.stopped = True

    @cached_property
    def flat(self) -> list[tuple[float, np.ndarray]]:
        """Where curves pass the flat state, see `flat_roots`."""
        return flat_roots(self.line, self.low, self.high)

    def states_at(self, s: float) -> list[tuple[int, Equilibrium]]:
        """Return the states of all arcs at s, with the positions of the arcs."""
        found = [(k, arc.at(s)) for k, arc in enumerate(self.arcs)]
        return [(k, frame) for k, frame in found if frame is not None]

    def frames_at(self, s: float, saddles: bool = True) -> list[Equilibrium]:
        """Return the states of all arcs at s, and those given there from which no equilibrium goes on, each once."""
        out, ended = list[Equilibrium](), {k for arc in self.arcs for k in (arc.start, arc.end)}
        alone = [
            node.halves[0].frame
            for k, node in enumerate(self.nodes)
            if k not in ended and node.halves and abs(node.s - s) <= ROUNDED * (1 + abs(s))
        ]
        for frame in (*(f for _, f in self.states_at(s)), *alone):
            if (saddles or not frame.index) and nearest(out, frame.state) > SETTLED:
                out.append(frame)
        return out

    def split(self, k: int, frame: Equilibrium) -> int:
        """Make a state on an arc a node, and return its number."""
        arc, number = self.arcs[k], len(self.nodes)
        forward = arc.frames[-1].s > arc.frames[0].s
        before = [f for f in arc.frames if (f.s < frame.s) == forward and f.s != frame.s]
        after = arc.frames[len(before) + (arc.frames[len(before)].s == frame.s) :]
        self.nodes.append(SpecialPoint(START, frame.x))
        self.arcs[k] = replace(arc, frames=(*before, frame), end=number)
        self.arcs.append(replace(arc, frames=(frame, *after), start=number))
        return number

    def add(
        self, x: np.ndarray, s: float, verdict: str = "", toward: float = 0.0, follow: bool = True
    ) -> bool:
        """Follow the equilibrium x [n] at s both ways, and all that comes of it; False where it is one of s alone, or
        none.

        verdict: of a state that no multipliers judge, see `find_one_sided_branches`.  toward: 1 or -1: only where s
        grows or falls at first; the other way is left.  follow: whether anything is followed yet.
        """
        point = np.append(x, s)
        node = SpecialPoint(START, point, halves=find_one_sided_branches(self.line, point, verdict))
        self.nodes.append(node)
        # at an end of the range only the half-branches that lead inside are followed
        ends = {1.0: self.high, -1.0: self.low}
        used = [s == ends.get(float(np.sign(h.frame.ahead))) for h in node.halves]
        node.used += np.flatnonzero(used).tolist()
        inside = [k for k, other in enumerate(used) if not other]
        if node.used:
            node.type = RANGE
        if not inside:
            why = "no equilibrium goes on from there: a state of this value alone"
            node.type, node.why = "singular", why
        node.left = [k for k in inside if not follow or node.halves[k].frame.ahead * toward < 0]
        self._follow_all([(len(self.nodes) - 1, k) for k in inside if k not in node.left])
        return bool(inside)

    def _follow_all(self, todo: Halves) -> None:
        """Follow half-branches, and all that comes of them."""
        most = len(self.arcs) + self.steps.arcs
        while todo and len(self.arcs) < most and not self.late:
            number, k = todo.pop()
            if k not in self.nodes[number].used:
                self.nodes[number].used.append(k)
                try:
                    if self.progress is not None:
                        self.progress(len(self.arcs), self.nodes[number].s)
                    todo += self._follow(number, self.nodes[number].halves[k])
                except KeyboardInterrupt:
                    self.stop()
        if todo and not self.interrupted:
            self.nodes[todo[0][0]].why = f"more than {self.steps.arcs} arcs"

    def resume(self, number: int, toward: float) -> bool:
        """Follow what was left at a node and leads to larger (1) or smaller s (-1); False where nothing does."""
        node = self.nodes[number]
        left = [k for k in node.left if k not in node.used]
        onward = [k for k in left if node.halves[k].frame.ahead * toward > 0]
        node.left = [k for k in node.left if k not in onward]
        self._follow_all([(number, k) for k in onward])
        return bool(onward)

    def add_flat(self) -> None:
        """Follow the minima that are born where curves pass the flat state."""
        for s, direction in [] if self.late else self.flat:
            for frame in beside_flat(self.line, s, direction):
                if frame is None or frame.index or not self.low <= frame.s <= self.high:
                    continue
                if nearest((f for _, f in self.states_at(frame.s)), frame.state) > SETTLED:
                    self.add(frame.state, frame.s, "minimum")

    def _follow(self, start: int, half: OneSidedBranch) -> Halves:
        """Follow a half-branch; return those that begin where it ends."""
        curve = EquilibriumCurve(self.line, half.frame.hold, corrector=self.steps.corrector)
        frames, stop = self._trace(curve, half)
        self.steps_made += len(frames)
        begun, here = [half.frame], start
        todo: Halves = []
        for frame in frames:
            at_flat = frame is stop.frame and stop.why == AT_FLAT  # nothing is said of its index
            step = CurveStep(curve, begun[-1], frame)
            for event in [] if at_flat else self._between(step, here):
                number, known = self._node(event)
                begun.append(event.frame)
                self._arc(begun, here, number)
                if known or event.type in ("singular", *self.stops):
                    self._arrive(number, event.frame)
                    return todo
                begun, here = [event.frame], number
                # the other curve through the branch point, both ways
                if event.type == "branching" and not self.lazy:
                    self.nodes[number].halves = one_sided_branches_at(curve, event.frame)
                    todo += [(number, k) for k in range(len(self.nodes[number].halves))]
            begun.append(frame)
        if len(begun) < 2:
            return todo
        if stop.type == START:  # once around
            self._arc(begun, here, start)
            self._arrive(start, begun[-1])
            return todo
        number, _ = self._node(stop)
        self._arc(begun, here, number)
        if stop.type == AGAIN:
            node = self.nodes[number]
            node.halves.append(replace(half, frame=stop.frame))
            node.left.append(len(node.halves) - 1)
            return todo
        return [*todo, *self._go_on(number, replace(half, frame=begun[-1]), stop)]

    def _between(self, step: CurveStep, here: int) -> list[LocatedEvent]:
        """Return what comes inside a step, in order: events, and states given that lie there; not the node `here`."""
        curve, a, _ = step
        found = list[LocatedEvent]()
        for node in self.nodes:
            h = curve.along(a, node.point)
            reach = 2 * h + SETTLED  # more than `beside` moves
            inside = node.type == START and 0 < h < step.length
            if inside and _near(self.root, node.point, a.x, reach):
                frame = curve.beside(a, h)
                if frame is not None and _near(self.root, frame.x, node.point):
                    found.append(LocatedEvent(START, replace(frame, x=node.point), located=True))
        found += folds_and_branchings(step, self.functions)
        node = self.nodes[here]
        near = NEAR_SINGULAR_TOL if node.type == "branching" else SETTLED
        found = [e for e in found if not _near(self.root, e.frame.x, node.point, near)]
        # by the length along the tangent at a, the same for all of them
        return sorted(found, key=lambda e: step.to(e.frame))

    def _arrive(self, number: int, frame: Equilibrium) -> None:
        """Note that a node was reached: what leads back from there is known."""
        node = self.nodes[number]
        node.used += _likest(node.halves, -frame.tangent)

    def _trace(self, curve: EquilibriumCurve, half: OneSidedBranch) -> Crossed:
        """Return the frames after a state, the last of them the event that ends them, and that event."""
        stop, between = list[LocatedEvent](), list[Equilibrium]()
        verdict = "" if half.signed else half.frame.judged.verdict
        unstable = [bool(half.frame.index)]

        def end(
            passed: Callable[[Equilibrium, Equilibrium], object],
            meet: Callable[[Equilibrium, Equilibrium], LocatedEvent],
        ) -> End[Equilibrium]:
            """Return what ends the curve in the first step in which something is passed."""
            last = [half.frame]

            def before(frames: Sequence[Equilibrium]) -> int:
                for k, f in enumerate(frames):
                    if passed(last[0], f):
                        return k
                    last[0] = f
                return len(frames)

            def met(a: Equilibrium, b: Equilibrium) -> Equilibrium:
                stop.append(meet(a, b))
                return stop[-1].frame

            return End(before, EVENT, met)

        def lost(_: Equilibrium, f: Equilibrium) -> bool:
            good = self.low <= f.s <= self.high and is_equilibrium(f)
            good = good and (not half.split or balances(f))
            return not good or bool(verdict and f.judged.verdict != verdict)

        def at_flat(a: Equilibrium, b: Equilibrium) -> LocatedEvent:
            root = passes(lambda: self.flat, a, b)
            assert root is not None
            between[:], event = flat_crossed(curve, root, a)
            return event

        def pole(a: Equilibrium, b: Equilibrium) -> Any:
            return multipliers_pass_infinity(CurveStep(curve, a, b))

        def stable_again(_: Equilibrium, f: Equilibrium) -> bool:
            unstable[0] |= bool(f.index)
            return unstable[0] and not f.index

        # where no multiplier judges, each step is classified: such states mostly stand still
        steps = self.steps if half.signed else replace(self.steps, longest=4 * self.steps.longest)
        ends = [
            end(lambda a, b: passes(lambda: self.flat, a, b), at_flat),
            end(lost, lambda a, b: self._first(CurveStep(curve, a, b), verdict, half.split)),
            end(pole, pole),
        ]
        if self.lazy:
            ends.append(end(stable_again, lambda a, b: LocatedEvent(AGAIN, b, located=True)))
        frames, _, why = trace_ahead(curve, half.frame, steps, ends)
        if stop:
            frames[-1:-1] = between
            return frames, stop[-1]
        last = frames[-1] if frames else half.frame
        if why == CLOSED_CURVE:
            return frames, LocatedEvent(START, last, located=True)
        if why == LATE:
            self.interrupted = True
            return frames, LocatedEvent(LATE, last, located=True)
        return frames, LocatedEvent("singular", last, why=why)

    def _first(self, step: CurveStep, verdict: str, split: bool) -> LocatedEvent:
        """Return the first event between a, which is followed, and b, which is not."""
        curve, a, b = step
        end = self.low if b.s < self.low else self.high if b.s > self.high else None
        if end is not None:
            # a guess; where Newton at s fails, bisection along the curve finds the end
            guess = a.x + (end - a.s) / (b.s - a.s) * (b.x - a.x)
            beyond = curve.at(guess, end, a.tangent) or curve.between(a, b, end)
            if beyond is None:
                return LocatedEvent("singular", a, why="no state at the end")
            b = beyond
        if split and not b.seen.refused and not balances(b):
            leaving = other_piece_leaves(CurveStep(curve, a, b))
            if is_equilibrium(leaving.frame):
                return leaving
            b = leaving.frame
        step = CurveStep(curve, a, b)
        if not is_equilibrium(b):
            return first_contact_event(step)
        if verdict and b.judged.verdict != verdict:
            return change_of_verdict(step, verdict)
        return LocatedEvent(RANGE, b, located=True)

    def _node(self, event: LocatedEvent) -> tuple[int, bool]:
        """Return the node of an event, and whether it was there before."""
        point = event.frame.x
        for k, node in enumerate(self.nodes):
            if (node.type == START) != (event.type == START) or event.type in (RANGE, LATE):
                continue
            # a branching is known to the root of rounding only along its branches
            # along a branch the eigenvalue vanishes to first order; across it states differ by its square root
            crude = node.type == event.type == "branching"
            # met before along another arc: the arcs are joined there
            if _near(self.root, node.point, point, NEAR_SINGULAR_TOL if crude else SETTLED):
                return k, True
        left = event.frame.system.residual if event.residual is None else event.residual
        how = left, event.located, event.why, event.between
        self.nodes.append(SpecialPoint(event.type, point, event.contact, event.value, *how))
        return len(self.nodes) - 1, False

    def _arc(self, frames: list[Equilibrium], start: int, end: int) -> None:
        first, point = frames[0], self.nodes[start].point
        if not _near(self.root, first.x, point):  # contacts held are dependent where they begin
            system = BorderedSystem(self.line, point, first.hold)
            frames = [Equilibrium(point, first.tangent, system), *frames]
        self.arcs.append(BranchSegment(tuple(frames), start, end))

    def _go_on(self, number: int, half: OneSidedBranch, stop: LocatedEvent) -> Halves:
        """Find how equilibria go on from the node at which a half-branch ends."""
        node = self.nodes[number]
        if stop.beyond is not None:
            return self._go_on_beyond(number, half, stop.beyond)
        if stop.type not in ("closes", "leaves"):
            return []
        if not node.halves:
            node.halves = find_one_sided_branches(self.line, node.point)
        along = half.frame.tangent
        came = _likest(node.halves, -along)
        node.used += came
        onward = [k for k in range(len(node.halves)) if k not in came]
        ahead = [node.halves[k].frame.ahead for k in onward]
        same = [np.allclose(node.halves[k].frame.tangent, along, atol=RANK) for k in onward]
        # the same tangent with other contacts held: of a dependent set another one takes over, and the states do not
        # turn
        if same == [True] and stop.type == "leaves":
            node.type = "corner"
        elif not onward:
            node.why = node.why or "no equilibrium goes on from there"
        # every way on goes back in s: a minimum and a saddle meet at the contact, without a zero eigenvalue
        elif all(v * half.frame.ahead < 0 for v in ahead):
            node.type = "nonsmooth-fold"
        onward = [k for k in onward if k not in node.used]
        if self.lazy and half.frame.index:
            # beyond unstable states: those that become stable there wait until they are asked for
            node.left += [k for k in onward if not node.halves[k].frame.index]
        return [(number, k) for k in onward if k not in node.left]

    def _go_on_beyond(self, number: int, half: OneSidedBranch, beyond: Equilibrium) -> Halves:
        """Go on from a point on the other side of a singular state, with the contacts that carry there."""
        node, found = self.nodes[number], find_one_sided_branches(self.line, beyond.x)
        onward = [h for h in found if h.is_like(half.frame)]
        if nearest((f for _, f in self.states_at(beyond.s)), beyond.state) > SETTLED:
            node.halves += onward
        if not onward:
            node.why += "; no equilibrium was found beyond"
        return [(number, k) for k in range(len(node.halves)) if k not in node.used]


def nearest(frames: Iterable[Equilibrium], x: np.ndarray) -> float:
    """Return how far the nearest of some states is; inf of none."""
    return min((float(np.abs(f.state - x).max()) for f in frames), default=math.inf)


def _near(root: np.ndarray, a: np.ndarray, b: np.ndarray, apart: float = SETTLED) -> bool:
    return float(np.abs(root * (a - b)).max()) <= apart


def _likest(halves: Sequence[OneSidedBranch], along: np.ndarray) -> list[int]:
    """Return the half-branch that leads most nearly along a direction, as a list; empty where none does."""
    across = [float(h.frame.tangent @ along) for h in halves]
    best = max(across, default=0.0)
    return [across.index(best)] if best > ALIGNED else []
