"""Types of hinge laws: formulas and tables as pieces, and sums of laws."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, check_whole
from origami_nlp.errors import SceneError
from origami_nlp.numerics import INPUT_TOL, RESOLVED
from origami_nlp.pattern.hinge_law import MOST_PIECES, HingeLaw, law_of, moved_cubic

AS_STATED = 1e-6
"""Of the largest torque: what the pieces of a law that is stated by a formula may differ by."""
FEWEST_ROWS = 6
"""Of a table."""
WIDTHS = 0.02, 10.0
"""Of wells [rad]."""
Formula = tuple[np.ndarray, np.ndarray]
"""Torque and stiffness at fold angles."""


def _linear(x: np.ndarray, stiffness: Any, rest: Any) -> Formula:
    return stiffness * (x - rest), stiffness * np.ones_like(x)


def _polynomial(x: np.ndarray, rest: float, coefficients: Sequence[float]) -> Formula:
    p = np.polynomial.Polynomial([0.0, *coefficients])
    return p(x - rest), p.deriv()(x - rest)


def _well(x: np.ndarray, energy: Any, at: Any, width: Any) -> Formula:
    d = (x - at) / width
    steep = energy / width * np.exp(-0.5 * d**2)
    return steep * d, steep / width * (1 - d**2)


def _double_well(x: np.ndarray, energy: Any, at: Any, centre: Any) -> Formula:
    d = (x - centre) / at
    return 4 * energy / at * d * (d**2 - 1), 4 * energy / at**2 * (3 * d**2 - 1)


def _detent(x: np.ndarray, energy: Any, wells: int, centre: Any) -> Formula:
    turn = wells * (x - centre)
    return 0.5 * energy * wells * np.sin(turn), 0.5 * energy * wells**2 * np.cos(turn)


def _one_sided(x: np.ndarray, stiffness: Any, start: float, width: float) -> Formula:
    side = math.copysign(1.0, start)
    d = np.clip(side * x - abs(start), 0.0, None)
    bent = np.where(d < width, 0.5 * d**2 / width, d - 0.5 * width)
    return side * stiffness * bent, stiffness * np.clip(d / width, 0.0, 1.0)


@dataclass(frozen=True)
class Number:
    """A number of a type of law.

    Attributes
    ----------
    low, high
        Its range; whole numbers are those of a whole number.
    usual
        What it is where it is not stated; None: it must be.
    key
        Of an angle in files, where it is in degrees.
    """

    low: float = -math.inf
    high: float = math.inf
    usual: float | None = None
    key: str = ""

    def read(self, name: str, value: Any) -> Any:
        """Return the number, or list of coefficients, or raise an error by its name."""
        if name == "coefficients":
            return [check_number(f"{name}[{i}]", v) for i, v in enumerate(value, start=1)]
        if isinstance(self.high, int):
            return check_whole(name, value, int(self.low), self.high)
        return check_number(name, value, self.low, self.high)

    def in_degrees(self, value: Any) -> float:
        """Return an angle [rad] that a file states in degrees."""
        most = 180.0 if math.isinf(self.high) else math.degrees(self.high)
        low = -180.0 if math.isinf(self.low) else math.degrees(self.low)
        return math.radians(check_number(self.key, value, low, most))


_SIZE, _AT = Number(0.0), Number(-math.pi, math.pi, key="at_deg")
_REST, _CENTRE = (Number(usual=0.0, key=f"{name}_deg") for name in ("rest", "centre"))
_APART, _WIDTH = Number(WIDTHS[0], math.pi, key="at_deg"), Number(*WIDTHS, key="width_deg")
_START = Number(-math.pi, math.pi, key="from_deg")
_BEND = Number(RESOLVED, 1.0, math.radians(2.0), "width_deg")
TYPES: dict[str, tuple[Callable[..., Formula], dict[str, Number]]] = {
    "linear": (_linear, {"stiffness": _SIZE, "rest": _REST}),
    "polynomial": (_polynomial, {"coefficients": Number(), "rest": _REST}),
    "well": (_well, {"energy": Number(), "at": _AT, "width": _WIDTH}),
    "double-well": (_double_well, {"energy": _SIZE, "at": _APART, "centre": _CENTRE}),
    "detent": (_detent, {"energy": _SIZE, "wells": Number(1, 32), "centre": _CENTRE}),
    "one-sided": (_one_sided, {"stiffness": _SIZE, "start": _START, "width": _BEND}),
}
"""Torque and stiffness of each type, and its numbers."""


def of_type(kind: str, **numbers: Any) -> HingeLaw:
    """Return a law of one of `TYPES`, of numbers in radians, J, N m: pieces that follow its formula to `AS_STATED`."""
    from scipy.interpolate import CubicHermiteSpline

    formula, known = TYPES[kind]
    read = {name: n.read(name, numbers.get(name, n.usual)) for name, n in known.items()}
    # begin with pieces no wider than what there is to see
    wide = read.get("width", math.tau) if kind == "well" else math.pi / read.get("wells", 0.5)
    x = np.linspace(-math.pi, math.pi, 2 ** max(1, math.ceil(math.log2(math.tau / wide))) + 1)
    if kind == "one-sided":
        start = read["start"]
        kinks = np.array([start, start + math.copysign(read["width"], start)])
        x = np.unique([*x, *kinks[np.abs(kinks) < math.pi]])
    while len(x) <= MOST_PIECES:
        law = CubicHermiteSpline(x, *formula(x, **read))
        between = x[:-1, None] + np.array([0.2, 0.5, 0.7]) * np.diff(x)[:, None]
        exact = formula(between, **read)[0]
        if not np.isfinite(exact).all():
            raise SceneError(f"hinge law {kind!r}: its torque is not finite everywhere")
        off = np.abs(law(between) - exact).max(axis=1) > AS_STATED * np.abs(exact).max()
        if not off.any():
            return law_of(x, law.c.T, kind)
        x = np.unique(np.concatenate([x, 0.5 * (x[:-1] + x[1:])[off]]))
    raise SceneError(f"hinge law {kind!r} bends too sharply for {MOST_PIECES} pieces")


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
    return of_type("linear", stiffness=stiffness, rest=rest)


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
    return of_type("polynomial", coefficients=coefficients, rest=rest)


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
    return of_type("well", energy=energy, at=at, width=width)


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
    return of_type("double-well", energy=energy, at=at, centre=centre)


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
    return of_type("detent", energy=energy, wells=wells, centre=centre)


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
    return of_type("one-sided", stiffness=stiffness, start=start, width=width)


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
        raise SceneError(f"hinge law {name!r}: give {FEWEST_ROWS} rows of angle and torque or more")
    good = np.isfinite(x) & np.isfinite(y) & (np.abs(x) <= math.pi * (1 + INPUT_TOL))
    good[1:] &= np.diff(x) > 0
    if not good.all():
        where = f"hinge law {name!r}, row {int(good.argmin()) + 1}"
        raise SceneError(f"{where}: angles must increase within +-180 degrees, torques be finite")
    return law_of(x, PchipInterpolator(x, y).c.T, name)


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
        starts, pieces = np.array(law.breaks)[own], np.array(law.coefficients)[own]
        c += moved_cubic(pieces.T, x[:-1] - starts).T
    return law_of(x, c, name)
