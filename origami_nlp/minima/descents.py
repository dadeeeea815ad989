"""Thousands of descents at once: Newton with an active set, on the set of closed states.

The metric is that of the stiffness, y = sqrt(k) phi, in which the elastic energy is half a squared distance and its
Hessian the identity: all curvature comes from closure and from the contacts that are held.  At each state

    G = rows' lam + R,      rows = closure and held gaps,      R = 0 on the free creases where it is stationary;

a fold limit whose R pulls, and a gap whose multiplier does, is let go; a step that reaches a limit, a mirror or another
facet stops there and holds it.  What comes out are candidates: polishing and judging them is for others.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from origami_nlp.minima.crossings import Crossings
from origami_nlp.numerics import EPS, FOLLOWED, RANK, ROUNDED
from origami_nlp.programme import OPEN, Kinematics, Model

SLOTS = 3
"""Gaps that a descent can hold at once, besides fold limits."""
FLAT_SLOPE = 1e-10
"""Torque that is left where a descent has converged, relative to the largest that balance."""
SADDLE = -1e-7
"""Eigenvalue (of a Hessian that is 1 for springs alone) below which a stationary state is left downhill."""
EARLY = 0.3
"""A contact that pulls more than this share of the torque that is left is let go before the rest has converged."""
FIRST_REACH, REACH, SHORTEST = 1.0, 2.0, 1e-9
"""Longest step of a fold angle [rad]: at first, ever, and where a descent gives up."""
ESCAPES, ESCAPE = 3, 0.05
"""How often a saddle is left, and by how much [rad]."""
QUADRATIC = 1e-8
"""A step of Gauss-Newton this short [rad] is the last one."""
POOR = 1e10
"""Condition of rows rows' above which its eigenvalues are looked at one by one."""
LONG, FEW = 24, 64
"""After so many steps the slowest are given up, one in so many: a step of a few costs as much as one of hundreds."""
NEAR = 0.3
"""Furthest that a state is moved onto a contact [rad]."""
TINY = 1e-7
"""A step that moves no fold angle by more [rad] is no progress; one that fails there has converged."""
STALLED = 6
"""Steps without progress after which a descent stops."""


@dataclass(frozen=True, eq=False)
class Samples:
    """States on their strata.

    Attributes
    ----------
    x
        Fold angles, shape [K, n] [rad].
    shut
        Creases held at their fold limits: -1, 0 or 1, shape [K, n].
    slots, sides
        Gaps held, as positions in `Structure.gaps` or `OPEN`, and the side on which each is open, shape [K, SLOTS].
    hold
        Whether contacts are held until the descent has converged on its stratum, shape [K].
    source
        Which kind of start it is, shape [K].
    """

    x: np.ndarray
    shut: np.ndarray
    slots: np.ndarray
    sides: np.ndarray
    hold: np.ndarray
    source: np.ndarray

    @classmethod
    def on(
        cls, x: np.ndarray, shut: np.ndarray | None = None, *, hold: bool = False, source: int = 0
    ) -> Samples:
        """Make samples that hold fold limits only."""
        k = len(x)
        shut = np.zeros(x.shape, dtype=int) if shut is None else shut
        none = np.full((k, SLOTS), OPEN)
        return cls(
            np.array(x, dtype=float),
            shut.astype(int),
            none,
            np.ones((k, SLOTS), dtype=int),
            np.full(k, hold),
            np.full(k, source),
        )

    def __getitem__(self, which: np.ndarray) -> Samples:
        return Samples(*(getattr(self, f.name)[which] for f in fields(self)))

    def __len__(self) -> int:
        return len(self.x)


def _put(into: Samples, where: np.ndarray, new: Samples) -> None:
    for f in fields(Samples):
        getattr(into, f.name)[where] = getattr(new, f.name)


def joined(*parts: Samples) -> Samples:
    """Return samples one after the other."""
    return Samples(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Samples)))


