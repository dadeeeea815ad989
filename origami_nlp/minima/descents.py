"""Thousands of descents at once: Newton with an active set, on the set of closed states.

The metric is that of the stiffness, y = sqrt(k) phi, in which the elastic energy is half a squared distance and its
Hessian the identity: all curvature comes from closure and from the contacts that are held.  At each state

    G = rows' lam + R,      rows = closure and held gaps,      R = 0 on the free creases where it is stationary;

a fold limit whose R pulls, and a gap whose Lagrange multiplier does, leaves the active set; a step that reaches a
limit, a mirror or another facet stops there and adds it.  Steps are accepted by a sufficient decrease of the energy;
after a refused one the next is shorter, as in a trust region.  What comes out are candidates: polishing and judging
them is for others.

Directions are rounded to `CHOSEN` and ties go to the first, so that a descent goes the same way on other processors,
but beside singular strata: states differ by what rounding leaves, and this does not grow from step to step.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from origami_nlp.minima.compiled_descents import CompiledDescents, compiled
from origami_nlp.minima.descent_rules import (
    CUT,
    EARLY,
    ESCAPE,
    ESCAPES,
    FIRST_REACH,
    FLAT_SLOPE,
    GROWTH,
    LONG_CHAIN,
    MOST_ONE_BY_ONE,
    MOST_STEPS,
    NEAR,
    NEXT,
    NO_SLOPE,
    REACH,
    SADDLE,
    SHORTEST,
    STALLED,
)
from origami_nlp.minima.recursive_newton import LEAST_PIVOT, sweep
from origami_nlp.numerics import (
    CHOSEN,
    CONTACT_TOL,
    DECREASE,
    EXPLORED,
    NONZERO,
    ROUNDED,
    SAME_ENERGY,
    SINGULAR,
    TINY,
    coarse,
    first_largest,
)
from origami_nlp.problem import OPEN, Model, Parameters
from origami_nlp.starts import (
    Closing,
    ClosurePoint,
    Ends,
    Samples,
    VertexCrossings,
    balance,
    joined,
    put,
)

APART = 128
"""So many samples without gaps, and with gaps, are worth steps of their own."""


@dataclass(frozen=True, eq=False)
class _Before:
    """What a step is measured against: states [K, n], energies, slopes to first order, and who leaves a saddle."""

    x: np.ndarray
    energy: np.ndarray
    slope: np.ndarray
    escaped: np.ndarray

    def __getitem__(self, which: np.ndarray) -> _Before:
        return _Before(self.x[which], self.energy[which], self.slope[which], self.escaped[which])


@dataclass(frozen=True, eq=False)
class _Progress:
    """What a step came to: the next reach, whether a saddle was left, converged, moved, [K] each."""

    reach: np.ndarray
    escaped: np.ndarray
    converged: np.ndarray
    moved: np.ndarray


class Descents:
    """Descents of a model's energy on the set of its admissible states.

    Parameters
    ----------
    model
        The posed scene.
    springs
        Where samples of several scenes of one vertex descend together, those of each; see `Closing`.
    until
        Time of `time.monotonic` after which they stop where they are, and have not converged.
    threads
        That share the descents where these are compiled.
    steps
        Of a descent, at most.
    longest
        Step of a fold angle [rad].

    Attributes
    ----------
    closing, crossings
        What brings states onto their strata, and what determines where they cross something.
    compiled
        The same descents in C; None where there is no compiler, and under forces in space.
    """

    def __init__(
        self,
        model: Model,
        springs: Sequence[Parameters] = (),
        until: float = math.inf,
        threads: int = 1,
        steps: int = MOST_STEPS,
        longest: float = REACH,
    ) -> None:
        self.until, self._threads, self._steps = until, threads, steps
        self._longest = longest
        self.model, self.closing = model, Closing(model, springs)
        self.crossings, self._m = VertexCrossings(model), model.equation_count
        plain = model.equation_count == 3 and not model.structure.gaps
        self._chain = plain and model.size >= LONG_CHAIN
        self._many = plain and model.size > MOST_ONE_BY_ONE
        self.compiled = None
        if model.parameters.dead is None and (descend := compiled()) is not None:
            rules: dict[str, Any] = {
                "limits": model.has_limits,
                "many": self._many,
                "chain": self._chain,
                "steps": steps,
                "longest": longest,
                "projects": False,
                "across": model.root,
            }
            rules |= {"low": model.fold_limits.low, "high": model.fold_limits.high}
            self.compiled = CompiledDescents(descend, self.closing, self.crossings, rules)

    @classmethod
    def of_each(cls, several: Sequence[Descents]) -> Descents | None:
        """Return descents whose samples name one of several scenes; None where their vertices, or labels, differ."""
        if len(several) <= 1:
            return None
        first, models = several[0].model, [descents.model for descents in several]
        same = not any(d._chain or not d.model.parameters.plain for d in several) and all(
            m.structure == first.structure
            and m.fold_limits.same_as(first.fold_limits)
            and np.array_equal(m.parameters.sectors, first.parameters.sectors)
            for m in models
        )
        return cls(first, [m.parameters for m in models]) if same else None

    def run(self, starts: Samples, paths: list[np.ndarray] | None = None) -> Ends:
        """Descend from closed samples.

        The hold of a sample ends once its stratum is reached: contacts that pull are let go then.  A sample at which
        linear algebra breaks down is found by halving, and ends where it started, as one that went nowhere; the others
        go on.  paths: filled with the states after each step, closed, [S, n] of each sample.
        """
        if self.compiled is not None:
            return self.compiled.run(starts, self.until, self._threads, paths)
        try:
            return self.run_in_numpy(starts, paths)
        except np.linalg.LinAlgError:
            if len(starts) <= 1:
                none = np.zeros(len(starts), dtype=bool)
                if paths is not None:
                    paths += np.zeros((len(starts), 0, starts.x.shape[1]))
                return Ends(starts, none, none, ~none)
            halves = np.array_split(np.arange(len(starts)), 2)
            return Ends.of([self.run(starts[half], paths) for half in halves])

    def run_in_numpy(self, starts: Samples, paths: list[np.ndarray] | None = None) -> Ends:
        """Descend in NumPy: what the compiled descents are compared with, and all there is of forces in space."""
        k, live = len(starts), np.arange(len(starts))
        s, kept = joined(starts), joined(starts)  # copies
        reach = np.full(k, min(FIRST_REACH, self._longest))
        escapes, went = np.zeros(k, dtype=int), [list[np.ndarray]() for _ in range(k)]
        idle = np.zeros(k, dtype=int)
        converged, settled = np.zeros(k, dtype=bool), np.zeros(k, dtype=bool)
        for _ in range(self._steps):
            if not len(live) or time.monotonic() > self.until:
                break
            slotted = s.slots[live].max(axis=1) != OPEN
            apart = min(slotted.sum(), (~slotted).sum()) >= APART  # fewer rows: faster
            for who in (live[~slotted], live[slotted]) if apart else (live,):
                before = s[who]
                new, now = self._step(
                    joined(before), reach[who], escapes[who]
                )  # of a copy: it is put in place
                left = before.hold & ~new.hold
                settled[who] |= left
                put(kept, who[left], before[left])
                put(s, who, new)
                reach[who], converged[who] = now.reach, now.converged
                escapes[who] += now.escaped
                idle[who] = np.where(now.moved, 0, idle[who] + 1)
            if paths is not None:
                for i, x in zip(live, self.closing.close(s[live], to=ROUNDED).x, strict=True):
                    went[i].append(x)
            live = live[~converged[live] & (reach[live] >= SHORTEST) & (idle[live] < STALLED)]
        # what its contacts did not let go of is an end of its own: of a set that exists only while they are closed
        back = np.flatnonzero(settled & ~converged)
        put(s, back, kept[back])
        broken = np.zeros(k, dtype=bool)
        if paths is not None:
            paths += (np.reshape(path, (len(path), s.x.shape[1])) for path in went)
        return Ends(self.closing.close(s, to=ROUNDED), converged, settled, broken)

    def _step(
        self, s: Samples, reach: np.ndarray, escapes: np.ndarray
    ) -> tuple[Samples, _Progress]:
        p = self.closing.point(s)
        # what is left of the torque is its projection, no longer than itself; where it is, closure is singular there
        left = np.abs(np.where(s.at_limit == 0, p.left, 0.0)).max(axis=1)
        lost = ~(left <= 2 * math.sqrt(self.model.size) * np.abs(p.torque).max(axis=1))
        p.left[lost], p.multipliers[lost] = 0.0, 0.0
        size = 1 + np.abs(p.torque).max(axis=1) + np.abs(p.multipliers).max(axis=1)
        slope = np.abs(np.where(s.at_limit == 0, p.left, 0.0)).max(axis=1) / size
        s, p, released, opens = self._release(s, p, slope, size)
        free = s.at_limit == 0
        # what rounding leaves of a balance has no direction
        down = np.where(free & (np.abs(p.left) > NO_SLOPE * size[:, None]), p.left, 0.0)
        root = self.closing.root(s)
        swept = sweep(s, p, root, self.closing.soft(s)) if self._chain else None
        h = np.zeros((len(s), 0, 0)) if swept else self._on_stratum(s, p)
        d = swept.direction if swept else _direction(h, down)
        # a contact that is let go must open: the steepest way down does that
        length = np.linalg.norm(opens, axis=1) * np.linalg.norm(d, axis=1)
        wrong = released & (np.einsum("ki,ki->k", opens, d) <= CHOSEN * length)
        d[wrong] = -down[wrong]
        converged = (slope <= FLAT_SLOPE) & ~released
        known = (swept.curvature, swept.bent) if swept else None
        wide = np.broadcast_to(root, d.shape)
        escaped = self._leave_saddles(h, d, wide, converged, escapes, known)
        d = coarse(d)
        go = np.flatnonzero(~converged)
        moved, reach = np.ones(len(s), dtype=bool), reach.copy()
        if len(go):
            tried, accepted, reach[go] = self._advance(
                s[go], d[go], down[go], reach[go], escaped[go]
            )
            moved[go] = np.abs(tried.x - s.x[go]).max(axis=1) > TINY
            put(s, go, tried)
            tiny = np.abs(d[go] / wide[go]).max(axis=1) < TINY
            converged[go] = ~accepted & tiny & ~released[go]
        converged[lost], reach[lost] = False, 0.0
        return s, _Progress(reach, escaped, converged, moved)

    def _on_stratum(self, s: Samples, p: ClosurePoint) -> np.ndarray:
        """Hessian along the stratum of each sample, the identity across it, [K, n, n]."""
        n = s.x.shape[1]
        # projector on the null space of the rows on free creases, 1 - A'(A A')^-1 A (Nocedal and Wright, section 16.3)
        projector = -p.free_rows.transpose(0, 2, 1) @ p.inverse @ p.free_rows
        projector[:, np.arange(n), np.arange(n)] += s.at_limit == 0
        h = projector @ self.closing.hessian(s, p) @ projector + np.eye(n) - projector
        return np.asarray(0.5 * (h + h.transpose(0, 2, 1)))

    def _leave_saddles(
        self,
        h: np.ndarray,
        d: np.ndarray,
        root: np.ndarray,
        converged: np.ndarray,
        escapes: np.ndarray,
        known: tuple[np.ndarray, np.ndarray] | None = None,
    ) -> np.ndarray:
        """Set the direction `d` of saddles downhill (in place; they have not converged); return which they are.

        known: lowest curvatures [K] and their directions [K, n], where they are.
        """
        escaped = np.zeros(len(h), dtype=bool)
        where = np.flatnonzero(converged)
        if not len(where):
            return escaped
        if known is None:
            value, vector = _lowest(h[where])
        else:
            value, vector = known[0][where], known[1][where]
        unstable = (value < SADDLE) & (escapes[where] < ESCAPES)
        where, v = where[unstable], vector[unstable]
        # either side is as good, and what torque is left is rounding: the largest entry goes up
        side = np.sign(v[np.arange(len(v)), first_largest(np.abs(v))])
        d[where] = v * (side * ESCAPE / np.abs(v / root[where]).max(axis=1))[:, None]
        converged[where], escaped[where] = False, True
        return escaped

    def _release(
        self, s: Samples, p: ClosurePoint, slope: np.ndarray, size: np.ndarray
    ) -> tuple[Samples, ClosurePoint, np.ndarray, np.ndarray]:
        """Drop the contact that pulls most from the active set, where it pulls enough; also return the gradient of
        its gap."""
        n = s.x.shape[1]
        # positive where a multiplier has the wrong sign: energy falls as the contact opens
        pull = np.concatenate([s.at_limit * p.left, -p.multipliers[:, self._m :]], axis=1)
        pull = pull / size[:, None]
        worst = first_largest(pull)
        early = np.where(slope <= FLAT_SLOPE, 0.0, np.where(s.hold, math.inf, EARLY * slope))
        released = pull[np.arange(len(s)), worst] > np.maximum(FLAT_SLOPE, early)
        opens = np.zeros_like(p.left)
        if not released.any():
            return s, p, released, opens
        r = np.flatnonzero(released)
        limit, gap = r[worst[r] < n], r[worst[r] >= n]
        at_limit, slots, rows = s.at_limit.copy(), s.slots.copy(), p.rows.copy()
        release = np.zeros_like(at_limit, dtype=bool)
        release[limit, worst[limit]] = True
        if self._many:  # what closing finds beyond its limit is put back to it
            most = pull[np.arange(len(s)), worst]
            release |= released[:, None] & (pull[:, :n] > np.maximum(EARLY * most, early)[:, None])
        opens[release] = -at_limit[release]
        at_limit[release] = 0
        opens[gap] = rows[gap, self._m + worst[gap] - n]
        rows[gap, self._m + worst[gap] - n] = 0.0
        slots[gap, worst[gap] - n] = OPEN
        s = replace(s, at_limit=at_limit, slots=slots, hold=s.hold & ~released)
        return s, balance(s, p.at, rows, p.torque), released, opens

    def _advance(
        self, s: Samples, d: np.ndarray, down: np.ndarray, reach: np.ndarray, escaped: np.ndarray
    ) -> tuple[Samples, np.ndarray, np.ndarray]:
        """Try a step; returns the samples (where it failed, as they were), whether it was taken, the next reach."""
        dx = d / self.closing.root(s)
        longest = np.abs(dx).max(axis=1)
        trial, share = self._moved(s, dx, np.minimum(1.0, reach / np.maximum(longest, NONZERO)))
        trial = self.closing.close(trial, metric=True)
        energy = self.closing.springs(s).energy(s.x)
        before = _Before(s.x, energy, np.einsum("ki,ki->k", down, d) * share, escaped)
        good, gap, side = self._try(trial, before)
        if (gap != OPEN).any():
            trial, good = self._meet(s, trial, dx * share[:, None], before, (good, gap, side))
        out, taken = joined(s), np.flatnonzero(good)
        put(out, taken, trial[taken])
        step = np.minimum(longest, reach)
        reach = np.where(
            good, np.minimum(self._longest, GROWTH * np.maximum(reach, step)), CUT * step
        )
        return out, good, reach

    def _moved(self, s: Samples, dx: np.ndarray, share: np.ndarray) -> tuple[Samples, np.ndarray]:
        """Step by a share of dx, to the first fold limit at most, which is held then; not closed."""
        if not self.model.has_limits or self._many:
            return replace(s, x=s.x + share[:, None] * dx), share
        at_limit = s.at_limit.copy()
        limits = self.model.fold_limits
        room = np.maximum(np.where(dx > 0, limits.high - s.x, s.x - limits.low), 0.0)
        to = np.where(
            (at_limit == 0) & (np.abs(dx) > ROUNDED),
            room / np.maximum(np.abs(dx), NONZERO),
            math.inf,
        )
        nearest = to.min(axis=1)
        first = (to <= nearest[:, None] * NEXT).argmax(axis=1)
        hit = np.flatnonzero(nearest <= share * NEXT)
        share = np.minimum(share, nearest)
        x = s.x + share[:, None] * dx
        side, v = np.sign(dx[hit, first[hit]]), first[hit]
        at_limit[hit, v], x[hit, v] = side, np.where(side > 0, limits.high[v], limits.low[v])
        return replace(s, x=x, at_limit=at_limit), share

    def _try(self, trial: Samples, before: _Before) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Return which trial states are taken; and which gap each crosses (`OPEN` for none), with its open side."""
        at, value, _ = self.closing.rows(trial)
        good = np.abs(value).max(axis=1) <= EXPLORED
        limits = self.model.fold_limits
        good &= limits.inside(trial.x, ROUNDED).all(axis=1) & (at.lift > 0)
        # closing may have gone to states far from where the step led
        good &= np.abs(trial.x - before.x).max(axis=1) < 2 * REACH
        now, e = self.closing.springs(trial).energy(trial.x), before.energy
        # sufficient decrease (Nocedal and Wright, eq. 3.4), with slack for the rounding of energies
        lower = now <= e + DECREASE * np.minimum(before.slope, 0) + EXPLORED * (1 + np.abs(e))
        good &= lower | (before.escaped & (now <= e + SAME_ENERGY))
        gap, side = self.crossings.of(at, trial.x, limits.folded_flat(trial.at_limit))
        return good & (gap == OPEN), gap, side

    def _meet(
        self,
        s: Samples,
        trial: Samples,
        dx: np.ndarray,
        before: _Before,
        found: tuple[np.ndarray, np.ndarray, np.ndarray],
    ) -> tuple[Samples, np.ndarray]:
        """Where a step crosses something, stop where its gap would close to first order, and hold it there."""
        good, gap, side = found
        todo = np.flatnonzero(gap >= 0)
        s, gap, side = s[todo], gap[todo], side[todo]
        k, kinematics = len(todo), self.closing.kinematics
        both = kinematics.fold(np.concatenate([s.x, trial.x[todo]]))
        values = np.tile(side, 2) * kinematics.gaps(both, np.tile(gap, 2)[:, None])[0][:, 0]
        was, is_now = values[:k], values[k:]
        share = np.clip(was / np.maximum(was - is_now, NONZERO), 0.1, 0.95)
        # a gap that was closed already is left: its crossing is another one, met half way
        share = np.where((was > CONTACT_TOL) & (is_now < 0), share, 0.5)
        shorter, _ = self._moved(s, dx[todo], share)
        held, room = shorter.holding(gap, side)
        first = shorter.x
        # the contact held, and as far as there without it, together: a batch costs by the call
        ends = self.closing.close(joined(held, shorter), metric=True)
        level = replace(before[np.tile(todo, 2)], slope=np.zeros(2 * k))
        ok = self._try(ends, level)[0]
        ok[:k] &= room & (np.abs(ends.x[:k] - first).max(axis=1) < NEAR)
        ok[k:] &= ~ok[:k]
        out, good = joined(trial), good.copy()
        for which in (np.flatnonzero(ok[:k]), np.flatnonzero(ok[k:]) + k):
            put(out, todo[which % k], ends[which])
            good[todo[which % k]] = True
        return out, good


