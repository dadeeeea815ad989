"""The path of a state through a bifurcation diagram, the load running one way: as far as it stays a minimum."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from origami_nlp.continuation import (
    LATE,
    BifurcationDiagram,
    Equilibrium,
    ParameterLine,
    SpecialPoint,
)
from origami_nlp.kkt import Classification, State, classify
from origami_nlp.loading.driver import BRANCHES, Driver, descend_beyond
from origami_nlp.numerics import EPS, INPUT_TOL, SETTLED

LEAST_SPAN = 1e-3
"""A snap at a load of less than this share of the whole range is stepped over by shares of that."""
OVER = (1e-5, 1e-4, 1e-3)
"""How far beyond a snap, over the load there or the whole range, the state is let go: the first from which it comes to
rest at a certified minimum."""
STEP = EPS ** (1 / 3)
"""Of central differences [rad]: its square is their error."""
WALL = ("refused", "singular", "touches")
"""Where nothing is known of what lies beyond."""


@dataclass(frozen=True, eq=False)
class StableSegment:
    """Stable states that a load passes, one way.

    frames: in order.  node: position of the node at its end.  why: ``range``, ``snap``, ``breaks-symmetry``, a type of
    event beyond which nothing is followed, or what stopped it.
    """

    frames: tuple[Equilibrium, ...]
    node: int
    why: str


def position(web: BifurcationDiagram, x: np.ndarray, s: float) -> tuple[int, Equilibrium] | None:
    """Return the arc that holds the stable state x at s, and the state there; None where none does."""
    for k, frame in web.states_at(s):
        if not frame.index and np.abs(frame.state - x).max() <= SETTLED:
            return k, frame
    return None


def given(web: BifurcationDiagram, x: np.ndarray, s: float) -> int | None:
    """Return the node at which the state x was given at s; None where it was not."""
    point = np.append(x, s)
    for k, node in enumerate(web.nodes):
        if node.halves and np.abs(node.point - point).max() <= SETTLED:
            return k
    return None


def walk(
    web: BifurcationDiagram,
    start: np.ndarray,
    s: float,
    toward: float,
    end: float,
    across: Callable[[Equilibrium], float] = lambda frame: math.nan,
) -> StableSegment | None:
    """Go from the stable state `start` at s towards the load `end`, up to the limit point or bifurcation that ends it.

    None where it is not in the diagram.  What was left of it (`BifurcationDiagram.resume`) is followed where the way
    goes on there. across: smallest eigenvalue across the symmetry; where it changes sign to below zero the way ends.
    """
    ahead = _ahead(web, start, s, toward)
    if not ahead:
        begun = given(web, start, s)
        if begun is not None and web.resume(begun, toward):
            return walk(web, start, s, toward, end, across)
        known = position(web, start, s)
        if known is None:
            return None
        node = web.arcs[known[0]].end
        near = min((web.arcs[known[0]].start, node), key=lambda k: abs(web.nodes[k].s - s))
        if not web.resume(near, toward) or not (ahead := _ahead(web, start, s, toward)):
            return StableSegment((known[1],), near, _why(web, near, end))
    k = ahead[0]
    here = web.arcs[k].at(s, web.tally)
    frames = [] if here is None else [here]
    while True:
        arc = web.arcs[k]
        forward = (arc.frames[-1].s - arc.frames[0].s) * toward > 0
        run = arc.frames if forward else arc.frames[::-1]
        last = frames[-1].s if frames else s
        # what of an arc lies behind the state is left out
        frames += [f for f in run if (f.s - last) * toward > 0]
        node = arc.end if forward else arc.start
        why = _why(web, node, end)
        onward = _onward(web, node, k, toward)
        if not onward and why != "range" and web.resume(node, toward):
            onward = _onward(web, node, k, toward)
        if why == "range" or not onward or leaves_flat(web, node):
            return StableSegment(tuple(frames), node, why)
        k = onward[0]
        beyond = web.arcs[k].frames
        # the event alone says that the eigenvalue changes sign, not which
        if why == "breaks-symmetry" and across(beyond[len(beyond) // 2]) < 0:
            return StableSegment(tuple(frames), node, why)


def leaves_flat(web: BifurcationDiagram, node: int) -> bool:
    """Return whether a node is the flat state, and the load pulls from there along another branch than the one that
    comes there: stable states that lead on beyond are not reached."""
    found = web.nodes[node]
    if found.type != "singular" or found.point[:-1].any():
        return False
    return classify(State(web.line.at(found.s), found.point[:-1])).verdict != "minimum"


def _ahead(web: BifurcationDiagram, start: np.ndarray, s: float, toward: float) -> list[int]:
    """Return the arcs of stable states that lead on from a state."""
    arcs = [
        k for k, f in web.states_at(s) if not f.index and np.abs(f.state - start).max() <= SETTLED
    ]
    return [k for k in arcs if _far(web, k, toward) * toward > s * toward + SETTLED * abs(toward)]


def _onward(web: BifurcationDiagram, node: int, arc: int, toward: float) -> list[int]:
    """Return the arcs of stable states that lead on from a node, but for the one that comes there."""
    return [
        j
        for j, other in enumerate(web.arcs)
        if j != arc and node in (other.start, other.end) and not other.index
        and (_far(web, j, toward) - web.nodes[node].s) * toward > 0
    ]  # fmt: skip


def _far(web: BifurcationDiagram, arc: int, toward: float) -> float:
    """The end of an arc that lies farthest in a direction."""
    return web.arcs[arc].high if toward > 0 else web.arcs[arc].low


def _why(web: BifurcationDiagram, node: int, end: float) -> str:
    found = web.nodes[node]
    if abs(found.s - end) <= SETTLED * (1 + abs(end)):
        return "range"
    if found.type in (LATE, *web.stops):
        return found.type
    if (
        found.type in WALL
        or (found.type == "slides" and not found.located)
        or found.type == "closes"
    ):
        return f"stopped: {found.why or 'closure or contacts lose rank'}"
    return "breaks-symmetry" if found.type == "breaks-symmetry" else "snap"


def release(
    web: BifurcationDiagram, node: SpecialPoint, toward: float
) -> tuple[np.ndarray, float, Classification] | str:
    """Descend from the end of a way, a little beyond its load; the minimum, its load and certificate, or why none."""
    point, why = node.point, ""
    span = max(abs(float(point[-1])), LEAST_SPAN * (web.high - web.low))
    # states that branch off are distinguished from those that do not by the square root of the share
    for share in OVER[node.type in BRANCHES :]:
        s = float(point[-1]) + toward * share * span
        end = descend_beyond(web.line, s, node, 10 * share, web.steps.until)
        if not isinstance(end, str):
            return end[0], s, end[1]
        why = end or why
    return why or "no lower state was reached"


def stiffness_at(frame: Equilibrium, root: np.ndarray, driver: Driver) -> float:
    """Return the derivative of the load by what it works on, along the tangent; inf where that stays."""
    along = frame.tangent / root
    ahead, behind = (frame.problem.expand(frame.state + h * along[:-1]) for h in (STEP, -STEP))
    moved = float(driver.conjugate(ahead) - driver.conjugate(behind)) / (2 * STEP)
    return math.inf if abs(moved) <= INPUT_TOL * driver.work.arm else float(along[-1]) / moved


def restabilises(
    web: BifurcationDiagram, node: int, ends: Callable[[ParameterLine, SpecialPoint], float | None]
) -> float | None:
    """Return the load at which the unstable states that begin at a snap become stable again.

    ends: the load at which stable states that are not in this diagram end at a node.
    """
    seen, todo = {node}, [node]
    while todo:
        here = todo.pop()
        for arc in web.arcs:
            if arc.index and here in (arc.start, arc.end):
                other = arc.end if here == arc.start else arc.start
                if other in seen:
                    continue
                found = web.nodes[other]
                if any(not a.index and other in (a.start, a.end) for a in web.arcs) or found.left:
                    return found.s
                beyond = ends(web.line, found)
                if beyond is not None:
                    return beyond
                seen.add(other)
                todo.append(other)
    return None
