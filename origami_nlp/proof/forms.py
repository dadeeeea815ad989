"""Quadratic forms in a direction u and a small radius r: have they a common zero on the faces of a cube?

Row i states, for 0 < r <= r0 (for `core` <= r only, where b_i stands for something over r),

    v_i(u) + r w_i(u) = +-(b_i + e_i r^p),    v = c + a . u + u' M u,    w = t . u + u' T u,    |u|_inf = 1.

*First step* (`left_over`): with the error b + sup |w| r0 + e r0^p, boxes on the faces are dropped where a row differs
from zero, or where an interval Newton step leaves nothing.  About the centre m of a box with radii d (M symmetric),
s = a + 2 M m, |u - m| <= d,

    v(u) = v(m) + s . (u - m) + (u - m)' M (u - m),    |(u - m)' M (u - m)| <= d' |M| d,
    |u - m + Y v(m)| <= |Y| (error + d' |M| d) + |1 - Y s| d    for any matrix Y.

*Second step* (`none_beside`), where boxes are left about a zero z of v, |v(z)| ~ rounding, and p = 2: P bounds |u - z|;
with q = || |1 - Y s| + |Y| |M| d || < 1,

    P <= || |Y| (|v(z)| + b + sup |w| r + e r^2) || / (1 - q).

Rows combined by y with y s ~ 0 have next to no term linear in u - z, hence there is no zero at r unless

    |y . w(z)| r <= |y . v(z)| + |y| b + |y s| P + P' (|y| |M|) P + r |y| |grad w| P + |y| e r^2.

The right side over r is convex in r: it is evaluated at r = core and r = r0 only.

*Rounding*: sums of k terms are within k EPS sum |.|; since |u| <= 1, what is computed from a row is within (n + 2)^2
EPS (|c| + sum |a| + 2 sum |M|).  Four times this is added to b once (`_with_rounding`); products with Y carry their
own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from origami_nlp.numerics import EPS

NARROWEST = 2.0**-9
"""Boxes narrower than this are not split: what is left there is taken for a zero of the leading forms."""
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
    tilt_linear, tilt_quadratic
        t [R, n], T [R, n, n] (symmetric).
    base, error
        b, e >= 0, [R].
    order
        p, 1 or 2.
    holds
        Whether row r is wanted on stratum s, bool [S, R].
    lower, upper
        Range of u on each stratum, within [-1, 1], [S, n].
    """

    constant: np.ndarray
    linear: np.ndarray
    quadratic: np.ndarray
    tilt_linear: np.ndarray
    tilt_quadratic: np.ndarray
    base: np.ndarray
    error: np.ndarray
    order: int
    holds: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    @property
    def tilts(self) -> np.ndarray:
        """Bound of |w| over |u| <= 1, [R]."""
        return np.abs(self.tilt_linear).sum(axis=1) + np.abs(self.tilt_quadratic).sum(axis=(1, 2))


@dataclass(frozen=True)
class DirectionBoxes:
    """K boxes of directions: stratum [K], lower and upper [K, n]."""

    stratum: np.ndarray
    lower: np.ndarray
    upper: np.ndarray

    def __getitem__(self, which: np.ndarray | slice) -> DirectionBoxes:
        return DirectionBoxes(self.stratum[which], self.lower[which], self.upper[which])


def left_over(forms: Forms, radius: float) -> tuple[np.ndarray, DirectionBoxes]:
    """Cover the faces |u|_inf = 1 by boxes and drop those without a common zero.

    Parameters
    ----------
    forms
        The rows and the strata.
    radius
        r0 > 0.

    Returns
    -------
    given_up : numpy.ndarray
        Strata with more boxes than are looked at, bool [S]; their boxes are not all among those left.
    left : DirectionBoxes
        Where no row could be distinguished from zero.  A stratum without boxes that was not given up has no zero:
        proved.
    """
    forms = _with_rounding(forms)
    error = (1 + 8 * EPS) * (forms.base + forms.tilts * radius + forms.error * radius**forms.order)
    boxes, given_up = _faces(forms), np.zeros(len(forms.holds), dtype=bool)
    left = [boxes[:0]]
    while len(boxes.stratum):
        width = (boxes.upper - boxes.lower).max(axis=1)  # of what the rows are looked at on
        keep, boxes = _contracted(forms, error, boxes)
        boxes, width = boxes[keep], width[keep]
        given_up |= np.bincount(boxes.stratum, minlength=len(given_up)) > MOST
        narrow, wanted = width < NARROWEST, ~given_up[boxes.stratum]
        left.append(boxes[narrow & wanted])
        boxes = _halved(boxes[~narrow & wanted])
    return given_up, DirectionBoxes(
        *(np.concatenate([getattr(b, k) for b in left]) for k in ("stratum", "lower", "upper"))
    )


