"""A snap confirmed by searches on both sides of it, which know nothing of the path."""

from __future__ import annotations

import numpy as np

from origami_nlp.continuation import BifurcationDiagram
from origami_nlp.numerics import SETTLED
from origami_nlp.paths.driver import Driver, Search
from origami_nlp.paths.load_records import ConfirmedSnap
from origami_nlp.paths.stable_path import StableSegment, walk

SIDE = 0.01
"""Torque over `scale`, or factor over that of the snap, between a snap and the loads beside it."""


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
