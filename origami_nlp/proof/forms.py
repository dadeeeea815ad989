"""Quadratic forms with errors: have they a common zero on the faces of a cube?

Row i states v_i(u) = c_i + a_i . u + u' M_i u = +-e_i.  `no_zero` covers the faces |u|_inf = 1 of each stratum's cube by
boxes and drops a box where some row certainly differs from zero, or where an interval Newton step on all rows
together leaves nothing.

About the centre p of a box with radii d (M symmetric), |u - p| <= d:

    v(u) = v(p) + s . (u - p) + (u - p)' M (u - p),   s = a + 2 M p,   |(u - p)' M (u - p)| <= d' |M| d.

*Interval Newton*, for any matrix Y: u - p = -Y v(p) + (1 - Y s) (u - p) + Y (error), so that

    |u - p + Y v(p)| <= |Y| (e + d' |M| d) + |1 - Y s| d.

*Rounding*: sums of k terms in any order are within k EPS sum |.| (gamma_k < k EPS).  Since |u| <= 1, every v, s d and
d' |M| d is computed to (n + 2)^2 EPS times |c| + sum |a| + 2 sum |M|; four times this is added to e once (`_rounded`).
The products with Y are sums over rows or variables and carry their own term.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from origami_nlp.numerics import EPS

NARROWEST = 2.0**-9
"""Boxes narrower than this are not split: what is left there is taken for a zero."""
MOST = 1500
"""Boxes of one stratum at a time; with more it is given up."""
FLOOR = 2.0**-20
"""Rows weigh no more than as if they were this share of their spread in error: keeps least squares regular."""


@dataclass(frozen=True)
class Forms:
    """R rows over n variables u, and S strata on which some of them hold.

    Attributes
    ----------
    constant, linear, quadratic
        c [R], a [R, n], M [R, n, n] (symmetric).
    error
        e [R] >= 0.
    holds
        Whether row r is wanted on stratum s, bool [S, R].
    lower, upper
        Range of u on each stratum, within [-1, 1], [S, n].
    """

    constant: np.ndarray
    linear: np.ndarray
    quadratic: np.ndarray
    error: np.ndarray
    holds: np.ndarray
    lower: np.ndarray
    upper: np.ndarray


@dataclass(frozen=True)
class Faces:
    """What was found on the faces.

    Attributes
    ----------
    empty
        Whether stratum s certainly has no common zero on them, bool [S].
    direction
        A point [S, n] near which none of the rows could be told from zero; nan where empty.
    boxes
        How many boxes were looked at.
    """

    empty: np.ndarray
    direction: np.ndarray
    boxes: int


def no_zero(forms: Forms) -> Faces:
    """Look for common zeros of forms on the faces |u|_inf = 1.

    Parameters
    ----------
    forms
        The rows and the strata.

    Returns
    -------
    Faces
        `empty` is proved, its opposite only says that it was not shown.
    """
    error = _rounded(forms)
    stratum, lower, upper = _faces(forms)
    empty = np.ones(len(forms.holds), dtype=bool)
    direction = np.full(forms.lower.shape, np.nan)
    boxes = 0
    while len(stratum):
        boxes += len(stratum)
        width = (upper - lower).max(axis=1, initial=0.0)  # of what the rows are looked at on
        keep, lower, upper = _contracted(forms, error, stratum, lower, upper)
        stratum, lower, upper, width = stratum[keep], lower[keep], upper[keep], width[keep]
        full = np.bincount(stratum, minlength=len(empty)) > MOST
        lost = (width < NARROWEST) | full[stratum]
        direction[stratum[lost]] = 0.5 * (lower[lost] + upper[lost])
        empty[stratum[lost]] = False
        left = empty[stratum]
        stratum, lower, upper = _halved(stratum[left], lower[left], upper[left])
    return Faces(empty, direction, boxes)


def _rounded(forms: Forms) -> np.ndarray:
    """Errors [R] with the rounding of all that is computed from the rows in a box within |u| <= 1."""
    size = (
        np.abs(forms.constant)
        + np.abs(forms.linear).sum(axis=1)
        + 2 * np.abs(forms.quadratic).sum(axis=(1, 2))
    )
    n = forms.linear.shape[1]
    return (1 + 8 * EPS) * (forms.error + 4 * (n + 2) ** 2 * EPS * size)


def _faces(forms: Forms) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stratum [K], lower and upper [K, n] of the faces u_k = +-1 that the ranges reach."""
    s, k, side = (
        np.concatenate(pair)
        for pair in zip(
            (*np.nonzero(forms.upper >= 1), np.ones(np.sum(forms.upper >= 1))),
            (*np.nonzero(forms.lower <= -1), -np.ones(np.sum(forms.lower <= -1))),
            strict=True,
        )
    )
    lower, upper = forms.lower[s], forms.upper[s]
    lower[np.arange(len(s)), k] = upper[np.arange(len(s)), k] = side
    return s, lower, upper


def _contracted(
    forms: Forms, error: np.ndarray, stratum: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which boxes [K, n] may hold a zero, and their parts where it may be."""
    p = 0.5 * (lower + upper)
    d = (1 + 2 * EPS) * np.maximum(upper - p, p - lower)
    holds = forms.holds[stratum]
    bent = np.einsum("rij,kj->kri", forms.quadratic, p)
    value = forms.constant + p @ forms.linear.T + np.einsum("kri,ki->kr", bent, p)
    slope = forms.linear + 2 * bent
    bow = np.einsum("rij,ki,kj->kr", np.abs(forms.quadratic), d, d, optimize=True)
    error = error + bow
    spread = np.einsum("kri,ki->kr", np.abs(slope), d)
    keep = ~(holds & (np.abs(value) > (spread + error) * (1 + 4 * EPS))).any(axis=1)
    if not keep.any():
        return keep, lower, upper
    value, slope, error, spread, holds, d, p = (
        part[keep] for part in (value, slope, error, spread, holds, d, p)
    )
    scaled = slope * d[:, None, :]
    weight = holds / (error + FLOOR * spread + EPS)
    w = weight[:, :, None] * scaled
    n = p.shape[1]
    y = np.linalg.solve(w.transpose(0, 2, 1) @ w + np.eye(n), w.transpose(0, 2, 1))
    y = d[:, :, None] * y * weight[:, None, :]
    size = np.abs(y)
    count = 2 * (n + len(forms.constant))
    rest = np.abs(np.eye(n) - y @ slope)
    loose = np.einsum("kir,kr->ki", size, error + count * EPS * (np.abs(value) + spread + error))
    loose = (1 + count * EPS) * (loose + np.einsum("kij,kj->ki", rest, d))
    middle = p - np.einsum("kir,kr->ki", y, value)
    loose += 4 * EPS * (np.abs(middle) + loose + 1)
    low, high = lower.copy(), upper.copy()
    low[keep] = np.maximum(lower[keep], middle - loose)
    high[keep] = np.minimum(upper[keep], middle + loose)
    keep[keep] = (low[keep] <= high[keep]).all(axis=1)
    return keep, low, high


def _halved(
    stratum: np.ndarray, lower: np.ndarray, upper: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Split each box [K, n] at the middle of its widest side; both halves share that number."""
    if not len(stratum):
        return stratum, lower, upper
    rows, axis = np.arange(len(stratum)), np.argmax(upper - lower, axis=1)
    middle = 0.5 * (lower[rows, axis] + upper[rows, axis])
    below, above = upper.copy(), lower.copy()
    below[rows, axis] = above[rows, axis] = middle
    return np.tile(stratum, 2), np.vstack([lower, above]), np.vstack([below, upper])
