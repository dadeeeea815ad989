"""Types of hinge laws: formulas and tables as pieces, and sums of laws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, check_whole
from origami_nlp.errors import SceneError
from origami_nlp.numerics import INPUT_TOL, RESOLVED
from origami_nlp.pattern.hinge_law import MOST_PIECES, HingeLaw, moved_cubic

AS_STATED = 1e-6
"""Of the largest torque: what the pieces of a law that is stated by a formula may differ by."""
FEWEST_ROWS = 6
"""Of a table."""
WIDTHS = 0.02, 10.0
"""Of wells [rad]."""
MOST_WELLS = 32
"""Of a detent, a turn."""


def _hermite(x: np.ndarray, torque: np.ndarray, slope: np.ndarray, name: str) -> HingeLaw:
    from scipy.interpolate import CubicHermiteSpline

    c = CubicHermiteSpline(x, torque, slope).c.T
    return HingeLaw(tuple(x.tolist()), tuple(map(tuple, c.tolist())), name)


def _sampled(
    torque: Any, slope: Any, name: str, width: float = math.tau, more: Sequence[float] = ()
) -> HingeLaw:
    """Return the law of a formula that bends over `width`: pieces are halved that are not within `AS_STATED` of it."""
    x = np.linspace(-math.pi, math.pi, 2 ** max(1, math.ceil(math.log2(math.tau / width))) + 1)
    x = np.unique(np.concatenate([x, [a for a in more if abs(a) < math.pi]]))
    while len(x) <= MOST_PIECES:
        law = _hermite(x, torque(x), slope(x), name)
        between = x[:-1, None] + np.array([0.2, 0.5, 0.7]) * np.diff(x)[:, None]
        exact = torque(between)
        if not np.isfinite(exact).all():
            raise SceneError(f"hinge law {name!r}: its torque is not finite everywhere")
        off = np.abs(law.torque(between) - exact).max(axis=1) > AS_STATED * np.abs(exact).max()
        if not off.any():
            return law
        x = np.unique(np.concatenate([x, 0.5 * (x[:-1] + x[1:])[off]]))
    raise SceneError(f"hinge law {name!r} bends too sharply for {MOST_PIECES} pieces")


def linear(stiffness: float, rest: float = 0.0) -> HingeLaw:
    """A linear spring as a law: torque stiffness (phi - rest).

    Parameters
    ----------
    stiffness
        Positive [N m/rad].
    rest
        Angle without torque [rad].

    Returns
    -------
    HingeLaw
        Known from -180 to 180 degrees.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    k, rest = check_number("stiffness", stiffness, 0.0), check_number("rest", rest)
    return _sampled(lambda x: k * (x - rest), lambda x: np.full_like(x, k), "linear")


def polynomial(coefficients: Sequence[float], rest: float = 0.0) -> HingeLaw:
    """Torque k1 d + k2 d^2 + k3 d^3 + ..., d = phi - rest.

    Parameters
    ----------
    coefficients
        k1, k2, ... [N m/rad, N m/rad^2, ...].
    rest
        Angle without torque [rad].

    Returns
    -------
    HingeLaw
        Known from -180 to 180 degrees.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    given = [check_number(f"coefficients[{i}]", c) for i, c in enumerate(coefficients, start=1)]
    p, rest = np.polynomial.Polynomial([0.0, *given]), check_number("rest", rest)
    return _sampled(lambda x: p(x - rest), lambda x: p.deriv()(x - rest), "polynomial")


def well(energy: float, at: float, width: float) -> HingeLaw:
    """A Gaussian well: U = -energy exp(-(phi - at)^2 / (2 width^2)).

    Parameters
    ----------
    energy
        Depth [J]; negative for a hill.
    at
        Its middle [rad].
    width
        Its standard deviation [rad].

    Returns
    -------
    HingeLaw
        Known from -180 to 180 degrees.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    e, w = check_number("energy", energy), check_number("width", width, WIDTHS[0], WIDTHS[1])
    at = check_number("at", at, -math.pi, math.pi)

    def torque(x: np.ndarray) -> np.ndarray:
        d = (x - at) / w
        return e / w * d * np.exp(-0.5 * d**2)

    def slope(x: np.ndarray) -> np.ndarray:
        d = (x - at) / w
        return e / w**2 * (1 - d**2) * np.exp(-0.5 * d**2)

    return _sampled(torque, slope, "well", w)


