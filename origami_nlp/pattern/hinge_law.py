"""Hinge laws: torque over fold angle as a piecewise cubic, in place of a linear spring.

A law is its pieces: breaks, and the torque on each as a cubic about its left end (SciPy's `PPoly`).  The torque is
continuous with its slope, or at least with its value; the energy is its integral, shifted so that the least one is 0.
Pieces with an origin of their own lose no digits to a far one.  Everything that is computed with a law is computed
with these pieces, by SciPy and by CasADi alike, so that IPOPT confirms with the law itself.

Signs: torque is dU/dphi, positive where energy grows towards valley; the hinge pushes the other way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number, check_whole
from origami_nlp.errors import SceneError
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import INPUT_TOL, RESOLVED

MOST_PIECES = 2_000
"""Of one law."""
AS_STATED = 1e-6
"""Of the largest torque: what the pieces of a law that is stated by a formula may differ by."""
FEWEST_ROWS = 6
"""Of a table."""
WIDTHS = 0.02, 10.0
"""Of wells [rad]."""
MOST_WELLS = 32
"""Of a detent, a turn."""


@dataclass(frozen=True, repr=False)
class HingeLaw(ShortRepr):
    """Torque of a hinge over its fold angle.

    Parameters
    ----------
    breaks
        Where pieces end, increasing, [B + 1] [rad]; the law is known between the first and the last.
    coefficients
        Of the torque on each piece, of (phi - break)^3 to (phi - break)^0, [B, 4] [N m/rad^3, ..., N m].
    name
        What reports call it.
    made_from
        The law, the factor and the angle [rad] that `times` and `shifted` made it with.

    Attributes
    ----------
    stiffness
        Mean |dtorque/dphi| [N m/rad]: what scales and metrics are made with, no value is.
    rest
        Angle of least energy [rad]; of a law that is shifted that of the law, shifted.
    monotone
        Whether the torque nowhere falls: the energy is convex.

    Examples
    --------
    >>> law = double_well(energy=1.0, at=1.0)
    >>> law.energy(np.array([-1.0, 0.0, 1.0])).round(6).tolist(), law.monotone
    ([0.0, 1.0, 0.0], False)
    """

    breaks: tuple[float, ...]
    coefficients: tuple[tuple[float, ...], ...]
    name: str = "law"
    made_from: tuple[HingeLaw, float, float] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        x, c = np.array(self.breaks, float), np.array(self.coefficients, float)
        if x.ndim != 1 or len(x) < 2 or c.shape != (len(x) - 1, 4) or len(x) > MOST_PIECES:
            raise SceneError(
                f"hinge law {self.name!r}: give breaks [B + 1] and coefficients [B, 4], at most {MOST_PIECES} pieces"
            )
        if not (np.isfinite(x).all() and np.isfinite(c).all() and (np.diff(x) > 0).all()):
            raise SceneError(
                f"hinge law {self.name!r}: breaks must increase, and all numbers be finite"
            )
        steps = np.diff(x)[:-1]
        ends = np.polyval(c[:-1].T, steps)
        jump = np.abs(ends - c[1:, 3]).max(initial=0.0)
        largest = np.abs(c[:, 2:] * np.stack([np.diff(x), np.ones(len(c))], axis=1)).max()
        if jump > INPUT_TOL * max(largest, np.finfo(float).tiny):
            raise SceneError(
                f"hinge law {self.name!r}: the torque jumps by {jump:.3g} N m between two pieces"
            )
        if not self.stiffness > 0:
            raise SceneError(
                f"hinge law {self.name!r}: the torque is the same everywhere: that is a preload"
            )

    @cached_property
    def _torque(self) -> Any:
        from scipy.interpolate import PPoly

        # beyond the ends the tangent goes on: searches look there, states do not stay
        x, c = np.array(self.breaks), np.array(self.coefficients)
        last, h = c[-1], x[-1] - x[-2]
        value, slope = np.polyval(last, h), np.polyval(np.polyder(last), h)
        first = np.array([0.0, 0.0, c[0, 2], c[0, 3] - c[0, 2] * FAR])
        whole = np.vstack([first, c, np.array([0.0, 0.0, slope, value])])
        return PPoly(whole.T, np.concatenate([[x[0] - FAR], x, [x[-1] + FAR]]))

    @cached_property
    def _slope(self) -> Any:
        return self._torque.derivative()

    @cached_property
    def _energy(self) -> Any:
        energy = self._torque.antiderivative()
        roots = np.concatenate([self._torque.roots(extrapolate=False), self.breaks])
        inside = roots[np.isfinite(roots) & (roots >= self.breaks[0]) & (roots <= self.breaks[-1])]
        energy.c[-1] -= energy(inside).min()
        return energy

    @property
    def origin(self) -> tuple[HingeLaw, float, float]:
        """The law U, the factor s and the angle d [rad] of which this is s U(phi - d); itself, 1 and 0 at first."""
        return self.made_from or (self, 1.0, 0.0)

    @property
    def energy_pieces(self) -> tuple[np.ndarray, np.ndarray]:
        """Breaks [B + 1], and coefficients of the energy, of (phi - break)^4 to 1, [5, B]; both ends go straight on."""
        return self._energy.x, self._energy.c

    def energy(self, phi: np.ndarray) -> np.ndarray:
        """Energy at fold angles [...] [J], 0 at the least; the torque goes on straight beyond the ends."""
        return np.asarray(self._energy(phi))

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Torque dU/dphi at fold angles [...] [N m]."""
        return np.asarray(self._torque(phi))

    def slope(self, phi: np.ndarray) -> np.ndarray:
        """Stiffness d2U/dphi2 at fold angles [...] [N m/rad]."""
        return np.asarray(self._slope(phi))

    def change(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Energy at b less that at a, [...] [J], without cancellation where both are on one piece."""
        here, there = (np.searchsorted(self.breaks, v, side="right") for v in (a, b))
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        # Gauss with two points integrates cubics exactly
        near = half * (
            self.torque(middle - half / math.sqrt(3)) + self.torque(middle + half / math.sqrt(3))
        )
        return np.where(here == there, near, self.energy(b) - self.energy(a))

    @cached_property
    def stiffness(self) -> float:
        """Mean |dtorque/dphi| [N m/rad]."""
        if self.made_from:
            return self.made_from[0].stiffness * self.made_from[1]
        x = np.array(self.breaks)
        inside = np.concatenate(
            [x[:-1] + share * np.diff(x) for share in (0.1, 0.3, 0.5, 0.7, 0.9)]
        )
        weights = np.tile(np.diff(x), 5)
        return float(np.average(np.abs(self.slope(inside)), weights=weights))

    @cached_property
    def rest(self) -> float:
        """Angle of least energy [rad]; of several the one nearest to 0, a valley before a mountain."""
        if self.made_from:
            law, _, by = self.made_from
            return float(np.clip(law.rest + by, -math.pi, math.pi))
        roots = np.concatenate([self._torque.roots(extrapolate=False), self.breaks])
        x = roots[np.isfinite(roots) & (roots >= self.breaks[0]) & (roots <= self.breaks[-1])]
        energy = self.energy(x)
        low = x[energy <= energy.min() + INPUT_TOL * max(float(energy.max()), np.finfo(float).tiny)]
        return float(low[np.lexsort((-low, np.round(np.abs(low), 9)))[0]])

    @cached_property
    def monotone(self) -> bool:
        """Whether the torque nowhere falls."""
        bent = self._slope.derivative().roots(extrapolate=False)
        x = np.concatenate([bent[np.isfinite(bent)], np.array(self.breaks)])
        x = x[(x >= self.breaks[0]) & (x <= self.breaks[-1])]
        low = np.nextafter(x, -np.inf)  # where the slope jumps both sides count
        return bool(min(self.slope(x).min(), self.slope(low).min()) >= -INPUT_TOL * self.stiffness)

    def times(self, factor: float) -> HingeLaw:
        """Return the law with `factor` times the torque: of a longer crease, or in other units."""
        law, so_far, by = self.origin
        check_number("factor", factor, 0.0)
        c = factor * np.array(self.coefficients)
        made = law, factor * so_far, by
        return replace(self, coefficients=tuple(map(tuple, c.tolist())), made_from=made)

    def shifted(self, by: float) -> HingeLaw:
        """Return the law whose wells are `by` [rad] further towards valley: U(phi - by)."""
        law, factor, so_far = self.origin
        moved = tuple((np.array(self.breaks) + by).tolist())
        return replace(self, breaks=moved, made_from=(law, factor, so_far + by))

    def plus(self, torque: float) -> HingeLaw:
        """Return the law with a constant torque [N m] added, of whatever else acts on the hinge."""
        c = np.array(self.coefficients) + [0.0, 0.0, 0.0, torque]
        return HingeLaw(self.breaks, tuple(map(tuple, c.tolist())), self.name)

    def turned(self) -> HingeLaw:
        """Return the law seen from the other side of the paper: U(-phi)."""
        x, c = np.array(self.breaks), np.array(self.coefficients)
        about = np.array([_moved(p, h) for p, h in zip(c, np.diff(x), strict=True)])
        turned = about[::-1] * np.array([1.0, -1.0, 1.0, -1.0])
        return HingeLaw(tuple((-x[::-1]).tolist()), tuple(map(tuple, turned.tolist())), self.name)

    def __str__(self) -> str:
        low, high = np.degrees([self.breaks[0], self.breaks[-1]])
        kind = "energy convex" if self.monotone else "energy not convex"
        return (
            f"{self.name}: {len(self.coefficients)} pieces from {low:.4g} to {high:.4g} degrees, least energy at "
            f"{math.degrees(self.rest):.4g} degrees, mean stiffness {self.stiffness:.4g} N m/rad, {kind}"
        )


FAR = 4.0
"""Length [rad] of the straight pieces beyond the ends."""


def _moved(p: np.ndarray, by: float) -> np.ndarray:
    """Coefficients of p(x + by)."""
    a, b, c, _ = p
    return np.array([a, 3 * a * by + b, (3 * a * by + 2 * b) * by + c, np.polyval(p, by)])


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
        c += np.array([_moved(p, by) for p, by in zip(pieces, x[:-1] - starts, strict=True)])
    return HingeLaw(tuple(x.tolist()), tuple(map(tuple, c.tolist())), name)
