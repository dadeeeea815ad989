"""A hinge law from measured torques: least squares with splines, or through averages, with a band and the loop.

The torque of a row is the mean law plus the half-gap of the loop, with its sign on loading and the other one on
unloading: both are fitted together, so that the loop is no noise, and the noise no loop.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from origami_nlp.io import ShortRepr
from origami_nlp.pattern.hinge_data import HingeData
from origami_nlp.pattern.hinge_law import HingeLaw, law_of
from origami_nlp.pattern.hinge_types import FEWEST_ROWS

MOST_INTERVALS = 40
"""Of the spline of the mean law; of that of the half-gap a quarter."""
ROWS_AN_INTERVAL = 4
"""Different angles that there are at least for each interval of a spline."""
LEAST_OVERLAP = 0.2
"""Share of the range that was loaded and unloaded, for there to be a loop."""
GRID = 721
"""Angles at which the band is stated."""


@dataclass(frozen=True, eq=False, repr=False)
class LawFit(ShortRepr):
    """A law fitted to measured torques.

    Attributes
    ----------
    data
        As measured.
    law
        The mean law, for `Scene(laws=)` and `Pattern.with_laws`, known where it was measured.
    knots
        Inner knots of the spline [rad].
    angle
        Where the next four are stated, [g] [rad].
    torque, band
        Of the mean law, with the 95 % half-width at each angle, [g] [N m]; nan if the noise is not known.
    slope_band
        95 % half-width of the stiffness, [g] [N m/rad].
    gap
        Half of what torques on loading are above those on unloading, [g] [N m]; 0 without a loop.
    residual_rms, residual_max
        Of torques less the law and the half-gap [N m].
    noise
        Standard deviation of a torque of weight 1 [N m]; nan if not known.
    correlation
        Of residuals that follow each other, for which the band is wider.
    loop_area, loop_error
        Energy that a cycle takes, with its 95 % half-width [J]; nan without loading and unloading.
    falling
        Intervals of angles in which the stiffness is negative for certain (95 % at each angle) [rad].
    unsure
        Share of the range in which the sign of the stiffness is not known.
    stored
        Largest less least energy of the mean law [J].
    """

    ALSO = ("falling", "unsure", "stored")

    data: HingeData
    law: HingeLaw
    knots: np.ndarray
    angle: np.ndarray
    torque: np.ndarray
    band: np.ndarray
    slope_band: np.ndarray
    gap: np.ndarray
    residual_rms: float
    residual_max: float
    noise: float
    correlation: float
    loop_area: float
    loop_error: float

    @property
    def falling(self) -> tuple[tuple[float, float], ...]:
        """Intervals of angles in which the stiffness is negative for certain [rad]."""
        slope = self.law.slope(self.angle)
        return tuple(runs(slope + self.slope_band < 0, self.angle))

    @property
    def unsure(self) -> float:
        """Share of the range in which the sign of the stiffness is not known."""
        return float(np.mean(~(np.abs(self.law.slope(self.angle)) > self.slope_band)))

    @property
    def stored(self) -> float:
        """Largest less least energy of the mean law [J]."""
        return float(np.ptp(self.law.energy(self.angle)))


def _overlap(data: HingeData) -> tuple[float, float] | None:
    """Return between which angles there are loading and unloading."""
    x, sweep = data.angle, data.sweep
    up, down = x[sweep > 0], x[sweep < 0]
    if min(len(up), len(down)) < FEWEST_ROWS:
        return None
    low, high = max(up.min(), down.min()), min(up.max(), down.max())
    return (low, high) if high - low > LEAST_OVERLAP * np.ptp(x) else None


def fit_data(data: HingeData, name: str = "") -> LawFit:
    """Fit a hinge law to measured torques: least squares by a cubic spline whose number of knots has the least BIC.

    Parameters
    ----------
    data
        As measured.
    name
        Of the law; of the data by default.

    Returns
    -------
    LawFit
        The mean law, with its band and the loop.
    """
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
    law = law_of(breaks, pieces.c[:, keep].T, name or data.name)
    bands = spread(value, factor[of_mean]), spread(slope, factor[of_mean])
    rms, worst = float(np.sqrt(np.mean(residuals**2))), float(np.abs(residuals).max())
    return LawFit(
        *(data, law, breaks[1:-1], grid, law.torque(grid), *bands, half, rms, worst),
        *(math.sqrt(s2), rho, *loop),
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
    x, c = np.array(law.breaks), np.array(law.coefficients)
    ends = x[[0, -1]]
    slope = law.slope(np.array([x[0], np.nextafter(x[-1], -math.inf)]))
    torque = law.torque(ends)
    if low < x[0]:
        c = np.vstack([[0.0, 0.0, slope[0], torque[0] - slope[0] * (x[0] - low)], c])
        x = np.append(low, x)
    if high > x[-1]:
        c, x = np.vstack([c, [0.0, 0.0, slope[1], torque[1]]]), np.append(x, high)
    return law_of(x, c, law.name)


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
