"""States of a curve that facets in contact hold: ends of the stretches of it where no facets cross."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.numerics import CLOSES, STATIONARY
from origami_nlp.sheets.curve import Curve
from origami_nlp.sheets.judgement import LOADED, curvature
from origami_nlp.sheets.layers import order_layers
from origami_nlp.sheets.sheet import Sheet
from origami_nlp.sheets.state import SheetContact, SheetState
from origami_nlp.sheets.touches import Touch, find_touch

NARROW = 1e-5
"""Share of a step to which a change from free to crossing is bracketed."""


@dataclass(frozen=True, eq=False)
class Pinned:
    """A state at which a stretch of a curve free of crossings ends.

    Attributes
    ----------
    phi
        Fold angles [rad], [n].
    touches
        What meets there; empty where features could not be told.
    falls
        Whether the energy falls into the contact: only such a state can be a minimum.
    """

    phi: np.ndarray
    touches: tuple[Touch, ...]
    falls: bool


def find_pinned(sheet: Sheet, curve: Curve) -> list[Pinned]:
    """Find where facets come to touch along a curve.

    Parameters
    ----------
    sheet
        The programme.
    curve
        Of `follow_curve`.

    Returns
    -------
    list of Pinned
        In the order of the curve; contacts that open and close again between two of its states are not seen.
    """
    crosses = [bool(sheet.crossings.find(x)) for x in curve.phi]
    found = []
    for i in range(len(crosses) - 1):
        if crosses[i] == crosses[i + 1]:
            continue
        a, b = (i, i + 1) if not crosses[i] else (i + 1, i)
        found.append(_between(sheet, curve.phi[a], curve.phi[b]))
    return found


def _between(sheet: Sheet, apart: np.ndarray, crossed: np.ndarray) -> Pinned:
    """Find the touch between two neighbouring states."""

    def state(s: float) -> np.ndarray:
        return sheet.project(apart + s * (crossed - apart))[0]

    low, high = 0.0, 1.0
    while high - low > NARROW:
        middle = 0.5 * (low + high)
        if sheet.crossings.find(state(middle)):
            high = middle
        else:
            low = middle
    # a crossing is seen from a depth on: the touch is a little before
    low = max(low - NARROW, 0.0)
    touches = []
    for pair in sheet.crossings.find(state(high)):
        here = find_touch(sheet, pair, state, low, high)
        if here is not None:
            touches.append(here)
    if not touches:
        return Pinned(state(low), (), _falls(sheet, state(low), crossed - apart))
    first = min(s for s, _ in touches)
    phi = state(first)
    meeting = tuple(t for s, t in touches if abs(t.gap(sheet, phi)) < 1e-9 * sheet.crossings.size)
    return Pinned(phi, meeting, _falls(sheet, phi, crossed - apart))


def _falls(sheet: Sheet, phi: np.ndarray, way: np.ndarray) -> bool:
    return float(sheet.torque(phi) @ sheet.along(phi, way)) < 0


def judge_pinned(sheet: Sheet, pinned: Pinned) -> SheetState:
    """Judge a state that facets in contact hold.

    The gap of features that meet inside each other is positive wherever they do not cross nearby, so that closed
    states beside it lie where it is; with one pair pushing, that is enough for the sufficient conditions.

    Parameters
    ----------
    sheet
        The programme.
    pinned
        The state.

    Returns
    -------
    SheetState
        Judged.
    """
    phi = pinned.phi
    torque = sheet.torque(phi)
    largest = float(np.abs(torque).max())
    blank = SheetState(
        phi,
        float(sheet.pattern.energy(phi)),
        "undecided",
        None,
        sheet.size - sheet.rank(phi),
        sheet.residual(phi),
        math.nan,
        math.nan,
        (),
        tuple(sheet.crossings.find(phi)),
        "not decided: facets touch, and which features meet could not be told",
    )
    if blank.closure_residual > CLOSES or not pinned.touches:
        return blank
    best = blank
    for touch in pinned.touches:
        push = touch.gradient(sheet, phi)
        free, gone = sheet.along(phi, torque), sheet.along(phi, push)
        force = float(free @ gone) / max(float(gone @ gone), 1e-300)
        left = float(np.abs(free - force * gone).max()) / largest
        contact = SheetContact(touch.type, touch.facets, force * sheet.scale)
        here = replace(blank, kkt_residual=left, contacts=(contact,))
        if blank.crossings or force <= LOADED or left > 10 * STATIONARY:
            best = replace(here, certificate="not decided: the contact does not balance the torque")
            continue
        lam = sheet.normal(phi).multipliers(torque - force * push)
        lowest, _, proved = curvature(
            sheet, phi, sheet.hessian(phi, lam), np.zeros(0, int), push[None]
        )
        if proved and math.isinf(lowest) and np.abs(phi).max() < math.pi:
            layers = order_layers(sheet, phi)
            if layers.verdict != "ordered":
                return replace(here, certificate=layers.reason)
            return replace(
                here,
                verdict="minimum",
                kind="contact-pinned",
                eigenvalue=lowest,
                certificate="strict minimum: the torque presses touching facets, nothing else is left free",
            )
        best = replace(here, certificate="not decided: motions along the contact are left free")
    return best
