"""A snap confirmed by a search before it, which knows nothing of the path, and by where its minima lead beyond."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.continuation import BifurcationDiagram
from origami_nlp.loading.driver import LoadSearch, VertexDriver
from origami_nlp.loading.pattern_driver import PatternDriver
from origami_nlp.loading.records import ConfirmedSnap
from origami_nlp.loading.stable_path import StableSegment, walk
from origami_nlp.numerics import SETTLED


def confirm(
    driver: VertexDriver | PatternDriver,
    led: tuple[BifurcationDiagram, StableSegment],
    landed: tuple[BifurcationDiagram, np.ndarray, float],
    toward: float,
    search: LoadSearch,
) -> ConfirmedSnap | None:
    """Search beside a snap for the states that a path has before and after it; None where that cannot be, or was cut.

    led: the way to the snap, in its diagram.  landed: the state after it, known at a load.
    """
    web, way = led
    at = web.nodes[way.node].s
    side = toward * driver.beside(at)
    t, beyond = at - side, at + side
    before, after = _passed(web, way, t), _ahead(*landed, beyond)
    if before is None:
        # beside states where closure loses rank Newton knows those of the path alone
        f = next((f for f in way.frames[::-1] if (t - f.s) * toward >= 0), way.frames[0])
        t, before = f.s, np.asarray(f.problem.expand(f.state))
    first = driver.states_at(t, search)
    if first is None or search.cut:
        return None
    others = [x for x in first if not _among(before, [x])]
    found = len(others) < len(first)
    second = driver.led_to(beyond, others) if found else None
    if second is None or not _among(after, second):
        second = driver.states_at(beyond, search)
    if second is None or search.cut:
        return None
    return ConfirmedSnap((t, beyond), (len(first), len(second)), (found, _among(after, second)))


def _ahead(web: BifurcationDiagram, x: np.ndarray, s: float, t: float) -> np.ndarray | None:
    """Return all fold angles at load t of the stable states that lead on from x at s; None where none do."""
    low, high = web.low, web.high
    web.low, web.high = min(s, t), max(s, t)
    try:
        way = walk(web, x, s, t - s, t)
    finally:
        web.low, web.high = low, high
    return None if way is None else _passed(web, way, t)


def _passed(web: BifurcationDiagram, way: StableSegment, t: float) -> np.ndarray | None:
    """Return all fold angles of the state of a way at load t; None where Newton finds none on its arcs."""
    on = {id(frame) for frame in way.frames}
    arcs = [a for a in web.arcs if not a.index and any(id(f) in on for f in a.frames)]
    states = [f for a in arcs if (f := a.at(t, web.tally)) is not None]
    near = min(way.frames, key=lambda f: abs(f.s - t))
    best = min(states, key=lambda f: float(np.abs(f.state - near.state).max()), default=None)
    return None if best is None else np.asarray(best.problem.expand(best.state))


def _among(state: np.ndarray | None, states: Sequence[np.ndarray]) -> bool:
    """Whether a state is one of some, of all fold angles."""
    return state is not None and any(np.abs(x - state).max() <= SETTLED for x in states)
