"""The edges of the admissible set X: curves along which one contact stays closed.

With two freedoms left, a closed contact leaves a curve in the space of the model's variables.  Each contact's curve
is found from many random states projected onto it, traced both ways to the fold limits, and cut where it leaves
X: where another contact closes, or where touching layers stop having an order.  Handles, the sets that
exist only while two contacts stay closed, are edges too: no state beside them belongs to X.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import project
from origami_nlp.numerics import bracketed_roots
from origami_nlp.programme import Contact, Model, held

STEP = 0.06
"""Length [rad] of the steps along a curve, shorter where it bends."""
SEEDS = 96
"""Random states projected onto each contact."""
MOST_POINTS = 4000
KNOWN = 1e-2
"""A seed closer than this [rad] to a traced curve of its contact lies on it."""
LOOKS = 3
"""The order of layers is looked at at so many points between two events of an edge."""
SURE = 1e-9
"""Openings below this have no sign: contacts that stay closed together all along."""


SAME = 1e-7
"""Ends nearer than this [rad] are one state."""
CLOSE = 1e-6
"""Events of a curve nearer than this [rad] are one."""


@dataclass(frozen=True)
class Edge:
    """A part of a contact's curve that belongs to X, both ends included.

    row: the contact.  x: states [M, n] in order.  tangent: unit tangents [M, n].  loop: whether it closes on itself.
    """

    row: Contact
    x: np.ndarray
    tangent: np.ndarray
    loop: bool

    @property
    def length(self) -> float:
        """Length [rad] in the model's variables."""
        return float(np.linalg.norm(np.diff(self.x, axis=0), axis=1).sum())


def possible_rows(model: Model) -> tuple[Contact, ...]:
    """Every contact of the model; facet pairs on one side only, the curve being the same for both."""
    rows = [Contact("limit", v, s) for v in range(model.size) for s in (-1, 1)]
    rows = rows if model.has_limits else []
    first: dict[tuple[str, tuple[int, ...]], int] = {}
    for index, gap in enumerate(model.structure.gaps):
        if first.setdefault((gap.type, gap.rays), index) == index:
            rows.append(Contact("gap", index, 1))
    return tuple(rows)


def trace_edges(model: Model, rng: np.random.Generator, seeds: int = SEEDS) -> tuple[Edge, ...]:
    """Find and trace every edge of X."""
    edges: list[Edge] = []
    rows = possible_rows(model)
    for position, row in enumerate(rows):
        start = rng.uniform(-math.pi, math.pi, (seeds, model.size))
        x, residual = project(model, start, (row,))
        x = x[(residual <= 1e-12) & model.admissible(x)]
        # where an earlier contact is closed as well, this curve is that contact's
        earlier, _ = model.local(x).openings(rows[:position])
        x = x[(np.abs(earlier) > SURE).all(axis=1)]
        traced = np.zeros((0, model.size))
        for state in x:
            if len(traced) and _distance(traced, state) < KNOWN:
                continue
            curve, tangent, loop = _trace(model, state, row)
            traced = np.concatenate([traced, _dense(curve), np.full((1, model.size), np.nan)])
            edges += _cut(model, row, curve, tangent, loop)
    return tuple(edges)


def _distance(points: np.ndarray, x: np.ndarray) -> float:
    """Distance of x from a cloud of points (NaN rows separate curves)."""
    return float(np.nanmin(np.linalg.norm(points - x, axis=1)))


def _dense(curve: np.ndarray) -> np.ndarray:
    """Return a polyline with points no further apart than half of `KNOWN`."""
    out = [curve[:1]]
    for a, b in itertools.pairwise(curve):
        count = max(1, int(np.linalg.norm(b - a) / (0.5 * KNOWN)) + 1)
        out.append(a + (b - a) * np.linspace(0, 1, count + 1)[1:, None])
    return np.concatenate(out)


def tangent_of(model: Model, x: np.ndarray, row: Contact) -> np.ndarray | None:
    """Unit tangent [n] of a contact's curve at x; None where closure and contact are dependent."""
    _, jac = model.constraints(x[None], (row,))
    _, sizes, v = np.linalg.svd(jac[0])
    return None if sizes[-1] <= 1e-7 else v[-1]


