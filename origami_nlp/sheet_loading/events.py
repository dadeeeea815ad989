"""Events between two equilibria of a sheet over a load, each located in its own function.

fold            dT/ds = 0 along the curve: the load turns back
branching       an eigenvalue of the reduced Hessian is zero, and the load does not turn
closes, leaves  a crease comes to its fold limit, or the moment of one that is held there is zero
touches         two facets come to touch: the curve of states of paper ends, contact of facets is not solved here

Where a crease that closes or leaves turns the load back, a minimum meets a saddle: `nonsmooth-fold`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.facets import INSIDE, Features, Placed, Touch
from origami_nlp.numerics import INDEPENDENT, OUTSIDE, SETTLED, STATIONARY, TOUCHES, bracketed_roots
from origami_nlp.sheet_loading.curve import LoadCurve, LoadedState

PULLS = -STATIONARY
"""A moment that is smaller, relative to the largest torque, pulls."""
REACH = 0.05
"""Features closer than this, over the sheet's size, may be those that meet."""
NARROW = 1e-4
"""Share of a step to which the first crossing of facets is bracketed."""
BISECTIONS = 24
"""Of a step at whose end no single event could be located."""
NEARLY = 1e-2
"""Creases this close to their limit are named where many shut at once [rad]."""
MOST_NAMED = 8
"""Creases that are named where many shut."""
TOUCHED = 1e-11
"""Gap of facets that touch, over the sheet's size, where it counts as located."""


@dataclass(frozen=True, eq=False)
class Found:
    """An event on a curve.

    Attributes
    ----------
    type
        As in the module, or ``range`` (the end of what is followed), or ``lost``.
    state
        Where, on the curve that comes there.
    value
        Of its own function there.
    contact
        In words, 1-based.
    creases
        Those that close or leave (0-based).
    why
        In words, where it is not located, or where nothing goes on.
    """

    type: str
    state: LoadedState
    value: float = 0.0
    contact: str = ""
    creases: tuple[int, ...] = ()
    why: str = ""

    @property
    def located(self) -> bool:
        """Whether its function and the equations vanish up to rounding."""
        return (
            not self.why
            and abs(self.value) <= STATIONARY
            and self.state.system.residual <= STATIONARY
        )


def words(creases: tuple[int, ...]) -> str:
    """Name creases at their fold limit."""
    if not creases:
        return ""
    numbers = ", ".join(str(i + 1) for i in creases[:MOST_NAMED])
    numbers += f", ... ({len(creases)})" if len(creases) > MOST_NAMED else ""
    return (
        f"crease {numbers} at its fold limit"
        if len(creases) == 1
        else f"creases {numbers} at their fold limits"
    )


def length(curve: LoadCurve, a: LoadedState, b: LoadedState) -> float:
    """Return the length of the step from a to b along the tangent at a."""
    return float(a.tangent @ (curve.root * (b.x - a.x)))


def root_between(
    curve: LoadCurve, a: LoadedState, b: LoadedState, value: Callable[[LoadedState], float]
) -> LoadedState | None:
    """Return the state between a and b at which a function changes sign, by regula falsi in the length."""
    known: dict[float, LoadedState | None] = {0.0: a}

    def at(h: np.ndarray) -> np.ndarray:
        key = float(h[0])
        if key not in known:
            known[key] = curve.beside(a, key)
        frame = known[key]
        return np.array([math.nan if frame is None else value(frame)])

    return known.get(float(bracketed_roots(at, [0.0], [length(curve, a, b)])[0]))