@dataclass(frozen=True, eq=False)
class Ends:
    """Where descents ended.

    Attributes
    ----------
    samples
        The states with what they hold.
    converged
        Whether nothing is left to let go and no torque is left, shape [K].
    settled
        Whether the descent was stationary on the stratum where it began before its contacts were let go; where it
        did not converge afterwards, that is the state returned, shape [K].
    """

    samples: Samples
    converged: np.ndarray
    settled: np.ndarray


@dataclass(frozen=True, eq=False)
class _Point:
    """Values at samples: closure and held gaps with their gradients over sqrt(k), multipliers and what they leave."""

    at: object
    rows: np.ndarray  # [K, m + S, n]
    residual: np.ndarray  # [K]
    torque: np.ndarray  # G, [K, n]
    multipliers: np.ndarray  # [K, m + S]
    left: np.ndarray  # R, [K, n]
    free_rows: np.ndarray
    inverse: np.ndarray  # of free_rows free_rows', [K, m + S, m + S]


class Descents:
    """Descents of a model's energy on the set of its admissible states."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.kinematics = Kinematics(model)
        self.crossings = Crossings(model)
        self._root = np.sqrt(model.parameters.stiffness)
        self._m = model.equation_count

    def run(self, starts: Samples, most: int = 45) -> Ends:
        """Descend from closed samples.

        The hold of a sample ends once its stratum is reached: contacts that pull are let go then.
        """
        live = np.arange(len(starts))
        s, kept = joined(starts), joined(starts)  # copies
        reach = np.full(len(s), FIRST_REACH)
        escapes, idle = np.zeros(len(s), dtype=int), np.zeros(len(s), dtype=int)
        converged, on_stratum = np.zeros(len(s), dtype=bool), np.zeros(len(s), dtype=bool)
        for step in range(most):
            if not len(live) or (step >= LONG and len(live) * FEW <= len(s)):
                break
            slotted = (s.slots[live] != OPEN).any(axis=1)
            stop = np.zeros(len(live), dtype=bool)
            for group in (np.flatnonzero(~slotted), np.flatnonzero(slotted)):  # fewer rows: faster
                if not len(group):
                    continue
                who = live[group]
                before = s[who]
                new, moved, state = self._step(before, reach[who], escapes[who])
                left = before.hold & ~new.hold
                on_stratum[who] |= left
                _put(kept, who[left], before[left])
                _put(s, who, new)
                reach[who] = state.reach
                escapes[who] += state.escaped
                idle[who] = np.where(moved, 0, idle[who] + 1)
                converged[who] = state.converged
                stop[group] = state.converged | (reach[who] < SHORTEST) | (idle[who] >= STALLED)
            live = live[~stop]
        # what its contacts did not let go of is an end of its own: of a set that exists only while they are closed
        back = np.flatnonzero(on_stratum & ~converged)
        _put(s, back, kept[back])
        return Ends(s, converged, on_stratum)

    # values

    def _rows(self, s: Samples) -> tuple[object, np.ndarray, np.ndarray]:
        """Fold samples; return the folded states, closure and held gaps [K, r], and their Jacobian [K, r, n]."""
        at = self.kinematics.fold(s.x)
        value, jacobian = self.kinematics.closure(at)
        if (s.slots == OPEN).all():
            return at, value, jacobian
        g, dg = self.kinematics.gaps(at, s.slots)
        return (
            at,
            np.concatenate([value, s.sides * g], axis=1),
            np.concatenate([jacobian, s.sides[..., None] * dg], axis=1),
        )

    def _point(self, s: Samples) -> _Point:
        at, value, jacobian = self._rows(s)
        torque = self.model.parameters.torque(s.x) / self._root
        return self._balance(s, at, np.abs(value).max(axis=1), jacobian / self._root, torque)

    def _balance(
        self, s: Samples, at: object, residual: np.ndarray, rows: np.ndarray, torque: np.ndarray
    ) -> _Point:
        free_rows = rows * (s.shut == 0)[:, None]
        inverse = _inverse(free_rows)
        lam = (inverse @ (free_rows @ torque[..., None]))[..., 0]
        left = torque - (lam[:, None] @ rows)[:, 0]
        return _Point(at, rows, residual, torque, lam, left, free_rows, inverse)

    def _hessian(self, s: Samples, p: _Point) -> np.ndarray:
        """Hessian of the Lagrangian in the metric, [K, n, n]."""
        m = self._m
        curved = self.kinematics.closure_hessian(p.at, p.multipliers[:, :m])
        if p.rows.shape[1] > m:
            curved += self.kinematics.gaps_hessian(p.at, s.slots, s.sides * p.multipliers[:, m:])
        return np.eye(s.x.shape[1]) - curved / np.outer(self._root, self._root)

    # one step

    def _step(
        self, s: Samples, reach: np.ndarray, escapes: np.ndarray
    ) -> tuple[Samples, np.ndarray, _Progress]:
        p = self._point(s)
        size = 1 + np.abs(p.torque).max(axis=1) + np.abs(p.multipliers).max(axis=1)
        slope = np.abs(np.where(s.shut == 0, p.left, 0.0)).max(axis=1) / size
        s, p, released, opens = self._release(s, p, slope, size)
        free = s.shut == 0
        down = np.where(free, p.left, 0.0)
        slope = np.where(released, np.abs(down).max(axis=1) / size, slope)
        projector = -p.free_rows.transpose(0, 2, 1) @ p.inverse @ p.free_rows
        n = s.x.shape[1]
        projector[:, np.arange(n), np.arange(n)] += free
        h = projector @ self._hessian(s, p) @ projector + np.eye(n) - projector
        h = 0.5 * (h + h.transpose(0, 2, 1))
        still = (slope <= FLAT_SLOPE) & ~released
        d = self._direction(h, down)
        # a contact that is let go must open: the steepest way down does that
        wrong = released & (np.einsum("ki,ki->k", opens, d) <= 0)
        d[wrong] = -down[wrong]
        converged = still.copy()
        escaped = np.zeros(len(s), dtype=int)
        if still.any():
            where = np.flatnonzero(still)
            value, vector = np.linalg.eigh(h[where])
            unstable = (value[:, 0] < SADDLE) & (escapes[where] < ESCAPES)
            where, v = where[unstable], vector[unstable, :, 0]
            # either side is as good: the one of more torque, the first crease up where there is none
            side = np.sign(np.einsum("ki,ki->k", v, -down[where]))
            lead = v[np.arange(len(v)), np.abs(v).argmax(axis=1)]
            side = np.where(side == 0, np.sign(lead), side)
            length = np.abs(v / self._root).max(axis=1)
            d[where] = v * (side * ESCAPE / length)[:, None]
            converged[where], escaped[where] = False, 1
        go = np.flatnonzero(~converged)
        out, moved = s, np.ones(len(s), dtype=bool)
        if len(go):
            tried, accepted, reached = self._advance(
                s[go], p.residual[go], d[go], down[go], reach[go], escaped[go] > 0
            )
            moved[go] = np.abs(tried.x - s.x[go]).max(axis=1) > TINY
            _put(out, go, tried)
            tiny = np.abs(d[go] / self._root).max(axis=1) < TINY
            converged[go] = ~accepted & tiny & ~released[go]
            reach = reach.copy()
            reach[go] = reached
        return out, moved, _Progress(reach, escaped, converged)

    def _release(
        self, s: Samples, p: _Point, slope: np.ndarray, size: np.ndarray
    ) -> tuple[Samples, _Point, np.ndarray, np.ndarray]:
        """Let go the contact that pulls most, where it pulls enough; returns also the gradient of its opening."""
        pull = np.concatenate([s.shut * p.left, -p.multipliers[:, self._m :]], axis=1)
        pull = pull / size[:, None]
        worst = pull.argmax(axis=1)
        most = pull[np.arange(len(s)), worst]
        threshold = np.where(s.hold, math.inf, EARLY) * np.maximum(slope, 1e-300)
        threshold = np.where(slope <= FLAT_SLOPE, 0.0, threshold)
        released = most > np.maximum(FLAT_SLOPE, threshold)
        opens = np.zeros_like(p.left)
        if not released.any():
            return s, p, released, opens
        n = s.x.shape[1]
        r = np.flatnonzero(released)
        limit = worst[r] < n
        shut, slots, hold = s.shut.copy(), s.slots.copy(), s.hold.copy()
        at, what = r[limit], worst[r[limit]]
        opens[at, what] = -shut[at, what]
        shut[at, what] = 0
        opens[r[~limit]] = p.rows[r[~limit], self._m + worst[r[~limit]] - n]
        slots[r[~limit], worst[r[~limit]] - n] = OPEN
        hold[r] = False
        rows = p.rows
        if rows.shape[1] > self._m:
            rows = rows.copy()
            rows[:, self._m :][slots == OPEN] = 0.0
        s = replace(s, shut=shut, slots=slots, hold=hold)
        return s, self._balance(s, p.at, p.residual, rows, p.torque), released, opens

    def _direction(self, h: np.ndarray, down: np.ndarray) -> np.ndarray:
        """Newton's direction; along negative curvature, or where it would climb, that of the mirrored Hessian."""
        d = -_solved(h, down)
        curvature = np.einsum("ki,kij,kj->k", d, h, d)
        climbs = np.einsum("ki,ki->k", d, down)
        length = np.linalg.norm(d, axis=1)
        bad = (climbs >= 0) | (curvature <= 1e-8 * length**2) | (length > 10) | ~np.isfinite(length)
        b = np.flatnonzero(bad)
        if len(b):
            value, vector = np.linalg.eigh(h[b])
            part = np.einsum("kij,ki->kj", vector, down[b])
            d[b] = -np.einsum("kij,kj->ki", vector, part / np.maximum(np.abs(value), 1e-2))
        return d

    def _advance(
        self,
        s: Samples,
        residual: np.ndarray,
        d: np.ndarray,
        down: np.ndarray,
        reach: np.ndarray,
        escaped: np.ndarray,
    ) -> tuple[Samples, np.ndarray, np.ndarray]:
        """Try a step; returns the samples (where it failed, as they were), whether it was taken, the next reach."""
        dx = d / self._root
        longest = np.abs(dx).max(axis=1)
        scale = np.minimum(1.0, reach / np.maximum(longest, 1e-300))
        energy = self.model.parameters.energy(s.x)
        trial, scale = self._move(s, dx, scale)
        slope = np.einsum("ki,ki->k", down, d) * scale
        good, bad_gap, side = self._try(trial, s.x, energy, slope, escaped)
        if bad_gap is not None:
            trial, good = self._meet(
                s, trial, dx, scale, energy, slope, escaped, good, bad_gap, side
            )
        taken = np.flatnonzero(good)
        out = joined(s)
        _put(out, taken, trial[taken])
        step = np.minimum(longest, reach)
        # a descent that has come close needs no long memory of a failed step
        reach = np.where(good, np.minimum(REACH, 1.7 * np.maximum(reach, step)), 0.3 * step)
        return out, good, reach

    def _move(self, s: Samples, dx: np.ndarray, scale: np.ndarray) -> tuple[Samples, np.ndarray]:
        """Step to the first fold limit at most, hold it, and close again."""
        x, shut = s.x.copy(), s.shut.copy()
        if self.model.has_limits:
            room = np.where(dx > 0, math.pi - x, math.pi + x)
            to = np.where((shut == 0) & (dx != 0), room / np.maximum(np.abs(dx), 1e-300), math.inf)
            first = to.argmin(axis=1)
            nearest = to[np.arange(len(s)), first]
            hit = np.flatnonzero(nearest <= scale)
            scale = np.minimum(scale, nearest)
            x = x + scale[:, None] * dx
            side = np.sign(dx[hit, first[hit]])
            shut[hit, first[hit]] = side
            x[hit, first[hit]] = side * math.pi
        else:
            x = x + scale[:, None] * dx
        return self.close(replace(s, x=x, shut=shut)), scale

    def close(self, s: Samples, steps: int = 12) -> Samples:
        """Close samples on their strata by Gauss-Newton; those that leave the fold limits are held there."""
        x, shut = s.x.copy(), s.shut.copy()
        todo = np.arange(len(s))
        for _ in range(3 if self.model.has_limits else 1):
            part = replace(s[todo], x=x[todo], shut=shut[todo])
            x[todo] = self._closed(part, steps)
            if not self.model.has_limits:
                break
            over = np.abs(x[todo]) > math.pi
            over &= shut[todo] == 0
            out = over.any(axis=1)
            todo, over = todo[out], over[out]
            if not len(todo):
                break
            sign = np.sign(x[todo])
            x[todo] = np.where(over, sign * math.pi, x[todo])
            shut[todo] = np.where(over, sign, shut[todo])
        return replace(s, x=x, shut=shut)

    def _closed(self, s: Samples, steps: int) -> np.ndarray:
        x = s.x.copy()
        todo = np.arange(len(x))
        for _ in range(steps):
            part = replace(s[todo], x=x[todo])
            _, value, rows = self._rows(part)
            far = np.abs(value).max(axis=1) > ROUNDED
            if not far.any():
                break
            todo, value = todo[far], value[far]
            rows = rows[far] * (part.shut[far] == 0)[:, None]
            move = rows.transpose(0, 2, 1) @ (_inverse(rows) @ value[..., None])
            move = move[..., 0]
            length = np.abs(move).max(axis=1, keepdims=True)
            x[todo] -= move * np.minimum(1.0, 1.0 / np.maximum(length, 1e-300))
            todo = todo[length[:, 0] > QUADRATIC]  # the next residual is the square of this
            if not len(todo):
                break
        return x

    def _try(
        self,
        trial: Samples,
        before: np.ndarray,
        energy: np.ndarray,
        slope: np.ndarray,
        escaped: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray | None, np.ndarray | None]:
        """Tell which trial states are taken; and of those that cross something, which gap and on which side."""
        at, value, _ = self._rows(trial)
        good = np.abs(value).max(axis=1) <= FOLLOWED
        good &= (np.abs(trial.x) <= self.model.bound + EPS).all(axis=1) & (at.sheet > 0)
        good &= np.abs(trial.x - before).max(axis=1) < 2 * REACH
        now = self.model.parameters.energy(trial.x)
        good &= (now <= energy + 1e-4 * np.minimum(slope, 0) + 1e-11 * (1 + energy)) | (
            escaped & (now <= energy + 1e-9)
        )
        if not self.crossings.any:
            return good, None, None
        gap, side = self.crossings.of(at, trial.x, trial.shut)
        crossed = gap != OPEN
        return good & ~crossed, np.where(crossed, gap, OPEN), side

    def _meet(
        self,
        s: Samples,
        trial: Samples,
        dx: np.ndarray,
        scale: np.ndarray,
        energy: np.ndarray,
        slope: np.ndarray,
        escaped: np.ndarray,
        good: np.ndarray,
        gap: np.ndarray,
        side: np.ndarray,
    ) -> tuple[Samples, np.ndarray]:
        """Where a step crosses something, stop where its gap would close to first order, and hold it there."""
        out, good = joined(trial), good.copy()
        todo = np.flatnonzero(gap >= 0)
        named = np.stack([gap[todo]] + [np.full(len(todo), OPEN)] * (SLOTS - 1), axis=1)
        before, after = (
            side[todo] * self.kinematics.gaps(self.kinematics.fold(x), named)[0][:, 0]
            for x in (s.x[todo], trial.x[todo])
        )
        share = before / np.maximum(before - after, 1e-300)
        # a gap that was closed already is left: its crossing is another one, met half way
        share = np.where((before > 0) & (after < 0), np.clip(share, 0.1, 0.95), 0.5)
        shorter, _ = self._move(s[todo], dx[todo], scale[todo] * share)
        held, room = _hold(shorter, gap[todo], side[todo])
        held = self.close(held, 6)
        old = s.x[todo], energy[todo], slope[todo] * 0, escaped[todo]
        ok, _, _ = self._try(held, *old)
        ok &= room & (np.abs(held.x - shorter.x).max(axis=1) < NEAR)
        plain, _, _ = self._try(shorter, *old)
        for taken, state in ((ok, held), (plain & ~ok, shorter)):
            _put(out, todo[taken], state[taken])
            good[todo[taken]] = True
        return out, good


