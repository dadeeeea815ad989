"""The edges of the admissible set X: curves along which one contact stays closed.

With two degrees of freedom left, a closed contact leaves a curve in the space of the model's variables.  Each contact's
curve is found from many random states projected onto it, traced both ways to the fold limits, and cut where it leaves
X: where another contact closes, or where touching layers stop having an order.  Handles, the sets that
exist only while two contacts stay closed, are edges too: no state beside them belongs to X.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from origami_nlp.continuation import ContinuationOptions, End, trace
from origami_nlp.kkt import State, project
from origami_nlp.numerics import CLOSURE_TOL, CONTACT_TOL, RANK, SETTLED, bracketed_roots
from origami_nlp.problem import Contact, Problem, held

SEEDS = 96
"""Random states projected onto each contact."""
STEPS = ContinuationOptions(
    first=0.06, longest=0.06, shortest=1e-9, turn=0.14, sharpest=0.1414, growth=1.5, most=4000
)
"""Along straight lines, so short that a step turns a curve by 8 degrees at most."""
KNOWN = 1e-2
"""A seed closer than this [rad] to a traced curve of its contact lies on it."""
LOOKS = 3
"""The order of layers is looked at at so many points between two events of an edge."""


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


def trace_edges(model: Problem, rng: np.random.Generator) -> tuple[Edge, ...]:
    """Find and trace every edge of X."""
    edges: list[Edge] = []
    rows = (*model.limits, *model.gaps)
    for position, row in enumerate(rows):
        x, residual = project(model, drawn(model, rng, SEEDS), (row,))
        x = x[(residual <= CLOSURE_TOL) & model.admissible(x)]
        # where an earlier contact is closed as well, this curve is that contact's
        earlier, _ = model.local(x).openings(rows[:position])
        x = x[(np.abs(earlier) > CONTACT_TOL).all(axis=1)]
        traced = np.zeros((0, model.size))
        for state in x:
            if len(traced) and _distance(traced, state) < KNOWN:
                continue
            curve, tangent, loop = _trace(model, state, row)
            traced = np.concatenate([traced, _dense(curve), np.full((1, model.size), np.nan)])
            edges += _cut(model, row, curve, tangent, loop)
    return tuple(edges)


def drawn(model: Problem, rng: np.random.Generator, many: int) -> np.ndarray:
    """Draw states uniformly between the fold limits, not closed, [many, n]."""
    limits = model.fold_limits
    return rng.uniform(limits.low, limits.high, (many, model.size))


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


@dataclass(frozen=True)
class _At:
    """A point of a contact's curve and its tangent, which the next step follows straight on."""

    x: np.ndarray
    tangent: np.ndarray

    @property
    def bend(self) -> np.ndarray:
        return np.zeros_like(self.x)


@dataclass(frozen=True)
class _Line:
    """A contact's curve in the problem's variables, for the tracer; see `continuation.tracer.CurveProblem`."""

    model: Problem
    row: Contact

    @property
    def root(self) -> np.ndarray:
        return np.ones(self.model.size)

    def correct(self, x: np.ndarray) -> np.ndarray | None:
        y, residual = _correct(self.model, x, self.row)
        return y if residual <= CLOSURE_TOL else None

    def frame(self, x: np.ndarray, along: np.ndarray) -> _At | None:
        """Return the point at x; None where closure and contact are dependent."""
        _, sizes, v = np.linalg.svd(self.model.constraints(x, (self.row,))[1])
        return _At(x, np.copysign(1.0, v[-1] @ along) * v[-1]) if sizes[-1] > RANK else None

    def inside(self, points: Sequence[_At]) -> int:
        """How many of the points, from the first on, are within the bounds of all fold angles."""
        inside = self.model.fold_limits.inside(np.array([p.x for p in points]), CONTACT_TOL)
        inside[:, [self.row.index] if self.row.is_limit else []] = True
        good = inside.all(axis=1)
        return len(points) if good.all() else int(np.argmin(good))

    def at_bound(self, a: _At, b: _At) -> _At:
        """Return the point between a and b at which a fold angle reaches its bound."""
        v = int(self.model.fold_limits.room(b.x).argmin())
        limit = self.model.fold_limits.contact(v, b.x[v])
        return _At(_meet(self.model, a.x, b.x, self.row, limit), b.tangent)


def _trace(model: Problem, start: np.ndarray, row: Contact) -> tuple[np.ndarray, np.ndarray, bool]:
    """Trace a contact's curve both ways to the fold limits: states, tangents, and whether it closes."""
    line = _Line(model, row)
    first = line.frame(start, np.zeros(model.size))
    end = End(line.inside, "fold limit", line.at_bound)
    found = None if first is None else trace(line, first, STEPS, [end])
    if found is None:
        return start[None], np.zeros((1, model.size)), False
    tangents = found.signs[:, None] * np.array([p.tangent for p in found.frames])
    return found.states, tangents, found.closed


def _correct(model: Problem, x: np.ndarray, row: Contact) -> tuple[np.ndarray, float]:
    """Project one state onto a contact's curve."""
    y, residual = project(model, x[None], (row,), steps=8)
    return y[0], float(residual[0])