def inner_events(curve: LoadCurve, a: LoadedState, b: LoadedState) -> list[Found]:
    """Return the events inside a step that leave the creases held as they are, in order."""
    out: list[Found] = []
    pole = _pole(curve, a, b)
    if pole is not None:
        b = pole.state
        out.append(pole)
    turns = a.ahead * b.ahead < 0
    if turns:
        state = root_between(curve, a, b, lambda f: f.ahead)
        out.append(
            Found("lost", a, why="a fold was not found")
            if state is None
            else Found("fold", state, state.ahead)
        )
    # where the load turns, one eigenvalue passes zero that is the fold's own
    crossing = range(min(a.index, b.index), max(a.index, b.index))
    for k in crossing[1:] if turns else crossing:

        def eigenvalue(f: LoadedState, k: int = k) -> float:
            return float(f.system.eigenvalues[k])

        state = root_between(curve, a, b, eigenvalue)
        if state is None:
            out.append(Found("branching", a, why="by its neighbours: there the system is singular"))
        elif abs(eigenvalue(state)) > SETTLED * max(abs(eigenvalue(a)), abs(eigenvalue(b))):
            out.append(Found("lost", a, why="closure loses rank: an eigenvalue passes infinity"))
        else:
            out.append(Found("branching", state, eigenvalue(state)))
    return sorted(out, key=lambda e: length(curve, a, e.state))


def _pole(curve: LoadCurve, a: LoadedState, b: LoadedState) -> Found | None:
    """Return the last state before one at which closure loses rank, and multipliers pass infinity; None if they do not.

    Ways cross there, at the flat state for one: closure does not balance what pulls along another of them, and the
    curve on the other side is not where the sheet must go.
    """
    if float(a.system.multipliers @ b.system.multipliers) >= 0:
        return None
    low, high, last, grown = 0.0, length(curve, a, b), a, math.inf
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        here = curve.beside(a, middle)
        if here is not None:
            grown = float(np.abs(here.system.multipliers).max())
        if here is None or float(a.system.multipliers @ here.system.multipliers) <= 0:
            high = middle
        else:
            low, last = middle, here
    if grown <= max(float(np.abs(s.system.multipliers).max()) for s in (a, b)):
        return None  # they pass zero
    flat = curve.sheet.pattern.is_flat and float(np.abs(last.phi).max()) < NEARLY
    where = "the flat state" if flat else "creases are aligned"
    why = f"{where}: closure loses rank, ways cross, and the load pulls along another one"
    return Found("singular", last, math.nan, why=why)


def admissible(state: LoadedState) -> bool:
    """Tell whether fold angles are within their limits and held ones push."""
    inside = float(np.abs(state.phi).max(initial=0.0)) <= math.pi + OUTSIDE
    return inside and bool((state.system.forces >= PULLS * state.system.size).all())


def first_event(curve: LoadCurve, a: LoadedState, b: LoadedState, low: float, high: float) -> Found:
    """Return what ends a curve between a, which is followed, and b, which is not; low, high: range of T."""
    found: list[Found] = []
    end = low if b.x[-1] < low else high if b.x[-1] > high else None
    if end is not None:
        share = (end - a.x[-1]) / (b.x[-1] - a.x[-1])
        state = curve.where(a.x + share * (b.x - a.x), -1, end, a.tangent)
        found += [] if state is None else [Found("range", state)]
    found += _closings(curve, a, b)
    for k in np.flatnonzero(b.system.forces < PULLS * b.system.size):

        def force(f: LoadedState, k: int = int(k)) -> float:
            return float(f.system.forces[k])

        state = a if force(a) <= 0 else root_between(curve, a, b, force)
        if state is not None:
            size = state.system.size
            weak = np.abs(state.system.forces) <= INDEPENDENT * size
            creases = tuple(sorted({a.held[int(k)], *np.array(a.held)[weak].tolist()}))
            value = 0.0 if state is a else force(state) / size
            found.append(Found("leaves", state, value, words(creases), creases))
    if not found and not admissible(b):
        found = [_last_before(curve, a, b)]
    first = min(found, key=lambda e: length(curve, a, e.state), default=None)
    touched = _touch(curve, a, b if first is None else first.state)
    if touched is not None:
        return touched
    assert first is not None
    return first


