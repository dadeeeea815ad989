"""What ends a curve of equilibria between two of them: the range, contacts that close or leave, facets that meet."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.numerics import INDEPENDENT, OUTSIDE, STATIONARY, TOUCHES
from origami_nlp.sheet_loading.curve import LoadCurve, LoadedState
from origami_nlp.sheet_loading.events import (
    BISECTIONS,
    NEARLY,
    PULLS,
    Found,
    admissible,
    length,
    root_between,
)
from origami_nlp.sheet_loading.held import Contact, creases_of, ordered, words
from origami_nlp.sheet_loading.touching import leaning, slid, sliding, touching


def first_event(curve: LoadCurve, a: LoadedState, b: LoadedState, low: float, high: float) -> Found:
    """Return what ends a curve between a, which is followed, and b, which is not; low, high: range of T."""
    found: list[Found] = []
    end = low if b.x[-1] < low else high if b.x[-1] > high else None
    if end is not None:
        share = (end - a.x[-1]) / (b.x[-1] - a.x[-1])
        state = curve.where(a.x + share * (b.x - a.x), -1, end, a.tangent)
        if (
            state is None
        ):  # where closure loses rank the load does not tell where, but the length does
            near = root_between(curve, a, b, lambda f: float(f.x[-1]) - end)
            good = near is not None and abs(near.x[-1] - end) <= STATIONARY * (1 + abs(end))
            state = near if good else None
        found += [] if state is None else [Found("range", state)]
    found += _closings(curve, a, b)
    found += [*_leavings(curve, a, b), *sliding(curve, a, b)]
    if not found and not _goes(curve, b):
        found = [_last_before(curve, a, b)]
    first = min(found, key=lambda e: length(curve, a, e.state), default=None)
    touched = touching(curve, a, b if first is None else first.state)
    if touched is not None:
        return touched
    return first or Found("lost", a, math.nan, why="what ends the curve was not found")


def _leavings(curve: LoadCurve, a: LoadedState, b: LoadedState) -> list[Found]:
    """Return where contacts that are held cease to push between a and b."""
    out = []
    for k in np.flatnonzero(b.system.forces < PULLS * b.system.size).tolist():

        def force(f: LoadedState, k: int = k) -> float:
            return float(f.system.forces[k])

        state = a if force(a) <= 0 else root_between(curve, a, b, force)
        if state is not None:
            size = state.system.size
            weak = np.flatnonzero(np.abs(state.system.forces) <= INDEPENDENT * size)
            contacts = ordered([a.held[k], *(a.held[j] for j in weak)])
            out.append(Found("leaves", state, force(state) / size, words(contacts), contacts))
    return out


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
    creases: tuple[Contact, ...] = ordered({first, *(i for i in together if i not in a.held)})
    if len(creases) == 1:
        return [Found("closes", state, 0.0, words(creases), creases)]
    shut = creases_of(creases)
    miss = float((np.abs(state.phi[shut]) - math.pi).max())
    x = state.x.copy()
    x[shut] = np.copysign(math.pi, x[shut])
    return [Found("closes", replace(state, x=x), miss, words(creases), creases)]


def _goes(curve: LoadCurve, state: LoadedState) -> bool:
    """Tell whether what is held pushes, and inside each other."""
    return admissible(state) and not slid(curve, state)


def _last_before(curve: LoadCurve, a: LoadedState, b: LoadedState) -> Found:
    """Return the last state that Newton reaches before closure, or gaps, lose rank."""
    low, high, last = 0.0, length(curve, a, b), a
    for _ in range(BISECTIONS):
        here = curve.beside(a, 0.5 * (low + high))
        if here is not None and _goes(curve, here):
            low, last = 0.5 * (low + high), here
        else:
            high = 0.5 * (low + high)
    near: tuple[Contact, ...] = tuple(np.flatnonzero(math.pi - np.abs(last.phi) < NEARLY).tolist())
    why = (
        f"{words(near)}: closure loses rank where so many creases shut at once"
        if near
        else leaning(curve, last) or "what ends the curve was not found"
    )
    return Found("singular", last, math.nan, words(near), near, why)