def none_beside(forms: Forms, boxes: DirectionBoxes, core: float, radius: float) -> np.ndarray:
    """Return for which boxes the next order excludes every common zero with core <= r <= radius.

    Parameters
    ----------
    forms
        The rows and the strata, of order 2.
    boxes
        Narrow boxes of directions.
    core, radius
        Smallest and largest r.

    Returns
    -------
    numpy.ndarray
        Bool [K]: True is proved.  After the first box of a stratum that is not, its others are not looked at.
    """
    out = np.zeros(len(boxes.stratum), dtype=bool)
    forms = _with_rounding(forms)
    for s in sorted(set(boxes.stratum.tolist())) if forms.order == 2 else ():
        rows = _held(forms, s)
        for i in np.flatnonzero(boxes.stratum == s):
            out[i] = _tilted(rows, boxes.lower[i], boxes.upper[i], core, radius)
            if not out[i]:
                break  # nothing is shown of this stratum
    return out


def _with_rounding(forms: Forms) -> Forms:
    """Add to the errors the rounding of all that is computed from the rows in a box within |u| <= 1."""
    size = (
        np.abs(forms.constant)
        + np.abs(forms.linear).sum(axis=1)
        + 2 * np.abs(forms.quadratic).sum(axis=(1, 2))
        + 2 * forms.tilts
    )
    n = forms.linear.shape[1]
    return replace(forms, base=(1 + 8 * EPS) * (forms.base + 4 * (n + 2) ** 2 * EPS * size))


def _held(forms: Forms, stratum: int) -> Forms:
    """Return the rows that hold on one stratum."""
    rows = forms.holds[stratum]
    names = "constant linear quadratic tilt_linear tilt_quadratic base error".split()
    return replace(forms, **{k: getattr(forms, k)[rows] for k in names})


def _faces(forms: Forms) -> DirectionBoxes:
    """Return the faces u_k = +-1 that the ranges reach."""
    parts = []
    for reached, side in ((forms.upper >= 1, 1.0), (forms.lower <= -1, -1.0)):
        s, k = np.nonzero(reached)
        lower, upper = forms.lower[s], forms.upper[s]
        lower[np.arange(len(s)), k] = upper[np.arange(len(s)), k] = side
        parts.append((s, lower, upper))
    return DirectionBoxes(*(np.concatenate(p) for p in zip(*parts, strict=True)))


def _contracted(
    forms: Forms, error: np.ndarray, boxes: DirectionBoxes
) -> tuple[np.ndarray, DirectionBoxes]:
    """Which boxes may hold a zero, and their parts where it may be."""
    lower, upper = boxes.lower, boxes.upper
    holds = forms.holds[boxes.stratum]
    m = 0.5 * (lower + upper)
    d = (1 + 2 * EPS) * np.maximum(upper - m, m - lower)
    bent = np.einsum("rij,kj->kri", forms.quadratic, m)
    value = forms.constant + m @ forms.linear.T + np.einsum("kri,ki->kr", bent, m)
    slope = forms.linear + 2 * bent
    # |(u - m)' M (u - m)| <= d' |M| d
    bow = np.einsum("kri,ki->kr", np.einsum("rij,kj->kri", np.abs(forms.quadratic), d), d)
    error = error + bow
    spread = np.einsum("kri,ki->kr", np.abs(slope), d)
    keep = ~(holds & (np.abs(value) > (spread + error) * (1 + 4 * EPS))).any(axis=1)
    value, slope, error, spread, holds, d, m = (
        part[keep] for part in (value, slope, error, spread, holds, d, m)
    )
    # weighted least squares for unknowns of size 1: any Y would do
    weight = holds / (error + FLOOR * spread + EPS)
    w = weight[:, :, None] * slope * d[:, None, :]
    turned = w.transpose(0, 2, 1)
    y = np.linalg.solve(turned @ w + np.eye(m.shape[1]), turned)
    y = d[:, :, None] * y * weight[:, None, :]
    size, n = np.abs(y), m.shape[1]
    count = 2 * (n + len(forms.constant))
    # |u - m + Y v(m)| <= |Y| (error + d' |M| d) + |1 - Y s| d
    rest = np.abs(np.eye(n) - y @ slope)
    loose = np.einsum("kir,kr->ki", size, error + count * EPS * (np.abs(value) + spread + error))
    loose = (1 + count * EPS) * (loose + np.einsum("kij,kj->ki", rest, d))
    middle = m - np.einsum("kir,kr->ki", y, value)
    loose += 4 * EPS * (np.abs(middle) + loose + 1)
    low, high = lower.copy(), upper.copy()
    low[keep] = np.maximum(lower[keep], middle - loose)
    high[keep] = np.minimum(upper[keep], middle + loose)
    keep[keep] = (low[keep] <= high[keep]).all(axis=1)
    return keep, DirectionBoxes(boxes.stratum, low, high)


