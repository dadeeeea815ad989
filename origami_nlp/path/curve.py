"""Follow a contact boundary: the curve of closed states on which given contacts stay closed.

Arclength s is that of the space of all N fold angles (paper, paragraph "Metastability"): y = sqrt(multiplicity) x
for the model's variables x, |dy| = ds.  With C the Jacobian of closure and held contacts in y, t the unit tangent
(C t = 0) and H the Hessian of the Lagrangian whose multipliers balance the normal part of grad U,

    dU/ds = grad U . t,        d2U/ds2 = t . K t + grad U . y'' = t . H t,

because C y'' = -t . (Hessian of each constraint) t: the paper's effective tangential stiffness, without
differences.  Where more than one freedom is left the curve is the geodesic of the contact-preserving
set that leaves the state in its softest direction; y'' is normal to that set and the formula stays exact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.kkt import find_multipliers
from origami_nlp.numerics import RANK, null_space
from origami_nlp.programme import (
    Contact,
    Model,
)

LONGEST, SHORTEST = 0.04, 1e-9
"""Longest step, and the step [rad] to which the end of a curve is bisected."""
TURN = 0.05
"""The tangent turns by about this much [rad] a step."""
CLOSED_TO = 1e-13
"""Residual of closure and held contacts at every point."""


@dataclass(frozen=True)
class Point:
    """One point of a curve, in the model's variables and scaled energy.

    x: [n].  tangent, bend: y' and y'' [n], in the metric.  slope, stiffness: dU/ds, d2U/ds2.
    springs: t . K t alone.  multipliers: of the rows, those of smallest norm where they are dependent.
    pressed: whether every held contact pushes.
    dimension: of the set on which the rows stay closed.
    """

    x: np.ndarray
    tangent: np.ndarray
    bend: np.ndarray
    slope: float
    stiffness: float
    springs: float
    multipliers: np.ndarray
    pressed: bool
    dimension: int


@dataclass(frozen=True)
class BoundaryCurve:
    """A followed contact boundary, in the scene's units.

    contacts: the contacts held closed.  s: arclength [m], 0 at the state or sample it was started from.
    fold_angles: [m, N].  energy, slope, stiffness: U, dU/ds, d2U/ds2 [m].  springs: t . K t, the part
    of the stiffness that the springs would have along a straight path; the rest is the bend of the boundary.
    multipliers: moment at each single contact, [m, contacts]; pressed: whether all contacts push, [m].
    start, end: why the curve ends there; both ``closed curve`` for a loop.
    dimension: of the set on which the contacts stay closed; above 1 only its softest direction is followed.
    """

    contacts: tuple[str, ...]
    rows: tuple[Contact, ...]
    s: np.ndarray
    fold_angles: np.ndarray
    energy: np.ndarray
    slope: np.ndarray
    stiffness: np.ndarray
    springs: np.ndarray
    multipliers: np.ndarray
    pressed: np.ndarray
    start: str
    end: str
    dimension: int

    @property
    def length(self) -> float:
        """Arclength [rad] in the space of all N fold angles."""
        return float(self.s[-1] - self.s[0])


def evaluate(
    model: Model, x: np.ndarray, rows: tuple[Contact, ...], along: np.ndarray | None = None
) -> Point | None:
    """Evaluate the boundary at x [n]; `along` [n] picks the tangent (default: the softest direction).

    Returns None where no motion keeps the rows closed.
    """
    root = np.sqrt(model.multiplicity)
    local = model.local(x)
    _, a = local.openings(rows)
    jac, a, pull = local.closure_jacobian / root, a / root, local.gradient / root
    c = np.vstack([jac, a])
    z = null_space(c)
    if z.shape[1] == 0:
        return None
    m = len(jac)
    balance = np.linalg.lstsq(c.T, pull, rcond=1e-9)[0]
    hessian = model.hessian(x, -balance[:m], -model.weights(rows, balance[m:]))
    hessian = hessian / np.outer(root, root)
    if along is None:
        tangent = z @ np.linalg.eigh(z.T @ hessian @ z)[1][:, 0]
    else:
        tangent = z @ (z.T @ along)
        size = float(np.linalg.norm(tangent))
        if size < 0.5:
            return None
        tangent = tangent / size
    step = tangent / root
    turning = np.array([_second(model, x, rows, i, m, step) for i in range(len(c))])
    bend = -np.linalg.lstsq(c, turning, rcond=1e-9)[0]
    k = model.parameters.stiffness / model.multiplicity
    multipliers, pressed = balance[m:], bool((balance[m:] > 0).all())
    if np.linalg.svd(c, compute_uv=False).min() <= RANK:
        free = null_space(jac)
        normal = free.T @ (pull - z @ (z.T @ pull))
        found = find_multipliers((a @ free).T, normal)
        multipliers = found.smallest
        size = 1.0 + float(np.abs(pull).max())
        pressed = found.residual <= 1e-9 * size and bool((found.upper > 0).all())
    return Point(
        x,
        tangent,
        bend,
        float(pull @ tangent),
        float(tangent @ hessian @ tangent),
        float(tangent @ (k * tangent)),
        multipliers,
        pressed,
        z.shape[1],
    )


def _second(
    model: Model, x: np.ndarray, rows: tuple[Contact, ...], i: int, m: int, step: np.ndarray
) -> float:
    """Return the second derivative of constraint i (closure first, then rows) along `step`."""
    lam, mu = np.zeros(m), np.zeros(len(rows))
    if i < m:
        lam[i] = 1.0
    else:
        mu[i - m] = 1.0
    return float(step @ model.hessian(x, lam, model.weights(rows, mu), 0.0) @ step)


def correct(model: Model, x: np.ndarray, rows: tuple[Contact, ...]) -> np.ndarray | None:
    """Project x onto closure with `rows` closed, by Gauss-Newton in the metric; None if that fails."""
    root = np.sqrt(model.multiplicity)
    for _ in range(12):
        local = model.local(x)
        values, a = local.openings(rows)
        f = np.concatenate([local.closure, values])
        if np.abs(f).max() <= CLOSED_TO:
            return x
        c = np.vstack([local.closure_jacobian, a]) / root
        x = x - np.linalg.lstsq(c, f, rcond=1e-8)[0] / root
        for row in rows:
            if row.is_limit:
                x[row.index] = row.side * math.pi
    return None


def advance(
    model: Model, point: Point, rows: tuple[Contact, ...], h: float
) -> tuple[Point, float] | None:
    """Go from `point` by about arclength h; return the new point and the exact-to-O(h^5) arclength."""
    root = np.sqrt(model.multiplicity)
    x = correct(model, point.x + (h * point.tangent + 0.5 * h * h * point.bend) / root, rows)
    if x is None:
        return None
    along = point.tangent + h * point.bend
    new = evaluate(model, x, rows, along / np.linalg.norm(along))
    if new is None or new.dimension != point.dimension:
        return None
    chord = float(np.linalg.norm(root * (x - point.x)))
    if not 0.5 * h <= chord <= 2 * h:
        return None
    bend = 0.5 * float(point.bend @ point.bend + new.bend @ new.bend)
    return new, chord * (1 + bend * chord * chord / 24)


def follow_boundary(
    model: Model,
    x: np.ndarray,
    rows: tuple[Contact, ...],
    *,
    stop_at_release: bool = True,
    longest: float = 30.0,
) -> BoundaryCurve | None:
    """Follow the boundary through x [n] on which `rows` stay closed, both ways.

    A curve ends where another contact closes, where a held contact no longer pushes (unless
    `stop_at_release` is false), where it meets itself, where closure or contacts become singular, or after
    `longest` [rad].  None where no motion keeps the rows closed.
    """
    first = evaluate(model, x, rows)
    if first is None:
        return None
    turned = evaluate(model, x, rows, -first.tangent)
    assert turned is not None
    ahead, why_end = _one_way(model, first, rows, stop_at_release, longest)
    if why_end == "closed curve":
        behind: list[tuple[Point, float]] = []
        why_start = why_end
    else:
        behind, why_start = _one_way(model, turned, rows, stop_at_release, longest)
    points = [p for p, _ in reversed(behind)] + [first] + [p for p, _ in ahead]
    s = np.array([-v for _, v in reversed(behind)] + [0.0] + [v for _, v in ahead])
    sign = np.array([-1.0] * len(behind) + [1.0] * (1 + len(ahead)))
    weights = np.array([model.weight(row) for row in rows])
    at = np.array([p.x for p in points])
    return BoundaryCurve(
        contacts=tuple(model.name(row) for row in rows),
        rows=rows,
        s=s,
        fold_angles=model.expand(at),
        energy=np.array([model.energy(v) for v in at]),
        slope=model.scale * sign * np.array([p.slope for p in points]),
        stiffness=model.scale * np.array([p.stiffness for p in points]),
        springs=model.scale * np.array([p.springs for p in points]),
        multipliers=model.scale * np.array([p.multipliers for p in points]) / weights,
        pressed=np.array([p.pressed for p in points]),
        start=why_start,
        end=why_end,
        dimension=first.dimension,
    )


def _one_way(
    model: Model, first: Point, rows: tuple[Contact, ...], stop_at_release: bool, longest: float
) -> tuple[list[tuple[Point, float]], str]:
    """Follow the boundary along the tangent of `first`; return points with arclength, and why it ends."""
    root = np.sqrt(model.multiplicity)
    out: list[tuple[Point, float]] = []
    point, s, h = first, 0.0, 1e-3
    while s < longest:
        moved = advance(model, point, rows, h)
        why = "singular: closure or contacts lose rank, or no solution beyond"
        if moved is not None:
            new, ds = moved
            turn = float(np.linalg.norm(new.tangent - point.tangent))
            if turn > 3 * TURN and h > 1e-5:
                h /= 2
                continue
            if model.refuses(new.x):
                why = "another contact closes"
            elif stop_at_release and first.pressed and not new.pressed:
                why = "the contact stops pushing"
            else:
                why = ""
        if why:
            h /= 2
            if h > SHORTEST:
                continue
            if why.startswith("another"):
                why += _which(model, point.x, rows)
            return out, why
        point, s = new, s + ds
        out.append((point, s))
        back = float(np.linalg.norm(root * (point.x - first.x)))
        if len(out) > 5 and back <= ds and point.tangent @ first.tangent > 0.9:
            return out, "closed curve"
        h = min(LONGEST, h * min(2.0, TURN / max(turn, 1e-3 * TURN)))
    return out, f"longer than {longest:g} rad"


def _which(model: Model, x: np.ndarray, rows: tuple[Contact, ...]) -> str:
    """Name the contacts that close at x besides `rows`."""
    found = model.closed(x, 1e-6)
    extra = dict.fromkeys(found.base)
    for options in found.branches:
        extra.update(dict.fromkeys(options[0]))
    names = [model.name(row) for row in extra if row not in rows]
    return f" ({'; '.join(names)})" if names else " (facets meet)"
