"""How far springs may be off before a state is gone: followed to its event along the worst directions found.

Each stiffness is multiplied by (1 + p)^(+-1) = e^(+-s), each rest angle (wound angles included) by 1 +- s, where
s = ln(1 + p) <= p.  A direction is a sign for each of these numbers; along it a state is followed as a curve of
equilibria, through contacts that close and leave, to the p at which it ceases to be a minimum.  The worst direction is
looked for by descent over the signs, from those that move the state fastest and from random ones, and from random
springs that lose a state: the number is exact along the direction that is named, and an upper bound of what
all directions allow.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from origami_nlp.continuation import (
    RANGE,
    BifurcationDiagram,
    BranchSegment,
    EquilibriumCurve,
    ParameterLine,
    Tally,
)
from origami_nlp.kkt import State, classify
from origami_nlp.minima import full_scene
from origami_nlp.numerics import SETTLED
from origami_nlp.pattern import Scene
from origami_nlp.problem import Model, Parameters

MOST = 0.5
"""Largest tolerance that is looked at."""
DRAWS = 8
"""Random directions that the descent over signs begins with."""
FOLLOWS = 120
"""Curves that are followed for one state."""
ENDED = 1e-3
"""Share of itself to which the size of errors that a state survives is bisected."""
HALVINGS = 4
"""Of a range, at whose ends a singular state is looked at."""
MOVES = "moves"
AGAIN = 3
"""Rounds of random springs: where a state is lost in one, its worst direction is looked for again from there."""


@dataclass(frozen=True)
class Loss:
    """Where a state is lost.

    Attributes
    ----------
    state
        Its name.
    percent
        How far each stiffness and rest angle is off then [%], or 50 where it is not lost that far.
    event
        What happens: ``fold``, ``nonsmooth-fold``, ...; ``kept``; ``singular`` where it can be followed no
        further, which need not be its end; ``moves`` where a state at which closure loses rank (flat, flat-folded) is
        last certified in its place (to 1e-3 of it): no curve of equilibria leads on, a minimum may stand beside it.
    stiffness, rest_angles
        The direction: a sign for each crease, or a number between them where random springs were worst, shape [N].
    fold_angles
        Of the state where it is lost, shape [N] [rad]; or as far as it was followed.
    """

    state: str
    percent: float
    event: str
    stiffness: tuple[float, ...]
    rest_angles: tuple[float, ...]
    fold_angles: tuple[float, ...] = ()

    def scene(self, design: Scene, percent: float) -> Scene:
        """Return a design with springs that are off by so much [%] in this direction."""
        s = math.log1p(percent / 100.0)
        k = np.array(design.stiffness) * np.exp(s * np.array(self.stiffness))
        wound = np.array(design.wound_angles) * (1.0 + s * np.array(self.rest_angles))
        rest = np.clip(wound, -math.pi, math.pi)
        preload = tuple((k * (wound - rest)).tolist()) if np.any(wound != rest) else ()
        return replace(
            full_scene(design), stiffness=tuple(k), rest_angles=tuple(rest), preload=preload
        )


@dataclass(frozen=True)
class Tolerance:
    """How far the springs of a design may be off.

    Attributes
    ----------
    losses
        Of each state along its worst direction.
    trials, kept
        Random springs within `percent` that were tried last, and in how many of them all states were still minima.
    """

    losses: tuple[Loss, ...]
    trials: int = 0
    kept: int = 0

    @property
    def percent(self) -> float:
        """Smallest of all states [%]."""
        return min(loss.percent for loss in self.losses)


def line_of(scene: Scene, stiffness: np.ndarray, rest: np.ndarray) -> ParameterLine:
    """Return the line of problems over s = ln(1 + p), without symmetry.

    Parameters
    ----------
    scene
        The design.
    stiffness, rest
        A sign for each crease, shape [N].
    """
    model = Model(full_scene(scene))
    p = model.parameters
    still = np.zeros_like(p.load)
    direction = Parameters(np.zeros_like(p.sectors), stiffness, rest * p.rest, still)
    return ParameterLine(model, p, direction)


class LostAt(NamedTuple):
    """Where a minimum ceases to be one: s, what happens there, and the state [N]."""

    s: float
    event: str
    state: np.ndarray


def lost_at(line: ParameterLine, start: np.ndarray, most: float) -> LostAt:
    """Follow a minimum `start` [N] to where it ceases to be one, at most to s = `most`; the event is ``kept`` there."""
    if not State(line.at(0.0), start).regular:
        return _in_place(line, start, most)
    web = BifurcationDiagram(line, 0.0, most, through_folds=False)
    if not web.add(start, 0.0, "minimum"):
        return LostAt(0.0, "singular", start)
    node, s = 0, 0.0
    for _ in range(len(web.arcs) + 1):
        ahead = [
            (a.high, k)
            for k, a in enumerate(web.arcs)
            # arcs of minima that lead on from here to larger s
            if a.index == 0 and node in (a.start, a.end) and a.low >= s - SETTLED and a.high > s
        ]
        if not ahead:
            break
        arc = web.arcs[max(ahead)[1]]
        node, s = arc.end if arc.frames[-1].s >= arc.frames[0].s else arc.start, arc.high
        if s > most:  # one step led over the end of the range and back, around a fold
            x = _on(arc, most, web.tally)
            return LostAt(most, "kept", x) if x is not None else LostAt(arc.low, "singular", start)
        if web.nodes[node].type == RANGE:
            return LostAt(most, "kept", web.nodes[node].point[:-1])
    return LostAt(s, web.nodes[node].type, web.nodes[node].point[:-1])


def _in_place(line: ParameterLine, start: np.ndarray, most: float) -> LostAt:
    """Return until when a singular state [N] is certainly a minimum without moving: no curve leads through it."""

    def stays(s: float) -> bool:
        return classify(State(line.at(s), start)).verdict == "minimum"

    low, high = 0.0, most
    for s in (SETTLED, *(most / 2**k for k in range(HALVINGS, -1, -1))):
        if s <= most and not stays(s):
            high = s
            break
        low = min(s, most)
    if low >= most:
        return LostAt(most, "kept", start)
    while high - low > max(SETTLED, ENDED * high):
        middle = 0.5 * (low + high)
        # invariant: certainly a minimum at `low`, not certainly at `high`
        low, high = (middle, high) if stays(middle) else (low, middle)
    return LostAt(low, MOVES, start)


def _on(arc: BranchSegment, s: float, tally: Tally) -> np.ndarray | None:
    """Return the state [n] of an arc at s, found along its length: next to a fold Newton at s may take another."""
    for a, b in itertools.pairwise(arc.frames):
        if min(a.s, b.s) <= s <= max(a.s, b.s):
            frame = EquilibriumCurve(a.system.line, a.hold, tally).between(a, b, s)
            return None if frame is None else frame.state
    return None


def tolerance_of(
    scene: Scene,
    states: dict[str, np.ndarray],
    *,
    seed: int = 0,
    trials: int = 0,
    draws: int = DRAWS,
) -> Tolerance:
    """Find how far the springs of a scene may be off before one of its states is gone.

    Parameters
    ----------
    scene
        The design.
    states
        Fold angles of its minima by name, shape [N].
    seed
        Of the directions.
    trials
        Random springs that are tried within the tolerance that was found; where a state is lost in some, it is less.
    draws
        Random directions that the descent begins with.

    Returns
    -------
    Tolerance
        With the worst direction found for each state.
    """
    rng = np.random.default_rng(seed)
    losses = {name: _worst(scene, name, phi, rng, draws) for name, phi in states.items()}
    kept = tried = 0
    for _ in range(AGAIN if trials else 0):
        percent = min(loss.percent for loss in losses.values())
        if percent <= 100.0 * SETTLED:
            break
        # random springs that are off by as much: where a state is lost sooner, that way is looked along
        lost = [_drawn_loss(scene, states, percent, rng) for _ in range(trials)]
        tried, kept = trials, sum(one is None for one in lost)
        worse = [one for one in lost if one is not None]
        if not worse:
            break
        for one in worse:
            if one.percent < losses[one.state].percent:
                losses[one.state] = one
        first = min(worse, key=lambda one: one.percent)
        again = _worst(scene, first.state, states[first.state], rng, 0, losses[first.state])
        losses[first.state] = again
    return Tolerance(tuple(losses.values()), tried, kept)


def _worst(
    scene: Scene,
    name: str,
    phi: np.ndarray,
    rng: np.random.Generator,
    draws: int,
    known_loss: Loss | None = None,
) -> Loss:
    """Search over the signs: from the worst of some, flips of one as long as one is worse.

    The first are those that move the state fastest, or take most from a contact's moment (`_fastest`); others random.
    """
    n = scene.degree
    known: dict[tuple[float, ...], LostAt] = {}

    def look(signs: np.ndarray, most: float) -> float:
        key = tuple(signs.tolist())
        if key not in known and len(known) < FOLLOWS:
            known[key] = lost_at(line_of(scene, signs[:n], signs[n:]), phi, most)
        return known[key].s if key in known else math.inf

    most = math.log1p(MOST)
    best, end = np.ones(2 * n), LostAt(most, "kept", phi)
    starts = [*_fastest(scene, phi), *rng.choice([-1.0, 1.0], size=(draws, 2 * n))]
    if known_loss is not None:
        best = np.array([*known_loss.stiffness, *known_loss.rest_angles])
        most = math.log1p(known_loss.percent / 100.0)
        end = LostAt(most, known_loss.event, np.array(known_loss.fold_angles))
        starts = [np.where(best < 0, -1.0, 1.0)]
    for signs in starts:
        if most <= SETTLED:
            break
        found = look(signs, most)
        if found < most:
            best, most = signs, found
    # coordinate descent over the corners of a cube, in random order: a local worst
    better = most > SETTLED
    while better:
        better = False
        for k, side in itertools.product(rng.permutation(2 * n), (-1.0, 1.0)):
            signs = best.copy()
            signs[k] = side
            if side == best[k]:
                continue
            found = look(signs, most)
            if found < most - SETTLED:
                best, most, better = signs, found, True
    end = known.get(tuple(best.tolist()), end)
    k, rest = np.split(best, 2)
    return Loss(name, 100.0 * math.expm1(most), end.event, tuple(k), tuple(rest), tuple(end.state))


def _fastest(scene: Scene, phi: np.ndarray) -> list[np.ndarray]:
    """Signs [2 N] that to first order move a state fastest along its soft modes, or take a contact's moment away.

    The torque of a crease changes by k (phi - rest) ds for its stiffness, by -k rest ds for its rest angle; what that
    does to the state and to the moments of its contacts is linear (`Stratum.response`).
    """
    model = Model(full_scene(scene))
    state = State(model, model.reduce(phi))
    held = state.on(state.pieces[0])
    if not held.tangent.shape[1] and not held.contacts:
        return []
    try:
        forces, states = held.response()
        _, modes = np.linalg.eigh(held.tangent.T @ held.hessian @ held.tangent)
    except np.linalg.LinAlgError:
        return []
    k, wound = np.array(scene.stiffness), np.array(scene.wound_angles)
    # d(torque) = k (phi - phi0) ds for the stiffness e^s k, -k phi0 ds for the rest angle (1 + s) phi0
    change = np.hstack([np.diag(k * (phi - wound)), np.diag(-k * wound)]) / model.root[:, None]
    # a load is the negative of a torque: dx = -(response) d(torque)
    moved = -(modes.T @ held.tangent.T @ states @ change)
    rows = [*moved, *-moved, *(forces @ change)]
    return [np.where(row < 0, -1.0, 1.0) for row in rows]


def _drawn_loss(
    scene: Scene, states: dict[str, np.ndarray], percent: float, rng: np.random.Generator
) -> Loss | None:
    """Try one random change of all springs, at most the tolerance in any of them; the state that is lost, if any."""
    n = scene.degree
    off = rng.uniform(-1.0, 1.0, 2 * n)
    size = float(np.abs(off).max())
    most = size * math.log1p(0.99 * percent / 100.0)
    line = line_of(scene, off[:n] / size, off[n:] / size)
    for name, phi in states.items():
        end = lost_at(line, phi, most)
        if end.event != "kept":
            k, rest = np.split(off / size, 2)
            percent = 100.0 * math.expm1(end.s)
            return Loss(name, percent, end.event, tuple(k), tuple(rest), tuple(end.state))
    return None
