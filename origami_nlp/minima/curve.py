"""Closed states with one degree of freedom as curves: Chebyshev series of fold angles and tangents, piece by piece.

One variable drives, all others follow in closed form, with two completions at most.  Between the angles where these
meet and those where a fold angle reaches a whole or half turn, a completion is an analytic function of the driver.
Where a curve turns back the driver goes as a square there, so that the function stays analytic up to the end.

Every variable drives in turn, and is asked only for states where none moves twice as fast as it does: that covers
every state with a tangent, lines on which some variables stand still included.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from origami_nlp.numerics import EPS, NONZERO, RESOLVED, cross
from origami_nlp.problem import CreaseChain, Model, close_by

NODES = 20
"""Chebyshev points of a section."""
DEEPEST = 60
"""Halvings of a section; those next to a meeting end after 25."""
ROUGH = 0.02
"""Error up to which a section is known well enough to say that another variable drives it faster."""
ACCURACY = 1e-9
"""Error of fold angles [rad] and unit tangents in a section that counts as resolved, beside what rounding leaves of
them next to a crossing; roots are polished afterwards."""
SLOW = 0.5
"""A driver answers for states where it moves at this share of the fastest variable's speed at least."""

POINTS = np.cos(math.pi * (np.arange(NODES) + 0.5) / NODES)
CHECKS = np.array([-0.71, 0.03, 0.57])
"""Between the nodes: values there reveal a series that only seems to have converged."""
TO_SERIES = np.cos(np.outer(np.arange(NODES), np.arccos(POINTS))) * 2 / NODES
TO_SERIES[0] /= 2
AT_CHECKS = np.cos(np.outer(np.arccos(CHECKS), np.arange(NODES)))


@dataclass(frozen=True)
class Sections:
    """Parts [s0, s1] of driven pieces [P], each with two branches.

    driver: variable.  low, high: driver's fold angle at the ends of the piece.  turns: whether the curve turns back
    there, [P, 2].  part: [P, 2], within [-1, 1].  wanted: branches that are not settled, [P, 2].
    """

    driver: np.ndarray
    low: np.ndarray
    high: np.ndarray
    turns: np.ndarray
    part: np.ndarray
    wanted: np.ndarray

    def take(self, which: np.ndarray) -> Sections:
        """Return some of them."""
        return Sections(*(getattr(self, f)[which] for f in self.__dataclass_fields__))

    def halves(self) -> Sections:
        """Cut each in two."""
        middle = self.part.mean(axis=1)
        left, right = np.stack([self.part[:, 0], middle], 1), np.stack([middle, self.part[:, 1]], 1)
        both = self.take(np.tile(np.arange(len(self.low)), 2))
        return replace(both, part=np.concatenate([left, right]))

    def angle(self, where: np.ndarray) -> np.ndarray:
        """Fold angle of the driver at positions [P, ...] in [-1, 1] of the sections."""
        more = (...,) + (None,) * (where.ndim - 1)
        (s0, s1), a, b = self.part.T, self.low[more], self.high[more]
        s = s0[more] + (s1 - s0)[more] * (1 + where) / 2
        # where a curve turns back, x goes as sqrt(angle - end): with angle - end ~ (1 + s)^2 it is analytic in s
        left, right = self.turns.T
        up = a + (b - a) * ((1 + s) / 2) ** 2
        down = b - (b - a) * ((1 - s) / 2) ** 2
        both = (a + b) / 2 + (b - a) / 2 * np.sin(math.pi * s / 2)
        plain = (a + b) / 2 + (b - a) / 2 * s
        one = np.where(left[more], up, np.where(right[more], down, plain))
        return np.where((left & right)[more], both, one)


@dataclass(frozen=True)
class Branches:
    """Branches [B] of sections, resolved: states and tangents at the nodes.

    sections: one for each.  side: which completion.  x: fold angles [B, NODES, n], continuous.  tangents: of unit
    length, [B, NODES, n].  odd: whether x is on the lift q = -1.  pinned: variables that stay at half a period.
    """

    sections: Sections
    side: np.ndarray
    x: np.ndarray
    tangents: np.ndarray
    odd: np.ndarray
    pinned: np.ndarray

    def take(self, which: np.ndarray) -> Branches:
        """Return some of them."""
        own = (getattr(self, f)[which] for f in list(self.__dataclass_fields__)[1:])
        return Branches(self.sections.take(which), *own)


