"""Judges a state of a pattern, by the kernel (`kkt.classify`): does it close, do facets cross, is it a minimum."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from origami_nlp.facets import MOST_DENSE, Sheet
from origami_nlp.kkt import Classification, State, classify, newton
from origami_nlp.minima import JudgedState
from origami_nlp.numerics import ANSWERED, BESIDE, CLOSES, NONZERO, OUTSIDE, STATIONARY
from origami_nlp.programme import fold_limit

NEAREST = 1e-5
"""Distance [rad] at which a state is told from a singular one: anything closes there to the square of its distance,
a hundred times `CLOSES`."""


def judge(sheet: Sheet, phi: np.ndarray, contact: bool = True) -> JudgedState:
    """Judge a state.

    Parameters
    ----------
    sheet
        The programme.
    phi
        Fold angles [rad], [n]; those beyond pi by less than closure can tell are at pi.
    contact
        Whether facets must not cross; without, only fold limits count.

    Returns
    -------
    JudgedState
        With the verdict and what it rests on.
    """
    phi = np.asarray(phi, float)
    shut = np.clip(phi, -math.pi, math.pi)
    if np.abs(phi - shut).max(initial=0.0) <= CLOSES:  # as exactly as states close
        phi = shut
    sheet = sheet.with_contact(contact)
    residual = sheet.residual(phi)
    energy, angles = float(sheet.pattern.energy(phi)), tuple(phi.tolist())
    why = ""
    if not residual <= CLOSES:
        why = f"does not close: {residual:.1e}"
    elif not sheet.closure.on_sheet(phi):
        why = "closes on the other sheet, q = -1, round a vertex"
    elif np.abs(phi).max(initial=0.0) > math.pi:
        why = "a fold angle is beyond pi"
    if why:
        return JudgedState(energy, angles, "not admissible", why, closure_residual=residual)
    what = classified(sheet, phi)
    missing = what.stationarity
    if math.isnan(missing):
        missing = float(np.abs(sheet.along(phi, sheet.torque(phi))).max(initial=0.0))
    largest = max(float(np.abs(sheet.torque(phi)).max(initial=0.0)), NONZERO)
    crossed = sheet.crossed(phi) if what.verdict == "not admissible" else ()
    state = JudgedState(
        energy,
        angles,
        what.verdict,
        what.reason,
        what.kind or "",
        what.local_dimension,
        freedoms=sheet.size - sheet.rank(phi),
        closure_residual=residual,
        kkt_residual=missing / largest,
        # the numbers of their gaps are those of this programme alone
        contacts=tuple(replace(c, contact=None) for c in what.contacts),
        hessian_eigenvalues=what.eigenvalues,
        crossings=tuple((a + 1, b + 1) for a, b in crossed),
        softest_mode=() if what.mode is None else tuple(what.mode.tolist()),
    )
    # lower states as well: what closes to rounding may be further off the curve than they are away
    if (state.verdict == "minimum" or state.refuted) and singular_beside(sheet, phi) is not None:
        why = f"not decided: within {NEAREST:g} rad of a state where closure loses rank, and not told from it"
        return replace(state, verdict="undecided", kind="", certificate=why)
    return state


def classified(sheet: Sheet, phi: np.ndarray) -> Classification:
    """Return what the kernel decides on a closed state; kept, as a descent asks before its end is judged."""
    what: Classification = sheet.kept("classified", phi, lambda: classify(State(sheet, phi)))
    return what


def singular_beside(sheet: Sheet, phi: np.ndarray) -> np.ndarray | None:
    """Return the state at which creases are flat or shut that all but are, if closure loses rank there.

    Beside such a state whatever obeys closure to first order closes to the square of the distance: to rounding.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state, [n] [rad].

    Returns
    -------
    numpy.ndarray or None
        That state, [n]; None where there is none, or it is this one.

    Examples
    --------
    >>> import math, numpy as np, origami_nlp as o
    >>> from origami_nlp.facets import Sheet
    >>> from origami_nlp.sheets import singular_beside
    >>> sheet = Sheet(o.examples.pattern("miura", 2, 2))
    >>> singular_beside(sheet, np.zeros(4)) is None, singular_beside(sheet, np.full(4, 1e-13)) is None
    (True, True)
    """
    shut, flat = math.pi - np.abs(phi) < NEAREST, np.abs(phi) < NEAREST
    near = np.where(shut, np.copysign(math.pi, phi), np.where(flat, 0.0, phi))
    if np.abs(near - phi).max(initial=0.0) <= OUTSIDE:
        return None
    near, residual = sheet.project(near, shut | flat)
    lost = residual <= CLOSES and np.abs(near - phi).max() < BESIDE
    return near if lost and sheet.rank(near) < sheet.rank(phi, CLOSES) else None


def judge_end(sheet: Sheet, phi: np.ndarray, contact: bool = True) -> JudgedState:
    """Judge the end of a descent, as `judge`; where torque is left, or closing leaves it loose, the state beside it."""
    state = judge(sheet, phi, contact)
    better = beside(sheet, state)
    return state if better is None else judge(sheet, better, contact)


def beside(sheet: Sheet, state: JudgedState) -> np.ndarray | None:
    """Return the stationary state beside one that leaves some torque or closes loosely, [n]; None: there is none."""
    left = state.kkt_residual > STATIONARY
    if state.refuted:
        left &= state.kkt_residual < ANSWERED
    elif state.verdict in ("minimum", "undecided"):
        left |= sheet.loose(state.phi)
    else:
        return None
    return stationary_beside(sheet, state.phi) if left else None


def stationary_beside(sheet: Sheet, phi: np.ndarray) -> np.ndarray | None:
    """Solve for the stationary state beside a closed one, creases that are shut kept so.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state, [n] [rad].

    Returns
    -------
    numpy.ndarray or None
        The state, [n]; None where it is far, or the sheet has more than `MOST_DENSE` creases.
    """
    if sheet.size > MOST_DENSE:
        return None
    shut = np.flatnonzero(np.abs(np.abs(phi) - math.pi) <= OUTSIDE)
    better, _ = newton(sheet, phi, tuple(fold_limit(int(v), phi[v]) for v in shut))
    return None if better is None or np.abs(better.x - phi).max() >= BESIDE else better.x