def _closings(curve: LoadCurve, a: LoadedState, b: LoadedState) -> list[Found]:
    """Return where creases come to their limits between a and b, those that do so together as one."""
    out: list[tuple[float, LoadedState, int]] = []
    for i in np.flatnonzero(np.abs(b.phi) > math.pi + OUTSIDE).tolist():
        limit = math.copysign(math.pi, b.phi[i])
        share = (limit - a.phi[i]) / (b.phi[i] - a.phi[i])
        state = curve.where(a.x + share * (b.x - a.x), i, limit, a.tangent)
        if state is not None:
            out.append((length(curve, a, state), state, i))
    if not out:
        return []
    _, state, first = min(out, key=lambda found: found[0])
    together = [i for i in range(len(state.phi)) if math.pi - abs(state.phi[i]) <= TOUCHES]
    creases = tuple(sorted({first, *(i for i in together if i not in a.held)}))
    if len(creases) == 1:
        return [Found("closes", state, 0.0, words(creases), creases)]
    miss = float((np.abs(state.phi[list(creases)]) - math.pi).max())
    x = state.x.copy()
    x[list(creases)] = np.copysign(math.pi, x[list(creases)])
    return [Found("closes", replace(state, x=x), miss, words(creases), creases)]


def _last_before(curve: LoadCurve, a: LoadedState, b: LoadedState) -> Found:
    """Return the last state that Newton reaches before many creases shut at once."""
    low, high, last = 0.0, length(curve, a, b), a
    for _ in range(BISECTIONS):
        here = curve.beside(a, 0.5 * (low + high))
        if here is not None and admissible(here):
            low, last = 0.5 * (low + high), here
        else:
            high = 0.5 * (low + high)
    near = tuple(np.flatnonzero(math.pi - np.abs(last.phi) < NEARLY).tolist())
    why = (
        f"{words(near)}: closure loses rank where so many creases shut at once"
        if near
        else ("what ends the curve was not found")
    )
    return Found("singular", last, math.nan, words(near), near, why)


def _touch(curve: LoadCurve, a: LoadedState, b: LoadedState) -> Found | None:
    """Return where facets come to touch between a, where none cross, and b; None where none do there."""
    crossings = curve.sheet.crossings
    if not crossings.find(b.phi):
        return None

    low, high, pairs = 0.0, length(curve, a, b), crossings.find(b.phi)
    whole = high
    last = a
    while abs(high - low) > NARROW * abs(whole):
        middle = 0.5 * (low + high)
        here = curve.beside(a, middle)
        if here is None:
            break
        crossed = crossings.find(here.phi)
        if crossed:
            high, pairs = middle, crossed
        else:
            low, last = middle, here
    # a crossing is seen from a depth on: the touch is a little before
    first, beyond = curve.beside(a, max(0.0, 2 * low - high)), curve.beside(a, 2 * high - low)
    names = [f"facets {p + 1} and {q + 1} touch" for p, q in pairs]
    met = []
    if first is not None and beyond is not None:
        facing = Features(crossings).facing(Placed(crossings.poses, first.phi), REACH)
        touches = [t for t, _ in facing if (min(t.facets), max(t.facets)) in pairs]
        met = [found for t in touches if (found := _closed(curve, first, beyond, t))]
    if not met:
        why = "by bisection: which features meet is not told"
        return Found("touches", last, contact="; ".join(names[:2]), why=why)
    at, touch, gap = min(met, key=lambda m: length(curve, a, m[0]))
    i, j = sorted(touch.facets)
    contact = f"facets {i + 1} and {j + 1} touch, {touch.type}"
    miss = "" if abs(gap) <= TOUCHED else f"its gap is {gap:.1e} there"
    return Found("touches", at, 0.0 if miss else gap, contact, why=miss)


def _closed(
    curve: LoadCurve, first: LoadedState, last: LoadedState, touch: Touch
) -> tuple[LoadedState, Touch, float] | None:
    """Return where the gap of features closes, and the gap over the sheet's size there; None where it does not."""
    crossings = curve.sheet.crossings

    def gap(state: LoadedState) -> float:
        return touch.gap(Placed(crossings.poses, state.phi)) / crossings.size

    if not gap(last) < 0 < gap(first):
        return None
    state = root_between(curve, first, last, gap)
    if state is None:
        return None
    facing = Features(crossings).facing(Placed(crossings.poses, state.phi), NARROW, INSIDE)
    same = any(t.facets == touch.facets and t.corners == touch.corners for t, _ in facing)
    return (state, touch, gap(state)) if same else None