def _trace(model: Model, start: np.ndarray, row: Contact) -> tuple[np.ndarray, np.ndarray, bool]:
    """Trace a contact's curve both ways to the fold limits: states, tangents, and whether it closes."""
    first = tangent_of(model, start, row)
    if first is None:
        return start[None], np.zeros((1, model.size)), False
    ahead, loop = _one_way(model, start, first, row)
    behind = [] if loop else _one_way(model, start, -first, row)[0]
    x = [p for p, _ in reversed(behind)] + [start] + [p for p, _ in ahead]
    t = [-d for _, d in reversed(behind)] + [first] + [d for _, d in ahead]
    return np.array(x), np.array(t), loop


def _one_way(
    model: Model, start: np.ndarray, tangent: np.ndarray, row: Contact
) -> tuple[list[tuple[np.ndarray, np.ndarray]], bool]:
    """Trace from `start` along `tangent`; returns points with tangents, and whether the curve closed."""
    out: list[tuple[np.ndarray, np.ndarray]] = []
    x, t, h, first = start, tangent, STEP, tangent
    while len(out) < MOST_POINTS:
        y, residual = _correct(model, x + h * t, row)
        new = tangent_of(model, y, row) if residual <= 1e-12 else None
        new = None if new is None else np.copysign(1.0, new @ t) * new
        moved = float(np.linalg.norm(y - x))
        if new is None or new @ t < 0.99 or not 0.5 * h <= moved <= 2 * h:
            h /= 2
            if h < 1e-9:  # the curve is singular here
                return out, False
            continue
        over = np.abs(y) - model.bound
        over[[row.index] if row.is_limit else []] = -1
        if over.max() > SURE:
            v = int(over.argmax())
            out.append((_meet(model, x, y, row, Contact("limit", v, 1 if y[v] > 0 else -1)), new))
            return out, False
        if len(out) > 3 and np.linalg.norm(y - start) < 0.75 * h and new @ first > 0.9:
            out.append((start, first))
            return out, True
        out.append((y, new))
        x, t, h = y, new, min(STEP, 1.5 * h)
    return out, False


def _correct(model: Model, x: np.ndarray, row: Contact) -> tuple[np.ndarray, float]:
    """Project one state onto a contact's curve."""
    y, residual = project(model, x[None], (row,), steps=8)
    return y[0], float(residual[0])


def _meet(model: Model, a: np.ndarray, b: np.ndarray, row: Contact, other: Contact) -> np.ndarray:
    """Return the state on the contact's curve between a and b at which `other` closes, by bracketing.

    Newton on both contacts would slide along sets where they are dependent.
    """

    def opening(share: np.ndarray) -> np.ndarray:
        at, _ = project(model, a + share[:, None] * (b - a), (row,), steps=8)
        return model.local(at).openings((other,))[0][:, 0]

    share = bracketed_roots(opening, np.zeros(1), np.ones(1))[0]
    at, _ = _correct(model, a + share * (b - a), row)
    return held(at, (row, other))


