"""Judges a state of a sheet: does it close, do facets cross, is it a minimum.

A minimum is certified by second-order sufficient conditions: torque = J'lam + A'mu with moments and forces mu >= 0 of
contacts, A the slopes of fold limits and gaps, and d'H(lam, mu)d > 0 for every d != 0 with J d = 0 that leaves loaded
contacts closed, where H has the curvature of closure and that of the gaps.  Directions in which closed states leave
a state lie in the kernel of J whatever its rank, and the conditions ask for some multipliers, not for unique ones: they
are sufficient whether or not rows of closure depend on each other.  Positivity on the kernel is shown by
H + rho J'J > 0 (Finsler), so that no rank is decided either.

At a flat state the set of closed states is its own mirror image (turn the sheet over: phi becomes -phi), so that with
every direction d it contains -d to first order: flat is a minimum only where the torque is orthogonal to all of them.
Where the torque is balanced by closure to first order it always is one: axes of creases lie in the sheet, their
products are normal to it, and the multipliers, which lie in it, add no curvature to that of the springs.  Where
the torque is orthogonal to the cone alone, the ways out are looked at one by one (`level_curvature`).
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from origami_nlp.facets import DEEP, MOST_DENSE, Faces, Lying, Sheet, order_layers
from origami_nlp.numerics import BESIDE, CLOSES, STATIONARY, nonnegative_least_squares
from origami_nlp.sheets.contacts import (
    Balance,
    balance,
    closed_choices,
    closed_contacts,
    joined_contacts,
    told_contacts,
)
from origami_nlp.sheets.curvature import lowest_curvature
from origami_nlp.sheets.descent import AT_LIMIT
from origami_nlp.sheets.lower import NEAREST, lower_state
from origami_nlp.sheets.pieces import MOST_PIECES, Piece, Pieces, judge_piece, judge_pieces
from origami_nlp.sheets.rows import LOADED, Rows, polish
from origami_nlp.sheets.sharp import level_curvature, list_ways, slopes
from origami_nlp.sheets.state import SheetState, Verdict

SHARP: dict[str, Any] = {
    "verdict": "minimum",
    "kind": "degenerate",
    "eigenvalue": math.inf,
    "certificate": "strict minimum: energy rises to first order along every way out, though closure loses rank and "
    "no moments balance it",
}


def judge(sheet: Sheet, phi: np.ndarray, contact: bool = True) -> SheetState:
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
    SheetState
        With the verdict and what it rests on.
    """
    state = _judged(sheet, phi, contact)
    return replace(state, softest=state.eigenvalue * sheet.scale)


def _judged(sheet: Sheet, phi: np.ndarray, contact: bool) -> SheetState:
    """Judge a state, see `judge`."""
    phi = np.asarray(phi, float)
    shut = np.clip(phi, -math.pi, math.pi)
    if np.abs(phi - shut).max(initial=0.0) <= CLOSES:  # as exactly as states close
        phi = shut
    residual = sheet.residual(phi)
    energy = float(sheet.pattern.energy(phi))
    blank = SheetState(
        phi, energy, "no state", None, -1, residual, math.nan, math.nan, (), (), ""
    )  # fmt: skip
    if not residual <= CLOSES:
        return replace(blank, certificate=f"does not close: {residual:.1e}")
    if not sheet.closure.on_sheet(phi):
        return replace(blank, certificate="closes on the other sheet, q = -1, round a vertex")
    if np.abs(phi).max(initial=0.0) > math.pi:
        return replace(blank, certificate="a fold angle is beyond pi")
    blank = replace(blank, freedoms=sheet.size - sheet.rank(phi))
    crossings = tuple(sheet.crossings.find(phi)) if contact else ()
    if crossings:
        many = f"{len(crossings)} pairs of facets pass" if len(crossings) > 1 else "two facets pass"
        return replace(
            blank, verdict="crosses", crossings=crossings, certificate=f"{many} through each other"
        )
    judged = _flat(sheet, blank, contact) if not phi.any() else _mechanics(sheet, blank, contact)
    # lower states as well: what closes to rounding may be further off the curve than they are away
    if judged.verdict in ("minimum", "not a minimum") and singular_beside(sheet, phi) is not None:
        why = f"not decided: within {NEAREST:g} rad of a state where closure loses rank, and not told from it"
        return replace(judged, verdict="undecided", kind=None, certificate=why)
    if judged.verdict != "minimum" or not contact:
        return judged
    layers = order_layers(sheet, phi)
    if layers.verdict == "ordered":
        if layers.pairs <= int((np.abs(phi) > 0.5 * math.pi).sum()):  # at most those that are shut
            return judged
        reach = Faces(sheet, phi).reach()
        if reach >= -DEEP:
            return judged
        why = f"not decided: facets face to face reach into each other by {-reach:.1e} of the sheet's size"
        return replace(judged, verdict="undecided", kind=None, certificate=why)
    verdict: Verdict = "crosses" if layers.verdict == "crosses" else "undecided"
    return replace(judged, verdict=verdict, kind=None, certificate=layers.reason)


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
    if np.abs(near - phi).max(initial=0.0) <= AT_LIMIT:
        return None
    near, residual = sheet.project(near, shut | flat)
    lost = residual <= CLOSES and np.abs(near - phi).max() < BESIDE
    return near if lost and sheet.rank(near) < sheet.rank(phi, CLOSES) else None


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
    limits = np.flatnonzero(np.abs(np.abs(phi) - math.pi) <= AT_LIMIT)
    better = polish(sheet, phi, Rows.at(sheet, phi, limits, ()), np.ones(len(limits)))
    return None if better is None or np.abs(better - phi).max() >= BESIDE else better