def _meet(model: Problem, a: np.ndarray, b: np.ndarray, row: Contact, other: Contact) -> np.ndarray:
    """Return the state on the contact's curve between a and b at which `other` closes, by bracketing.

    Newton on both contacts would slide along sets where they are dependent.
    """

    def opening(share: np.ndarray) -> np.ndarray:
        at, _ = project(model, a + share[:, None] * (b - a), (row,), steps=8)
        return model.local(at).openings((other,))[0][:, 0]

    share = bracketed_roots(opening, np.zeros(1), np.ones(1))[0]
    at, _ = _correct(model, a + share * (b - a), row)
    return held(at, (row, other))


def _cut(
    model: Problem, row: Contact, x: np.ndarray, tangent: np.ndarray, loop: bool
) -> list[Edge]:
    """Cut a traced curve at every event, and keep the parts that belong to X.

    Events: another contact's opening changes sign, or the curve of a contact that is closed all along crosses
    itself (det (C; t) changes sign, C the Jacobian of closure and that contact): there a handle may begin.
    Between events the touching features stay the same.
    """
    rows = tuple(r for r in (*model.limits, *model.gaps) if r != row)
    values, _ = model.local(x).openings(rows)
    events: dict[int, list[np.ndarray]] = {}
    sure = np.abs(values) > CONTACT_TOL
    changes = sure[:-1] & sure[1:] & ((values[:-1] > 0) != (values[1:] > 0))
    along_all = [r for r, v in zip(rows, values.T, strict=True) if (np.abs(v) <= CONTACT_TOL).all()]
    for contact in (row, *along_all):
        node = _orientation(model, x, tangent, contact)
        for k in np.flatnonzero((node[:-1] > 0) != (node[1:] > 0)):
            known = events.setdefault(int(k), [])
            if not known:
                known.append(_crossing(model, x[k], x[k + 1], tangent[k], row, contact))
    for k, r in zip(*np.nonzero(changes), strict=True):
        at = _meet(model, x[k], x[k + 1], row, rows[r])
        known = events.setdefault(int(k), [])
        if all(np.abs(at - other).max() > SETTLED for other in known):
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
        # invariant: `points` begins with the last event, `begin` is the first sample behind it
        points = np.concatenate([points, x[begin : cell + 1], at[None]])
        along = np.concatenate([along, tangent[begin : cell + 2]])
        if loop or np.abs(points[-1] - points[0]).max() > SETTLED:
            kept += _inside(model, Edge(row, points, along, loop))
        begin, points, along = cell + 1, at[None], tangent[cell : cell + 1]
    return kept


def _orientation(model: Problem, x: np.ndarray, tangent: np.ndarray, row: Contact) -> np.ndarray:
    """Return det (C; t), [M], C the Jacobian of closure and `row`: 0 where they lose rank."""
    _, jac = model.constraints(x, (row,))
    # test function of a branch point (Kuznetsov, bordered systems): it changes sign where two curves cross
    return np.linalg.det(np.concatenate([jac, tangent[:, None]], axis=1))


def _crossing(
    model: Problem, a: np.ndarray, b: np.ndarray, tangent: np.ndarray, row: Contact, held: Contact
) -> np.ndarray:
    """Return the state of row's curve between a and b at which closure and `held` lose rank."""

    def turn(share: np.ndarray) -> np.ndarray:
        at, _ = project(model, a + share[:, None] * (b - a), (row,), steps=8)
        _, jac = model.constraints(at, (row,))
        t = np.linalg.svd(jac)[2][:, -1]
        return _orientation(model, at, np.copysign(1.0, t @ tangent)[:, None] * t, held)

    share = bracketed_roots(turn, np.zeros(1), np.ones(1))[0]
    return _correct(model, a + share * (b - a), row)[0]


def _inside(model: Problem, edge: Edge) -> list[Edge]:
    """Return the edge if it belongs to X, nothing if not, and its parts that do if it changes on the way."""
    x = edge.x
    if len(x) <= 3:  # between close events: look half-way
        x = np.array([x[0], _correct(model, 0.5 * (x[0] + x[-1]), edge.row)[0], x[-1]])
    inner = np.unique(np.linspace(1, len(x) - 2, LOOKS).round().astype(int))
    pairs = model.admissible(x)[1:-1]
    layers = np.array([pairs[k - 1] and _belongs(State(model, x[k]), edge.row) for k in inner])
    if pairs.all() and layers.all():
        return [edge]
    if not layers.any():
        return []
    # each sample takes the verdict of the nearest one whose layers were looked at
    good = layers[np.abs(np.arange(len(x))[:, None] - inner).argmin(axis=1)]
    good[1:-1] &= pairs
    begin = np.flatnonzero(good & ~np.concatenate([[False], good[:-1]]))
    end = np.flatnonzero(good & ~np.concatenate([good[1:], [False]]))
    return [
        Edge(edge.row, x[b : e + 1], edge.tangent[b : e + 1], False)
        for b, e in zip(begin, end, strict=True)
        if e > b
    ]


def _belongs(state: State, row: Contact) -> bool:
    """Return whether a state belongs to X, layers included, and `row` is a contact that touches there."""
    return not state.refused and touches(state, row)


def touches(state: State, row: Contact) -> bool:
    """Return whether a contact whose opening vanishes touches: a facet's plane may be met beside the facet."""
    if row.is_limit:
        return True
    found = state.contacts
    rows = [*found.base, *(r for options in found.branches for o in options for r in o)]
    rows += [again for again, _ in found.implied]
    return any(r.kind == row.kind and r.index == row.index for r in rows)
