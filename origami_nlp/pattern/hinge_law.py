"""Hinge laws: torque over fold angle as a piecewise cubic, in place of a linear spring.

A law is its pieces: breaks, and the torque on each as a cubic about its left end (SciPy's `PPoly`).  The torque is
continuous with its slope, or at least with its value; the energy is its integral, shifted so that the least one is 0.
Pieces with an origin of their own lose no digits to a far one.  Everything that is computed with a law is computed
with these pieces, by SciPy and by CasADi alike, so that IPOPT confirms with the law itself.

Signs: torque is dU/dphi, positive where energy grows towards valley; the hinge pushes the other way.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from origami_nlp.arguments import check_number
from origami_nlp.errors import SceneError
from origami_nlp.io import ShortRepr
from origami_nlp.numerics import EPS, INPUT_TOL, RESOLVED

MOST_PIECES = 2_000
"""Of one law."""


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

    Examples
    --------
    >>> from origami_nlp.pattern import double_well
    >>> law = double_well(energy=1.0, at=1.0)
    >>> law.energy(np.array([-1.0, 0.0, 1.0])).round(6).tolist()
    [0.0, 1.0, 0.0]
    """

    breaks: tuple[float, ...]
    coefficients: tuple[tuple[float, ...], ...]
    name: str = "law"
    made_from: tuple[HingeLaw, float, float] | None = field(default=None, compare=False)

    def __post_init__(self) -> None:
        if self.made_from:  # of one that was checked
            return
        x, c = np.array(self.breaks, float), np.array(self.coefficients, float)
        if x.ndim != 1 or len(x) < 2 or c.shape != (len(x) - 1, 4) or len(x) > MOST_PIECES:
            what = f"breaks [B + 1] and coefficients [B, 4], at most {MOST_PIECES} pieces"
            raise SceneError(f"hinge law {self.name!r}: give {what}")
        if not (np.isfinite(x).all() and np.isfinite(c).all() and (np.diff(x) > 0).all()):
            raise SceneError(f"hinge law {self.name!r}: breaks must increase, all be finite")
        steps = np.diff(x)[:-1]
        ends = np.polyval(c[:-1].T, steps)
        jump = np.abs(ends - c[1:, 3]).max(initial=0.0)
        largest = np.abs(c[:, 2:] * np.stack([np.diff(x), np.ones(len(c))], axis=1)).max()
        if jump > INPUT_TOL * max(largest, np.finfo(float).tiny):
            raise SceneError(f"hinge law {self.name!r}: the torque jumps by {jump:.3g} N m")
        if not self.stiffness > 0:
            raise SceneError(
                f"hinge law {self.name!r}: its torque never changes: that is a preload"
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
        energy.c[-1] -= energy(self._turns(self._torque)).min()
        return energy

    def _turns(self, of: Any) -> np.ndarray:
        """Where a piecewise polynomial is 0 or a piece begins or ends, [r] [rad]."""
        x = np.concatenate([of.roots(extrapolate=False), self.breaks])
        # of nan neither holds
        return np.asarray(x[(x >= self.breaks[0]) & (x <= self.breaks[-1])])

    @cached_property
    def _rounding(self) -> float:
        """What energies at rest are off by [J]: they are sums over pieces."""
        return 64 * EPS * float(np.abs(self._energy(np.array(self.breaks))).max())

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
        energy = np.asarray(self._energy(phi))
        return np.where(np.abs(energy) <= self._rounding, 0.0, energy)

    def torque(self, phi: np.ndarray) -> np.ndarray:
        """Torque dU/dphi at fold angles [...] [N m]."""
        return np.asarray(self._torque(phi))

    def slope(self, phi: np.ndarray) -> np.ndarray:
        """Stiffness d2U/dphi2 at fold angles [...] [N m/rad]."""
        return np.asarray(self._slope(phi))

    def change(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Energy at b less that at a, [...] [J], without cancellation where at most one break is between them."""
        x = np.array(self.breaks)
        here, there = (np.searchsorted(x, v, side="right") for v in (a, b))
        # where a break is between them the work is that to the break and that from there on
        knot = np.clip(x[np.clip(np.maximum(here, there) - 1, 0, len(x) - 1)], *np.sort([a, b], 0))
        near = self._work(a, np.where(here == there, b, knot))
        near = near + np.where(here == there, 0.0, self._work(knot, b))
        return np.where(abs(here - there) <= 1, near, self.energy(b) - self.energy(a))

    def _work(self, a: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Integral of the torque between angles on one piece: Gauss with two points integrates cubics exactly."""
        middle, half = 0.5 * (a + b), 0.5 * (b - a)
        away = half / math.sqrt(3)
        return half * (self.torque(middle - away) + self.torque(middle + away))

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
        x = self._turns(self._torque)
        energy = self.energy(x)
        low = x[energy <= energy.min() + INPUT_TOL * max(float(energy.max()), np.finfo(float).tiny)]
        return float(low[np.lexsort((-low, np.round(np.abs(low), 9)))[0]])

    @cached_property
    def most(self) -> float:
        """Largest |torque| [N m], or more: what turns a spring as stiff once round."""
        return max(
            2 * math.pi * self.stiffness, float(np.abs(self.torque(self._turns(self._slope))).max())
        )

    def extremes(self, low: float, high: float) -> np.ndarray:
        """Return energies [J] between two angles [rad], the least and the largest among them."""
        x = np.concatenate([self._torque.roots(extrapolate=False), self.breaks, [low, high]])
        return self.energy(x[np.isfinite(x) & (x >= low) & (x <= high)])

    def rests(self, low: float, high: float) -> tuple[float, ...]:
        """Return where the hinge rests between two fold limits: wells, and limits that it is pushed to, increasing."""
        x = self._torque.roots(extrapolate=False)
        x = np.sort(x[(x > max(low, self.breaks[0])) & (x < min(high, self.breaks[-1]))])
        # where pieces meet, once
        x = np.array([low, *x[np.diff(x, prepend=-np.inf) > RESOLVED], high])
        between = self.torque(0.5 * (x[1:] + x[:-1]))
        falls, rises = np.array([True, *(between < 0)]), np.array([*(between > 0), True])
        return tuple(x[falls & rises].tolist())

    @cached_property
    def one_rest(self) -> float:
        """Where alone the hinge rests between the ends of the law [rad]; 0 where that is at several angles, or a range.

        Then which of them is named may turn with the paper.
        """
        rests = self.rests(self.breaks[0], self.breaks[-1])
        return rests[0] if len(rests) == 1 else 0.0

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

    def equals(self, other: HingeLaw) -> bool:
        """Return whether another law has the same pieces up to rounding."""
        if len(self.breaks) != len(other.breaks):
            return False
        size = INPUT_TOL * max(np.abs(self.torque(np.array(self.breaks))).max(), self.stiffness)
        apart = np.abs(np.array(self.coefficients) - other.coefficients)
        return bool(
            np.allclose(self.breaks, other.breaks, rtol=0, atol=INPUT_TOL)
            and (apart <= size / np.diff(self.breaks)[:, None] ** [3, 2, 1, 0]).all()
        )

    def plus(self, torque: float) -> HingeLaw:
        """Return the law with a constant torque [N m] added, of whatever else acts on the hinge."""
        pieces = np.add(self.coefficients, (0.0, 0.0, 0.0, torque))
        return law_of(np.array(self.breaks), pieces, self.name)

    def turned(self) -> HingeLaw:
        """Return the law seen from the other side of the paper: U(-phi)."""
        x, c = np.array(self.breaks), np.array(self.coefficients)
        turned = moved_cubic(c.T, np.diff(x)).T[::-1] * np.array([1.0, -1.0, 1.0, -1.0])
        return law_of(-x[::-1], turned, self.name)

    def __str__(self) -> str:
        low, high = np.degrees([self.breaks[0], self.breaks[-1]])
        return (
            f"{self.name}: {len(self.coefficients)} pieces from {low:.4g} to {high:.4g} degrees, least energy at "
            f"{math.degrees(self.rest):.4g} degrees, mean stiffness {self.stiffness:.4g} N m/rad"
        )


FAR = 4.0
"""Length [rad] of the straight pieces beyond the ends."""


def moved_cubic(p: np.ndarray, by: np.ndarray) -> np.ndarray:
    """Return the coefficients of p(x + by).

    Parameters
    ----------
    p
        Coefficients of cubics, the highest power first, [4, B].
    by
        Of each, [B].

    Returns
    -------
    numpy.ndarray
        Shape [4, B].
    """
    a, b, c, _ = p
    return np.array([a, 3 * a * by + b, (3 * a * by + 2 * b) * by + c, np.polyval(p, by)])


def law_of(x: np.ndarray, c: np.ndarray, name: str) -> HingeLaw:
    """Return the law with breaks [B + 1] and coefficients [B, 4]."""
    return HingeLaw(tuple(x.tolist()), tuple(map(tuple, c.tolist())), name)
