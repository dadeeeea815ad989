"""The path of a state through a bifurcation diagram, the load running one way: as far as it stays a minimum."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.continuation import (
    LATE,
    BifurcationDiagram,
    Equilibrium,
    Line,
    SpecialPoint,
)
from origami_nlp.kkt import Classification, State, classify, follow, singular_beside
from origami_nlp.numerics import EPS, INPUT_TOL, SETTLED, first_largest
from origami_nlp.paths.driver import Driver, Search
from origami_nlp.paths.records import ConfirmedSnap
from origami_nlp.pattern_problem import MOST_DENSE
from origami_nlp.pattern_states import classified
from origami_nlp.search import TRUST, descend_by_newton

BRANCHES = ("branching", "breaks-symmetry")
"""Events at which states lose stability without a limit point."""
SIDE = 0.01
"""Torque over `scale`, or factor over that of the snap, between a snap and the loads beside it."""
OFF_BRANCH = 1e-3
"""How far beside such a state a descent begins [rad]."""
LEAST_SPAN = 1e-3
"""A snap at a load of less than this share of the whole range is stepped over by shares of that."""
OVER = (1e-5, 1e-4, 1e-3)
"""How far beyond a snap, over the load there or the whole range, the state is let go: the first from which it comes to
rest at a certified minimum."""
MOST_STEPS = 400
"""Of a descent."""
UNTOLD = "facets meet at borders or face to face, where no single gap distinguishes them"
"""Why a descent ends at a state that is neither held on every piece nor left on one."""
STEP = EPS ** (1 / 3)
"""Of central differences [rad]: its square is their error."""
WALL = ("refused", "singular", "touches", "closes")
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


def holding(web: BifurcationDiagram, x: np.ndarray, s: float) -> list[tuple[int, Equilibrium]]:
    """Return the arcs that hold the stable state x at s, and the state there."""
    stable = [(k, f) for k, f in web.states_at(s) if not f.index]
    return [(k, f) for k, f in stable if np.abs(f.state - x).max() <= SETTLED]


def given(web: BifurcationDiagram, x: np.ndarray, s: float) -> int | None:
    """Return the node at which the state x was given at s; None where it was not."""
    begun = [(k, node.point) for k, node in enumerate(web.nodes) if node.halves]
    near = (k for k, point in begun if np.abs(point - np.append(x, s)).max() <= SETTLED)
    return next(near, None)


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

    def ahead() -> list[int]:
        arcs = [(k, _far(web, k, toward)) for k, _ in holding(web, start, s)]
        return [k for k, far in arcs if (far - s) * toward > SETTLED * abs(toward)]

    arcs = ahead()
    if not arcs:
        begun, known = given(web, start, s), holding(web, start, s)
        if begun is not None and web.resume(begun, toward):
            return walk(web, start, s, toward, end, across)
        if not known:
            return None
        number, frame = known[0]
        ends = web.arcs[number].start, web.arcs[number].end
        near = min(ends, key=lambda k: abs(web.nodes[k].s - s))
        arcs = ahead() if web.resume(near, toward) else []
        if not arcs:
            return StableSegment((frame,), near, _why(web, near, end))
    k = arcs[0]
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
    if found.type in WALL or (found.type == "slides" and not found.located):
        return f"stopped: {found.why or 'closure or contacts lose rank'}"
    return "breaks-symmetry" if found.type == "breaks-symmetry" else "snap"


def release(
    web: BifurcationDiagram, node: SpecialPoint, toward: float
) -> tuple[np.ndarray, float, Classification] | str:
    """Descend from the end of a way, a little beyond its load; the minimum, its load and certificate, or why none.

    By the kernel; on sheets too large for it, and where nothing touches, by steps in the null space of closure.
    """
    phi, why, line = node.point[:-1], "", web.line
    posed: Any = line.problem
    span = max(abs(node.s), LEAST_SPAN * (web.high - web.low))
    lower = classify(State(line.at(node.s), phi)).lower if node.type == "slides" else None
    posed.until = web.steps.until
    try:
        # states that branch off are distinguished from those that do not by the square root of the share
        for share in OVER[node.type in BRANCHES :]:
            s = node.s + toward * share * span
            problem: Any = line.at(s)
            starts = [phi]
            if node.type in BRANCHES:  # balanced: the energy falls to second order, to either side
                soft = State(problem, phi).on(State(problem, phi).pieces[0]).softest
                if soft is not None:
                    aside = OFF_BRANCH * soft * np.sign(soft[first_largest(np.abs(soft))])
                    starts = [phi + aside, phi - aside]
            elif (
                node.type == "slides"
            ):  # lower states are beside where a facet ends, unless others hold
                starts = [] if lower is None else [lower]
            for start in starts:
                end, lost = start, ""
                if free := problem.sparse and all(c.is_limit for c in node.held):
                    down = descend_by_newton(problem, start)
                    free = not any(map(problem.crossings.find, (*down.path, down.phi)))
                    end, lost = down.phi, "" if down.arrived else down.why
                if not free:
                    end, lost = _downhill(problem, start)
                if np.abs(end - phi).max() <= 10 * share:
                    continue
                what = classified(problem, end)
                if not lost and what.verdict == "minimum" and singular_beside(problem, end) is None:
                    return end, s, what
                why = lost or what.reason
    finally:
        posed.until = math.inf
    return why or "no lower state was reached"


def _downhill(problem: Any, start: np.ndarray) -> tuple[np.ndarray, str]:
    """Follow the energy downhill along states in which no facets cross; where to, and why that is no minimum."""
    if problem.size > MOST_DENSE:
        many = f"the pattern has {problem.size:,} creases, contact is solved up to {MOST_DENSE}"
        return start, many
    try:
        found = follow(problem, start, curved=True, longest=TRUST, most_steps=MOST_STEPS)
    except np.linalg.LinAlgError:  # a ValueError as well
        raise
    except ValueError as refused:
        return start, str(refused)
    if found.what.verdict != "minimum":
        return found.end, UNTOLD
    problem.kept("classified", found.end, lambda: found.what)
    return found.end, ""


def stiffness_at(frame: Equilibrium, root: np.ndarray, driver: Driver) -> float:
    """Return the derivative of the load by what it works on, along the tangent; inf where that stays."""
    along = frame.tangent / root
    ahead, behind = (frame.problem.expand(frame.state + h * along[:-1]) for h in (STEP, -STEP))
    moved = float(driver.conjugate(ahead) - driver.conjugate(behind)) / (2 * STEP)
    return math.inf if abs(moved) <= INPUT_TOL * driver.work.arm else float(along[-1]) / moved


def restabilises(
    web: BifurcationDiagram,
    node: int,
    ends: Callable[[Line, SpecialPoint], float | None],
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


def confirm(
    driver: Driver,
    led: tuple[BifurcationDiagram, StableSegment],
    landed: tuple[BifurcationDiagram, np.ndarray, float],
    toward: float,
    search: Search,
) -> ConfirmedSnap | None:
    """Search on both sides of a snap for the states that a path has there; None where that cannot be.

    led: the way to the snap, in its diagram.  landed: the state after it, known at a load.
    """
    web, way = led
    at = web.nodes[way.node].s
    side = toward * SIDE * (driver.problem.scale if driver.creases else abs(at))
    t, beyond = at - side, at + side
    before, after = _passed(web, way, t), _ahead(*landed, beyond)
    if before is None:
        # beside states where closure loses rank Newton knows those of the path alone
        f = next((f for f in way.frames[::-1] if (t - f.s) * toward >= 0), way.frames[0])
        t, before = f.s, np.asarray(f.problem.expand(f.state))
    minima, known = [], []
    for load, state in ((t, before), (beyond, after)):
        origami = driver.at(load)
        if origami is None:
            return None
        found = [m.phi for m in search(origami)]
        minima.append(len(found))
        known.append(state is not None and any(np.abs(x - state).max() <= SETTLED for x in found))
    return ConfirmedSnap((t, beyond), (minima[0], minima[1]), (known[0], known[1]))


def _ahead(web: BifurcationDiagram, x: np.ndarray, s: float, t: float) -> np.ndarray | None:
    """Return all fold angles at load t of the stable states that lead on from x at s; None where none do."""
    web.low, web.high = min(s, t), max(s, t)  # all else is packed by then
    way = walk(web, x, s, t - s, t)
    return None if way is None else _passed(web, way, t)


def _passed(web: BifurcationDiagram, way: StableSegment, t: float) -> np.ndarray | None:
    """Return all fold angles of the state of a way at load t; None where Newton finds none on its arcs."""
    on = {id(frame) for frame in way.frames}
    arcs = [a for a in web.arcs if not a.index and any(id(f) in on for f in a.frames)]
    states = [f for a in arcs if (f := a.at(t, web.tally)) is not None]
    near = min(way.frames, key=lambda f: abs(f.s - t))
    best = min(states, key=lambda f: float(np.abs(f.state - near.state).max()), default=None)
    return None if best is None else np.asarray(best.problem.expand(best.state))