def _flat(sheet: Sheet, blank: SheetState, contact: bool) -> SheetState:
    """Judge the flat state, by what the head of this file says of it."""
    phi = blank.fold_angles
    torque = sheet.torque(phi)
    free = sheet.along(phi, torque)
    missing = float(np.abs(free).max() / max(float(np.abs(torque).max()), 1e-300))
    blank = replace(blank, kkt_residual=missing)
    if missing <= STATIONARY or not torque.any():
        return replace(
            blank,
            verdict="minimum",
            kind="interior",
            eigenvalue=float(lowest_curvature(sheet, phi, np.diag(sheet.stiffness))),
            certificate="flat, its springs balanced by closure: strict minimum, curvature of the springs",
        )
    out = list_ways(sheet, phi)
    if slopes(sheet, phi, out)[0]:
        why = "flat and alone: no way leads out of it, strict minimum"
        return replace(
            blank, verdict="minimum", kind="interior", eigenvalue=math.inf, certificate=why
        )
    curved = level_curvature(sheet, out)
    if curved is not None:
        why = f"flat: the energy is level along each of {len(out.lines)} ways out and curves up: strict minimum"
        return replace(
            blank, verdict="minimum", kind="degenerate", eigenvalue=curved, certificate=why
        )
    drawn = np.random.default_rng(0).normal(size=(10, sheet.size))
    ways = [
        -free,
        *out.lines,
        *(b[:, k] for b in out.families for k in range(b.shape[1])),
        *drawn,
    ]
    # states come in pairs, phi and -phi: one of them is lower wherever the torque is not orthogonal
    if any(
        lower_state(sheet, phi, sign * way, None, contact) is not None
        for way in ways
        for sign in (1.0, -1.0)
    ):
        why = "flat: springs pull along folding, and with every way the opposite way is open"
        return replace(blank, verdict="not a minimum", certificate=why)
    return replace(
        blank,
        verdict="undecided",
        certificate="not decided: flat, springs pull to first order, no lower state found beside it",
    )


def _mechanics(sheet: Sheet, blank: SheetState, contact: bool) -> SheetState:
    """Judge stationarity and curvature of a closed state."""
    phi = blank.fold_angles
    touching = contact and sheet.size <= MOST_DENSE
    rows = closed_contacts(sheet, phi, touching)
    z = sheet.kernel(phi) if sheet.size <= MOST_DENSE else None
    found = (
        _by_limits(sheet, phi, rows)
        if z is None or not len(rows.gaps)
        else balance(sheet, phi, rows, z)
    )
    if rows.gaps.min(initial=0.0) < -10 * CLOSES:
        why = f"not decided: facets reach into each other by {-rows.gaps.min():.1e} of the sheet's size"
        return replace(blank, verdict="undecided", certificate=why)
    piece = judge_piece(sheet, phi, rows, found)
    pieces = Pieces([piece], count=1)
    if piece.proved:
        return _told(sheet, blank, pieces)
    ways = None if piece.balanced else list_ways(sheet, phi)
    if touching:
        assert z is not None
        faces, meeting = Faces(sheet, phi), closed_choices(sheet, phi)
        if faces.reach() < -10 * CLOSES:
            why = f"not decided: facets face to face reach into each other by {-faces.reach():.1e} of the sheet's size"
            return replace(blank, verdict="undecided", certificate=why)
        pieces = judge_pieces(sheet, phi, rows, meeting, z, faces, ways)
        return _told(sheet, blank, pieces, faces.reason)
    rises, falling = (False, []) if ways is None else slopes(sheet, phi, ways)
    if rises:
        contacts = told_contacts(sheet, rows, found)
        return replace(blank, kkt_residual=piece.missing, contacts=contacts, **SHARP)
    found_ways = (lower_state(sheet, phi, w, rows, contact) for w in (*piece.ways, *falling))
    down = next((new for new in found_ways if new is not None), None)
    return _told(sheet, blank, Pieces([], piece, down, 1))