def double_well(energy: float, at: float, centre: float = 0.0) -> HingeLaw:
    """Two wells with a hill between: U = energy (((phi - centre)/at)^2 - 1)^2.

    Parameters
    ----------
    energy
        Of the hill over the wells [J].
    at
        How far the wells are from the hill [rad].
    centre
        Where the hill is [rad].

    Returns
    -------
    HingeLaw
        Known from -180 to 180 degrees.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    e, w = check_number("energy", energy, 0.0), check_number("at", at, WIDTHS[0], math.pi)
    centre = check_number("centre", centre)

    def torque(x: np.ndarray) -> np.ndarray:
        d = (x - centre) / w
        return 4 * e / w * d * (d**2 - 1)

    def slope(x: np.ndarray) -> np.ndarray:
        d = (x - centre) / w
        return 4 * e / w**2 * (3 * d**2 - 1)

    return _sampled(torque, slope, "double well")


def detent(energy: float, wells: int, centre: float = 0.0) -> HingeLaw:
    """Detents all round: U = energy (1 - cos(wells (phi - centre))) / 2.

    Parameters
    ----------
    energy
        Of the hills over the wells [J].
    wells
        Wells a turn, at most 32.
    centre
        Where one of them is [rad].

    Returns
    -------
    HingeLaw
        Known from -180 to 180 degrees.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    e, w = check_number("energy", energy, 0.0), check_whole("wells", wells, 1, MOST_WELLS)
    check_number("centre", centre)
    return _sampled(
        lambda x: 0.5 * e * w * np.sin(w * (x - centre)),
        lambda x: 0.5 * e * w**2 * np.cos(w * (x - centre)),
        "detent",
        math.pi / w,
    )


def one_sided(stiffness: float, start: float, width: float = math.radians(2.0)) -> HingeLaw:
    """A soft stop: no torque before `start`, then stiffness (phi - start), rounded.

    Parameters
    ----------
    stiffness
        Positive [N m/rad].
    start
        Where it begins [rad]: towards valley if positive, towards mountain if negative.
    width
        Over which the torque bends [rad].

    Returns
    -------
    HingeLaw
        Known from -180 to 180 degrees.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    k, start = (
        check_number("stiffness", stiffness, 0.0),
        check_number("start", start, -math.pi, math.pi),
    )
    side = math.copysign(1.0, start)
    w = check_number("width", width, RESOLVED, 1.0)

    def inside(x: np.ndarray) -> np.ndarray:
        return np.clip(side * x - abs(start), 0.0, None)

    def torque(x: np.ndarray) -> np.ndarray:
        d = inside(x)
        return side * k * np.where(d < w, 0.5 * d**2 / w, d - 0.5 * w)

    return _sampled(
        torque,
        lambda x: k * np.clip(inside(x) / w, 0.0, 1.0),
        "one-sided",
        more=(start, start + side * w),
    )


def table(angle: Sequence[float], torque: Sequence[float], name: str = "table") -> HingeLaw:
    """A law through points, monotone between them where they are (PCHIP).

    Parameters
    ----------
    angle
        Fold angles, which increase, six at least [rad].
    torque
        Torques dU/dphi there [N m].
    name
        What reports call it.

    Returns
    -------
    HingeLaw
        Known between the first and the last angle.

    Raises
    ------
    SceneError
        If there are too few points, or they are not in order.
    """
    from scipy.interpolate import PchipInterpolator

    x, y = np.array(angle, float), np.array(torque, float)
    if x.ndim != 1 or x.shape != y.shape or len(x) < FEWEST_ROWS:
        raise SceneError(
            f"hinge law {name!r}: a table needs {FEWEST_ROWS} rows of angle and torque at least"
        )
    if not (np.isfinite(x).all() and np.isfinite(y).all()):
        raise SceneError(f"hinge law {name!r}: angles and torques must be finite")
    if not (np.diff(x) > 0).all():
        row = int(np.argmin(np.diff(x) > 0)) + 2
        raise SceneError(f"hinge law {name!r}: angles must increase: row {row} does not")
    if np.abs(x).max() > math.pi * (1 + INPUT_TOL):
        raise SceneError(f"hinge law {name!r}: angles are beyond +-180 degrees")
    c = PchipInterpolator(x, y).c.T
    return HingeLaw(tuple(x.tolist()), tuple(map(tuple, c.tolist())), name)


def sum_of(laws: Sequence[HingeLaw], name: str = "sum") -> HingeLaw:
    """Springs side by side on one hinge: their torques add.

    Parameters
    ----------
    laws
        One or more.
    name
        What reports call it.

    Returns
    -------
    HingeLaw
        Known where all are.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    low, high = max(law.breaks[0] for law in laws), min(law.breaks[-1] for law in laws)
    every = np.unique(np.concatenate([law.breaks for law in laws]))
    x = every[(every >= low) & (every <= high)]
    # each law is one cubic between two of all breaks: its values and slopes there are the law
    c = np.zeros((len(x) - 1, 4))
    for law in laws:
        own = np.searchsorted(law.breaks, x[:-1], side="right") - 1
        own = np.clip(own, 0, len(law.coefficients) - 1)
        starts = np.array(law.breaks)[own]
        pieces = np.array(law.coefficients)[own]
        c += moved_cubic(pieces.T, x[:-1] - starts).T
    return HingeLaw(tuple(x.tolist()), tuple(map(tuple, c.tolist())), name)