@dataclass(frozen=True, eq=False)
class _Progress:
    reach: np.ndarray
    escaped: np.ndarray
    converged: np.ndarray


def _hold(s: Samples, gap: np.ndarray, side: np.ndarray) -> tuple[Samples, np.ndarray]:
    """Put a gap into a free slot of each sample; returns the samples and whether there was one."""
    slots, sides = s.slots.copy(), s.sides.copy()
    free = (slots == OPEN) & ~(slots == gap[:, None]).any(axis=1, keepdims=True)
    free &= (gap >= 0)[:, None]  # what has no name cannot be held
    gap = np.maximum(gap, 0)
    room = free.any(axis=1)
    first = free.argmax(axis=1)
    r = np.flatnonzero(room)
    slots[r, first[r]], sides[r, first[r]] = gap[r], side[r]
    return replace(s, slots=slots, sides=sides), room


def _inverse(rows: np.ndarray) -> np.ndarray:
    """Return the (pseudo-)inverse [K, r, r] of rows rows', rows [K, r, n]; empty rows are those of the identity.

    Where rows depend on each other (on a handle, or where a crease lies on another) what they do not
    resolve is left out: singular values below `RANK`.
    """
    a = rows @ rows.transpose(0, 2, 1)
    d = np.arange(a.shape[1])
    diagonal = a[:, d, d]
    trace = diagonal.sum(axis=1)
    a[:, d, d] += np.where(diagonal == 0, 1.0, ROUNDED**2 * trace[:, None])
    inverse = _inverted(a + EPS * trace[:, None, None] * np.eye(len(d)))
    largest = np.abs(inverse[:, d, d]).max(axis=1, initial=0.0)
    poor = np.flatnonzero(~(largest * np.maximum(trace, 1.0) <= POOR))
    if len(poor):
        value, vector = np.linalg.eigh(a[poor])
        keep = value > RANK**2 * value[:, -1:]
        over = np.where(keep, 1 / np.where(keep, value, 1.0), 0.0)
        inverse[poor] = (vector * over[:, None]) @ vector.transpose(0, 2, 1)
    return inverse


def _inverted(a: np.ndarray) -> np.ndarray:
    """Return inverses of positive definite matrices [K, r, r]; those of three rows by their cofactors."""
    if a.shape[1] != 3:
        return np.linalg.inv(a)
    (p, q, r), (_, s, t), (_, _, u) = a.transpose(1, 2, 0)
    pp, pq, pr = s * u - t * t, r * t - q * u, q * t - r * s
    qq, qr, rr = p * u - r * r, q * r - p * t, p * s - q * q
    with np.errstate(divide="ignore", invalid="ignore"):
        over = 1 / (p * pp + q * pq + r * pr)
        inverse = np.array([[pp, pq, pr], [pq, qq, qr], [pr, qr, rr]]) * over
    return np.nan_to_num(inverse, nan=math.inf, posinf=math.inf, neginf=-math.inf).transpose(
        2, 0, 1
    )


def _solved(h: np.ndarray, right: np.ndarray) -> np.ndarray:
    try:
        return np.linalg.solve(h, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.einsum("kij,kj->ki", np.linalg.pinv(h), right)