def _told(sheet: Sheet, blank: SheetState, pieces: Pieces, unknown: str = "") -> SheetState:
    """Say what was found on the pieces."""
    at = pieces.left or pieces.proved[0]
    blank = replace(blank, kkt_residual=at.missing, eigenvalue=at.lowest)
    blank = replace(blank, contacts=told_contacts(sheet, at.rows, at.balance))
    if pieces.left is None:
        return replace(blank, **_of_minimum(sheet, blank.fold_angles, pieces.proved))
    where = f" on piece {pieces.count} of what meets" if pieces.count > 1 else ""
    if pieces.lower is not None:
        why = f"lower states beside it: curvature {at.lowest:.3g}"
        why = why if at.balanced else "torque along a free motion"
        return replace(blank, verdict="not a minimum", certificate=why + where)
    if pieces.count >= MOST_PIECES:
        why = f"not decided: facets meet at borders or face to face, in more than {MOST_PIECES} pieces"
    elif not at.balanced:
        why = (
            f"not decided: torque of {at.missing:.1e} is left{where}, but no lower state was found"
        )
    elif at.lowest > 0:
        why = f"not decided: facets face to face push at borders alone{where}, where they may slide off"
    else:
        why = f"not decided: curvature {at.lowest:.3g} along a free motion{where} proves nothing"
    why += f"; {unknown}" if unknown else ""
    return replace(blank, verdict="undecided", certificate=why)


def _of_minimum(sheet: Sheet, phi: np.ndarray, proved: list[Piece]) -> dict[str, Any]:
    """Return kind, certificate, contacts and residuals of a minimum, from the pieces on which it is one."""
    residual = max(p.missing for p in proved)
    if sharp := [p for p in proved if p.sharp]:
        pairs = {t.facets for p in sharp for t in p.rows.touches if isinstance(t, Lying)}
        apart = ", ".join(f"{a + 1}|{b + 1}" for a, b in sorted(map(sorted, pairs)))
        why = SHARP["certificate"] + (
            f"; with layers of facets {apart} kept apart" if pairs else ""
        )
        held = sharp[0].rows.only(np.arange(len(sharp[0].rows.gaps)) < len(sharp[0].rows.limits))
        told = told_contacts(sheet, held, balance(sheet, phi, held, sheet.kernel(phi)))
        return {**SHARP, "certificate": why, "kkt_residual": residual, "contacts": told}
    most = np.concatenate([p.most for p in proved])
    every = bool((most > LOADED).all())
    kind = "interior" if not len(most) else "contact-pinned" if every else "contact-touching"
    lowest = min(p.lowest for p in proved)
    what = f"curvature {lowest:.3g}" if math.isfinite(lowest) else "nothing is left free"
    many = f" on each of {len(proved)} pieces" if len(proved) > 1 else ""
    why = f"strict minimum{many}: torque balanced, {what} along what loaded contacts leave free"
    return {
        "verdict": "minimum",
        "kind": kind,
        "certificate": why,
        "eigenvalue": lowest,
        "kkt_residual": residual,
        "contacts": joined_contacts([told_contacts(sheet, p.rows, p.balance) for p in proved]),
    }


def _by_limits(sheet: Sheet, phi: np.ndarray, rows: Rows) -> Balance:
    """Balance the springs of a sheet without contacts, or of one too large for a kernel, by its fold limits."""
    _, moments, left = sheet.multipliers(phi, rows.limits)
    if (
        len(moments) and moments.min() <= -LOADED
    ):  # rows may depend on limits: look for moments that push
        moments = nonnegative_least_squares(rows.slopes.T, sheet.torque(phi))
        left = sheet.along(phi, sheet.torque(phi) - rows.slopes.T @ moments)
    moments = np.maximum(moments, 0.0)
    return Balance(moments, left, np.eye(len(moments)), np.ones(len(moments)))