def _direction(h: np.ndarray, down: np.ndarray) -> np.ndarray:
    """Newton's direction; along negative curvature, or where it would climb, that of the mirrored Hessian."""
    try:
        inverse = np.linalg.inv(h)
    except np.linalg.LinAlgError:
        inverse = np.linalg.pinv(h)
    d = -np.einsum("kij,kj->ki", inverse, down)
    curvature = np.einsum("ki,kij,kj->k", d, h, d)
    length = np.linalg.norm(d, axis=1)
    climbs = np.einsum("ki,ki->k", d, down) >= 0
    bad = climbs | (curvature <= SINGULAR * length**2) | (length > 10) | ~np.isfinite(length)
    bad |= np.abs(inverse).max(axis=(1, 2)) > 1 / SINGULAR
    b = np.flatnonzero(bad)
    if len(b):
        value, vector = np.linalg.eigh(h[b])
        part = np.einsum("kij,ki->kj", vector, down[b])
        # |eigenvalues| in place of eigenvalues: always downhill (Nocedal and Wright, section 3.4)
        d[b] = -np.einsum("kij,kj->ki", vector, part / np.maximum(np.abs(value), LEAST_PIVOT))
    return np.asarray(d)


def _lowest(h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lowest eigenvalues [K], and of their eigenvectors the one nearest to a fixed direction, [K, n]."""
    values, vectors = np.linalg.eigh(h)
    # eigenvectors of equal eigenvalues are arbitrary; what they span of a fixed vector is not
    near = np.where(values <= values[:, :1] + CHOSEN * np.abs(values).max(axis=1)[:, None], 1, 0)
    fixed = np.cos(np.arange(1, h.shape[1] + 1))
    v = np.einsum("kij,kj,kj->ki", vectors, near, np.einsum("kij,i->kj", vectors, fixed))
    length = np.linalg.norm(v, axis=1)
    v = np.where(
        (length > CHOSEN)[:, None], v / np.maximum(length, CHOSEN)[:, None], vectors[..., 0]
    )
    return values[:, 0], v
