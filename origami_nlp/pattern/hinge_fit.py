"""A hinge law from measured torques: least squares with splines, or through averages, with a band and the loop.

The torque of a row is the mean law plus the half-gap of the loop, with its sign on loading and the other one on
unloading: both are fitted together, so that the loop is no noise, and the noise no loop.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.arguments import check_type
from origami_nlp.errors import OptionError
from origami_nlp.pattern.hinge_data import HingeData
from origami_nlp.pattern.hinge_law import HingeLaw
from origami_nlp.pattern.hinge_types import FEWEST_ROWS

FITS = ("spline", "pchip")
MOST_INTERVALS = 40
"""Of the spline of the mean law; of that of the half-gap a quarter."""
ROWS_AN_INTERVAL = 4
"""Different angles that there are at least for each interval of a spline."""
AVERAGES = 64
"""Points at most that a law goes through."""
ROWS_AN_AVERAGE = 2
LEAST_OVERLAP = 0.2
"""Share of the range that was loaded and unloaded, for there to be a loop."""
GRID = 721
"""Angles at which the band is stated."""


@dataclass(frozen=True, eq=False)
class LawFit:
    """A law fitted to measured torques.

    Attributes
    ----------
    law
        The mean law, known where it was measured.
    intervals
        Number of pieces between knots, or of averages.
    knots
        Inner knots of the spline, or angles of the averages [rad].
    angle
        Where what follows is stated, [g] [rad].
    torque
        Of the mean law there, [g] [N m].
    band
        95 % half-width of the mean law at each angle, [g] [N m]; nan where the noise is not known.
    slope_band
        The same of its stiffness, [g] [N m/rad].
    gap
        Half of what torques on loading are above those on unloading, [g] [N m]; 0 without a loop.
    residuals
        Torques less the mean law and the half-gap, [n] [N m].
    noise
        Standard deviation of a torque of weight 1 [N m]; nan if not known.
    correlation
        Of residuals that follow each other; the band is wider for it.
    loop
        Area of the loop and its 95 % half-width [J]; nan without loading and unloading.
    """

    law: HingeLaw
    intervals: int
    knots: np.ndarray
    angle: np.ndarray
    torque: np.ndarray
    band: np.ndarray
    slope_band: np.ndarray
    gap: np.ndarray
    residuals: np.ndarray
    noise: float
    correlation: float
    loop: tuple[float, float]


def fit_data(data: HingeData, fit: str = "spline", name: str = "") -> LawFit:
    """Fit a hinge law to measured torques.

    Parameters
    ----------
    data
        As measured.
    fit
        ``"spline"``: least squares by a cubic spline, whose number of knots has the least BIC; ``"pchip"``: through
        the rows, or through averages of rows at equal or neighbouring angles, monotone between them.
    name
        Of the law; of the data by default.

    Returns
    -------
    LawFit
        The mean law, with its band and the loop.

    Raises
    ------
    OptionError
        If `fit` is neither.
    """
    check_type("data", data, HingeData)
    if fit not in FITS:
        raise OptionError(f"fit = {fit!r} must be one of {', '.join(FITS)}")
    return (_spline if fit == "spline" else _through)(data, name or data.name)


def _overlap(data: HingeData) -> tuple[float, float] | None:
    """Return between which angles there are loading and unloading."""
    x, sweep = data.angle, data.sweep
    up, down = x[sweep > 0], x[sweep < 0]
    if min(len(up), len(down)) < FEWEST_ROWS:
        return None
    low, high = max(up.min(), down.min()), min(up.max(), down.max())
    return (low, high) if high - low > LEAST_OVERLAP * np.ptp(x) else None


def _spline(data: HingeData, name: str) -> LawFit:
    from scipy.interpolate import BSpline, PPoly
    from scipy.special import stdtrit

    x, y, sweep, overlap = data.angle, data.torque, data.sweep, _overlap(data)
    root = np.sqrt(data.weight)
    n, most = len(x), max(1, min(MOST_INTERVALS, len(np.unique(x)) // ROWS_AN_INTERVAL))

    def basis(at: np.ndarray, among: np.ndarray, intervals: int) -> tuple[np.ndarray, np.ndarray]:
        """Knots among angles, as many between any two, and the B-splines at `at` [n, intervals + 3]."""
        t = np.quantile(among, np.linspace(0, 1, intervals + 1))
        t = np.concatenate([[t[0]] * 3, t, [t[-1]] * 3])
        return t, BSpline.design_matrix(np.clip(at, t[0], t[-1]), t, 3).toarray()

    def columns(of_mean: int, of_gap: int) -> np.ndarray:
        parts = [basis(x, np.unique(x), of_mean)[1]]
        if of_gap:
            parts.append(sweep[:, None] * basis(x, np.array(overlap), of_gap)[1])
        return np.hstack(parts)

    def bic(pair: tuple[int, int]) -> float:
        a = columns(*pair)
        p = a.shape[1]
        if p >= n - 1:
            return math.inf
        rest = root * (y - a @ np.linalg.lstsq(root[:, None] * a, root * y, rcond=None)[0])
        least = np.finfo(float).eps * float(np.abs(root * y).max())  # data without noise
        return float(n * math.log(rest @ rest / n + least**2) + p * math.log(n))

    some = min(4, max(1, most // 4)) if overlap else 0
    mean = min(range(1, most + 1), key=lambda k: bic((k, some)))
    counts = [0, *(2**j for j in range(int(math.log2(max(1, most // 4))) + 1))] if overlap else [0]
    gap = min(counts, key=lambda k: bic((mean, k)))
    a = columns(mean, gap)
    c = np.linalg.lstsq(root[:, None] * a, root * y, rcond=None)[0]
    residuals = y - a @ c
    left = n - a.shape[1]
    s2 = float((root * residuals) @ (root * residuals)) / left if left > 0 else math.nan
    rho = _correlation(root * residuals)
    wide = float(stdtrit(max(left, 1), 0.975)) * math.sqrt(s2 * (1 + rho) / (1 - rho))

    def spread(rows: np.ndarray, factor: np.ndarray) -> np.ndarray:
        return wide * np.sqrt(((rows @ factor) ** 2).sum(axis=1))

    # a spline of the least BIC is off by as much as its own band says: that of twice the knots covers both
    finer = max(mean, min(2 * mean, n - (gap + 3 if gap else 0) - 4))
    factor = np.linalg.pinv(root[:, None] * columns(finer, gap))
    of_mean, of_gap = slice(0, finer + 3), slice(finer + 3, None)
    t, _ = basis(x, np.unique(x), mean)
    fine, _ = basis(x, np.unique(x), finer)
    grid = np.linspace(x.min(), x.max(), GRID)
    value = basis(grid, np.unique(x), finer)[1]
    slope = np.array([BSpline(fine, e, 3).derivative()(grid) for e in np.eye(finer + 3)]).T
    half, loop = np.zeros(GRID), (math.nan, math.nan)
    if overlap:
        loop = (0.0, math.nan)
    if overlap and gap:
        s, rows = basis(grid, np.array(overlap), gap)
        half = rows @ c[mean + 3 :]
        whole = np.array([BSpline(s, e, 3).integrate(*overlap) for e in np.eye(gap + 3)])[None]
        loop = (2 * float((whole @ c[mean + 3 :])[0]), 2 * float(spread(whole, factor[of_gap])[0]))
    pieces = PPoly.from_spline((t, c[: mean + 3], 3))
    keep = np.diff(pieces.x) > 0
    breaks = np.append(pieces.x[:-1][keep], pieces.x[-1])
    law = HingeLaw(tuple(breaks.tolist()), _rows(pieces.c[:, keep].T), name)
    return LawFit(
        law,
        mean,
        breaks[1:-1],
        grid,
        law.torque(grid),
        spread(value, factor[of_mean]),
        spread(slope, factor[of_mean]),
        half,
        residuals,
        math.sqrt(s2),
        rho,
        loop,
    )


def _through(data: HingeData, name: str) -> LawFit:
    from scipy.interpolate import PchipInterpolator
    from scipy.special import stdtrit

    x, y, w, sweep, overlap = data.angle, data.torque, data.weight, data.sweep, _overlap(data)
    different, of = np.unique(x, return_inverse=True)
    if len(different) > AVERAGES:
        count = max(FEWEST_ROWS, min(AVERAGES, len(x) // ROWS_AN_AVERAGE))
        ends = np.linspace(x.min(), x.max(), count + 1)
        of = np.unique(
            np.clip(np.searchsorted(ends, x, "right") - 1, 0, count - 1), return_inverse=True
        )[1]
    groups = int(of.max()) + 1

    def averages(values: np.ndarray, rows: Any = slice(None)) -> tuple[np.ndarray, np.ndarray]:
        total = np.bincount(of[rows], w[rows], groups)
        with np.errstate(invalid="ignore"):
            return np.bincount(of[rows], (w * values)[rows], groups) / total, total

    at = averages(x)[0]
    half, loop, both = np.zeros(groups), (math.nan, math.nan), 0
    if overlap:
        high, low = averages(y, sweep > 0)[0], averages(y, sweep < 0)[0]
        known = np.isfinite(high) & np.isfinite(low)
        both = int(known.sum())
        if both >= 2:
            half = np.interp(at, at[known], 0.5 * (high - low)[known])
            inside = np.linspace(*overlap, GRID)
            gap = np.interp(inside, at, half)
            area = float((gap[1:] + gap[:-1]) @ np.diff(inside))
            loop = (area, math.nan)
    rid = y - sweep * np.interp(x, at, half) if both >= 2 else y
    mean, total = averages(rid)
    left = len(x) - groups - both
    within = rid - mean[of]
    s2 = float(w @ within**2) / left if left > 0 else math.nan
    rho = _correlation(np.sqrt(w) * within) if left > 0 else 0.0
    wide = float(stdtrit(max(left, 1), 0.975)) * math.sqrt((1 + rho) / (1 - rho))
    curve = PchipInterpolator(at, mean)
    law = straight_on(HingeLaw(tuple(at.tolist()), _rows(curve.c.T), name), x.min(), x.max())
    grid = np.linspace(x.min(), x.max(), GRID)
    spread = wide * np.sqrt(s2 / total)
    piece = np.clip(np.searchsorted(at, grid, "right") - 1, 0, groups - 2)
    chord = np.hypot(spread[:-1], spread[1:]) / np.diff(at)
    residuals = rid - law.torque(x)
    return LawFit(
        law,
        groups,
        at,
        grid,
        law.torque(grid),
        np.interp(grid, at, spread),
        chord[piece],
        np.interp(grid, at, half),
        residuals,
        math.sqrt(s2),
        rho,
        loop,
    )


def straight_on(law: HingeLaw, low: float, high: float) -> HingeLaw:
    """Return a law that goes straight on, with the slope that it has at its ends.

    Parameters
    ----------
    law
        The law.
    low, high
        Between which it is to be known [rad].

    Returns
    -------
    HingeLaw
        Known there, and where it was.
    """
    x, c = list(law.breaks), list(law.coefficients)
    ends = np.array([x[0], x[-1]])
    slope = law.slope(np.array([x[0], np.nextafter(x[-1], -math.inf)]))
    torque = law.torque(ends)
    if low < x[0]:
        c.insert(0, (0.0, 0.0, float(slope[0]), float(torque[0] - slope[0] * (x[0] - low))))
        x.insert(0, low)
    if high > x[-1]:
        c.append((0.0, 0.0, float(slope[1]), float(torque[1])))
        x.append(high)
    return HingeLaw(tuple(map(float, x)), tuple(c), law.name)


def _rows(c: np.ndarray) -> tuple[tuple[float, ...], ...]:
    return tuple(map(tuple, c.tolist()))


def _correlation(residuals: np.ndarray) -> float:
    """Correlation of each with the next; 0 where chance would make as much."""
    r = residuals - residuals.mean()
    if not r @ r > 0:
        return 0.0
    rho = float(r[1:] @ r[:-1] / (r @ r))
    return min(rho, 0.95) if rho > 2 / math.sqrt(len(r)) else 0.0


def runs(where: np.ndarray, angle: np.ndarray) -> Iterator[tuple[float, float]]:
    """Go through the intervals of angles [g] at which `where` [g] holds.

    Parameters
    ----------
    where
        Whether it holds.
    angle
        Increasing [rad].

    Returns
    -------
    iterator
        Of first and last angle.
    """
    change = np.flatnonzero(np.diff(np.concatenate([[False], where, [False]]).astype(int)))
    for a, b in zip(change[::2], change[1::2], strict=True):
        yield float(angle[a]), float(angle[b - 1])