class ConfigurationCurves:
    """All closed states of a model with one degree of freedom, fold angles up to whole turns."""

    def __init__(self, model: Model) -> None:
        self.model, self.piece = model, CreaseChain(model)
        n = model.size
        cyclic = self.piece.kind == "C" and self.piece.order > 1
        whole = (self.piece.share == 1) & (not cyclic)
        self.period = np.where(whole, 2 * math.pi, 4 * math.pi)
        """What brings each variable back to the same shape; a whole turn changes the lift without symmetry."""
        self.two_lifts = self.piece.kind == "C" and not cyclic
        self.whole = math.pi if model.has_limits else 2 * math.pi
        """Largest fold angle of any state; stops are looked at by those who take states from curves."""
        self.reach = np.minimum(self.period / 2, self.whole)
        """Largest fold angle of a variable that is looked at, up to its period."""
        self.others = np.array([np.delete(np.arange(n), v) for v in range(n)])

    def states(
        self, driver: np.ndarray, angle: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Complete fold angles [K] of drivers [K]: states [K, 2, n] within `reach`, exist, odd [K, 2]."""
        x = np.zeros((len(angle), self.model.size))
        x[np.arange(len(angle)), driver] = angle
        states, exists, _ = close_by(self.piece, False, x, self.others[driver])
        turns = np.round(states / self.period)
        odd = (turns.sum(axis=2) % 2 != 0) & self.two_lifts
        return states - self.period * turns, exists, odd

    def tangents(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Unit tangents of states [K, n], and how firmly closure sets them, [K]: 0 where curves cross."""
        axes, end = self.piece.fold(x * self.piece.share)
        axes = axes.transpose(2, 0, 1)  # [K, n, 3]
        axes = axes * self.piece.share[:, None]
        # the null vector of closure's rows: signed minors of a 3 x 4 matrix, cross product of two rows, gradient turned
        if self.model.equation_count == 3:
            volume = [
                np.sum(cross(axes[:, i], axes[:, j]) * axes[:, k], axis=1)
                for i, j, k in self.others
            ]
            t = np.stack(volume, axis=1) * (-1.0) ** np.arange(4)
        elif self.model.equation_count == 2:
            t = cross(axes[:, :, 0], axes[:, :, 2])
        else:
            slope = self.piece.slopes(axes, end)
            t = np.stack([slope[:, 1], -slope[:, 0]], axis=1)
        size = np.linalg.norm(t, axis=1)
        return t / np.maximum(size, NONZERO)[:, None], size

    @cached_property
    def crossings(self) -> list[tuple[int, float]]:
        """Drivers and fold angles at which two completions touch."""
        out = []
        for v in range(self.model.size):
            angles, touching = self.piece.meetings(v)
            out += [(v, a) for a in np.unique(angles[touching]) if abs(a) <= self.reach[v]]
        return out

    def pieces(self) -> Sections:
        """Cut the range of each driver where its completions meet and where fold angles reach their ends."""
        n = self.model.size
        driver = np.repeat(np.arange(n), 2)
        ends, exists, _ = self.states(driver, self.reach[driver] * np.tile([1.0, -1.0], n))
        ends = ends[exists]
        drivers: list[int] = []
        low: list[float] = []
        high: list[float] = []
        turns: list[np.ndarray] = []
        for v in range(n):
            meet, touching = self.piece.meetings(v)
            inside = np.abs(meet) < self.reach[v]
            meet, touching = meet[inside], touching[inside]
            limit = self.reach[v]
            cuts = np.unique(
                np.concatenate([meet, ends[np.abs(ends[:, v]) < limit, v], [-limit, limit]])
            )
            cuts = cuts[np.diff(cuts, prepend=-math.inf) > 4 * EPS]
            # completions that meet without touching end there: the curve turns back from one to the other
            turning = np.isin(cuts, meet[~touching]) & ~np.isin(cuts, meet[touching])
            middle = (cuts[1:] + cuts[:-1]) / 2
            _, exists, _ = self.states(np.full(len(middle), v), middle)
            for k in np.flatnonzero(exists.any(axis=1)):
                drivers.append(v)
                low.append(cuts[k])
                high.append(cuts[k + 1])
                turns.append(turning[k : k + 2])
        count = len(low)
        back = np.array(turns, dtype=bool).reshape(count, 2)
        part = np.tile([-1.0, 1.0], (count, 1))
        every = np.ones((count, 2), dtype=bool)
        return Sections(
            np.array(drivers, dtype=int), np.array(low), np.array(high), back, part, every
        )

    def evaluate(self, sections: Sections) -> tuple[np.ndarray, ...]:
        """Values at nodes and checks of both branches: x, tangents [2 P, N, n], size, odd [2 P, N]."""
        where = np.concatenate([POINTS, CHECKS])
        count, many = len(sections.low), len(where)
        angle = sections.angle(np.tile(where, (count, 1)))
        x, _, odd = self.states(np.repeat(sections.driver, many), angle.ravel())
        shape = (count, many, 2, self.model.size)
        x = x.reshape(shape).transpose(0, 2, 1, 3).reshape(2 * count, many, -1)
        odd = odd.reshape(shape[:3]).transpose(0, 2, 1).reshape(2 * count, many)
        x, odd = self._aligned(x, odd)
        t, size = self.tangents(x.reshape(-1, self.model.size))
        return x, t.reshape(x.shape), size.reshape(odd.shape), odd

    def ambiguous(self, x: np.ndarray) -> np.ndarray:
        """Return which fold angles [..., n] are half a period, where rounding decides on the sign."""
        return self.period / 2 - np.abs(x) <= RESOLVED

    def _aligned(self, x: np.ndarray, odd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Give ambiguous fold angles the sign of the nearest that is not, or plus where all are."""
        near, place = self.ambiguous(x), np.concatenate([POINTS, CHECKS])
        for b, v in zip(*np.nonzero(near.any(axis=1)), strict=True):
            firm = np.flatnonzero(~near[b, :, v])
            for k in np.flatnonzero(near[b, :, v]):
                nearest = firm[np.abs(place[firm] - place[k]).argmin()] if len(firm) else None
                sign = 1.0 if nearest is None else math.copysign(1.0, x[b, nearest, v])
                if x[b, k, v] * sign < 0:
                    x[b, k, v] += self.period[v] * sign
                    odd[b, k] ^= self.two_lifts
        return x, odd

    def _beyond(self, x: np.ndarray, odd: np.ndarray) -> np.ndarray:
        """Return which branches [B, N, n] are no states of the model, whatever the resolution."""
        if not self.model.has_limits:
            return np.zeros(len(x), dtype=bool)
        outside = (np.abs(x) > self.reach + RESOLVED).any(axis=2).all(axis=1)
        return outside | (odd.all(axis=1) & ~self.ambiguous(x).any(axis=(1, 2)))

    def resolved(self) -> tuple[Branches, list[str]]:
        """Cut until every branch is resolved, and say where that failed."""
        open_, failures = self.pieces(), []
        x = np.zeros((0, NODES, self.model.size))
        none, mask = open_.take(np.zeros(0, dtype=int)), np.zeros(0, dtype=bool)
        done = [
            Branches(none, np.zeros(0, dtype=int), x, x, mask, np.zeros((0, self.model.size), bool))
        ]
        for _ in range(DEEPEST):
            if not len(open_.low):
                break
            x, t, size, odd = self.evaluate(open_)
            error = series_error(x) + series_error(t)
            speed = np.abs(
                np.take_along_axis(t, np.repeat(open_.driver, 2)[:, None, None], 2)[..., 0]
            )
            share = (speed / np.maximum(np.abs(t).max(axis=2), EPS)).max(axis=1)
            # next to a crossing states are known to EPS / size, and tangents to EPS / size^2
            fine = error <= ACCURACY + 4 * EPS / np.maximum(size.min(axis=1), EPS) ** 2
            fine &= (odd == odd[:, :1]).all(axis=1)
            # another driver answers for what moves much faster than this one
            slow = (error <= ROUGH) & (share < 0.8 * SLOW)
            wanted = open_.wanted.ravel() & ~self._beyond(x, odd)
            keep = np.flatnonzero(wanted & fine & ~slow)
            pinned = np.asarray(self.ambiguous(x[keep]).all(axis=1))
            cut = slice(0, NODES)
            done.append(
                Branches(
                    open_.take(keep // 2),
                    keep % 2,
                    x[keep, cut],
                    t[keep, cut],
                    np.asarray(odd[keep, 0]),
                    pinned,
                )
            )
            open_ = replace(open_, wanted=(wanted & ~fine & ~slow).reshape(-1, 2))
            ends = open_.angle(np.tile([-1.0, 1.0], (len(open_.low), 1)))
            left = open_.wanted.any(axis=1)
            # inside a piece that is a failure; next to its ends lies a meeting of completions, which is listed by
            # itself
            tiny = left & (np.abs(ends[:, 1] - ends[:, 0]) <= RESOLVED)
            for k in np.flatnonzero(tiny):
                if min(ends[k, 0] - open_.low[k], open_.high[k] - ends[k, 1]) > RESOLVED:
                    failures.append(
                        f"fold angle {ends[k, 0]:.9g} of variable {open_.driver[k] + 1}"
                    )
            open_ = open_.take(left & ~tiny).halves()
        if len(open_.low):
            failures.append(f"{len(open_.low)} sections after {DEEPEST} halvings")
        return _joined(done), failures


def _joined(parts: list[Branches]) -> Branches:
    names = list(Branches.__dataclass_fields__)[1:]
    own = [np.concatenate([getattr(p, f) for p in parts]) for f in names]
    sections = Sections(
        *(
            np.concatenate([getattr(p.sections, f) for p in parts])
            for f in Sections.__dataclass_fields__
        )
    )
    return Branches(sections, *own)


def series_error(values: np.ndarray) -> np.ndarray:
    """How far series of values [B, NODES + checks, n] are from having converged, [B]."""
    # a small tail alone can be aliasing: values between the nodes have to agree as well
    series = np.einsum("kj,bjn->bkn", TO_SERIES, values[:, :NODES])
    tail = np.abs(series[:, -3:]).max(axis=(1, 2))
    at_checks = np.einsum("ck,bkn->bcn", AT_CHECKS, series)
    return np.maximum(tail, np.abs(at_checks - values[:, NODES:]).max(axis=(1, 2)))
