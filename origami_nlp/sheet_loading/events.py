"""Events between two equilibria of a sheet over a load, each located in its own function.

fold            dT/ds = 0 along the curve: the load turns back
branching       an eigenvalue of the reduced Hessian is zero, and the load does not turn
closes, leaves  a crease comes to its fold limit, or features of facets come to touch (their gap is zero); the moment or
                force of one that is held is zero
touches         facets come to touch at borders or face to face, where no single gap keeps them apart: the curve ends
slides          features that touch come to a border, where their gap no longer keeps facets apart: they slip off each
                other, or the curve ends

Where a contact that closes or leaves turns the load back, a minimum meets a saddle: `nonsmooth-fold`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import OUTSIDE, SETTLED, STATIONARY, bracketed_roots
from origami_nlp.sheet_loading.curve import LoadCurve, LoadedState
from origami_nlp.sheet_loading.held import Contact

BISECTIONS = 24
"""Of a step at whose end no single event could be located."""
BEFORE = 0.999
"""Share of a step at which is looked at what its end does not tell."""
NEARLY = 1e-2
"""Creases this close to their limit are named where many shut at once [rad]."""

PULLS = -STATIONARY
"""A moment that is smaller, relative to the largest torque, pulls."""


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
    contacts
        Those that close or leave.
    why
        In words, where it is not located, or where nothing goes on.
    """

    type: str
    state: LoadedState
    value: float = 0.0
    contact: str = ""
    contacts: tuple[Contact, ...] = ()
    why: str = ""

    @property
    def located(self) -> bool:
        """Whether its function and the equations vanish up to rounding."""
        return (
            not self.why
            and abs(self.value) <= STATIONARY
            and self.state.system.residual <= STATIONARY
        )


def length(curve: LoadCurve, a: LoadedState, b: LoadedState) -> float:
    """Return the length of the step from a to b along the tangent at a."""
    return float(a.tangent @ (curve.root * (b.x - a.x)))


def admissible(state: LoadedState) -> bool:
    """Tell whether fold angles are within their limits and held ones push."""
    inside = float(np.abs(state.phi).max(initial=0.0)) <= math.pi + OUTSIDE
    return inside and bool((state.system.forces >= PULLS * state.system.size).all())


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
    """Return the events inside a step that leave what is held as it is, in order."""
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
    if len(a.eigenvalues) != len(
        b.eigenvalues
    ):  # closure loses rank at the end: what is free is not
        b = curve.beside(a, BEFORE * length(curve, a, b)) or a
    # where the load turns, one eigenvalue passes zero that is the fold's own
    crossing = range(min(a.index, b.index), max(a.index, b.index))
    for k in crossing[1:] if turns else crossing:

        def eigenvalue(f: LoadedState, k: int = k) -> float:
            return float(f.eigenvalues[k])

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
