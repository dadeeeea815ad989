"""Where facets come to touch on a curve of equilibria, and where features that touch come to a border."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from origami_nlp.facets import INSIDE, MOST_DENSE, Placed, Touch
from origami_nlp.numerics import BESIDE, ROUNDED, SETTLED, STATIONARY
from origami_nlp.sheet_loading.curve import LoadCurve, LoadedState, System
from origami_nlp.sheet_loading.events import Found, admissible, length, root_between
from origami_nlp.sheet_loading.held import margin, ordered, touches_of, without, words
from origami_nlp.sheets import closed_contacts

REACH = 0.05
"""Features closer than this, over the sheet's size, may be those that meet."""
NARROW = 1e-4
"""Share of a step to which the first crossing of facets is bracketed."""
LATE = 1, 30
"""Lengths of that bracket before and after it between which gaps are looked at."""
MOST_BORDERS = 8
"""Pairs of facets that are named where they meet at borders."""


def slid(curve: LoadCurve, state: LoadedState) -> list[Touch]:
    """Return the features held that are no longer inside each other, by `INSIDE`."""
    touches = touches_of(state.held)
    if not touches:
        return []
    crossings = curve.sheet.crossings
    features, at = curve.sheet.features, Placed(crossings.poses, state.phi)
    return [t for t in touches if margin(features, t, at) <= INSIDE]


def leaning(curve: LoadCurve, state: LoadedState) -> str:
    """Say which features held are so close to a border that forces on them grow beyond bounds; empty if none are."""
    crossings = curve.sheet.crossings
    features, at = curve.sheet.features, Placed(crossings.poses, state.phi)
    close = [t for t in touches_of(state.held) if margin(features, t, at) <= BESIDE]
    return f"{words(close)}: close to a border, where the gap hardly moves" if close else ""


def sliding(curve: LoadCurve, a: LoadedState, b: LoadedState) -> list[Found]:
    """Return where features held come to a border between a, where they are inside each other, and b.

    Where nothing else happens between `INSIDE` and the border itself it is the border, and the event has its features:
    there facets slip off each other.  Otherwise it is the last state of which their gap tells.
    """
    crossings, out = curve.sheet.crossings, []
    features = curve.sheet.features
    for touch in slid(curve, b):

        def inside(state: LoadedState, least: float = 0.0, touch: Touch = touch) -> float:
            return margin(features, touch, Placed(crossings.poses, state.phi)) - least

        def told(state: LoadedState) -> float:
            return inside(state, INSIDE)

        near = a if told(a) <= 0.0 else root_between(curve, a, b, told)
        if near is None or abs(told(near)) > STATIONARY:
            continue
        named = f"{words([touch])}: to a border"
        found = Found("slides", near, told(near), named)
        for beyond in (b, curve.beside(a, 2 * length(curve, a, b))):
            if beyond is not None and inside(beyond) < 0.0:
                border = root_between(curve, near, beyond, inside)
                if border is not None and admissible(border) and abs(inside(border)) <= STATIONARY:
                    found = Found("slides", border, inside(border), named, (touch,))
                break
        out.append(found)
    return out


def touching(curve: LoadCurve, a: LoadedState, b: LoadedState) -> Found | None:
    """Return where facets come to touch between a, where none cross, and b; None where none do there."""
    crossings = curve.sheet.crossings
    pairs = crossings.find(b.phi)
    if not pairs:
        return None
    low, high, last = 0.0, length(curve, a, b), a
    whole = high
    while abs(high - low) > NARROW * abs(whole):
        middle = 0.5 * (low + high)
        here = curve.beside(a, middle)
        if here is None or (crossed := crossings.find(here.phi)):
            high, pairs = middle, pairs if here is None else crossed
        else:
            low, last = middle, here
    # a crossing is seen from a depth on, a little after the touch; before it where a side all but lies in the facet
    met: list[tuple[LoadedState, Touch]] = []
    features = curve.sheet.features
    for reach in LATE:
        room = reach * (high - low)
        first, beyond = curve.beside(a, max(0.0, low - room)), curve.beside(a, high + room)
        if first is None or beyond is None:
            break
        facing = [t for t, _ in features.facing(Placed(crossings.poses, first.phi), REACH)]
        new = without(facing, a.held)
        between = [t for t in touches_of(new) if any(features.between(t, p) for p in pairs)]
        met = [(s, t) for t in between if (s := _closed(curve, first, beyond, t)) is not None]
        if met:
            break
    if not met:
        return _at_borders(curve, last, pairs)
    return _meeting(curve, *min(met, key=lambda m: length(curve, a, m[0])))


def _at_borders(curve: LoadCurve, last: LoadedState, pairs: Sequence[tuple[int, int]]) -> Found:
    """Return the last state before facets cross, where no single gap tells where they meet."""
    names = "; ".join(f"facets {p + 1} and {q + 1} touch" for p, q in pairs[:MOST_BORDERS])
    why = "at borders or face to face, where no single gap keeps them apart: bracketed, not located"
    return Found("touches", last, contact=names, why=why)


def _meeting(curve: LoadCurve, state: LoadedState, touch: Touch) -> Found:
    """Return the event at which features meet, all that do so together as one."""
    crossings = curve.sheet.crossings
    if curve.sheet.size > MOST_DENSE:
        why = f"contact is followed up to {MOST_DENSE} creases"
        return Found("touches", state, 0.0, words([touch]), why=why)
    closed = closed_contacts(curve.sheet, state.phi).touches
    contacts = ordered(without(closed, state.held)) or (touch,)
    at = Placed(crossings.poses, state.phi)
    value = max((t.gap(at) / crossings.size for t in touches_of(contacts)), key=abs)
    miss = "" if abs(value) <= STATIONARY else f"a gap is {value:.1e} there"
    return Found("closes", state, value, words(contacts), contacts, miss)


def _closed(
    curve: LoadCurve, first: LoadedState, last: LoadedState, touch: Touch
) -> LoadedState | None:
    """Return where the gap of features closes, inside each other; None where it does not."""
    crossings = curve.sheet.crossings

    def gap(state: LoadedState) -> float:
        return touch.gap(Placed(crossings.poses, state.phi)) / crossings.size

    if not gap(last) < -ROUNDED < ROUNDED < gap(first):  # gaps that others keep closed are rounding
        return None
    near = root_between(curve, first, last, gap)
    if near is None:
        return None

    def shut(point: np.ndarray, system: System) -> tuple[np.ndarray, float]:
        at = Placed(crossings.poses, point[:-1])
        row = np.append(touch.row(at), 0.0) / crossings.size
        return row, -touch.gap(at) / crossings.size

    found = curve.solve(near.x, shut)
    polished = None if found is None else curve.frame_of(*found, near.tangent)
    if polished is not None and np.abs(polished.x - near.x).max() <= SETTLED:
        near = polished
    facing = curve.sheet.features.facing(Placed(crossings.poses, near.phi), NARROW, INSIDE)
    return near if touch.key in {t.key for t, _ in facing} else None
