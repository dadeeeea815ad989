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
products are normal to it, and the multipliers, which lie in it, add no curvature to that of the springs.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import ArpackNoConvergence, eigsh

from origami_nlp.facets import MOST_DENSE, Matrix, Sheet, dense, order_layers
from origami_nlp.numerics import CLOSES, CURVED, EPS, RANK, STATIONARY, nonnegative_least_squares
from origami_nlp.sheets.branches import list_branches
from origami_nlp.sheets.contacts import Balance, balance, closed_contacts, told_contacts
from origami_nlp.sheets.rows import LOADED, Rows, put_back
from origami_nlp.sheets.sharp import slopes
from origami_nlp.sheets.state import SheetState, Verdict

PENALTIES = 1e2, 1e4, 1e6, 1e8, 1e10, 1e12
"""Weights rho with which positivity on the kernel is tried."""
MOST_CHOICES = 20
"""Forces with which a certificate is tried, where they are not unique."""
UNSTRESSED = 1e-4
"""Torques over the mean stiffness [rad] below which residuals are not relative to them: all may be rounding."""
REACHES = 1e-1, 1e-2, 1e-3, 1e-4
"""Distances at which lower states are looked for [rad]."""

NEAREST = 1e-5
"""Distance of lower states at least [rad]: beside a singular state anything closes to the square of its distance, here
a hundred times `CLOSES`, so that states that are nearer may be none."""
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
        Fold angles [rad], [n].
    contact
        Whether facets must not cross; without, only fold limits count.

    Returns
    -------
    SheetState
        With the verdict and what it rests on.
    """
    phi = np.asarray(phi, float)
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
    if judged.verdict != "minimum" or not contact:
        return judged
    layers = order_layers(sheet, phi)
    if layers.verdict == "ordered":
        return judged
    verdict: Verdict = "crosses" if layers.verdict == "crosses" else "undecided"
    return replace(judged, verdict=verdict, kind=None, certificate=layers.reason)


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
            eigenvalue=float(_lowest(sheet, phi, np.diag(sheet.stiffness))),
            certificate="flat, its springs balanced by closure: strict minimum, curvature of the springs",
        )
    if slopes(sheet, phi)[0]:
        why = "flat and alone: no way leads out of it, strict minimum"
        return replace(
            blank, verdict="minimum", kind="interior", eigenvalue=math.inf, certificate=why
        )
    branches = list_branches(sheet.pattern)
    drawn = np.random.default_rng(0).normal(size=(10, sheet.size))
    ways = [
        -free,
        *branches.lines,
        *(b[:, k] for b in branches.families for k in range(b.shape[1])),
        *drawn,
    ]
    # states come in pairs, phi and -phi: one of them is lower wherever the torque is not orthogonal
    if any(_lower(sheet, phi, sign * way, None, contact) for way in ways for sign in (1.0, -1.0)):
        why = "flat: springs pull along folding, and with every way the opposite way is open"
        return replace(blank, verdict="not a minimum", certificate=why)
    return replace(
        blank,
        verdict="undecided",
        certificate="not decided: flat, springs pull to first order, no lower state found beside it",
    )


def _lowest(sheet: Sheet, phi: np.ndarray, hessian: Matrix) -> float:
    """Return the smallest curvature on the kernel of closure at a state; inf if there is none."""
    if sheet.size > MOST_DENSE:
        return _smallest(hessian, sheet.closure.jacobian(phi), np.arange(sheet.size))[0]
    z = sheet.kernel(phi)
    return float(np.linalg.eigvalsh(z.T @ (hessian @ z))[0]) if z.shape[1] else math.inf


def _mechanics(sheet: Sheet, blank: SheetState, contact: bool) -> SheetState:
    """Judge stationarity and curvature of a closed state."""
    phi = blank.fold_angles
    rows = closed_contacts(sheet, phi, contact and sheet.size <= MOST_DENSE)
    z = sheet.kernel(phi) if len(rows.gaps) and sheet.size <= MOST_DENSE else None
    if z is None:
        found = _by_limits(sheet, phi, rows)
    else:
        found = balance(sheet, phi, rows, z)
    if rows.gaps.min(initial=0.0) < -10 * CLOSES:
        why = f"not decided: facets reach into each other by {-rows.gaps.min():.1e} of the sheet's size"
        return replace(blank, verdict="undecided", certificate=why)
    largest = max(float(np.abs(sheet.torque(phi)).max()), UNSTRESSED)
    missing = float(np.abs(found.left).max(initial=0.0)) / largest
    blank = replace(blank, kkt_residual=missing, contacts=told_contacts(sheet, rows, found))

    def lower(way: np.ndarray) -> bool:
        return _lower(sheet, phi, way, rows, contact)

    if missing > STATIONARY * 10:
        rises, falling = slopes(sheet, phi)
        if rises:
            return replace(blank, **SHARP)
        if any(lower(way) for way in [-found.left, *falling]):
            return replace(blank, verdict="not a minimum", certificate="torque along a free motion")
        why = f"not decided: torque of {missing:.1e} is left, but no lower state was found"
        return replace(blank, verdict="undecided", certificate=why)
    choices, _, most = found.choices()
    lowest, way, proved, loaded = math.nan, np.zeros(0), False, np.zeros(0, bool)
    for forces in [found.forces, *choices[:MOST_CHOICES]]:
        loaded = forces > LOADED
        pushing = rows.slopes.T @ np.where(loaded, forces, 0.0)
        lam = sheet.normal(phi).multipliers(sheet.torque(phi) - pushing)
        hessian = sheet.hessian(phi, lam)
        if rows.touches:
            hessian = dense(hessian) - rows.bent(sheet, phi, forces)
        many = len(rows.limits)
        lowest, way, proved = curvature(
            sheet, phi, hessian, rows.limits[loaded[:many]], rows.slopes[many:][loaded[many:]]
        )
        if proved:
            break
    blank = replace(blank, eigenvalue=lowest)
    if proved:
        every = bool((most > LOADED).all())
        kind = "interior" if not len(most) else "contact-pinned" if every else "contact-touching"
        what = f"curvature {lowest:.3g}" if math.isfinite(lowest) else "nothing is left free"
        why = f"strict minimum: torque balanced, {what} along what loaded contacts leave free"
        return replace(blank, verdict="minimum", kind=kind, certificate=why)  # type: ignore[arg-type]
    if lowest < 0 and (lower(way) or lower(-way)):
        why = f"lower states beside it: curvature {lowest:.3g}"
        return replace(blank, verdict="not a minimum", certificate=why)
    why = f"not decided: curvature {lowest:.3g} along a free motion proves nothing"
    return replace(blank, verdict="undecided", certificate=why)


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


def curvature(
    sheet: Sheet,
    phi: np.ndarray,
    hessian: Matrix,
    held: np.ndarray,
    extra: np.ndarray | None = None,
) -> tuple[float, np.ndarray, bool]:
    """Examine curvature along motions that closure allows with creases held.

    Parameters
    ----------
    sheet, phi
        The programme and a closed state.
    hessian
        Of the Lagrangian, [n, n].
    held
        Creases that stay.
    extra
        Further rows that must stay 0 to first order, [r, n]; of no sheet beyond `MOST_DENSE`.

    Returns
    -------
    smallest : float
        Curvature; inf where nothing is free.
    way : numpy.ndarray
        Its direction, [n].
    proved : bool
        Whether it is positive, shown without a rank decision.
    """
    free = np.setdiff1d(np.arange(sheet.size), held)
    j = sheet.closure.jacobian(phi)[:, free]
    h = hessian[free][:, free]
    way = np.zeros(sheet.size)
    if not len(free):
        return math.inf, way, True
    if sheet.size > MOST_DENSE:
        smallest, vector = _smallest(h, j, free)
        way[free] = vector
        return smallest, way, smallest > CURVED
    j, h = dense(j), dense(h)
    if extra is not None and len(extra):
        j = np.vstack([j, extra[:, free]])
    _, values, vt = np.linalg.svd(j, full_matrices=True)
    z = vt[int((values > RANK).sum()) :].T
    smallest = math.inf
    if z.shape[1]:
        curvatures, vectors = np.linalg.eigh(z.T @ h @ z)
        smallest = float(curvatures[0])
        way[free] = z @ vectors[:, 0]
    if smallest <= CURVED:
        return smallest, way, False
    square, size = j.T @ j, float(np.abs(h).max())
    for rho in PENALTIES:
        whole = h + rho * square
        margin = CURVED * size + 10 * len(h) * EPS * rho  # rows of J have entries up to 1/2
        try:
            linalg.cholesky(whole - margin * np.eye(len(h)))
        except linalg.LinAlgError:
            continue
        return smallest, way, True
    return smallest, way, False


def _smallest(h: Matrix, j: Matrix, free: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the smallest eigenvalue of H + rho J'J and its vector: a lower bound of the curvature on the kernel."""
    whole = (sparse.csc_array(h) + 1e4 * sparse.csc_array(j).T @ sparse.csc_array(j)).tocsc()
    # below every eigenvalue (Gershgorin; J'J adds none below), the closest one is the smallest
    below = -float(np.abs(sparse.csr_array(h)).sum(axis=1).max()) - 1.0
    try:
        values, vectors = eigsh(whole, k=1, sigma=below, which="LM", v0=np.ones(len(free)))
    except ArpackNoConvergence:
        return math.nan, np.zeros(len(free))
    vector = vectors[:, 0]
    left = float(np.linalg.norm(whole @ vector - values[0] * vector))
    return float(values[0] - left), vector


def _lower(
    sheet: Sheet, phi: np.ndarray, way: np.ndarray, rows: Rows | None = None, contact: bool = False
) -> bool:
    """Find a closed state within the limits beside phi, lower than rounding, along a direction."""
    size = float(np.abs(way).max(initial=0.0))
    if not size:
        return False
    for reach in reversed(REACHES):
        start = np.clip(phi + reach * way / size, -math.pi, math.pi)
        if rows is not None and rows.touches:
            back = put_back(sheet, start, rows)
            if back is None:
                continue
            new, residual = back, sheet.residual(back)
        else:
            new, residual = sheet.project(start, np.abs(start) == math.pi)
        if residual > CLOSES or np.abs(new).max() > math.pi or not sheet.closure.on_sheet(new):
            continue
        if np.abs(new - phi).max() < NEAREST:
            continue
        if contact and (sheet.crossings.find(new) or order_layers(sheet, new).verdict != "ordered"):
            return False  # what lies further that way would be reached through facets
        drop = sheet.energy(phi) - sheet.energy(new)
        if np.abs(new - phi).max() <= 3 * reach and drop > 1e-13 * (1 + sheet.energy(phi)):
            return True
    return False