def _halved(boxes: DirectionBoxes) -> DirectionBoxes:
    """Split each box at the middle of its widest side; both halves share that number."""
    lower, upper = boxes.lower, boxes.upper
    rows, axis = np.arange(len(lower)), np.argmax(upper - lower, axis=1)
    middle = 0.5 * (lower[rows, axis] + upper[rows, axis])
    below, above = upper.copy(), lower.copy()
    below[rows, axis] = above[rows, axis] = middle
    return DirectionBoxes(
        np.tile(boxes.stratum, 2), np.vstack([lower, above]), np.vstack([below, upper])
    )


def _tilted(rows: Forms, lower: np.ndarray, upper: np.ndarray, core: float, radius: float) -> bool:
    """Return whether rows (all hold) have no zero with a direction in a box for core <= r <= radius."""
    move = upper > lower
    z = 0.5 * (lower + upper)
    for _ in range(6):  # Gauss and Newton: any z will do, a zero of the leading forms does best
        value, slope = _at(rows, z)
        z[move] -= np.linalg.lstsq(slope[:, move], value, rcond=None)[0]
    value, slope = _at(rows, z)
    value, slope = np.abs(value), slope[:, move]
    bow = np.abs(rows.quadratic)[:, move][:, :, move]
    d = np.maximum(np.abs(upper - z), np.abs(z - lower))[move]
    if not move.any() or np.abs(z).max() > 1.5 or d.max() > 64 * NARROWEST:
        return False
    # any Y would do: of least squares, rows by what they leave open, so that slopes of rounding alone weigh nothing
    weight = 1 / (rows.base + bow @ d @ d + FLOOR * (np.abs(slope) @ d) + EPS)
    y = d[:, None] * np.linalg.pinv(weight[:, None] * slope * d) * weight
    size = np.abs(slope).max(axis=1) + rows.base + EPS
    count = 4 * (len(value) + len(z))
    shrink = np.abs(np.eye(len(d)) - y @ slope) + count * EPS * (np.abs(y) @ np.abs(slope))
    shrink += _bowed(y, bow, d)
    # contraction: |u - z| <= |Y| (...) + q |u - z|, hence the bound over 1 - q
    q = shrink.sum(axis=1).max() * (1 + count * EPS)
    if q >= 1:
        return False
    grow = (1 + count * EPS) / (1 - q)

    def away(r: float) -> float:
        return grow * float(
            (np.abs(y) @ (value + rows.base + rows.tilts * r + rows.error * r * r)).max()
        )

    tilt = rows.tilt_linear @ z + np.einsum("rij,i,j->r", rows.tilt_quadratic, z, z)
    # combinations y of rows without a term linear in u - z
    null = np.linalg.svd(slope / size[:, None])[0][:, int(move.sum()) :]
    best = null @ (null.T @ (tilt / size)) / size
    weight = np.abs(best)
    steep = np.abs(rows.tilt_linear).sum(axis=1) + 4 * np.abs(rows.tilt_quadratic).sum(axis=(1, 2))
    crooked = (np.abs(best @ slope) + count * EPS * (weight @ np.abs(slope))).sum()

    def beaten(r: float) -> bool:
        p = away(r)
        other = abs(float(best @ _at(rows, z)[0])) + weight @ rows.base + crooked * p
        other += weight @ bow.sum(axis=(1, 2)) * p * p + r * (weight @ steep) * p
        other += weight @ rows.error * r * r + count * EPS * (weight @ value)
        return abs(float(best @ tilt)) * r * (1 - count * EPS) > other * (1 + count * EPS)

    # a / r + b + c r is convex: largest at an end
    return beaten(core) and beaten(radius)


def _bowed(y: np.ndarray, bow: np.ndarray, d: np.ndarray) -> np.ndarray:
    """Matrix [n, n] that bounds |Y| (u - z)' |M| (u - z) by itself times |u - z|, |u - z| <= d."""
    return np.einsum("ir,rj->ij", np.abs(y), np.einsum("rij,i->rj", bow, d))


def _at(rows: Forms, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Leading values [R] and slopes [R, n] at u [n]."""
    bent = rows.quadratic @ u
    return rows.constant + rows.linear @ u + bent @ u, rows.linear + 2 * bent