def _cut(model: Model, row: Contact, x: np.ndarray, tangent: np.ndarray, loop: bool) -> list[Edge]:
    """Cut a traced curve at every event, and keep the parts that belong to X.

    Events: another contact's opening changes sign, or the curve of a contact that is closed all along crosses
    itself (det (C; t) changes sign, C the Jacobian of closure and that contact): there a handle may begin.
    Between events the touching features stay the same.
    """
    rows = tuple(r for r in possible_rows(model) if r != row)
    values, _ = model.local(x).openings(rows)
    events: dict[int, list[np.ndarray]] = {}
    sure = np.abs(values) > SURE
    changes = sure[:-1] & sure[1:] & ((values[:-1] > 0) != (values[1:] > 0))
    along_all = [r for r, v in zip(rows, values.T, strict=True) if (np.abs(v) <= SURE).all()]
    for contact in (row, *along_all):
        node = _orientation(model, x, tangent, contact)
        for k in np.flatnonzero((node[:-1] > 0) != (node[1:] > 0)):
            known = events.setdefault(int(k), [])
            if not known:
                known.append(_crossing(model, x[k], x[k + 1], tangent[k], row, contact))
    for k, r in zip(*np.nonzero(changes), strict=True):
        at = _meet(model, x[k], x[k + 1], row, rows[r])
        known = events.setdefault(int(k), [])
        if all(np.abs(at - other).max() > CLOSE for other in known):
            known.append(at)
    cuts: list[tuple[int, np.ndarray]] = []
    for cell in sorted(events):
        order = np.argsort([(at - x[cell]) @ tangent[cell] for at in events[cell]])
        cuts += [(cell, events[cell][i]) for i in order]
    if loop and cuts:  # start at an event, so that no part runs over the joint
        cell, at = cuts[0]
        x = np.concatenate([at[None], x[cell + 1 : -1], x[: cell + 1], at[None]])
        turned = [tangent[cell : cell + 1], tangent[cell + 1 : -1]]
        turned += [tangent[: cell + 1], tangent[cell : cell + 1]]
        return _cut(model, row, x, np.concatenate(turned), False)
    kept: list[Edge] = []
    begin, points, along = 0, x[:0], tangent[:0]
    for cell, at in [*cuts, (len(x) - 2, x[-1])]:
        points = np.concatenate([points, x[begin : cell + 1], at[None]])
        along = np.concatenate([along, tangent[begin : cell + 2]])
        if loop or np.abs(points[-1] - points[0]).max() > SAME:
            kept += _inside(model, Edge(row, points, along, loop))
        begin, points, along = cell + 1, at[None], tangent[cell : cell + 1]
    return kept


def _orientation(model: Model, x: np.ndarray, tangent: np.ndarray, row: Contact) -> np.ndarray:
    """Return det (C; t), [M], C the Jacobian of closure and `row`: 0 where they lose rank."""
    _, jac = model.constraints(x, (row,))
    return np.linalg.det(np.concatenate([jac, tangent[:, None]], axis=1))


def _crossing(
    model: Model, a: np.ndarray, b: np.ndarray, tangent: np.ndarray, row: Contact, held: Contact
) -> np.ndarray:
    """Return the state of row's curve between a and b at which closure and `held` lose rank."""

    def turn(share: np.ndarray) -> np.ndarray:
        at, _ = project(model, a + share[:, None] * (b - a), (row,), steps=8)
        _, jac = model.constraints(at, (row,))
        t = np.linalg.svd(jac)[2][:, -1]
        return _orientation(model, at, np.copysign(1.0, t @ tangent)[:, None] * t, held)

    share = bracketed_roots(turn, np.zeros(1), np.ones(1))[0]
    return _correct(model, a + share * (b - a), row)[0]


def _inside(model: Model, edge: Edge) -> list[Edge]:
    """Return the edge if it belongs to X, nothing if not, and its parts that do if it changes on the way."""
    x = edge.x
    if len(x) <= 3:  # between close events: look half-way
        x = np.array([x[0], _correct(model, 0.5 * (x[0] + x[-1]), edge.row)[0], x[-1]])
    inner = np.unique(np.linspace(1, len(x) - 2, LOOKS).round().astype(int))
    pairs = model.admissible(x)[1:-1]
    layers = np.array([pairs[k - 1] and _belongs(model, x[k], edge.row) for k in inner])
    if pairs.all() and layers.all():
        return [edge]
    if not layers.any():
        return []
    good = layers[np.abs(np.arange(len(x))[:, None] - inner).argmin(axis=1)]
    good[1:-1] &= pairs
    begin = np.flatnonzero(good & ~np.concatenate([[False], good[:-1]]))
    end = np.flatnonzero(good & ~np.concatenate([good[1:], [False]]))
    return [
        Edge(edge.row, x[b : e + 1], edge.tangent[b : e + 1], False)
        for b, e in zip(begin, end, strict=True)
        if e > b
    ]


def _belongs(model: Model, x: np.ndarray, row: Contact) -> bool:
    """Tell whether x belongs to X, layers included, and `row` is a contact that touches there."""
    if model.refuses(x):
        return False
    return row.is_limit or touches(model, x, row)


def touches(model: Model, x: np.ndarray, row: Contact) -> bool:
    """Tell whether a gap whose value vanishes at x is a contact: a facet's plane may be met beside the facet."""
    found = model.closed(x)
    rows = [*found.base, *(r for options in found.branches for o in options for r in o)]
    rows += [again for again, _ in found.implied]
    return any(r.kind == row.kind and r.index == row.index for r in rows)
