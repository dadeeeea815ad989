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

    @property
    def problem(self) -> Any:
        """Of the line that is followed."""
        return self.line.problem

    def holding(self, x: np.ndarray, s: float) -> list[tuple[int, Equilibrium]]:
        """Return the arcs that hold the stable state x at s, and the state there."""
        stable = [(k, f) for k, f in self.states_at(s) if not f.index]
        return [(k, f) for k, f in stable if np.abs(f.state - x).max() <= SETTLED]

    def given(self, x: np.ndarray, s: float) -> int | None:
        """Return the node at which the state x was given at s; None where it was not."""
        point = np.append(x, s)
        begun = ((k, node.point) for k, node in enumerate(self.nodes) if node.halves)
        return next((k for k, at in begun if np.abs(at - point).max() <= SETTLED), None)

    def walk(self, x: Any, s: float, toward: float, end: float, last: int = -1) -> Run | None:
        """Go from the stable state x at s towards the load `end`, up to the limit point or bifurcation that ends it.

        None where it is not in the diagram.  What was left of it (`BifurcationDiagram.resume`) is followed where the
        way goes on there.  last: a node at which the way ends, too.
        """

        def ahead() -> list[int]:
            arcs = [(k, self._far(k, toward)) for k, _ in self.holding(x, s)]
            return [k for k, far in arcs if (far - s) * toward > SETTLED * abs(toward)]

        if not (arcs := ahead()):
            begun, known = self.given(x, s), self.holding(x, s)
            if begun is not None and self.resume(begun, toward):
                return self.walk(x, s, toward, end, last)
            if not known:
                return None
            number, frame = known[0]
            arc = self.arcs[number]
            near = min((arc.start, arc.end), key=lambda k: abs(self.nodes[k].s - s))
            arcs = ahead() if self.resume(near, toward) else []
            if not arcs:
                return Run(self, (frame,), near, self._why(near, end), toward)
        k = arcs[0]
        here = self.arcs[k].at(s)
        frames = [] if here is None else [here]
        while True:
            arc = self.arcs[k]
            forward = (arc.frames[-1].s - arc.frames[0].s) * toward > 0
            begin = frames[-1].s if frames else s
            # what of an arc lies behind the state is left out
            frames += [f for f in arc.frames[:: 1 if forward else -1] if (f.s - begin) * toward > 0]
            node = arc.end if forward else arc.start
            why, onward = self._why(node, end), self._onward(node, k, toward)
            if not onward and why != "range" and self.resume(node, toward):
                onward = self._onward(node, k, toward)
            if why == "range" or not onward or node == last or self._leaves_flat(node):
                return Run(self, tuple(frames), node, why, toward)
            k = onward[0]

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
