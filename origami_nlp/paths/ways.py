"""Ways of a state through a diagram, the load running one way: as far as it stays a minimum, and where it falls to."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from origami_nlp.continuation import LATE, Equilibrium, SpecialPoint
from origami_nlp.kkt import Classification, State, classified, classify, singular_beside
from origami_nlp.numerics import SETTLED, first_largest
from origami_nlp.paths.followed import FollowedDiagram
from origami_nlp.search import TRUST, descent_path

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


class Ways(FollowedDiagram):
    """A diagram over a load, through which stable states lead."""

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
        meet = [
            a.frames[0 if a.start == node else -1] for a in self.arcs if node in (a.start, a.end)
        ]
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
        at = self.nodes[node].s
        every = [k for k, a in enumerate(self.arcs) if node in (a.start, a.end)]
        every = [k for k in every if k != arc and not self.arcs[k].index]
        return [k for k in every if (self._far(k, toward) - at) * toward > 0]

    def _far(self, arc: int, toward: float) -> float:
        """The end of an arc that lies farthest in a direction."""
        return self.arcs[arc].high if toward > 0 else self.arcs[arc].low

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


def _downhill(problem: Any, start: np.ndarray) -> tuple[np.ndarray, str]:
    """Follow the energy downhill along states in which no facets cross; where to, and why that is no minimum."""
    try:
        found = descent_path(problem, start, longest=TRUST)
    except np.linalg.LinAlgError:  # a ValueError as well
        raise
    except ValueError as refused:
        return start, str(refused)
    return found.end, "" if found.arrives else UNTOLD
