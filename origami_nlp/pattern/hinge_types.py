"""Types of hinge laws: formulas and tables as pieces, and sums of laws."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
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


Formula = tuple[np.ndarray, np.ndarray]
"""Torque and stiffness at fold angles."""


def _law(x: np.ndarray, c: np.ndarray, name: str, stated: Any = None) -> HingeLaw:
    return HingeLaw(tuple(x.tolist()), tuple(map(tuple, c.tolist())), name, stated=stated)


def hermite(x: np.ndarray, formula: Formula, name: str, stated: Any = None) -> HingeLaw:
    """Return the law whose pieces have the torque and stiffness of a formula at their ends."""
    from scipy.interpolate import CubicHermiteSpline

    c = CubicHermiteSpline(x, *formula).c.T
    return _law(x, c, name, stated)


def _linear(x: np.ndarray, stiffness: Any, rest: Any) -> Formula:
    return stiffness * (x - rest), stiffness * np.ones_like(x)


def _polynomial(x: np.ndarray, rest: Any, **coefficients: Any) -> Formula:
    p = np.polynomial.Polynomial([0.0, *coefficients.values()])
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
    d = np.clip(side * np.real(x) - abs(start), 0.0, None)
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
    smooth
        Whether its formula is analytic in it, so that states are followed over it: kinks move with others.
    """

    low: float = -math.inf
    high: float = math.inf
    usual: float | None = None
    key: str = ""
    smooth: bool = True

    def read(self, name: str, value: Any) -> float:
        """Return the number, or raise an error by its name."""
        if isinstance(self.high, int):
            return check_whole(name, value, int(self.low), self.high)
        return check_number(name, value, self.low, self.high)

    def in_degrees(self, value: Any) -> float:
        """Return an angle [rad] that a file states in degrees."""
        low, high = (
            math.degrees(a) if math.isfinite(a) else math.copysign(180.0, a)
            for a in (self.low, self.high)
        )
        return math.radians(check_number(self.key, value, low, high))


_SIZE, _AT = Number(0.0), Number(-math.pi, math.pi, key="at_deg")
_REST, _CENTRE = (Number(usual=0.0, key=f"{name}_deg") for name in ("rest", "centre"))
_APART, _WIDTH = Number(WIDTHS[0], math.pi, key="at_deg"), Number(*WIDTHS, key="width_deg")
_START = Number(-math.pi, math.pi, key="from_deg", smooth=False)
_BEND = Number(RESOLVED, 1.0, math.radians(2.0), "width_deg", smooth=False)
TYPES: dict[str, tuple[Callable[..., Formula], dict[str, Number]]] = {
    "linear": (_linear, {"stiffness": _SIZE, "rest": _REST}),
    "polynomial": (_polynomial, {"coefficients": Number(), "rest": _REST}),
    "well": (_well, {"energy": Number(), "at": _AT, "width": _WIDTH}),
    "double-well": (_double_well, {"energy": _SIZE, "at": _APART, "centre": _CENTRE}),
    "detent": (_detent, {"energy": _SIZE, "wells": Number(1, 32, smooth=False), "centre": _CENTRE}),
    "one-sided": (_one_sided, {"stiffness": _SIZE, "start": _START, "width": _BEND}),
}
"""Torque and stiffness of each type, and its numbers."""


def pieces_for(every: Sequence[Callable[[np.ndarray], Formula]], name: str, x: np.ndarray) -> Any:
    """Return breaks within which cubics follow all formulas: pieces are halved that are not within `AS_STATED`.

    Parameters
    ----------
    every
        Formulas.
    name
        Of the law.
    x
        Breaks to begin with [rad].

    Returns
    -------
    numpy.ndarray
        Breaks [B + 1] [rad].

    Raises
    ------
    SceneError
        If a torque is not finite, or there were too many.
    """
    while len(x) <= MOST_PIECES:
        between = x[:-1, None] + np.array([0.2, 0.5, 0.7]) * np.diff(x)[:, None]
        off = np.zeros(len(between), dtype=bool)
        for formula in every:
            exact = formula(between)[0]
            if not np.isfinite(exact).all():
                raise SceneError(f"hinge law {name!r}: its torque is not finite everywhere")
            away = np.abs(hermite(x, formula(x), name).torque(between) - exact).max(axis=1)
            off |= away > AS_STATED * np.abs(exact).max()
        if not off.any():
            return x
        x = np.unique(np.concatenate([x, 0.5 * (x[:-1] + x[1:])[off]]))
    raise SceneError(f"hinge law {name!r} bends too sharply for {MOST_PIECES} pieces")


def first_breaks(kind: str, numbers: Mapping[str, Any]) -> np.ndarray:
    """Return equal pieces for what bends as fast as a law of a type, and where it has kinks, [B + 1]."""
    width = {
        "well": lambda: numbers["width"],
        "detent": lambda: math.pi / numbers["wells"],
    }.get(kind, lambda: math.tau)()
    x = np.linspace(-math.pi, math.pi, 2 ** max(1, math.ceil(math.log2(math.tau / width))) + 1)
    if kind == "one-sided":
        start = numbers["start"]
        kinks = np.array([start, start + math.copysign(numbers["width"], start)])
        x = np.unique([*x, *kinks[np.abs(kinks) < math.pi]])
    return x


def of_type(kind: str, numbers: Mapping[str, Any]) -> HingeLaw:
    """Return the law of a type.

    Parameters
    ----------
    kind
        One of `TYPES`.
    numbers
        Its numbers by name; of a list each by itself, as ``coefficients[1]``.

    Returns
    -------
    HingeLaw
        Known from -180 to 180 degrees.

    Raises
    ------
    SceneError, OptionError
        If a number does not fit.
    """
    formula, known = TYPES[kind]
    usual = {name: n.usual for name, n in known.items() if n.usual is not None}
    places = list(known)
    given = sorted(
        {**usual, **numbers}.items(), key=lambda one: places.index(one[0].partition("[")[0])
    )
    read = {name: known[name.partition("[")[0]].read(name, value) for name, value in given}
    of = partial(formula, **read)
    x = pieces_for([of], kind, first_breaks(kind, read))
    return hermite(x, of(x), kind, (kind, read))


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
    return of_type("linear", {"stiffness": stiffness, "rest": rest})


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
    each = {f"coefficients[{i}]": c for i, c in enumerate(coefficients, start=1)}
    return of_type("polynomial", {"rest": rest, **each})


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
    return of_type("well", {"energy": energy, "at": at, "width": width})


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
    return of_type("double-well", {"energy": energy, "at": at, "centre": centre})


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
    return of_type("detent", {"energy": energy, "wells": wells, "centre": centre})


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
    return of_type("one-sided", {"stiffness": stiffness, "start": start, "width": width})


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
    return _law(x, c, name)


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
    return _law(x, c, name, ("sum", tuple(laws)))
