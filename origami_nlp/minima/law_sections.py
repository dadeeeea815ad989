"""Curves of closed states cut where hinges pass from one piece of their law to the next.

Between two knots the slope of the energy along a curve is analytic; over one it converges like a power.  So sections
are cut at the knots of every law, and halved where the slope is not resolved yet.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.minima.curve import (
    ACCURACY,
    CHECKS,
    NODES,
    POINTS,
    TO_SERIES,
    Branches,
    series_error,
)
from origami_nlp.numerics import LEVEL, NONZERO, SETTLED
from origami_nlp.problem import Model

GRID = np.linspace(-1.0, 1.0, 33)
"""Where fold angles are compared with knots; between two of them a fold angle goes one way, or passes no knot twice."""
HALVINGS = 40
"""Of a section between two knots."""
CLOSE = 2 * SETTLED
"""Length of a section, of 2, below which it is not halved."""


@dataclass(frozen=True, eq=False)
class SlopeSections:
    """Sections of branches on each of which the slope of the energy is resolved.

    parent: number of the branch [P].  low, high: ends of the section on it, within [-1, 1], [P].  x, tangents: at its
    nodes, [P, NODES, n].  series: of dE/ds [P, NODES].  size: the sum of |torque| [P].  left: how many are unresolved.
    """

    parent: np.ndarray
    low: np.ndarray
    high: np.ndarray
    x: np.ndarray
    tangents: np.ndarray
    series: np.ndarray
    size: np.ndarray
    left: int

    def on_branch(self, which: np.ndarray, where: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return places [K] in [-1, 1] of sections as branches and places on them."""
        low, high = self.low[which], self.high[which]
        return self.parent[which], low + (high - low) * (1 + where) / 2


def slopes_with_laws(
    model: Model, b: Branches, turns: np.ndarray
) -> tuple[Branches, SlopeSections]:
    """Resolve the slope of the energy along branches of a model with hinge laws.

    Parameters
    ----------
    model
        The problem.
    b
        Branches, resolved.
    turns
        Added to their fold angles, [n] [rad].

    Returns
    -------
    tuple
        Shorter branches [P], and the sections that they are.
    """
    found = slope_sections(model, b.x + turns, b.tangents)
    out = b.take(found.parent)
    whole, part = out.sections.part, np.stack([found.low, found.high], axis=1)
    ends = whole[:, :1] + np.diff(whole, axis=1) * (1 + part) / 2
    sections = replace(out.sections, part=ends)
    return replace(out, sections=sections, x=found.x - turns, tangents=found.tangents), found


def slope_sections(model: Model, x: np.ndarray, tangents: np.ndarray) -> SlopeSections:
    """Resolve the slope of the energy on pieces of curves, fold angles and tangents at nodes [B, NODES, n]."""
    at = np.einsum("kj,bjn->bkn", TO_SERIES, np.concatenate([x, tangents], axis=2))
    parent, low, high = _cut(model, at)
    done: list[tuple[np.ndarray, ...]] = []
    place, n = np.concatenate([POINTS, CHECKS]), model.size
    left = 0
    for halving in range(HALVINGS + 1):
        where = low[:, None] + (high - low)[:, None] * (1 + place) / 2
        both = np.einsum("pmk,pkn->pmn", _chebyshev(where), at[parent])
        x, t = both[..., :n], both[..., n:]
        work = model.parameters.torque(x) * t
        size = np.abs(work).sum(axis=2).max(axis=1) + LEVEL * model.parameters.stiffness.max()
        value = work.sum(axis=2, keepdims=True)
        fine = series_error(value) <= ACCURACY * size
        tiny = (high - low <= CLOSE) | (halving == HALVINGS)
        left += int((tiny & ~fine).sum()) if halving == HALVINGS else 0
        keep = fine | tiny
        done.append(
            (
                parent[keep],
                low[keep],
                high[keep],
                both[keep, :NODES],
                value[keep, :NODES, 0],
                size[keep],
            )
        )
        middle, parent = 0.5 * (low + high)[~keep], np.tile(parent[~keep], 2)
        low, high = np.append(low[~keep], middle), np.append(middle, high[~keep])
        if not len(parent):
            break
    parent, low, high, both, value, size = (
        np.concatenate(part) for part in zip(*done, strict=True)
    )
    x, tangents = both[..., :n], both[..., n:]
    return SlopeSections(parent, low, high, x, tangents, value @ TO_SERIES.T, size, left)


def _chebyshev(where: np.ndarray) -> np.ndarray:
    return np.polynomial.chebyshev.chebvander(where, NODES - 1)


def _cut(model: Model, at: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cut branches of series [B, NODES, 2 n] at knots: number of the branch, and ends within [-1, 1], [P] each."""
    count = len(at)
    whose, where = [np.arange(count), np.arange(count)], [np.full(count, -1.0), np.ones(count)]
    grid = np.einsum("mk,bkn->bmn", _chebyshev(GRID), at[..., : model.size])
    laws = model.parameters.laws
    for v, law in enumerate(laws.laws if laws else ()):
        if laws is None or law is None:
            continue
        knots = law.knots + laws.shift[v]
        x = grid[..., v]
        below = np.searchsorted(knots, x)
        first, many = np.minimum(below[:, 1:], below[:, :-1]), np.abs(np.diff(below, axis=1))
        branch, step = np.nonzero(many)
        times = many[branch, step]
        order = np.arange(times.sum()) - np.repeat(np.cumsum(times) - times, times)
        branch, step = np.repeat(branch, times), np.repeat(step, times)
        knot = knots[first[branch, step] + order]
        # regula falsi, then Newton's method, on the series
        x0, x1, h = x[branch, step], x[branch, step + 1], GRID[1] - GRID[0]
        s = GRID[step] + h * np.clip((knot - x0) / np.where(x1 == x0, NONZERO, x1 - x0), 0, 1)
        series = at[branch, :, v]
        falls = np.polynomial.chebyshev.chebder(series, axis=1)
        for _ in range(3):
            t = _chebyshev(s)
            off = (t * series).sum(axis=1) - knot
            slope = (t[:, :-1] * falls).sum(axis=1)
            step_to = off / np.where(np.abs(slope) > NONZERO, slope, np.inf)
            s = np.clip(s - np.clip(step_to, -h, h), -1, 1)
        whose.append(branch)
        where.append(s)
    b, s = np.concatenate(whose), np.concatenate(where)
    order = np.lexsort((s, b))
    b, s = b[order], s[order]
    apart = (b[1:] == b[:-1]) & (s[1:] > s[:-1])
    return b[:-1][apart], s[:-1][apart], s[1:][apart]
