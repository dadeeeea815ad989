"""One degree of freedom: the closed states between two states as a curve, and what barriers ask of the springs there.

Energies and slopes at given states are linear in stiffness and torque, so that a pass that stands where it is
prescribed has conditions as linear as those of a well.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from origami_nlp.continuation import BoundaryCurve, evaluate, follow_boundary
from origami_nlp.errors import OptionError
from origami_nlp.inverse_design.equilibrium import SpringRows, bounded
from origami_nlp.inverse_design.targets import EnergyBounds, Targets
from origami_nlp.kkt import State, project
from origami_nlp.numerics import (
    CLOSURE_TOL,
    DUPLICATE_TOL,
    EQUAL,
    LEVEL,
    POSITIVE,
    SAMPLED,
    SETTLED,
    ConeRows,
)
from origami_nlp.pattern_problem import PatternProblem

CANDIDATES = 15
"""Places between two wells at which the pass may be prescribed."""
MOST_CANDIDATES = 300
"""Choices of passes for all pairs together."""
BESIDE_PASS = 0.1
"""Curvature of a prescribed pass, over the margin."""


@dataclass(frozen=True)
class TransitionPath:
    """Admissible closed states from one state to another.

    Attributes
    ----------
    states
        From the first to the last, shape [m, n].
    tangents, bends
        First and second derivative by arclength in the metric, 0 where the curve is singular, shape [m, n].
    """

    states: np.ndarray
    tangents: np.ndarray
    bends: np.ndarray

    @property
    def regular(self) -> np.ndarray:
        """Where the curve has a tangent, shape [m]."""
        return np.asarray(np.linalg.norm(self.tangents, axis=1) > 0.5)


def curve_of(model: PatternProblem, x: np.ndarray) -> BoundaryCurve | None:
    """Return the curve of closed states through x [n], up to contacts or a singular state; None where it has none."""
    held = State(model, x).on(())
    first = evaluate(held)
    if first is None or first.dimension != 1:
        return None
    return follow_boundary(held, stop_at_release=False)


def path_between(model: PatternProblem, a: np.ndarray, b: np.ndarray) -> TransitionPath | None:
    """Return the shortest way from a to b on the curves of a model with one degree of freedom.

    Parameters
    ----------
    model
        With `dof` 1.
    a, b
        Closed states, shape [n].

    Returns
    -------
    TransitionPath or None
        None where no curve joins them, except through a singular state that is not flat.
    """
    one, two = curve_of(model, a), curve_of(model, b)
    if one is not None and (found := _part(one, a, b)):
        return _way(model, min(found, key=len))
    if two is not None and (found := _part(two, b, a)):
        return _way(model, min(found, key=len)[::-1])
    for first, second in itertools.product(outward(one, a), outward(two, b)):
        corner = math.pi * np.round(first[-1] / math.pi)
        near = max(np.abs(first[-1] - corner).max(), np.abs(second[-1] - corner).max())
        if near <= SAMPLED and np.abs(model.closure(corner)[0]).max() <= CLOSURE_TOL:
            found.append(_thinned(np.vstack([first[:-1], corner, second[-2::-1]])))
    return _way(model, min(found, key=len)) if found else None


def _part(curve: BoundaryCurve, a: np.ndarray, b: np.ndarray) -> list[np.ndarray]:
    """Cut the ways from a, where the curve was started, to b out of it."""
    at = curve.states
    i = int(np.abs(at - a).max(axis=1).argmin())
    steps = np.diff(at, axis=0)
    # nearest point of each step of the polyline to b
    share = np.einsum("ij,ij->i", b - at[:-1], steps) / np.einsum("ij,ij->i", steps, steps)
    on = at[:-1] + np.clip(share, 0, 1)[:, None] * steps
    j = int(np.abs(on - b).max(axis=1).argmin())
    if np.abs(on[j] - b).max() > SAMPLED:
        return []
    ways = [at[i + 1 : j + 1] if j >= i else at[j + 1 : i][::-1]]
    if curve.end == "closed curve":
        ring = at[:-1]
        rest = [*ring[j + 1 :], *ring[:i]][::-1] if j >= i else [*ring[i + 1 :], *ring[: j + 1]]
        ways.append(np.array(rest).reshape(-1, len(a)))
    return [_thinned(np.vstack([a, way, b])) for way in ways]


def _thinned(w: np.ndarray) -> np.ndarray:
    """Drop samples that stand on the one before, the ends kept."""
    keep = [0]
    for k in range(1, len(w) - 1):
        if np.abs(w[k] - w[keep[-1]]).max() > SETTLED and np.abs(w[k] - w[-1]).max() > SETTLED:
            keep.append(k)
    return np.asarray(w[[*keep, len(w) - 1]])


def outward(curve: BoundaryCurve | None, x: np.ndarray) -> list[np.ndarray]:
    """Both sides of a curve, from x outwards; a flat state is an arm by itself."""
    if curve is None:
        return [np.array([x, x])]
    i = int(np.abs(curve.states - x).max(axis=1).argmin())
    out = []
    for side in (curve.states[i:], curve.states[: i + 1][::-1]):
        at = np.abs(side - math.pi * np.round(side / math.pi)).max(axis=1)
        corner = np.flatnonzero(at[1:] <= SAMPLED)  # (other curves may cross this one there)
        side = side[: corner[0] + 2] if len(corner) else side
        if len(side) > 1:
            out.append(np.vstack([x, side[1:]]))
    return out


def _way(model: PatternProblem, states: np.ndarray) -> TransitionPath:
    """Give a way its tangents."""
    tangents, bends = np.zeros_like(states), np.zeros_like(states)
    for k, x in enumerate(states):
        before, after = states[max(k - 1, 0)], states[min(k + 1, len(states) - 1)]
        point = evaluate(State(model, x).on(()))
        if point is None or point.dimension != 1:
            continue
        sign = math.copysign(1.0, float(point.tangent @ (model.root * (after - before))))
        tangents[k], bends[k] = sign * point.tangent, point.bend
    return TransitionPath(states, tangents, bends)


def height(model: PatternProblem, way: TransitionPath) -> tuple[float, np.ndarray]:
    """Return the highest energy on a way [J], and the state [n] where it is, found by Newton along the curve.

    Parameters
    ----------
    model
        Of the scene with its springs.
    way
        On a curve of its closed states.
    """
    energies = model.energies(way.states)
    k = int(np.argmax(energies))
    x, best = way.states[k], float(energies[k])
    if k in (0, len(energies) - 1) or not way.regular[k]:
        return best, x
    for _ in range(12):
        # the tangent keeps the sense of the way
        point = evaluate(State(model, x).on(()), way.tangents[k])
        if point is None or point.stiffness >= 0:
            break
        # Newton on dU/ds = 0
        h = float(np.clip(-point.slope / point.stiffness, -SAMPLED, SAMPLED))
        y, residual = project(model, x + (h * point.tangent + h**2 / 2 * point.bend) / model.root)
        if residual > CLOSURE_TOL:
            break
        x, best = y, max(best, float(model.energy(y)))
        if abs(h) <= DUPLICATE_TOL:
            break
    return best, x


class Passes:
    """What the barriers of a question ask of its springs, for each choice of where the passes stand.

    Parameters
    ----------
    targets
        With barriers, and one degree of freedom.
    """

    def __init__(self, targets: Targets) -> None:
        self.targets, model = targets, targets.model
        self.springs = SpringRows(model, targets.kinds)
        self.asks: dict[tuple[str, str], list[EnergyBounds]] = {}
        for ask in targets.barriers:
            pair = (ask.first, ask.second)
            one = pair[::-1] if pair[::-1] in self.asks else pair
            self.asks.setdefault(one, []).append(ask)
        at = {p.target.name: p.state.x for p in targets.placed}
        self.ways: dict[tuple[str, str], TransitionPath] = {}
        self.tops: dict[tuple[str, str], list[np.ndarray]] = {pair: [] for pair in self.asks}
        for pair in self.asks:
            way, who = (
                path_between(model, *(at[name] for name in pair)),
                f"{pair[0]!r} to {pair[1]!r}",
            )
            if way is None:
                raise OptionError(f"[[barriers]] {who}: no curve of closed states joins them")
            if len(way.states) < 3:
                raise OptionError(f"[[barriers]] {who} are the same state")
            self.ways[pair] = way

    def choices(self) -> list[dict[tuple[str, str], int | None]]:
        """Return where passes may stand: a sample of each way, or None where only a height is bounded from above."""
        options: list[list[int | None]] = []
        for pair, asks in self.asks.items():
            m, share = len(self.ways[pair].states), int(MOST_CANDIDATES ** (1 / len(self.asks)))
            where = np.linspace(0, m - 1, min(CANDIDATES, max(2, share)) + 2)[1:-1]
            at = np.unique(np.clip(np.round(where), 1, m - 2).astype(int)).tolist()
            options.append(at if any(a.least > 0.0 for a in asks) else [None])
        every = itertools.islice(itertools.product(*options), MOST_CANDIDATES)
        return [dict(zip(self.asks, c, strict=True)) for c in every]

    def slope(self, way: TransitionPath, k: int) -> np.ndarray:
        """Row of the slope of the energy along a way."""
        return self.springs.slope(way.states[k], way.tangents[k] / self.targets.model.root)

    def curvature(self, way: TransitionPath, k: int) -> np.ndarray:
        """Row of the second derivative of the energy along a way."""
        row = self.springs.slope(way.states[k], way.bends[k] / self.targets.model.root)
        # paper, eq. 3.6: t . K t + grad U . y'', linear in k and tau where the curve is given
        np.add.at(
            row, self.springs.places.stiffness.start + self.springs.kind, way.tangents[k] ** 2
        )
        return row

    def rows(self, choice: dict[tuple[str, str], int | None]) -> list[ConeRows]:
        """Return the rows of a choice."""
        out: list[ConeRows] = []
        scale = np.zeros(self.springs.places.size)
        scale[self.springs.places.scale] = 1.0
        for pair, asks in self.asks.items():
            way, p = self.ways[pair], choice[pair]
            out += [] if p is None else self._pass(pair, way, p)
            top = [*way.states[1:-1], *self.tops[pair]] if p is None else [way.states[p]]
            for ask in asks:
                start = self.springs.energy(self._start(pair, ask))
                rises = np.array([self.springs.energy(x) - start for x in top])
                words = f"barrier from {ask.first} to {ask.second}"
                least = ask.least if ask.least > 0.0 else -math.inf
                out += bounded(rises, scale, least, ask.most, words)
        return out

    def _start(self, pair: tuple[str, str], ask: EnergyBounds) -> np.ndarray:
        """Return the end of a way at which a barrier begins."""
        x: np.ndarray = self.ways[pair].states[0 if ask.first == pair[0] else -1]
        return x

    def see(self, model: PatternProblem) -> bool:
        """Note the tops of ways between samples that are too high in a scene; False where all are low enough."""
        new = False
        for pair, asks in self.asks.items():
            top, x = height(model, self.ways[pair])
            for ask in asks:
                if top - float(model.energy(self._start(pair, ask))) > ask.most * (1 + LEVEL):
                    self.tops[pair].append(x)
                    new = True
        return new

    def _pass(self, pair: tuple[str, str], way: TransitionPath, p: int) -> list[ConeRows]:
        """Rows of a pass at sample p: up to it, stationary there, down from it."""
        words = f"the only pass between {pair[0]} and {pair[1]} is the one prescribed"
        slopes = [
            # rising before the pass, falling behind it: its only top
            math.copysign(1.0, p - k) * self.slope(way, k)
            for k in range(1, len(way.states) - 1)
            if k != p and way.regular[k]
        ]
        out = []
        if slopes:
            out.append(ConeRows.of(POSITIVE, slopes, words))
        if way.regular[p]:
            # a pass: level and bent down there, rising before and falling behind
            bend = -self.curvature(way, p)
            bend[self.springs.places.margin] -= BESIDE_PASS
            out.append(ConeRows.of(EQUAL, self.slope(way, p), f"{words}: level there"))
            out.append(ConeRows.of(POSITIVE, bend, f"{words}: bends down there"))
        return out
